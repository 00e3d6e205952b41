"""(R·V)^p of the mirror direction R = 2 (N·L) N − L, without losing the peak.

Near the mirror direction the cosine c = R·V is so close to 1 that its rounding alone, multiplied by p = 1000, costs three
digits. The chord does not suffer: |R − V|² = 2 − 2c, so ln c = log1p(−|R − V|²/2), and c^p = exp(p ln c).

The sensitivity of c^p = cos^p θ to an error δ of either direction is |d cos^p θ / dθ| δ ≤ s(p) δ, with

    s(p) = max over θ of p cos^(p−1) θ sin θ = √p ((p − 1)/p)^((p−1)/2)     at tan² θ = 1/(p − 1),     p ≥ 1

(1 for p = 1, about 0.61 √p beyond: 19 for p = 1000). For p < 1 the slope has no bound at c = 0, so there the cosine itself is
computed in double-double, which makes its *relative* error that of one rounding.
"""

from __future__ import annotations

import numpy as np

from equilux_oracle.doubledouble import DD, Array, dot

DIRECTIONS = 34.0
"""Bound, in u, on |Δ(R − V)| computed in double: L 5.5 and N 1, so N·L 9.5 (its own three products and two sums 3 more),
doubled and rounded twice 21, L again 5.5, difference 2, V 3 with the last subtraction."""


def power_of_chord(mirror: Array, to_viewer: Array, exponent: Array) -> Array:
    """max(0, R·V)^p for p ≥ 1 or p = 0, unit vectors (3, n), p (n,): 0 where R·V ≤ 0, for p = 0 too."""
    half_chord2 = 0.5 * np.sum((mirror - to_viewer) ** 2, axis=0)
    towards = half_chord2 < 1.0
    power: Array = np.where(towards, np.exp(exponent * np.log1p(-np.where(towards, half_chord2, 0.0))), 0.0)
    return power


def power_of_cosine(normal: DD, to_light: DD, to_viewer: DD, exponent: Array) -> Array:
    """The same for 0 < p < 1, from R·V = 2 (N·L)(N·V) − L·V in double-double; all three unit, (3, n)."""
    cosine = dot(normal, to_light) * 2.0 * dot(normal, to_viewer) - dot(to_light, to_viewer)
    towards = cosine.hi > 0.0
    power: Array = np.where(towards, np.where(towards, cosine.hi, 1.0) ** exponent, 0.0)
    return power


def sensitivity(exponent: Array) -> Array:
    """s(p) above, for p ≥ 1; 0 below, where the double-double path leaves nothing of it (and p = 0 has no slope)."""
    p = np.maximum(exponent, 1.0)
    slope: Array = np.sqrt(p) * ((p - 1.0) / p) ** ((p - 1.0) / 2.0)
    return np.where(exponent < 1.0, 0.0, slope)
