"""The interval of a median supposes nothing of how times are distributed, and says what it is worth."""

from __future__ import annotations

import random

import pytest

from equilux.tradeoff.spread import spread


@pytest.mark.parametrize(
    ("samples", "confidence", "low", "high"),
    [(1, 0.0, 0, 0), (3, 0.75, 0, 2), (5, 0.9375, 0, 4), (6, 0.96875, 0, 5), (9, 0.9609375, 1, 7)],
)
def test_the_interval_is_that_of_the_binomial_table(samples: int, confidence: float, low: int, high: int):
    found = spread([float(i) for i in range(samples)])
    assert (found.low, found.high, found.samples) == (low, high, samples)
    assert found.confidence == pytest.approx(confidence, abs=1e-12)


def test_it_holds_the_true_median_as_often_as_it_says():
    draw = random.Random(5)
    hits = 0
    for _ in range(4000):
        found = spread([draw.expovariate(1.0) for _ in range(9)])
        hits += found.low <= 0.6931471805599453 <= found.high
    # binomial: 4 standard deviations of the share are 0.012
    assert abs(hits / 4000 - 0.9609375) < 0.0125, hits / 4000


def test_no_sample_is_an_error():
    with pytest.raises(ValueError, match="no sample"):
        spread([])
