"""What is expected, what has improved, and which exit code a run ends with (contracts §2 and §3).

Here without a diagnosis, where the presence of a divergence is all that can be judged; test_judge_by_cause.py has the rest.
"""

from __future__ import annotations

from typing import Any

import pytest

from equilux.judge import exit_code, judge_case
from support.engine import scene

PINNED = "expect:\n  - {adapter: vtk, cause: exponent-clamped}"


def pair(a: str, b: str, verdict: str, invalid: int = 0) -> dict[str, Any]:
    return {"a": a, "b": b, "verdict": verdict, "invalid": invalid}


def judged(rest: str, *pairs: dict[str, Any], **statuses: str) -> dict[tuple[str, str], str]:
    (case,) = scene(rest=rest).cases
    present = {name: "ok" for each in pairs for name in (each["a"], each["b"])}
    return judge_case(case, present | statuses, pairs).judged


def test_a_divergence_nobody_expects_is_unexpected():
    assert judged("", pair("vtk", "oracle", "diverge")) == {("vtk", "oracle"): "diverge_unexpected"}


def test_an_expectation_covers_every_pair_of_its_adapter_and_no_other():
    pairs = [pair("vtk", "oracle", "diverge"), pair("vtk", "povray", "diverge"), pair("povray", "oracle", "diverge")]
    found = judged(PINNED, *pairs)
    assert found == {
        ("vtk", "oracle"): "diverge_expected",
        ("vtk", "povray"): "diverge_expected",
        ("povray", "oracle"): "diverge_unexpected",
    }


def test_a_pinned_divergence_that_is_gone_is_improved_against_the_truth_only():
    found = judged(PINNED, pair("vtk", "oracle", "agree"), pair("vtk", "reference", "agree"), pair("vtk", "povray", "agree"))
    assert found == {("vtk", "oracle"): "improved", ("vtk", "reference"): "agree", ("vtk", "povray"): "agree"}


def test_the_reference_is_the_truth_where_the_oracle_did_not_deliver():
    assert judged(PINNED, pair("vtk", "reference", "agree"), oracle="unsupported") == {("vtk", "reference"): "improved"}


def test_an_expectation_still_holds_when_the_adapter_agrees_with_a_peer_but_not_with_the_truth():
    found = judged(PINNED, pair("vtk", "oracle", "diverge"), pair("vtk", "povray", "agree"))
    assert found == {("vtk", "oracle"): "diverge_expected", ("vtk", "povray"): "agree"}


def test_pixels_that_are_no_radiance_are_never_expected():
    assert judged(PINNED, pair("vtk", "oracle", "diverge", invalid=1)) == {("vtk", "oracle"): "diverge_unexpected"}


def test_what_cannot_be_compared_is_neither():
    assert judged(PINNED, pair("vtk", "oracle", "not-comparable")) == {("vtk", "oracle"): "not_comparable"}


def test_an_expectation_is_used_once_per_case_and_only_when_its_adapter_was_compared():
    (case,) = scene(rest=PINNED).cases
    used = judge_case(case, {"vtk": "ok", "oracle": "ok"}, [pair("vtk", "oracle", "diverge"), pair("vtk", "povray", "diverge")])
    assert [(each.adapter, each.cause) for each in used.expectations_used] == [("vtk", "exponent-clamped")]
    assert judge_case(case, {"vtk": "missing", "oracle": "ok"}, [pair("povray", "oracle", "agree")]).expectations_used == []


def test_an_expectation_whose_condition_does_not_hold_has_no_say():
    rest = (
        "sweep:\n  exponent: {path: materials.clay.exponent, values: [100, 1000]}\n"
        'expect:\n  - {adapter: vtk, cause: exponent-clamped, when: "exponent > 128"}'
    )
    low, high = scene(specular=0.5, rest=rest).cases
    statuses = {"vtk": "ok", "oracle": "ok"}
    assert judge_case(low, statuses, [pair("vtk", "oracle", "agree")]).judged == {("vtk", "oracle"): "agree"}
    assert judge_case(high, statuses, [pair("vtk", "oracle", "agree")]).judged == {("vtk", "oracle"): "improved"}


AGREE, NOT, TRUTHS = ("vtk", "oracle", "agree"), ("vtk", "oracle", "not_comparable"), ("reference", "oracle", "agree")
EXPECTED, UNEXPECTED = ("vtk", "oracle", "diverge_expected"), ("vtk", "oracle", "diverge_unexpected")
IMPROVED = ("vtk", "oracle", "improved")


@pytest.mark.parametrize(
    ("statuses", "pairs", "named", "code"),
    [
        ("ok", [AGREE], "", 0),
        ("ok", [AGREE, EXPECTED], "", 0),
        ("unsupported", [AGREE], "", 0),
        ("missing", [TRUTHS], "", 0),
        ("ok", [AGREE, UNEXPECTED], "", 1),
        ("ok", [AGREE, IMPROVED], "", 1),
        ("invalid", [UNEXPECTED], "vtk", 1),
        ("missing", [TRUTHS], "vtk", 3),
        ("timeout", [AGREE], "", 3),
        ("crashed", [UNEXPECTED], "", 3),
        ("failed", [], "", 3),
        ("unsupported", [], "", 4),
        ("unsupported", [TRUTHS], "vtk", 4),
        ("ok", [NOT], "", 4),
        ("ok", [], "", 4),
        ("ok", [NOT, AGREE], "vtk", 0),
    ],
)
def test_exit_codes(statuses: str, pairs: list[tuple[str, str, str]], named: str, code: int):
    assert exit_code([("vtk", statuses), ("oracle", "ok")], pairs, frozenset(filter(None, [named]))) == code
