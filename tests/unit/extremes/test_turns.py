"""What is said of one direction of a curve."""

from __future__ import annotations

from collections.abc import Mapping

import pytest

from equilux.extremes.axes import BY_NAME
from equilux.extremes.breakdown import Outcome
from equilux.extremes.measure import turns
from equilux.extremes.record import Point, Turn

AXIS = BY_NAME["light-count"]
"""1, 10, 100, 1000: one direction."""


def turn(*told: tuple[Outcome, float]) -> Turn:
    """Of outcomes and errors, outward."""
    pairs = zip(AXIS.values, told, strict=True)
    points = [Point(value=value, case="c", outcome=outcome, error=error) for value, (outcome, error) in pairs]
    (found,) = turns(AXIS, points)
    return found


@pytest.mark.parametrize(
    ("told", "expected"),
    [
        ([("inside", 1e-7)] * 4, {"breakdown": None, "gives_up": None, "last_good": 1000}),
        ([("inside", 1e-7), ("inside", 2e-3), ("inside", 0.5), ("outside", 1.0)],
         {"breakdown": 1000, "coarse": 10, "gives_up": 10, "last_good": 1}),
        ([("inside", 1e-7), ("inside", 1e-7), ("blind", 1.0), ("refused", 0.0)],
         {"breakdown": None, "coarse": 100, "blind": 100, "refused": 1000, "gives_up": 100, "last_good": 10}),
        ([("inside", 5e-3), ("inside", 2e-2), ("inside", 6e-2), ("inside", 6e-2)],
         {"breakdown": None, "coarse": 100, "gives_up": 100, "last_good": 10}),
        ([("inside", 1e-7), ("outside", 1.0), ("inside", 0.5), ("inside", 1e-7)],
         {"breakdown": 10, "coarse": None, "gives_up": None, "last_good": 1}),
    ],
    ids=["holds", "coarse, then broken", "blind", "noisy from the start", "broken first"],
)  # fmt: skip
def test_a_picture_that_is_wrong_within_what_is_stated_does_not_hold(told: list, expected: Mapping[str, float | None]):
    found = turn(*told)
    assert {name: getattr(found, name) for name in expected} == expected
