"""What a surface sends to the viewer per radiance of a region: K_diff ∫ N·ω dω + K_spec × the highlight's integral."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equilux_oracle.doubledouble import Array, Bools, Index
from equilux_oracle.emitters.arcs import Arcs, circle_arc
from equilux_oracle.emitters.frame import Frame
from equilux_oracle.emitters.lambert import UNIT_ROUNDOFF, lambert
from equilux_oracle.emitters.lobe import curves, rotation_error
from equilux_oracle.emitters.panels import integrate
from equilux_oracle.emitters.regions import Polygon, Round
from equilux_scenes.model import Material


@dataclass(frozen=True)
class Reflecting:
    """Materials at n points: K_diff, K_spec (3, n), p (n,), and whether the highlight carries the receiver's cosine (n,)."""

    diffuse: Array
    specular: Array
    exponent: Array
    cosine: Bools

    @classmethod
    def of(cls, materials: list[Material], index: Index) -> Reflecting:
        """The materials `materials[index]`. Under brdf lambert K_spec does not count."""
        specular = [np.zeros(3) if m.brdf == "lambert" else np.asarray(m.specular) for m in materials]
        return cls(
            np.stack([np.asarray(m.diffuse) for m in materials], axis=1)[:, index],
            np.stack(specular, axis=1)[:, index],
            np.asarray([m.exponent for m in materials])[index],
            np.asarray([m.brdf == "phong-cosine" for m in materials])[index],
        )

    def __getitem__(self, chosen: Index) -> Reflecting:
        return Reflecting(self.diffuse[:, chosen], self.specular[:, chosen], self.exponent[chosen], self.cosine[chosen])


def from_region(region: Round | Polygon, frame: Frame, here: Reflecting) -> tuple[Array, Array]:
    """Radiance reflected per radiance of the region, (3, n), and a bound on its error."""
    value, bound = np.zeros_like(here.diffuse), np.zeros_like(here.diffuse)
    if np.any(here.diffuse):
        contour = region.contour(frame, highlight=False)
        irradiance, error = lambert(contour)
        value += here.diffuse * irradiance
        bound += here.diffuse * (error + _open(contour))
    if np.any(here.specular):
        contour = region.contour(frame, highlight=True)
        lobe, error = _highlight(contour, frame, here)
        value += here.specular * lobe
        bound += here.specular * (error + _open(contour))
    return value, bound + 4 * UNIT_ROUNDOFF * value


def from_everywhere(frame: Frame, here: Reflecting) -> tuple[Array, Array]:
    """The same for the whole hemisphere: π K_diff, and for the highlight the lune between the horizons of N and M."""
    value = np.pi * here.diffuse
    bound = np.zeros_like(value)
    if np.any(here.specular):
        zero, one = np.zeros(len(frame)), np.ones(len(frame))
        quarter = np.full(len(frame), np.pi / 2)
        contour = [
            circle_arc(np.stack([one, zero, zero]), np.stack([zero, one, zero]), -quarter, quarter),
            circle_arc(np.stack([-frame.a, zero, frame.b]), np.stack([zero, -one, zero]), -quarter, quarter),
        ]
        lobe, error = _highlight(contour, frame, here)
        value, bound = value + here.specular * lobe, bound + here.specular * error
    return value, bound + 4 * UNIT_ROUNDOFF * value


def _highlight(contour: list[Arcs], frame: Frame, here: Reflecting) -> tuple[Array, Array]:
    shiny = np.any(here.specular > 0.0, axis=0)
    arcs = [part.between(part.start, np.where(shiny, part.end, part.start)) for part in contour]
    of = curves(arcs, frame, here.exponent, here.cosine)
    lobe, error = integrate(of, len(frame))
    lit = np.bincount(of.owner, minlength=len(frame)) > 0
    return np.maximum(lobe, 0.0), error + np.where(lit, UNIT_ROUNDOFF * rotation_error(frame, here.exponent), 0.0)


def _open(contour: list[Arcs]) -> Array:
    """How far a contour is from closed: nothing but rounding, unless two crossings of a horizon have been confused.

    An integrand is at most 1 per unit of length, so this also bounds what is missing.
    """
    gap = sum((arcs.gap() for arcs in contour), np.zeros(3).reshape(3, 1))
    result: Array = np.sqrt(np.sum(gap**2, axis=0))
    return result
