"""The text of a failure alone tells what to fix."""

from __future__ import annotations

import pytest

from equilux.ci import RunView
from equilux.ci.outcome import of_case

SAYS = {
    "vtk--oracle": [
        "clay[exponent=1]: vtk against oracle: diverge, and the scene does not expect it",
        "12 diverge (25.0 %)", "(3, 2)", "vtk     0.75 0.5 0.5 W/(m²·sr)", "oracle  0.5 W/(m²·sr)",
        "exponent-clamped [128]: the highlight's exponent is cut off at 128",
        "K_spec max(0, R·V)^p", "K_spec max(0, R·V)^min(p, 128)", "explains 99.8 %", "in the highlight of light key",
        "exponent-scaled [0.128]", "specular +0.93", "specs/clay.scene.yaml:2",
        "equilux explain out 'clay[exponent=1]' vtk oracle", "equilux report out",
    ],
    "povray--oracle": [
        "povray agrees with oracle, but the scene expects it to diverge (scaled): remove the expectation",
        "expectation: specs/clay.scene.yaml:16:5: povray: scaled no longer holds: remove it",
    ],
    "mitsuba": ["mitsuba crashed: ended by signal 11", "a pipe `and` a tick", "specs/clay.scene.yaml:2"],
}  # fmt: skip


@pytest.mark.parametrize("name", SAYS)
def test_a_failure_says_what_to_fix(view: RunView, name: str):
    (outcome,) = [outcome for outcome in of_case(view.results.cases[0], view) if outcome.name == name]
    for words in SAYS[name]:
        assert words in outcome.text, f"{words!r} is not in\n{outcome.text}"


def test_only_what_failed_has_a_text(view: RunView):
    outcomes = [outcome for case in view.results.cases for outcome in of_case(case, view)]
    assert {outcome.result for outcome in outcomes if outcome.text} == {"failed"}
    assert all(outcome.text for outcome in outcomes if outcome.result == "failed")


def test_only_pairs_with_an_adapter_that_was_named_are_scored(view: RunView):
    scored = {outcome.name for outcome in of_case(view.results.cases[0], view) if outcome.scored}
    assert scored == {"vtk--oracle", "vtk--povray", "vtk--reference"}
