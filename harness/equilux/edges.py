"""Which of a pair's diverging pixels are excused because a discontinuity passes within the film-position uncertainty δ of
their centre.

The reference is asked at positions around the centre, never at neighbouring pixels: a rule that looks at the neighbours
excuses half a pixel's shift along every silhouette.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

MINIMUM_DELTA_PX = 1e-6
MAXIMUM_DELTA_PX = 0.1
CHUNK_PIXELS = 1 << 15
"""Candidates judged at a time: bounds memory to some 60 MB, whatever the image's size."""


class Evaluator(Protocol):
    """What is asked of the tracer: radiance and path signature at any film position."""

    def evaluate(self, film_xy: Floats, channels: Sequence[str]) -> dict[str, npt.NDArray[Any]]:
        """film_xy: (n, 2) in pixels, (0.5, 0.5) the centre of the top-left one. "radiance": (n, 3), "signature": (n,)."""
        ...


def film_delta_px(film_px_a: float, film_px_b: float) -> float:
    """δ of a pair: both stated film-position uncertainties together, at least 1e-6 (double precision's own), at most 0.1
    pixel.
    """
    return min(max(film_px_a + film_px_b, MINIMUM_DELTA_PX), MAXIMUM_DELTA_PX)


def sample_offsets(delta_px: float) -> Floats:
    """(17, 2): the centre and eight points on each of the rings of radius δ/2 and δ, one ring turned by half a step against
    the other.

    A straight edge at distance ρ from the centre separates one of them from the centre wherever ρ ≤ δ cos(π/8) = 0.92 δ.
    """
    angles = np.arange(8) * (np.pi / 4)
    rings = [
        radius * np.stack([np.cos(angles + turn), np.sin(angles + turn)], axis=-1)
        for radius, turn in ((0.5 * delta_px, np.pi / 8), (delta_px, 0.0))
    ]
    return np.concatenate([np.zeros((1, 2)), *rings])


def edge_pixels(
    pixels: npt.NDArray[np.intp], width: int, a: Floats, b: Floats, bound: Floats, delta_px: float, tracer: Evaluator
) -> npt.NDArray[np.bool_]:
    """Which of the given pixels are edges, (n,) bool.

    pixels: (n,) row-major indices of pixels that would diverge; a, b, bound: (n, 3) both radiances and B there. A pixel is an
    edge when the path signature differs among the reference's samples around its centre, and each renderer's value lies, in
    all bands, within the range of the samples that share one signature, widened at both ends by that range's own width and by
    B (comparison.md, "Classes of pixel").
    """
    result = np.zeros(len(pixels), np.bool_)
    for start in range(0, len(pixels), CHUNK_PIXELS):
        part = slice(start, start + CHUNK_PIXELS)
        result[part] = _chunk(pixels[part], width, a[part], b[part], bound[part], delta_px, tracer)
    return result


def _chunk(
    pixels: npt.NDArray[np.intp], width: int, a: Floats, b: Floats, bound: Floats, delta_px: float, tracer: Evaluator
) -> npt.NDArray[np.bool_]:
    offsets = sample_offsets(delta_px)
    centres = np.stack([pixels % width + 0.5, pixels // width + 0.5], axis=-1)
    film_xy = (centres[:, None, :] + offsets).reshape(-1, 2)
    answer = tracer.evaluate(film_xy, ("radiance", "signature"))
    radiance = np.asarray(answer["radiance"], np.float64).reshape(len(pixels), len(offsets), 3)
    signature = np.asarray(answer["signature"]).reshape(len(pixels), len(offsets))

    crossed = np.flatnonzero((signature != signature[:, :1]).any(axis=1))
    low, high = _ranges(radiance[crossed], signature[crossed])
    result = np.zeros(len(pixels), np.bool_)
    result[crossed] = _explained(a[crossed], low, high, bound[crossed]) & _explained(b[crossed], low, high, bound[crossed])
    return result


def _ranges(radiance: Floats, signature: npt.NDArray[Any]) -> tuple[Floats, Floats]:
    """(n, s, 3) each: least and greatest radiance among the samples that share the signature of sample s."""
    low, high = np.empty_like(radiance), np.empty_like(radiance)
    for sample in range(signature.shape[1]):
        alike = (signature == signature[:, sample : sample + 1])[..., None]
        low[:, sample] = np.where(alike, radiance, np.inf).min(axis=1)
        high[:, sample] = np.where(alike, radiance, -np.inf).max(axis=1)
    return low, high


def _explained(value: Floats, low: Floats, high: Floats, bound: Floats) -> npt.NDArray[np.bool_]:
    """Whether one side of the discontinuity, some samples that share a signature, accounts for the value in all three bands."""
    margin = (high - low) + bound[:, None, :]
    inside: npt.NDArray[np.bool_] = (value[:, None, :] >= low - margin) & (value[:, None, :] <= high + margin)
    return np.asarray(np.any(np.all(inside, axis=2), axis=1))
