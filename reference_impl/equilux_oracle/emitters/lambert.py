"""Irradiance per radiance of a region: ∫ N·ω dω = ½ ∮ N·(r × dr), arc by arc in closed form (Lambert 1760).

On an arc (`arcs.py`) N·(r × r') = (k0 + kc cos t + ks sin t)/(A + Bc cos t + Bs sin t). Turned so that the denominator is
A + B cos τ, B ≥ 0, with D = √(A² − B²) = √(nearest (nearest + 2B)), κ = B/(A + D) and
φ(τ) = arctan(κ sin τ/(1 + κ cos τ)):

    ∫ dτ/q      = (τ − 2φ)/D
    ∫ cos τ/q   = −B τ/(D (A + D)) + 2 A φ/(B D),      φ/B = (φ/κ)/(A + D)
    ∫ sin τ/q   = −ln(q)/B

all written so that nothing is lost as B → 0 (a point on the disc's axis, and every cap and great circle). A whole turn leaves
2π (k0 − kc' B/(A + D))/D.

Rounding: a direction of the contour is off by some ε ≤ 8 u (|c| + |e|)/|p|, which moves the region's border and so changes the
integral by at most ½ ε per unit of length |p'|/|p| of the contour; evaluation loses as much again. That is 16 u ∫ (|c| + |e|)
|e|/|p|² dt = 16 u (|c| + |e|) |e| 2π/D at most, plus 16 u for each arc. Contours that lie wholly above the horizon keep their
relative accuracy, because k0 and kc' B are of the order of the solid angle itself.
"""

from __future__ import annotations

import numpy as np

from equilux_oracle.doubledouble import Array
from equilux_oracle.emitters.arcs import Arcs

UNIT_ROUNDOFF = 2.0**-53
DIRECTIONS = 16.0
"""In u: what a direction of the contour is off, 8 (centre minus point 1, into the local frame 5, sine and cosine 2), and as much
again for the evaluation."""


def lambert(contour: list[Arcs]) -> tuple[Array, Array]:
    """∫ N·ω dω over the region within a contour above the horizon, and a bound on its absolute error, both (n,)."""
    parts = [_along(arcs) for arcs in contour]
    return np.maximum(np.sum([value for value, _ in parts], axis=0), 0.0), np.sum([error for _, error in parts], axis=0)


def _along(arcs: Arcs) -> tuple[Array, Array]:
    """½ ∫ N·(r × dr) along each arc, and a bound on its error; 0 for an empty one."""
    c, e, f = arcs.c, arcs.e, arcs.f
    k0, kc, ks = _cross_z(e, f), _cross_z(c, f), -_cross_z(c, e)
    e2, c2 = np.sum(e**2, axis=0), np.sum(c**2, axis=0)
    bc, bs = 2 * np.sum(c * e, axis=0), 2 * np.sum(c * f, axis=0)
    b, turned = np.hypot(bc, bs), np.arctan2(bs, bc)
    # A cap and a great circle have no first harmonic: what rounding leaves of it is none.
    b = np.where(b <= 8 * UNIT_ROUNDOFF * (c2 + e2), 0.0, b)
    a = arcs.nearest + b
    d = np.sqrt(arcs.nearest * (arcs.nearest + 2 * b))
    along, across = kc * np.cos(turned) + ks * np.sin(turned), ks * np.cos(turned) - kc * np.sin(turned)
    whole = arcs.length >= 2 * np.pi
    with np.errstate(divide="ignore", invalid="ignore"):
        value = np.where(
            whole,
            2 * np.pi * (k0 - along * b / (a + d)) / d,
            _partial(k0, along, across, a, b, d, arcs.start - turned, arcs.end - turned),
        )
        turn_error = DIRECTIONS * UNIT_ROUNDOFF * (np.sqrt(c2) + np.sqrt(e2)) * np.sqrt(e2) / d
        relative = DIRECTIONS * UNIT_ROUNDOFF * np.sqrt(1 + e2 / arcs.nearest)
        error = np.where(
            whole,
            2 * np.pi * relative * (np.abs(k0) + e2 + np.abs(along) * b / (a + d)) / d,
            2 * np.pi * turn_error + DIRECTIONS * UNIT_ROUNDOFF,
        )
    error, used = error * arcs.unsure, arcs.end > arcs.start
    return np.where(used, 0.5 * value, 0.0), np.where(used, 0.5 * error, 0.0)


def _partial(k0: Array, along: Array, across: Array, a: Array, b: Array, d: Array, start: Array, end: Array) -> Array:
    """∫ (k0 + along cos τ + across sin τ)/(a + b cos τ) dτ from start to end, at most one turn."""
    kappa = b / (a + d)
    # φ jumps nowhere, κ being below 1. Its difference per κ:
    phi = [_arctan_per(kappa, np.sin(t), 1 + kappa * np.cos(t)) for t in (start, end)]
    change = phi[1] - phi[0]
    turn = end - start
    plain = (turn - 2 * kappa * change) / d
    cosine = -b * turn / (d * (a + d)) + 2 * a * change / ((a + d) * d)
    # cos τ1 − cos τ0 = −2 sin((τ1 + τ0)/2) sin((τ1 − τ0)/2)
    step = -2 * np.sin((end + start) / 2) * np.sin(turn / 2) / (a + b * np.cos(start))
    sine = -_log1p_per(b, step)
    result: Array = k0 * plain + along * cosine + across * sine
    return result


def _arctan_per(kappa: Array, sine: Array, base: Array) -> Array:
    """arctan(κ s/base)/κ, for κ = 0 too."""
    x = kappa * sine / base
    small = np.abs(x) < 1e-8
    factor = np.where(small, 1.0, np.arctan(x) / np.where(small, 1.0, x))
    result: Array = sine / base * factor
    return result


def _log1p_per(b: Array, step: Array) -> Array:
    """ln(1 + b s)/b, for b = 0 too."""
    x = b * step
    small = np.abs(x) < 1e-16
    result: Array = step * np.where(small, 1.0, np.log1p(np.where(small, 0.0, x)) / np.where(small, 1.0, x))
    return result


def _cross_z(v: Array, w: Array) -> Array:
    """N·(v × w), N being z."""
    result: Array = v[0] * w[1] - v[1] * w[0]
    return result
