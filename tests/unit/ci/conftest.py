"""One run with everything that a CI must be told, made by hand: no renderer, no engine."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from equilux.ci import RunView
from equilux.results import CaseRecord, PairRecord, RenderRecord, Results, RunRecord, summarise
from support.engine import write_scene

COLOURED = "\x1b[31mparse error\x1b[0m at line 3: \x00\x08 <&>]]> ￿\n| a pipe `and` a tick"
"""What a renderer may write to stderr."""
CLAMPED = {
    "id": "exponent-clamped", "parameter": 128, "explained": 0.998, "residual_max_abs": 1e-9, "side": "vtk",
    "words": "the highlight's exponent is cut off at 128", "formula": ["K_spec max(0, R·V)^p", "K_spec max(0, R·V)^min(p, 128)"],
    "suspects": "renderer",
    "region": {"pixels": 10, "x0": 2, "y0": 1, "x1": 5, "y1": 4, "words": "in the highlight of light key"},
    "alternatives": [{"id": "exponent-scaled", "parameter": 0.128}],
}  # fmt: skip
LEFT = {"id": "unexplained", "explained": 0.002, "side": "vtk", "terms": {"specular": 0.93, "diffuse": 0.2}}
PINNED = """sweep:
  exponent: {path: materials.clay.exponent, values: [1, 1000]}
expect:
  - {adapter: povray, cause: scaled}
  # vtk clamps it
  - {adapter: vtk, cause: exponent-clamped, when: exponent > 128}"""


def pair(a: str, b: str, judged: str, **fields: Any) -> PairRecord:
    verdict = {"agree": "agree", "improved": "agree", "not_comparable": "not-comparable"}.get(judged, "diverge")
    diverge = 12 if verdict == "diverge" else 0
    base = {
        "a": a, "b": b, "verdict": verdict, "judged": judged, "expected": judged == "diverge_expected", "pixels": 48,
        "agree": 48 - diverge, "diverge": diverge, "edge": 0, "invalid": 0, "max_abs": 0.25, "max_rel": 0.5, "rms": 0.1,
        "bias": 0.0,
        "p50": 0.0, "p95": 0.1, "p99": 0.2, "edge_max_abs": None, "en_max": 40.0,
        "worst": {"x": 3, "y": 2, "a": [0.75, 0.5, 0.5], "b": [0.5, 0.5, 0.5]} if diverge else None,
    }  # fmt: skip
    return PairRecord.model_validate(base | fields)


def render(status: str = "ok", **fields: Any) -> RenderRecord:
    return RenderRecord.model_validate({"status": status, "seconds": {"start": 0.5, "render": 1.0}, "version": "1.0"} | fields)


def case(name: str, renders: dict[str, RenderRecord], pairs: list[PairRecord], expect: list[dict[str, Any]] = []) -> CaseRecord:  # noqa: B006
    return CaseRecord.model_validate(
        {
            "case": name,
            "scene": name.partition("[")[0],
            "model": "phong",
            "width": 8,
            "height": 6,
            "requires": ["light.point"],
            "renders": renders,
            "pairs": pairs,
            "expect": expect,
        }
    )


@pytest.fixture
def view(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> RunView:
    """An unexpected divergence, one that is gone, one that is expected, a crash, an unsupported and a missing render."""
    monkeypatch.chdir(tmp_path)
    spec = write_scene(tmp_path / "specs" / "clay.scene.yaml", "clay", specular=0.5, rest=PINNED)
    tree = tmp_path / "out"
    folder = tree / "cases" / "clay[exponent=1]" / "mitsuba"
    folder.mkdir(parents=True)
    (folder / "render.json").write_text(json.dumps({"stderr_tail": COLOURED, "program": {"entry": "scene.xml"}}))
    (folder / "program").mkdir()
    (folder / "program" / "scene.xml").write_text("<scene/>")
    mine = {"adapter": "povray", "cause": "scaled", "held": False}
    known = {"adapter": "vtk", "cause": "exponent-clamped", "when": "exponent > 128", "held": True}
    cases = [
        case(
            "clay[exponent=1]",
            {
                "vtk": render(),
                "povray": render(),
                "oracle": render(),
                "reference": render(reused=True),
                "mitsuba": render("crashed", reason="ended by signal 11", signal=11, attempts=2),
                "opengl": render("unsupported", reason="cannot express model.phong", missing_features=["model.phong"]),
                "extra": render("missing", reason="no such program: extra"),
            },
            [
                pair("povray", "oracle", "improved"),
                pair("vtk", "oracle", "diverge_unexpected", causes=[CLAMPED, LEFT], explained=0.998),
                pair("vtk", "povray", "diverge_unexpected"),
                pair("vtk", "reference", "diverge_unexpected", causes=[CLAMPED, LEFT], explained=0.998),
                pair("reference", "oracle", "agree"),
            ],
            [mine],
        ),
        case(
            "clay[exponent=1000]",
            {"vtk": render(), "oracle": render()},
            [pair("vtk", "oracle", "diverge_expected", causes=[CLAMPED | {"declared": True}], explained=1.0)],
            [known],
        ),
        case("fog", {"vtk": render(), "oracle": render()}, [pair("vtk", "oracle", "not_comparable", reason="σ from 2 repeats")]),
    ]
    record = RunRecord(
        equilux="0.1.0", adapters={"vtk": "9.7", "povray": "3.7"}, command=["equilux", "run"],
        started="2026-01-02T03:04:05+00:00", ended="2026-01-02T03:04:09+00:00", seconds=4.0,
    )  # fmt: skip
    results = Results(run=record, cases=cases, summary=summarise(cases, 3))
    return RunView(results, tree, frozenset({"vtk"}), {"clay": spec}, ("fog: a | fault",))
