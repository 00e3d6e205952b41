"""The uncertainty budget of a render: named terms, each with a kind and a reason.

Two renders agree at a pixel when |L_a − L_b| ≤ B, B = Σ bounds of both + k √(σ_a² + σ_b²). A `Bound` is a hard limit on
|error|. A `Geometric` term bounds the error of the normal, of the position or of the position on the film, and is propagated
through the reference. A `Sampled` term is a standard deviation.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import numpy.typing as npt

FloatImage = npt.NDArray[np.floating]


@dataclass(frozen=True)
class Bound:
    """|error| ≤ abs + rel |L|, W/(m²·sr). `abs` may vary per pixel and band: (h, w, 3)."""

    name: str
    reason: str
    abs: float | FloatImage = 0.0
    rel: float = 0.0
    kind: Literal["bound"] = "bound"


@dataclass(frozen=True)
class Geometric:
    """A bound on what the renderer knows of the geometry, to be propagated through the reference.

    normal: bound on |ΔN| of the unit shading normal; position_m: bound on |ΔP| of the shaded point; each either one number or
    one per object (key: index in `scene.objects`, absent: 0). film_px: how far, in pixels, a discontinuity may be displaced
    on the film.
    """

    name: str
    reason: str
    normal: float | Mapping[int, float] = 0.0
    position_m: float | Mapping[int, float] = 0.0
    film_px: float = 0.0
    kind: Literal["geometric"] = "geometric"


@dataclass(frozen=True)
class Sampled:
    """σ of the mean per pixel and band, (h, w, 3), estimated from `repeats` independent repeats."""

    name: str
    reason: str
    sigma: FloatImage
    repeats: int
    kind: Literal["sampled"] = "sampled"


Term = Bound | Geometric | Sampled


@dataclass(frozen=True)
class Budget:
    """All terms of one render."""

    terms: tuple[Term, ...] = field(default=())

    @property
    def film_px(self) -> float:
        """Film-position uncertainty of the render in pixels: geometric terms add."""
        return sum(term.film_px for term in self.terms if isinstance(term, Geometric))


def pixel_mean(means: FloatImage, centres: FloatImage, terms: Sequence[Term]) -> Bound:
    """The term that makes a budget of the pixels' centres hold for means over pixels.

    Radiance is judged at the centres. How far a mean is off cannot be told from the mean, so the renderer's own picture of the
    centres is asked: |mean − truth| ≤ |mean − centre| + |centre − truth|, and the last is what `terms` state, relative ones of
    the centre's radiance. Both (h, w, 3); where one is not finite nothing is stated.
    """
    relative = sum(term.rel for term in terms if isinstance(term, Bound))
    finite = np.isfinite(means) & np.isfinite(centres)
    off = np.abs(np.where(finite, means, 0.0) - np.where(finite, centres, 0.0))
    reason = "antialiased: a mean over the pixel, off its centre's radiance by what the renderer's picture of the centres says"
    return Bound("pixel mean", reason, abs=off * (1.0 + relative))
