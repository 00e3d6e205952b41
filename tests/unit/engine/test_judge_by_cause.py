"""An expectation covers what was proven, and no more; it is gone when its cause is (contracts §2 and §3)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pytest

from equilux.diagnose.diagnosis import Alternative, Diagnosis, Found
from equilux.judge import JudgedCase, judge_case
from support.engine import scene

TRUTH = ("vtk", "oracle")


def pair(a: str = "vtk", b: str = "oracle", verdict: str = "diverge", invalid: int = 0, diverge: int = 9) -> dict[str, Any]:
    return {"a": a, "b": b, "verdict": verdict, "invalid": invalid, "diverge": diverge if verdict == "diverge" else 0}


def found(*causes: str | Found, adapter: str = "vtk") -> Diagnosis:
    named = tuple(cause if isinstance(cause, Found) else Found(id=cause, explained=1.0) for cause in causes)
    return Diagnosis(adapter=adapter, diverging=9, explained=1.0, causes=named)


def judge(
    expected: str, *diagnoses: Diagnosis, pairs: Sequence[dict[str, Any]] = (), excused: Sequence[str] = (), ruled: str = ""
) -> JudgedCase:
    """Judge a case that expects these causes of vtk."""
    pins = "\n".join(f'  - {{adapter: vtk, cause: "{cause}"}}' for cause in expected.split())
    (case,) = scene(rest=f"expect:\n{pins}" if pins else "").cases
    pairs = pairs or [pair()]
    statuses = {name: "ok" for each in pairs for name in (each["a"], each["b"])}
    rules = {"ruled": ruled.split()} if ruled else {}
    by_adapter = {diagnosis.adapter: diagnosis for diagnosis in diagnoses}
    return judge_case(case, statuses, pairs, by_adapter, excused={"vtk": excused}, **rules)


EITHER = Found(id="flipped-x", explained=1.0, alternatives=(Alternative(id="mirrored-handedness"),))


@pytest.mark.parametrize(
    ("expected", "causes", "judgement", "held"),
    [
        ("half-vector", ["half-vector"], "diverge_expected", [True]),
        ("half-vector scaled", ["scaled", "half-vector"], "diverge_expected", [True, True]),
        # another cause than the expected one, or one more
        ("half-vector", ["scaled"], "diverge_unexpected", [False]),
        ("half-vector", ["half-vector", "scaled"], "diverge_unexpected", [True]),
        ("", ["half-vector"], "diverge_unexpected", []),
        # something is left
        ("half-vector", ["half-vector", "unexplained"], "diverge_unexpected", [True]),
        ("half-vector", ["unexplained"], "diverge_unexpected", [False]),
        ("half-vector", [], "diverge_unexpected", [False]),
        ("unexplained", ["unexplained"], "diverge_expected", [True]),
        ("half-vector unexplained", ["half-vector", "unexplained"], "diverge_expected", [True, True]),
        ("unexplained", ["half-vector", "unexplained"], "diverge_unexpected", [True]),
        # a third party's cause that has no rule stands for what is left
        ("mine:blur", ["unexplained"], "diverge_expected", [True]),
        ("half-vector mine:blur", ["half-vector", "unexplained"], "diverge_expected", [True, True]),
        ("mine:blur", ["scaled", "unexplained"], "diverge_unexpected", [True]),
        # one of the expected causes is gone
        ("half-vector scaled", ["half-vector"], "improved", [True, False]),
        ("half-vector unexplained", ["half-vector"], "improved", [True, False]),
        ("half-vector mine:blur", ["half-vector"], "improved", [True, False]),
        # causes that the scene cannot tell apart
        ("flipped-x", [EITHER], "diverge_expected", [True]),
        ("mirrored-handedness", [EITHER], "diverge_expected", [True]),
        ("flipped-y", [EITHER], "diverge_unexpected", [False]),
    ],
)
def test_a_divergence_is_expected_where_every_proven_cause_is_and_nothing_is_left(
    expected: str, causes: list[str | Found], judgement: str, held: list[bool]
):
    judged = judge(expected, found(*causes))
    assert (judged.judged[TRUTH], judged.held) == (judgement, held)


def test_a_third_partys_cause_that_has_a_rule_covers_nothing_but_itself():
    assert judge("mine:blur", found("unexplained"), ruled="mine:blur scaled").judged[TRUTH] == "diverge_unexpected"
    assert judge("mine:blur", found("mine:blur"), ruled="mine:blur scaled").judged[TRUTH] == "diverge_expected"


def test_a_pair_that_agrees_improves_on_every_expectation():
    judged = judge("half-vector scaled", pairs=[pair(verdict="agree")])
    assert (judged.judged[TRUTH], judged.held) == ("improved", [False, False])


def test_pixels_that_are_no_radiance_are_never_expected_whatever_else_was_proven():
    assert judge("half-vector", found("half-vector"), pairs=[pair(invalid=1)]).judged[TRUTH] == "diverge_unexpected"


def test_a_picture_that_cannot_be_laid_over_the_truth_has_no_proven_cause_and_is_not_expected():
    other_size = [pair(diverge=0)]
    assert judge("half-vector", pairs=other_size).judged[TRUTH] == "diverge_unexpected"
    assert judge("unexplained", pairs=other_size).judged[TRUTH] == "diverge_expected"


def test_where_the_diagnosis_failed_presence_is_all_that_is_judged():
    assert judge("half-vector").judged[TRUTH] == "diverge_expected"
    assert judge("").judged[TRUTH] == "diverge_unexpected"


def test_an_expectation_that_stands_for_a_lack_is_not_gone_because_it_does_not_show():
    judged = judge("reflection-missing occlusion-ignored", found("reflection-missing"), excused=["occlusion-ignored"])
    assert (judged.judged[TRUTH], judged.held) == ("diverge_expected", [True, None])


def test_but_it_is_gone_where_the_picture_agrees():
    judged = judge("occlusion-ignored", pairs=[pair(verdict="agree")], excused=["occlusion-ignored"])
    assert (judged.judged[TRUTH], judged.held) == ("improved", [False])


def test_an_expectation_covers_the_pairs_of_its_adapter_with_peers_and_with_the_other_truth():
    pairs = [pair(), pair(b="reference"), pair(b="povray"), pair("povray", verdict="agree")]
    judged = judge("half-vector", found("half-vector"), pairs=pairs).judged
    assert judged["vtk", "povray"] == judged["vtk", "reference"] == "diverge_expected"


def test_it_covers_no_pair_where_its_adapter_does_something_else():
    pairs = [pair(), pair(b="reference"), pair(b="povray"), pair("povray", verdict="agree")]
    judged = judge("half-vector", found("scaled"), pairs=pairs).judged
    assert judged["vtk", "povray"] == judged["vtk", "reference"] == "diverge_unexpected"


def test_what_cannot_be_compared_leaves_the_expectation_undecided():
    judged = judge("half-vector", pairs=[pair(verdict="not-comparable"), pair(b="povray")])
    assert (judged.judged[TRUTH], judged.held) == ("not_comparable", [None])
