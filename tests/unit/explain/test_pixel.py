"""What B is made of at one pixel."""

from __future__ import annotations

import math

import pytest

from equilux.explain.pixel import SidePixel, pixel_facts

BOUND = {"name": "storage", "kind": "bound", "reason": "float32", "abs": 1e-3, "rel": 1e-2}
GEOMETRIC = {
    "name": "tessellation",
    "kind": "geometric",
    "reason": "sagitta",
    "normal": {"0": 2e-5},
    "position_m": 0.0,
    "film_px": 0,
}
SAMPLED = {"name": "noise", "kind": "sampled", "reason": "repeats", "sigma": {"max": 1, "median": 1}, "repeats": 64}


def side(adapter: str, radiance: float, *terms: dict, per_pixel: float = 0.0, sigma: float = 0.0) -> SidePixel:
    return SidePixel(adapter, (radiance,) * 3, {"terms": list(terms)}, (per_pixel,) * 3, (sigma,) * 3)


def test_bounds_add_and_what_is_sampled_is_squared():
    a, b = side("a", 2.0, BOUND, SAMPLED, sigma=3.0), side("b", 1.0, BOUND, SAMPLED, sigma=4.0)
    facts = pixel_facts(0, 0, a, b, coverage_factor=7.0)
    assert facts.bound[0] == pytest.approx((1e-3 + 2e-2) + (1e-3 + 1e-2) + 7 * 5)
    assert facts.normalised_error[0] == pytest.approx(1 / facts.bound[0])


def test_the_parts_are_named_largest_first_and_sum_to_b():
    facts = pixel_facts(0, 0, side("vtk", 2.0, BOUND, GEOMETRIC, per_pixel=0.5), side("oracle", 1.0, BOUND), 0.0)
    assert [(part.adapter, part.term, part.kind) for part in facts.parts] == [
        ("vtk", "tessellation", "geometric"), ("vtk", "storage", "bound"), ("oracle", "storage", "bound"),
    ]  # fmt: skip
    assert math.fsum(part.amount[0] for part in facts.parts) == pytest.approx(facts.bound[0])
    assert "|ΔN| ≤ 2e-05" in facts.parts[0].reason


def test_a_difference_between_exact_values_is_infinitely_many_bounds():
    facts = pixel_facts(0, 0, side("a", 1.0), side("b", 2.0), 0.0)
    assert facts.normalised_error == (-math.inf,) * 3
    assert facts.to_json()["en"] == [None] * 3


def test_the_worst_band_is_the_one_that_is_no_number():
    a = SidePixel("a", (1.0, math.nan, 5.0), {"terms": [BOUND]})
    assert pixel_facts(0, 0, a, side("b", 1.0), 0.0).band == 1
