"""Numbers that have a name."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest

from equilux.diagnose.scales import NAMED, candidates, recognised


@pytest.mark.parametrize(
    ("value", "name"),
    [(math.pi, "π"), (1 / math.pi, "1/π"), (1 / (4 * math.pi), "1/4π"), (683.0, "683"), (255 / 256, "255/256"), (0.5, "1/2")],
)
def test_a_factor_with_a_name_is_recognised(value: float, name: str) -> None:
    assert recognised(value) == name


def test_a_number_a_little_off_has_no_name() -> None:
    assert recognised(math.pi * (1 + 1e-9)) is None


def test_names_are_of_different_values() -> None:
    values = sorted(NAMED.values())
    assert all(b / a > 1 + 1e-9 for a, b in pairwise(values)), "two names of one value"


def test_nearest_names_come_before_digits_and_few_digits_before_many() -> None:
    found = list(candidates(3.1416, 3.1, 3.2))
    assert found[0] == (math.pi, "π")
    assert [value for value, name in found if name is None] == [3.1, 3.14, 3.142, 3.1416]
