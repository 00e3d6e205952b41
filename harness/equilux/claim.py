"""The accuracy that a render claims for itself: its largest stated uncertainty over its largest radiance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from equilux.edges import MAXIMUM_DELTA_PX
from equilux.uncertainty import Uncertainty, coverage_factor

SURE = Uncertainty()
"""Of a truth without any error: what a claim is made against."""


@dataclass(frozen=True)
class Claim:
    """relative: |L − L_true| ≤ relative · max |L_true| on every pixel that is no edge, as far as the renderer follows the model
    or what it declares; None where nothing can be claimed, for `reason`. Where the renderer samples, it holds on all pixels at
    once with a probability of 1 − 1e-6."""

    relative: float | None
    reason: str | None = None


def claimed(image: npt.NDArray[np.floating], stated: Uncertainty) -> Claim:
    """What a picture's own uncertainty claims.

    max |L_true| is not known: it is at least the largest |L| − B over the pixels, which is taken for it, so that the claim is
    never too good. A picture that is 0 with no uncertainty claims 0.
    """
    if stated.obstacle is not None:
        return Claim(None, stated.obstacle)
    if stated.film_px > MAXIMUM_DELTA_PX:
        moved = f"an outline may be displaced by {stated.film_px:.2g} pixels"
        return Claim(None, f"{moved}; only pixels within {MAXIMUM_DELTA_PX:g} of one are edges")
    if not np.all(np.isfinite(image)):
        return Claim(None, "the picture holds values that are no numbers")
    bound = stated.bound(image)
    if stated.sigma is not None:
        bound = bound + coverage_factor(stated, SURE, image.size) * stated.sigma
    worst = float(bound.max())
    if worst == 0:
        return Claim(0.0)
    largest = float((np.abs(image.astype(np.float64)) - bound).max())
    if not (largest > 0 and np.isfinite(worst)):
        return Claim(None, "the stated uncertainty is as large as the largest radiance")
    return Claim(worst / largest)
