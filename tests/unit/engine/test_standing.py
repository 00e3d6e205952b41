"""A render is judged against the truth, against what its adapter declares, and against its peers: whose fault is it?"""

from __future__ import annotations

from typing import Any, Literal

import pytest

from equilux.diagnose.diagnosis import Diagnosis, Found
from equilux.standing import standing_of


def pair(a: str, b: str, verdict: str = "diverge", reason: str | None = None) -> dict[str, Any]:
    return {"a": a, "b": b, "verdict": verdict, "reason": reason}


def cause(id: str, suspects: Literal["renderer", "translation"] = "renderer", declared: bool = False) -> Found:
    return Found(id=id, explained=1.0, suspects=suspects, declared=declared)


def diagnosis(*causes: Found, dialect: Literal["agree", "diverge"] | None = None, explained: float = 1.0) -> Diagnosis:
    return Diagnosis(adapter="vtk", diverging=9, explained=explained, causes=causes, dialect=dialect)


LEFT = Found(id="unexplained", explained=0.25)


@pytest.mark.parametrize(
    ("found", "finding", "said"),
    [
        (diagnosis(cause("exponent-clamped", declared=True), dialect="agree"), "model-difference", "exponent-clamped"),
        (diagnosis(cause("half-vector"), dialect="diverge"), "implementation-bug", "not declared: half-vector"),
        (diagnosis(cause("half-vector")), "implementation-bug", "not declared: half-vector"),
        (
            diagnosis(cause("half-vector", declared=True), cause("scaled")),
            "implementation-bug",
            "not declared: scaled",
        ),
        (
            diagnosis(cause("half-vector", declared=True), dialect="diverge"),
            "implementation-bug",
            "not as declared: half-vector",
        ),
        (diagnosis(cause("bands-swapped", "translation")), "translation-bug", "more likely the translation's fault"),
        (
            diagnosis(cause("half-vector", declared=True), cause("flipped-y", "translation"), dialect="diverge"),
            "translation-bug",
            "flipped-y: more likely",
        ),
        (diagnosis(cause("flipped-y", "translation"), cause("scaled")), "implementation-bug", "flipped-y, scaled"),
        (
            diagnosis(cause("scaled"), LEFT, explained=0.75),
            "implementation-bug",
            "25.0% of the diverging pixels stay unexplained",
        ),
        (diagnosis(LEFT, explained=0.0), "unexplained", "no named cause"),
    ],
)
def test_a_departure_is_the_models_the_renderers_or_the_translations(found: Diagnosis, finding: str, said: str):
    standing = standing_of("vtk", "oracle", [pair("vtk", "oracle")], found, was_diagnosed=True)
    assert standing is not None
    assert (standing.truth, standing.dialect, standing.finding) == ("diverge", found.dialect, finding)
    assert said in standing.reason


def test_who_agrees_with_the_truth_does_what_the_model_says_and_its_peers_are_named():
    pairs = [
        pair("vtk", "oracle", "agree"),
        pair("vtk", "povray"),
        pair("vtk", "opengl", "not-comparable"),
        pair("vtk", "reference"),
    ]
    standing = standing_of("vtk", "oracle", pairs, None, was_diagnosed=True)
    assert standing is not None
    assert (standing.finding, standing.peers, standing.reason) == ("as-modelled", {"povray": "diverge"}, "agrees with the oracle")


def test_what_was_not_diagnosed_says_why():
    for reason, was_diagnosed, said in (
        ("the images differ in size", True, "the images differ in size"),
        (None, True, "no cause could be looked for"),
        ("9 of 48 pixels diverge", False, "it was not diagnosed"),
    ):
        standing = standing_of("vtk", "oracle", [pair("vtk", "oracle", reason=reason)], None, was_diagnosed=was_diagnosed)
        assert standing is not None
        assert (standing.finding, standing.reason) == ("unexplained", said)


def test_a_truth_and_what_no_truth_was_compared_with_have_no_standing():
    assert standing_of("reference", "oracle", [pair("reference", "oracle")], None, was_diagnosed=True) is None
    assert standing_of("vtk", None, [pair("vtk", "povray")], None, was_diagnosed=True) is None
    assert standing_of("vtk", "oracle", [pair("vtk", "oracle", "not-comparable")], None, was_diagnosed=True) is None
