"""The median of a few repeats, and an interval for it that supposes nothing of how times are distributed."""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence

from equilux.tradeoff.record import Spread

CONFIDENCE = 0.95


def spread(samples: Sequence[float]) -> Spread:
    """Median, and the narrowest pair of order statistics [x_(j), x_(n+1−j)] that holds the true median with at least 95 %.

    The number of samples below the median is binomial (n, ½), so the pair holds it with 1 − 2 P(B ≤ j − 1) (David & Nagaraja,
    Order Statistics, 7.1). Few repeats cannot reach 95 %: then it is the least and the greatest, and `confidence` says how much
    that is worth (five: 93.75 %). Raises ValueError without samples.
    """
    ordered = sorted(samples)
    n = len(ordered)
    if n == 0:
        raise ValueError("no sample: expected at least one")
    outside, place = 2 * 0.5**n, 0
    while place + 1 < (n + 1) // 2:
        wider = outside + 2 * math.comb(n, place + 1) * 0.5**n
        if 1 - wider < CONFIDENCE:
            break
        outside, place = wider, place + 1
    return Spread(
        median=statistics.median(ordered), low=ordered[place], high=ordered[n - 1 - place],
        confidence=max(0.0, 1 - outside), samples=n,
    )  # fmt: skip
