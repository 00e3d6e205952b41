"""cos^p of the angle between two directions, without losing the peak: (R·V)^p of the mirror direction R = 2 (N·L) N − L, (N·H)^s
of the half vector, (T·V)^p of light refracted from behind.

Near the mirror direction the cosine c = R·V is so close to 1 that its rounding alone, multiplied by p = 1000, costs three
digits. The chord does not suffer: |R − V|² = 2 − 2c, so ln c = log1p(−|R − V|²/2), and c^p = exp(p ln c).

The sensitivity of c^p = cos^p θ to an error δ of either direction is |d cos^p θ / dθ| δ ≤ s(p) δ, with

    s(p) = max over θ of p cos^(p−1) θ sin θ = √p ((p − 1)/p)^((p−1)/2)     at tan² θ = 1/(p − 1),     p ≥ 1

(1 for p = 1, about 0.61 √p beyond: 19 for p = 1000). For p < 1 the slope has no bound at c = 0, so there the cosine itself is
computed in double-double, which makes its *relative* error that of one rounding.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from equilux_oracle.doubledouble import DD, Array, Bools, Index, dot, unit

MIRRORED = 34.0
"""Bound, in u, on |Δ(R − V)| computed in double: L 5.5 and N 1, so N·L 9.5 (its own three products and two sums 3 more),
doubled and rounded twice 21, L again 5.5, difference 2, V 3 with the last subtraction."""

ROUNDED_ONCE = 4.0
"""The same for two directions that come in double-double and are rounded to double: each 1, their difference 2."""

Highlight = Callable[[Index], Array]
"""The power at some of the points that it was made for, (k,)."""


def mirrored(normal: DD, to_light: DD, to_viewer: DD, exponent: Array) -> Highlight:
    """max(0, R·V)^p at points (3, n), p (n,): 0 where R·V ≤ 0, for p = 0 too. The vector to the light need not be unit."""

    def at(chosen: Index) -> Array:
        n, w, v, p = normal[:, chosen], to_light[:, chosen], to_viewer[:, chosen], exponent[chosen]
        towards = w.hi / np.sqrt(np.sum(w.hi**2, axis=0))
        mirror = 2.0 * np.sum(n.hi * towards, axis=0) * n.hi - towards
        power = power_of_chord(mirror, v.hi, p)
        steep = np.flatnonzero((p > 0.0) & (p < 1.0))
        if len(steep):
            n, towards_dd, v = n[:, steep], unit(w[:, steep]), v[:, steep]
            power[steep] = power_of_cosine(dot(n, towards_dd) * 2.0 * dot(n, v) - dot(towards_dd, v), p[steep])
        return power

    return at


def halfway(normal: DD, to_light: DD, to_viewer: DD, exponent: Array) -> Highlight:
    """max(0, N·H)^s with H = unit(L + V); 1 for s = 0 (Q9 of the oracle adapter's QUIRKS.md)."""

    def at(chosen: Index) -> Array:
        n, p = normal[:, chosen], exponent[chosen]
        half = unit(unit(to_light[:, chosen]) + to_viewer[:, chosen])
        return np.where(p == 0.0, 1.0, _power_between(half, n, p))

    return at


def passed(normal: DD, to_light: DD, to_viewer: DD, exponent: Array, eta: DD) -> Highlight:
    """max(0, T·V)^p of the light's ray d = −L, refracted to the side of the normal; 0 where it is totally reflected.

    eta: n_behind / n_front. With c = N·d and s² = η² (1 − c²), T = η d + (√(1 − s²) − η c) N.
    """

    def at(chosen: Index) -> Array:
        n, v, p, ratio = normal[:, chosen], to_viewer[:, chosen], exponent[chosen], eta[chosen]
        onward, total = refracted(-unit(to_light[:, chosen]), n, ratio)
        return np.where(total, 0.0, _power_between(onward, v, p))

    return at


def refracted(direction: DD, normal: DD, eta: DD) -> tuple[DD, Bools]:
    """A unit direction refracted by Snell's law to the side that `normal` points to, and where it is not but totally reflected.

    eta: the index that it comes from over the one it goes to. The tangential part t = d − c N grows η-fold, and
    T = η t + √(1 − η² t²) N; taken from 1 − c² it would lose η² digits.
    """
    along = (direction - normal * dot(normal, direction)) * eta
    s2 = dot(along, along)
    return along + normal * (1.0 - s2).sqrt(), s2.hi > 1.0


def _power_between(a: DD, b: DD, exponent: Array) -> Array:
    power = power_of_chord(a.hi, b.hi, exponent)
    steep = np.flatnonzero((exponent > 0.0) & (exponent < 1.0))
    if len(steep):
        power[steep] = power_of_cosine(dot(a[:, steep], b[:, steep]), exponent[steep])
    return power


def power_of_chord(mirror: Array, to_viewer: Array, exponent: Array) -> Array:
    """max(0, R·V)^p for p ≥ 1 or p = 0, unit vectors (3, n), p (n,): 0 where R·V ≤ 0, for p = 0 too."""
    half_chord2 = 0.5 * np.sum((mirror - to_viewer) ** 2, axis=0)
    towards = half_chord2 < 1.0
    power: Array = np.where(towards, np.exp(exponent * np.log1p(-np.where(towards, half_chord2, 0.0))), 0.0)
    return power


def power_of_cosine(cosine: DD, exponent: Array) -> Array:
    """max(0, c)^p for 0 < p < 1, of a cosine in double-double, such as R·V = 2 (N·L)(N·V) − L·V."""
    towards = cosine.hi > 0.0
    power: Array = np.where(towards, np.where(towards, cosine.hi, 1.0) ** exponent, 0.0)
    return power


def sensitivity(exponent: Array) -> Array:
    """s(p) above, for p ≥ 1; 0 below, where the double-double path leaves nothing of it (and p = 0 has no slope)."""
    p = np.maximum(exponent, 1.0)
    slope: Array = np.sqrt(p) * ((p - 1.0) / p) ** ((p - 1.0) / 2.0)
    return np.where(exponent < 1.0, 0.0, slope)
