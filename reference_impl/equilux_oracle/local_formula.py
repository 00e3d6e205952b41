"""The local formula of model `phong`, and a bound on the rounding of its evaluation.

    L = K_emit + K_amb L_amb + Σ_i E_i g_i [ K_diff (N·L_i) + K_spec max(0, R_i·V)^p ],     g_i = 1 if N·L_i > 0 else 0

N, V and the vectors to the lights come in double-double, exact to some 1e-28, and are rounded to double once; the rest is
double. Sums over lights are compensated, so that sixty-four lights cost no more digits than one.

The bound, with u = 2^-53, adds in first order (and a tenth more for the rest):
- K_emit + K_amb L_amb: product and sum, 2 u of the sum;
- diffuse of light i: E's own error e_i, N·L 9.5 absolute, two products: (e_i + 12) u E_i K_diff;
- highlight of light i: e_i, two products, the power's own exp and log1p 4 (x exp(−x) ≤ 0.37 tames what p multiplies), and what
  the directions are off: (e_i + 6 + 34 s(p)) u E_i K_spec, s(p) of highlight.py;
- the last sum: u |L|.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equilux_oracle.doubledouble import DD, Array, unit
from equilux_oracle.highlight import DIRECTIONS, power_of_chord, power_of_cosine, sensitivity
from equilux_oracle.lights import Arriving
from equilux_scenes.model import Material

UNIT_ROUNDOFF = 2.0**-53
_SECOND_ORDER = 1.1


@dataclass(frozen=True)
class Surface:
    """Material constants at n points: bands (3, n), exponent (n,)."""

    constant: Array  # K_emit + K_amb L_amb
    diffuse: Array
    specular: Array
    exponent: Array


def surface(materials: list[Material], index: Array, ambient: tuple[float, float, float]) -> Surface:
    """The constants of the materials `materials[index]`."""

    def bands(values: list[Array]) -> Array:
        return np.stack(values, axis=1)[:, index]

    return Surface(
        bands([np.asarray(m.emission) + np.asarray(m.ambient) * np.asarray(ambient) for m in materials]),
        bands([np.asarray(m.diffuse) for m in materials]),
        bands([np.asarray(m.specular) for m in materials]),
        np.asarray([m.exponent for m in materials])[index],
    )


@dataclass
class Shading:
    """What is being summed, (3, n).

    total and lost: radiance, and what rounding has taken from the sum. bound: the error so far, in u. scale: K_emit +
    K_amb L_amb + Σ E_i (K_diff + K_spec).
    """

    total: Array
    lost: Array
    bound: Array
    scale: Array

    @classmethod
    def begin(cls, here: Surface) -> Shading:
        return cls(here.constant.copy(), np.zeros_like(here.constant), 2.0 * here.constant, here.constant.copy())

    def add(self, term: Array) -> None:
        """Neumaier's compensated sum of terms that are never negative."""
        s = self.total + term
        larger, smaller = np.maximum(self.total, term), np.minimum(self.total, term)
        self.lost += (larger - s) + smaller
        self.total = s

    def finish(self) -> tuple[Array, Array]:
        """Radiance and its absolute bound, (3, n)."""
        radiance = self.total + self.lost
        return radiance, UNIT_ROUNDOFF * _SECOND_ORDER * (self.bound + radiance)


def shade(here: Surface, normal: DD, to_viewer: DD, light: Arriving, into: Shading) -> None:
    """Add one light's diffuse term and highlight."""
    n, v, w = normal.hi, to_viewer.hi, light.to_light.hi
    with np.errstate(invalid="ignore", divide="ignore"):  # a light exactly at the point has no direction, and adds nothing
        to_light = w / np.sqrt(np.sum(w**2, axis=0))
        cosine = np.sum(n * to_light, axis=0)
    into.scale += light.value * (here.diffuse + here.specular)
    lit = np.flatnonzero(cosine > 0.0)
    if len(lit) == 0:
        return
    cosine, e, p = cosine[lit], light.value[:, lit], here.exponent[lit]
    power = np.zeros(len(lit))
    if np.any(here.specular[:, lit]):
        mirror = 2.0 * cosine * n[:, lit] - to_light[:, lit]
        power = power_of_chord(mirror, v[:, lit], p)
        steep = np.flatnonzero((p > 0.0) & (p < 1.0))
        if len(steep):
            at = lit[steep]
            power[steep] = power_of_cosine(normal[:, at], unit(light.to_light[:, at]), to_viewer[:, at], p[steep])
    term, bound = np.zeros_like(into.total), e * here.diffuse[:, lit] * (light.error[lit] + 12.0)
    term[:, lit] = e * (here.diffuse[:, lit] * cosine + here.specular[:, lit] * power)
    into.add(term)
    into.bound[:, lit] += bound + e * here.specular[:, lit] * (light.error[lit] + 6.0 + DIRECTIONS * sensitivity(p))


