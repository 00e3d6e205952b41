"""The shortest `when:` that selects exactly the diverging cases."""

from __future__ import annotations

import itertools
import random
import time
from collections.abc import Callable
from typing import Any

import pytest

from equilux.pinning.when import shortest_when
from equilux_scenes.expectation import parse_when

EXPONENTS = [{"exponent": value} for value in (1, 10, 100, 1000)]
GRID = [{"exponent": p, "size": s} for p, s in itertools.product((1, 10, 100), (0.5, 1, 2))]


def found(cases: list[dict[str, Any]], holds: Callable[..., bool], parameters: tuple[float, ...] = ()) -> str | None:
    wanted = [holds(**case) for case in cases]
    when = shortest_when(cases, wanted, parameters)
    if when:
        assert [parse_when(when).holds(case) for case in cases] == wanted, when
    return when


def test_all_cases_need_no_condition():
    assert found(EXPONENTS, lambda exponent: True) == ""


def test_a_threshold_takes_the_parameter_of_the_cause_where_it_lies_in_the_gap():
    assert found(EXPONENTS, lambda exponent: exponent > 128, (128.0,)) == "exponent > 128"
    assert found(EXPONENTS, lambda exponent: exponent < 5, (5.0,)) == "exponent < 5"


def test_without_a_parameter_the_threshold_is_a_value_of_the_sweep():
    assert found(EXPONENTS, lambda exponent: exponent >= 100) == "exponent > 10"
    assert found(EXPONENTS, lambda exponent: exponent < 100, (7777.0,)) == "exponent < 100"


@pytest.mark.parametrize(
    ("holds", "when"),
    [
        (lambda exponent: exponent == 10, "exponent == 10"),
        (lambda exponent: exponent != 10, "exponent != 10"),
        (lambda exponent: exponent in (1, 1000), "exponent < 10 or exponent > 100"),
        (lambda exponent: exponent in (10, 100), "exponent > 1 and exponent < 1000"),
    ],
)
def test_one_axis(holds: Callable[..., bool], when: str):
    assert found(EXPONENTS, holds) == when


@pytest.mark.parametrize(
    ("holds", "when"),
    [
        (lambda exponent, size: size > 1, "size > 1"),
        (lambda exponent, size: exponent > 10 and size > 1, "exponent > 10 and size > 1"),
        (lambda exponent, size: exponent > 10 or size > 1, "size > 1 or exponent > 10"),
    ],
)
def test_two_axes(holds: Callable[..., bool], when: str):
    assert found(GRID, holds) == when


def test_cases_without_a_pattern_are_listed():
    assert found(GRID, lambda exponent, size: (exponent, size) in ((1, 1), (10, 0.5), (100, 2))) is not None


def test_every_selection_of_a_small_sweep_is_selected_exactly():
    for wanted in itertools.product((False, True), repeat=4):
        when = shortest_when(EXPONENTS, wanted)
        if any(wanted) and not all(wanted):
            assert when is not None
            assert tuple(parse_when(when).holds(case) for case in EXPONENTS) == wanted, when


def test_what_no_number_tells_apart_cannot_be_expressed():
    cases = [{"material": name, "size": 1} for name in ("clay", "glass")]
    assert shortest_when(cases, [True, False]) is None
    assert shortest_when([{"and": 1}, {"and": 2}], [True, False]) is None
    assert shortest_when(EXPONENTS, [False] * 4) is None


def test_axes_that_are_no_numbers_do_not_keep_the_others_from_being_used():
    cases = [{"material": name, "size": size} for name in ("clay", "glass") for size in (1, 2)]
    assert found(cases, lambda material, size: size == 2) == "size > 1"


def test_a_pattern_of_three_axes_is_found_among_a_thousand_cases():
    cases = [{"a": a, "b": b, "c": c} for a, b, c in itertools.product(range(10), range(10), range(10))]
    assert found(cases, lambda a, b, c: (a > 2 and b < 5 and c == 3) or c > 7) == "c > 7 or a > 2 and b < 5 and c == 3"


def test_a_sweep_without_a_pattern_takes_no_noticeable_time():
    cases = [{"a": a, "b": b, "c": c} for a, b, c in itertools.product(range(5), range(6), range(5))]
    chance = random.Random(1)
    wanted = [chance.random() < 0.5 for _ in cases]
    began = time.process_time()
    when = shortest_when(cases, wanted)
    assert when is not None
    assert [parse_when(when).holds(case) for case in cases] == wanted
    assert time.process_time() - began < 10
