"""What one surface point sends back of the lights' light, in every local model, and a bound on the rounding of its evaluation.

    L = K_emit + K_amb L_amb + Σ_i E_i g_i [ K_diff (N·L_i) + K_spec h_i ],     g_i = 1 if N·L_i > 0 else 0

with h_i = max(0, R_i·V)^p in models `phong` and `raytraced`, max(0, N·H_i)^s in `opengl`, and max(0, T_i·V)^p for light from
behind.

N, V and the vectors to the lights come in double-double, exact to some 1e-28, and are rounded to double once; the rest is
double. Sums over lights are compensated, so that sixty-four lights cost no more digits than one.

The bound, with u = 2^-53, adds in first order (and a tenth more for the rest):
- K_emit + K_amb L_amb: product and sum, 2 u of the sum;
- diffuse of light i: E's own error e_i, N·L 9.5 absolute (below 2^-10 it is taken from the double-doubles, which leaves relative
  ones), two products: (e_i + 12) u E_i K_diff;
- highlight of light i: e_i, two products, the power's own exp and log1p 4 (x exp(−x) ≤ 0.37 tames what p multiplies), and what
  the directions are off: (e_i + 6 + 34 s(p)) u E_i K_spec, s(p) of highlight.py (34 for R, 4 for H and T);
- the last sum: u |L|.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from equilux_oracle.doubledouble import DD, Array, Index
from equilux_oracle.highlight import Highlight, sensitivity
from equilux_oracle.lights import Arriving, cosine_to_light
from equilux_scenes.model import Material

Lit: TypeAlias = tuple[npt.NDArray[np.intp], Array]

UNIT_ROUNDOFF = 2.0**-53
_SECOND_ORDER = 1.1


@dataclass(frozen=True)
class Surface:
    """Material constants at n points: bands (3, n), exponent (n,)."""

    constant: Array  # K_emit + K_amb L_amb
    diffuse: Array
    specular: Array
    exponent: Array
    ambient: Array


def surface(materials: list[Material], index: Index, ambient: tuple[float, float, float]) -> Surface:
    """The constants of the materials `materials[index]`."""

    def bands(values: list[Array]) -> Array:
        return np.stack(values, axis=1)[:, index]

    return Surface(
        bands([np.asarray(m.emission) + np.asarray(m.ambient) * np.asarray(ambient) for m in materials]),
        bands([np.asarray(m.diffuse) for m in materials]),
        bands([np.asarray(m.specular) for m in materials]),
        np.asarray([m.exponent for m in materials])[index],
        bands([np.asarray(m.ambient) for m in materials]),
    )


@dataclass
class Shading:
    """What is being summed, (3, n).

    total and lost: radiance, and what rounding has taken from the sum. bound: the error so far, in u.
    """

    total: Array
    lost: Array
    bound: Array

    @classmethod
    def begin(cls, here: Surface) -> Shading:
        return cls(here.constant.copy(), np.zeros_like(here.constant), 2.0 * here.constant)

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


def shade(here: Surface, normal: DD, light: Arriving, highlight: Highlight, directions: float, into: Shading) -> Lit:
    """Add one light's diffuse term and highlight, where the light is on the normal's side; return where, and the power there.

    directions: bound, in u, on the error of the directions that the highlight compares.
    """
    cosine = cosine_to_light(normal, light)
    lit = np.flatnonzero((cosine > 0.0) & np.any(light.value > 0.0, axis=0))
    if len(lit) == 0:
        return lit, np.zeros(0)
    cosine, e, error, p = cosine[lit], light.value[:, lit], light.error[lit], here.exponent[lit]
    power = highlight(lit) if np.any(here.specular[:, lit]) else np.zeros(len(lit))
    term, bound = np.zeros_like(into.total), e * here.diffuse[:, lit] * (error + 12.0)
    term[:, lit] = e * (here.diffuse[:, lit] * cosine + here.specular[:, lit] * power)
    into.add(term)
    into.bound[:, lit] += bound + e * here.specular[:, lit] * (error + 6.0 + directions * sensitivity(p))
    return lit, power
