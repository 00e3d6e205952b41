"""B between a renderer's picture and a changed reference: the kernel's rule, at any pixels, for any radiance the change gives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from equilux import uncertainty
from equilux.compare import RenderedImage
from equilux.uncertainty import Uncertainty

Floats = npt.NDArray[np.float64]
Pixels = npt.NDArray[np.intp]

NO_DIGIT = 1e30
"""W/(m²·sr): stands for a bound beyond all numbers, as in the reference's own budget."""

TINY = 1e-300
"""In place of B = 0, so that E_n stays a number."""


@dataclass(frozen=True)
class PairBounds:
    """The renderer's share of B at all pixels, and how the reference's share follows from its radiance and its own error."""

    own: Floats
    """(pixels, 3): the renderer's hard bounds plus k σ."""
    abs: float
    rel: float
    coverage_factor: float

    @classmethod
    def of(cls, side: RenderedImage, truth: RenderedImage, stated: Uncertainty | None = None) -> PairBounds:
        """stated: in place of the side's own uncertainty (its geometric terms propagated through another tracer)."""
        stated = stated or side.uncertainty
        k = uncertainty.coverage_factor(side.uncertainty, truth.uncertainty, side.image.size)
        with np.errstate(invalid="ignore", over="ignore"):
            own = stated.bound(np.nan_to_num(np.asarray(side.image, np.float64))).reshape(-1, 3)
        if stated.sigma is not None:
            own = own + k * stated.sigma.reshape(-1, 3)
        return cls(own, truth.uncertainty.abs, truth.uncertainty.rel, k)

    def at(self, pixels: Pixels, radiance: Floats, error: Floats) -> Floats:
        """(n, 3): B where the changed reference shows `radiance` and bounds its own error by `error`."""
        return np.maximum(self.own[pixels] + self.abs + self.rel * np.abs(radiance) + error, TINY)

    def of_changed(self, error: Floats, film_px: float) -> Uncertainty:
        """What a changed reference states about its picture. error: (h, w, 3)."""
        with np.errstate(over="ignore"):
            rounded_up = np.nextafter(np.minimum(error, NO_DIGIT).astype(np.float32), np.float32(np.inf))
        return Uncertainty(abs=self.abs, rel=self.rel, per_pixel=rounded_up, film_px=film_px)


ERROR_CHANNELS = ("rounding", "quadrature")
"""The tracer's channels that bound the error of its radiance."""


def error_of(channels: dict[str, npt.NDArray[Any]]) -> Floats:
    """The sum of the tracer's error bounds; what it cannot vouch for is NO_DIGIT."""
    total = np.asarray(channels["rounding"] + channels["quadrature"], np.float64)
    return np.where(total <= NO_DIGIT, total, NO_DIGIT)


@dataclass(frozen=True)
class Tilts:
    """The geometric terms of a stated uncertainty, added up: δN and δP (m) of each object."""

    normal: Floats
    position_m: Floats

    @classmethod
    def of(cls, stated: Uncertainty, objects: int) -> Tilts | None:
        """None where nothing has to be propagated."""
        terms = [term for term in stated.terms if term["kind"] == "geometric"]
        tilts = cls(*(_per_object([term[name] for term in terms], objects) for name in ("normal", "position_m")))
        return tilts if tilts.normal.any() or tilts.position_m.any() else None


def _per_object(values: list[Any], objects: int) -> Floats:
    """One number is of all objects; so is entry −1 of those that are listed object by object."""
    total = np.zeros(objects)
    for value in values:
        if isinstance(value, dict):
            for index, part in value.items():
                total[slice(None) if int(index) < 0 else int(index)] += part
        else:
            total += value
    return total
