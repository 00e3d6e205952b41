"""What arrives from each light: the direction to it and the value E_i, before the cosine.

Point light: E = I / (d_c + d_l r + d_q r²). Directional light: E constant, L = −direction. Spot light: a point light times
cos^e θ of the angle θ to its axis where cos θ ≥ cos(half-angle), inclusive, and 0 outside.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from equilux_oracle.constants import cos_deg
from equilux_oracle.doubledouble import DD, Array, direction, dot, norm, unit, vector
from equilux_oracle.shapes.crossing import each_ray
from equilux_scenes.model import Attenuation, DeltaLight, DirectionalLight, PointLight, SpotLight


@dataclass(frozen=True)
class Arriving:
    """For n points: the vector to the light (not unit), the bands E_i (3, n), and a bound on E's relative error in units of u.

    The vector comes in double-double, its leading part being the exact vector rounded once. feels: how much the direction of the
    light matters to E, |d ln E / dθ| (n,). doubt: below what a cosine to the light is nothing but rounding, (n,).
    """

    to_light: DD
    value: Array
    error: Array
    feels: Array
    doubt: Array


FROM_POINTS = 9.0
"""Bound, in u, on the relative error of I / (d_c + d_l r + d_q r²): rounding of the vector's components 1 each, their squares'
sum 3 (r² has 5 in all, r 3.5), product with d_q 1, two sums 2, quotient 1."""


_SHRINK = 2.0**-600

NOTHING = 2.0**-85
"""Where a light lies in a surface's own plane, double-double leaves a cosine below this: it is not in front of it."""


def arriving(light: DeltaLight, eye: tuple[float, float, float]) -> Callable[[DD], Arriving]:
    """The light as a function of points (3, n) relative to the eye; what does not depend on the point is computed once."""
    if isinstance(light, DirectionalLight):
        return _directional(light)
    if isinstance(light, PointLight):
        return _point(light, eye)
    return _spot(light, eye)


def _directional(light: DirectionalLight) -> Callable[[DD], Arriving]:
    to_light, bands = unit(-direction(light.direction)), np.asarray(light.irradiance).reshape(3, 1)

    def at(point: DD) -> Arriving:
        count = point.hi.shape[1]
        nothing = np.zeros(count)
        return Arriving(each_ray(to_light, count), np.broadcast_to(bands, (3, count)), nothing, nothing, np.full(count, NOTHING))

    return at


def _point(light: PointLight, eye: tuple[float, float, float]) -> Callable[[DD], Arriving]:
    position, bands = vector(light.position) - vector(eye), np.asarray(light.intensity).reshape(3, 1)

    def at(point: DD) -> Arriving:
        to_light = position - point
        count = point.hi.shape[1]
        value = weakened(bands, light.attenuation, to_light.hi)
        return Arriving(to_light, value, np.full(count, FROM_POINTS), np.zeros(count), _doubt(point, to_light))

    return at


def _spot(light: SpotLight, eye: tuple[float, float, float]) -> Callable[[DD], Arriving]:
    position, bands = vector(light.position) - vector(eye), np.asarray(light.intensity).reshape(3, 1)
    axis, edge = unit(direction(light.direction)), cos_deg(light.cone_half_angle_deg)

    def at(point: DD) -> Arriving:
        to_light = position - point
        cosine = -dot(to_light, axis) / norm(to_light)
        factor, error = spot_factor(cosine, edge, light.exponent)
        value = weakened(bands, light.attenuation, to_light.hi) * factor
        flank = light.exponent * np.sqrt(np.maximum(np.where(factor > 0.0, cosine.hi, 1.0) ** -2.0 - 1.0, 0.0))
        return Arriving(to_light, value, FROM_POINTS + 1 + error, flank, _doubt(point, to_light))

    return at


def cosine_to_light(normal: DD, light: Arriving) -> Array:
    """N·L (n,), to its own last digits: where it is small, in double-double; 0 where that leaves nothing; NaN at the light."""
    w = light.to_light.hi
    with np.errstate(invalid="ignore", divide="ignore"):
        length = np.sqrt(np.sum(w**2, axis=0))
        cosine: Array = np.sum(normal.hi * (w / length), axis=0)
        small = np.flatnonzero(np.abs(cosine) < 2.0**-10)
        if len(small):
            exact = dot(normal[:, small], light.to_light[:, small]).hi / length[small]
            cosine[small] = np.where(np.abs(exact) > light.doubt[small], exact, 0.0)
    return cosine


def _doubt(point: DD, to_light: DD) -> Array:
    with np.errstate(divide="ignore", invalid="ignore"):
        farther: Array = np.max(np.abs(point.hi), axis=0) / np.sqrt(np.sum(to_light.hi**2, axis=0))
    return NOTHING * (1.0 + farther)


def weakened(bands: Array, law: Attenuation, to_light: Array) -> Array:
    """I / (d_c + d_l r + d_q r²) for bands (3, 1) and vectors (3, n); Inf at the light itself, where nothing is added."""
    r2 = np.sum(to_light**2, axis=0)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        r = np.sqrt(r2)
        whole: Array = law.constant + law.linear * r + law.quadratic * r2
        # A sum beyond all doubles may still leave something of a strong light.
        shrunk: Array = law.constant * _SHRINK + law.linear * _SHRINK * r + law.quadratic * _SHRINK * r2
        return np.where(np.isinf(whole), bands / shrunk * _SHRINK, bands / whole)


def spot_factor(cosine: DD, edge: DD, exponent: float) -> tuple[Array, Array]:
    """cos^e θ where cos θ ≥ edge, else 0; and a bound on its relative error in u.

    The cosine comes in double-double, because on the flank of a tight spot a relative error of it is multiplied by e. Rounded
    to double it is off by u; its logarithm ln c by another u |ln c| and by the function's own rounding, 2 u |ln c|; near 1 the
    logarithm is taken of the whole cosine, and nothing is lost by the rounding. All that times e, and 2 u for exp and product.
    """
    inside = cosine >= edge
    if exponent == 0.0:
        return np.where(inside, 1.0, 0.0), np.zeros(inside.shape)
    c = np.where(inside & (cosine.hi > 0.0), cosine.hi, 1.0)
    # ln(hi + lo) = log1p((hi − 1) + lo) near 1, where hi − 1 is exact.
    logarithm = np.where(c > 0.5, np.log1p((c - 1.0) + np.where(c == cosine.hi, cosine.lo, 0.0)), np.log(c))
    power = np.exp(exponent * logarithm)
    error = 2.0 + exponent * (np.where(c > 0.5, 0.0, 1.0) + 3.0 * np.abs(logarithm))
    return np.where(inside & (cosine.hi > 0.0), power, 0.0), error
