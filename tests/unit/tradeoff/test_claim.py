"""What a picture claims for itself is never better than what its budget says."""

from __future__ import annotations

import numpy as np
import pytest

from equilux.adapter import Bound, Budget, Geometric, Sampled
from equilux.claim import claimed
from equilux.uncertainty import coverage_factor, stated


def picture(*values: float) -> np.ndarray:
    return np.repeat(np.array(values, np.float64)[None, :, None], 3, axis=2)


def test_a_claim_is_the_largest_uncertainty_over_the_least_that_the_largest_radiance_can_be():
    image = picture(0.5, 2.0)
    claim = claimed(image, stated(Budget((Bound("b", "", abs=0.1),)), image))
    assert claim.relative == pytest.approx(0.1 / 1.9)


def test_a_dark_pixel_with_a_large_uncertainty_counts_against_the_brightest_radiance():
    image = picture(0.0, 2.0)
    bound = np.zeros((1, 2, 3))
    bound[0, 0] = 0.5
    assert claimed(image, stated(Budget((Bound("b", "", abs=bound),)), image)).relative == pytest.approx(0.25)


def test_a_sampled_uncertainty_counts_with_its_coverage_factor():
    image = picture(1.0, 1.0)
    uncertainty = stated(Budget((Sampled("s", "", sigma=np.full((1, 2, 3), 1e-3), repeats=64),)), image)
    k = coverage_factor(uncertainty, stated(Budget(), image), image.size)
    assert claimed(image, uncertainty).relative == pytest.approx(k * 1e-3 / (1 - k * 1e-3), rel=1e-6)
    assert k > 5


@pytest.mark.parametrize(
    ("image", "budget", "why"),
    [
        (picture(1.0, 1.0), Budget((Sampled("s", "", sigma=np.full((1, 2, 3), 1e-3), repeats=8),)), "rests on 8 repeats"),
        (picture(np.nan, 1.0), Budget(), "no numbers"),
        (picture(0.1, 0.2), Budget((Bound("b", "", abs=1.0),)), "as large as the largest radiance"),
        (picture(1.0, 1.0), Budget((Geometric("g", "", film_px=2.0),)), "an outline may be displaced by 2 pixels"),
    ],
)
def test_where_nothing_can_be_claimed_the_reason_is_told(image: np.ndarray, budget: Budget, why: str):
    claim = claimed(image, stated(budget, image))
    assert claim.relative is None
    assert why in str(claim.reason)


def test_an_exact_picture_claims_0():
    assert claimed(picture(0.0, 1.0), stated(Budget(), picture(0.0, 1.0))).relative == 0
