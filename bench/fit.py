"""How a cost grows with a size: the exponent of the power law, by least squares in logarithms, with its interval."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from equilux.uncertainty import student_quantile

CONFIDENCE = 0.95


@dataclass(frozen=True)
class PowerLaw:
    """cost ≈ factor · size^exponent; the exponent lies in [low, high] with 95 % confidence, residuals being independent."""

    factor: float
    exponent: float
    low: float
    high: float

    def __call__(self, size: float) -> float:
        return self.factor * math.pow(size, self.exponent)


def power_law(sizes: Sequence[float], costs: Sequence[float]) -> PowerLaw:
    """Ordinary least squares of log cost over log size; the interval is Student's with n − 2 degrees of freedom. Raises
    ValueError below three points, which leave no residual to judge by, and for a size or cost that has no logarithm."""
    if len(sizes) < 3 or min(*sizes, *costs) <= 0:
        raise ValueError(f"a power law: got {len(sizes)} points, {min(*sizes, *costs)} the least number; needed 3, all above 0")
    x, y = np.log(np.asarray(sizes, float)), np.log(np.asarray(costs, float))
    spread = float(((x - x.mean()) ** 2).sum())
    slope = float(((x - x.mean()) * (y - y.mean())).sum() / spread)
    level = float(y.mean() - slope * x.mean())
    freedom = len(sizes) - 2
    residual = float(((y - level - slope * x) ** 2).sum()) / freedom
    half = student_quantile((1 - CONFIDENCE) / 2, freedom) * math.sqrt(residual / spread)
    return PowerLaw(math.exp(level), slope, slope - half, slope + half)


def tail(sizes: Sequence[float], costs: Sequence[float], points: int = 4) -> PowerLaw:
    """The law of the largest sizes, where what does not grow (a start, an import) weighs least."""
    return power_law(sizes[-points:], costs[-points:])
