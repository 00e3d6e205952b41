"""A truth's stated bound → one that a budget can hold."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

NO_DIGIT = 1e30
"""W/(m²·sr), or the radiance itself where that is more. Where numbers end (between curved mirrors a bound grows with every
bounce, beyond all of them in the end; scenes too small for their distance from the origin; overflow) a bound says nothing, and
this stands for it, because a budget holds finite numbers only."""

Array = npt.NDArray[np.float64]


def vouched(image: Array, bound: Array) -> tuple[Array, int]:
    """The bound (h, w, 3), finite; and of how many pixels it vouches for no digit."""
    with np.errstate(invalid="ignore"):
        most = np.where(np.isfinite(image), np.maximum(np.abs(image), NO_DIGIT), NO_DIGIT)
    lost = ~(bound <= most)
    return np.where(lost, most, bound), int(lost.any(axis=2).sum())


def said_of_lost(pixels: int) -> str:
    """For the reason of the budget's term."""
    return f"; of {pixels} pixels it cannot vouch for a single digit, and says {NO_DIGIT:g}" if pixels else ""
