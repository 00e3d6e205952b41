"""What a run says at its end of pairs that need a look: by which causes, and which expectation is to be removed."""

from __future__ import annotations

import pytest

from equilux.cli.summary import summary
from equilux.diagnose.diagnosis import Found
from equilux.results import CaseRecord, ExpectationRecord, PairRecord, RenderRecord, Results, RunRecord, summarise

CLAMPED = Found(id="exponent-clamped", parameter=128.0, side="vtk")
TINTED = Found(id="highlight-tinted", side="vtk")


def pair(judged: str, *causes: Found, b: str = "oracle") -> PairRecord:
    verdict = "agree" if judged == "improved" and not causes else "diverge"
    counted = {"pixels": 12, "agree": 3, "diverge": 0 if verdict == "agree" else 9, "edge": 0, "invalid": 0}
    statistics = dict.fromkeys(("max_rel", "rms", "bias", "p50", "p95", "p99", "edge_max_abs"))
    fields = {"a": "vtk", "b": b, "verdict": verdict, "expected": False, "judged": judged, "max_abs": 0.5, "causes": list(causes)}
    return PairRecord.model_validate(counted | statistics | fields)


def told(one: PairRecord, *expectations: tuple[str, bool]) -> str:
    """The line about the pair."""
    case = CaseRecord(
        case="clay", scene="clay", model="phong", width=4, height=3, requires=[], pairs=[one],
        renders={"vtk": RenderRecord(status="ok"), one.b: RenderRecord(status="ok")},
        expect=[ExpectationRecord(adapter="vtk", cause=cause, held=held) for cause, held in expectations],
    )  # fmt: skip
    run = RunRecord(equilux="1", adapters={"vtk": "9"}, command=[], started="", ended="", seconds=1)
    (line,) = [
        line for line in summary(Results(run=run, cases=[case], summary=summarise([case], 1))).splitlines() if "clay:" in line
    ]
    return line


@pytest.mark.parametrize(
    ("one", "expectations", "line"),
    [
        (
            pair("diverge_unexpected", CLAMPED, TINTED),
            (),
            "clay: vtk diverges from oracle: 9 of 12 pixels, largest difference 0.5; by exponent-clamped [128], highlight-tinted",
        ),
        (
            pair("diverge_unexpected", CLAMPED, b="povray"),
            (),
            "clay: vtk diverges from povray: 9 of 12 pixels, largest difference 0.5; by vtk's exponent-clamped [128]",
        ),
        (
            pair("improved", CLAMPED),
            (("exponent-clamped", True), ("half-vector", False)),
            "clay: vtk diverges from oracle by exponent-clamped, and no more by half-vector as the scene expects: "
            "remove the expectation",
        ),
        (
            pair("improved"),
            (("exponent-clamped", False), ("half-vector", False)),
            "clay: vtk agrees with oracle, but the scene expects it to diverge (exponent-clamped, half-vector): "
            "remove the expectations",
        ),
    ],
)
def test_a_pair_that_needs_a_look_is_one_line_with_its_causes(
    one: PairRecord, expectations: tuple[tuple[str, bool], ...], line: str
):
    assert told(one, *expectations) == line
