"""`when`: the grammar and its precedence; comments beside expectations; expectations of a case."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from equilux_scenes.expectation import WhenError, parse_when

AXES = {"a": 1.0, "b": 2, "long-name_3": -4.5}
HOLDS = {
    "a == 1": True, "a != 1": False, "a < 1": False, "a <= 1": True, "a > .5": True, "a >= 1e0": True, "long-name_3 < -4": True,
    "a==1 and b==2": True, "a == 1 and b == 3": False, "a == 2 or b == 2": True, "a>-1": True,
    "a == 1 or b == 9 and b == 8": True,  # and binds tighter: otherwise False
    "b == 9 and b == 8 or a == 1": True,
    "a == 2 and b == 2 or a == 3 and b == 2": False,
}  # fmt: skip


@pytest.mark.parametrize("text", HOLDS)
def test_a_when_compares_axes_with_numbers_and_and_binds_tighter(text: str) -> None:
    assert parse_when(text).holds(AXES) is HOLDS[text]


# text → offset of the error
WRONG = {
    "": 0, "a": 1, "a >": 3, "a > b": 4, "1 < a": 0, "a < 1 < 2": 6, "a > 1 and": 9, "and a > 1": 0, "a > 1 or or b > 1": 9,
    "a > 1, b > 2": 5, "(a > 1)": 0, "not a > 1": 4, "a > 1 && b > 2": 6, "a = 1": 2, "a > 0x10": 4, "a > 1_0": 4, "a > nan": 4,
    "a > 1e999": 4,
    "a > 1 xor b > 1": 6, "__import__('os')": 10, "a.b > 1": 1, "a > 1 b > 2": 6, "a > --1": 4,
}  # fmt: skip


@pytest.mark.parametrize("text", WRONG)
def test_anything_else_is_an_error_at_its_place(text: str) -> None:
    with pytest.raises(WhenError) as caught:
        parse_when(text)
    assert caught.value.offset == WRONG[text], f"{caught.value} at {caught.value.offset}"


def test_a_when_on_an_axis_that_is_not_of_numbers_is_refused(only_error: Callable[..., str], edited: Callable[..., str]) -> None:
    text = edited(
        "exponent: {path: materials.clay.exponent, values: [1, 10, 100, 1000]}",
        "on: {path: objects.5.capped, values: [true, false]}",
        '"exponent > 128"', '"«on == 1"',
    )  # fmt: skip
    assert only_error(text) == "when of expectation 0: got axis 'on', allowed an axis whose values are all numbers (one is true)"


def test_an_expectation_applies_to_the_cases_where_it_holds(load: Callable[..., Any], valid: str) -> None:
    cases = load(valid).cases
    assert [(case.axes["exponent"], len(case.expectations)) for case in cases] == [(1, 0), (10, 0), (100, 0), (1000, 1)]


def test_an_expectation_without_when_applies_always(load: Callable[..., Any], edited: Callable[..., str]) -> None:
    assert [len(case.expectations) for case in load(edited(', when: "exponent > 128"', "")).cases] == [1, 1, 1, 1]


def test_an_expectation_that_holds_for_no_case_is_warned_about(load: Callable[..., Any], edited: Callable[..., str]) -> None:
    file = load(edited('"exponent > 128"', '"exponent > 1000"'))
    assert [str(warning) for warning in file.warnings] == [
        "spec.yaml:36:5: when of expectation 0: got 'exponent > 1000', which holds for no case of the sweep"
    ]


@pytest.mark.parametrize("cause", ["exponent-clamped", "unexplained", "blender:filmic-view", "my.lab:x_1"])
def test_known_causes_and_those_of_third_parties_are_accepted(
    load: Callable[..., Any], edited: Callable[..., str], cause: str
) -> None:
    assert load(edited("cause: exponent-clamped", f"cause: '{cause}'")).scene.expect[0].cause == cause


COMMENTS = {
    '- {adapter: vtk, cause: unexplained}  # beside': "beside",
    "# above\n  - {adapter: vtk, cause: unexplained}": "above",
    "# two\n  # lines\n  - {adapter: vtk, cause: unexplained}": "two lines",
    "- adapter: vtk  # first\n    cause: unexplained": "first",
    "- adapter: vtk\n    # between\n    cause: unexplained": "between",
    "- adapter: vtk\n    cause: unexplained  # last": "last",
    "- {adapter: vtk, cause: unexplained}": None,
    "- {adapter: 'v # not a comment', cause: unexplained}": None,
    "- {adapter: v#tk, cause: unexplained}": None,
    "- {adapter: 'v # no', cause: unexplained}  # yes": "yes",
    "# above\n\n  - {adapter: vtk, cause: unexplained}": None,
    "- {adapter: vtk, cause: unexplained}\n# below": None,
}  # fmt: skip


@pytest.mark.parametrize("item", COMMENTS)
def test_the_comment_beside_an_expectation_can_be_seen(load: Callable[..., Any], valid: str, item: str) -> None:
    text = valid[: valid.index("expect:")] + f"expect:\n  {item}\n"
    assert load(text).expect_comments == (COMMENTS[item],)


def test_comments_belong_to_their_own_item(load: Callable[..., Any], valid: str) -> None:
    a, b, c = (f"  - {{adapter: {name}, cause: unexplained}}" for name in "abc")
    items = f"{a}  # of a\n{b}\n  # of c\n{c}\n"
    assert load(valid[: valid.index("expect:")] + "expect:\n" + items).expect_comments == ("of a", None, "of c")
