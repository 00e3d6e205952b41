"""Integrals of `lobe.py` along arcs, by Gauss–Legendre panels each of which has a proven bound.

For f analytic and |f| ≤ M in the ellipse with foci at a panel's ends and semi-axes h (ρ ± 1/ρ)/2, the rule of N nodes on a
panel of half-length h is off by at most (64/15) h M ρ^(−2(N−1))/(1 − ρ^(−2)) (L. N. Trefethen, "Approximation Theory and
Approximation Practice", theorem 19.3). M is bounded here from ranges of the trigonometric polynomials in the ellipse: with t =
x + iy, Re cos t = cos x cosh y and |Im cos t| = |sin x sinh y|, and

- |q| ≥ Re q > 0, so that √q is analytic; |u| ≤ U = max |m|/√(min Re q);
- u^n, n no integer, is analytic where Re m > 0, and |u^n| = |u|^n ≤ U^n;
- |(1 − u^n)/(n (1 − u))| = |∫₀¹ (1 − s (1 − u))^(n−1) ds| ≤ max(1, U)^(n−1), and ≤ (1 + U^n)/(n (1 − U)) where U < 1;
- |1 + u| ≥ 1 where Re u ≥ 0, ≥ ½ where U ≤ ½, ≥ 1/√2 where Re m > 0 (then |arg u| < 3π/4).

Where u^n itself is negligible on the real panel (near M's horizon, or far from a sharp peak) it is split off: the rest, 1/(n (1
− u²)), is analytic across u = 0, and u^n costs at most twice its largest value times the panel's length. Every panel whose
bound exceeds the tolerance is halved. Near u = 0 that ends because U^n times the panel's length shrinks; it must end, and if it
does not within `DEPTH` halvings the panel keeps the bound that it has.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from equilux_oracle.doubledouble import Array, Bools, Index
from equilux_oracle.emitters.lobe import UNIT_ROUNDOFF, Curves, integrand

NODES = 20
DEPTH = 60
TOLERANCE = UNIT_ROUNDOFF
"""Allowed bound of a panel, times n: the lobe's whole integral is at most 2π/n, and its rounding several u."""
_ELLIPSES = (2.6, 4.0, 7.0)
_AT_ONCE = 1 << 15  # panels whose nodes are evaluated together

_X, _W = np.polynomial.legendre.leggauss(NODES)


def integrate(of: Curves, count: int) -> tuple[Array, Array]:
    """Sum of the integrals over the arcs that each of `count` points owns, and a bound on its error, both (count,)."""
    total, bound = np.zeros(count), np.zeros(count)
    for panels in _panels(of):
        for start in range(0, len(panels.curve), _AT_ONCE):
            part = panels[start : start + _AT_ONCE]
            curve = of[part.curve]
            t = part.middle[:, np.newaxis] + part.half[:, np.newaxis] * _X
            value, density = integrand(curve, t)
            total += np.bincount(curve.owner, part.half * (value @ _W), count)
            # Neighbouring panels meet up to the rounding of t, some 4 u: that much of the integrand is missing or counted twice.
            rounding = part.half * (density @ _W) + 0.5 * density.max(axis=1)
            bound += np.bincount(curve.owner, part.bound + UNIT_ROUNDOFF * rounding, count)
    return total, bound


@dataclass(frozen=True)
class _Panels:
    """curve: index of each panel's curve; middle and half-length of its range of t; bound: of its quadrature error."""

    curve: Index
    middle: Array
    half: Array
    bound: Array

    def __getitem__(self, chosen: Index) -> _Panels:
        return _Panels(self.curve[chosen], self.middle[chosen], self.half[chosen], self.bound[chosen])


def _panels(of: Curves) -> list[_Panels]:
    shapes = _Shapes.of(of)
    pieces = np.maximum(1, np.ceil((of.end - of.start) / 0.8)).astype(np.int64)
    curve = np.repeat(np.arange(len(pieces)), pieces)
    number = np.arange(len(curve)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    half = 0.5 * ((of.end - of.start) / pieces)[curve]
    middle = of.start[curve] + half * (2 * number + 1)
    accepted = []
    for depth in range(DEPTH + 1):
        bound = _bound(shapes[curve], middle, half)
        good = (bound * of.n[curve] <= TOLERANCE) | (depth == DEPTH)
        accepted.append(_Panels(curve[good], middle[good], half[good], bound[good]))
        bad = ~good
        if not bad.any():
            break
        curve, half = np.repeat(curve[bad], 2), np.repeat(0.5 * half[bad], 2)
        middle = np.repeat(middle[bad], 2) + half * np.tile([-1.0, 1.0], len(half) // 2)
    return accepted


@dataclass(frozen=True)
class _Shapes:
    """The trigonometric polynomials as constant + amplitude cos(t − phase), and what else a bound needs."""

    m0: Array
    m1: Array
    m_phase: Array
    k_most: Array
    k1: Array
    y0: Array
    y1: Array
    q0: Array
    q1: Array
    q_phase: Array
    nearest: Array
    n: Array
    whole: Bools
    a: Array
    b: Array
    cosine: Bools

    @classmethod
    def of(cls, c: Curves) -> _Shapes:
        q1 = np.hypot(c.q[1], c.q[2])
        return cls(
            c.m[0], np.hypot(c.m[1], c.m[2]), np.arctan2(c.m[2], c.m[1]),
            np.abs(c.k[0]), np.hypot(c.k[1], c.k[2]),
            np.abs(c.y[0]), np.hypot(c.y[1], c.y[2]),
            c.q[0], q1, np.arctan2(c.q[2], c.q[1]), c.nearest,
            c.n, c.n == np.round(c.n), c.a, c.b, c.cosine,
        )  # fmt: skip

    def __getitem__(self, chosen: Index) -> _Shapes:
        return _Shapes(*(getattr(self, name)[chosen] for name in self.__dataclass_fields__))


@dataclass(frozen=True)
class _Within:
    """Bounds in an ellipse: |u| ≤ most_u, |k/q| ≤ k, |d(B·r)/dt| ≤ dy; Re m > 0: ahead; Re u ≥ 0: upper; q cannot vanish:
    apart."""

    most_u: Array
    k: Array
    dy: Array
    ahead: Bools
    upper: Bools
    apart: Bools


def _bound(s: _Shapes, middle: Array, half: Array) -> Array:
    """The least proven bound on each panel's quadrature error, (panels,)."""
    with np.errstate(all="ignore"):  # where something may vanish, the bound is Inf and not used
        real = _within(s, middle, half, 1.0)
        u = np.minimum(real.most_u, 1.0)
        # Twice the largest value times the length, whatever the integrand does.
        best = 4 * half * real.k * np.where(s.cosine, s.a + s.b, 1.0)
        best = np.where(s.cosine, best + 4 * half * s.b / s.n * real.dy, best)
        split = 4 * half * _singular(s, real, u)
        for rho in _ELLIPSES:
            scale = half * (64 / 15) * rho ** (-2.0 * (NODES - 1)) / (1 - rho**-2.0)
            inside = _within(s, middle, half, rho)
            best = _least(best, scale * _whole(s, inside))
            best = _least(best, scale * _regular(s, inside) + split)
    return np.where(np.isnan(best), np.inf, best)


def _whole(s: _Shapes, w: _Within) -> Array:
    """Bound on the integrand in an ellipse; Inf where it need not be analytic."""
    u = w.most_u
    minus_one = np.where(w.upper, 1.0, np.where(u <= 0.5, 2.0, np.where(w.ahead, math.sqrt(2.0), np.inf)))
    value = minus_one * _lobe(u, s.n) * w.k
    if s.cosine.any():
        both = s.a * minus_one * _lobe(u, s.n + 1.0) * w.k + s.b / s.n * u**s.n * w.dy
        value = np.where(s.cosine, both, value)
    return np.where((w.ahead | s.whole) & w.apart, value, np.inf)


def _regular(s: _Shapes, w: _Within) -> Array:
    """Bound on the integrand without its u^n."""
    value = w.k / (1.0 - w.most_u**2) * np.where(s.cosine, s.a / (s.n + 1.0), 1.0 / s.n)
    return np.where((w.most_u < 1.0) & w.apart, value, np.inf)


def _singular(s: _Shapes, w: _Within, u: Array) -> Array:
    """Bound on what u^n contributes to the integrand on the real panel, u ≤ 1."""
    rest = w.k / (1.0 - u**2)
    plain = u**s.n / s.n * rest
    if s.cosine.any():
        both = s.a * u ** (s.n + 1.0) / (s.n + 1.0) * rest + s.b / s.n * u**s.n * w.dy
        plain = np.where(s.cosine, both, plain)
    return np.where(u < 1.0, plain, np.inf)


def _lobe(u: Array, n: Array) -> Array:
    """Bound on |(1 − u^n)/(n (1 − u))| for |u| ≤ u."""
    near = np.maximum(u, 1.0) ** (n - 1.0)
    far = np.where(u < 1.0, (1.0 + u**n) / (n * np.where(u < 1.0, 1.0 - u, 1.0)), np.inf)
    return np.minimum(near, far)


def _within(s: _Shapes, middle: Array, half: Array, rho: float) -> _Within:
    along, up = half * (rho + 1 / rho) / 2, half * (rho - 1 / rho) / 2
    cosh, sinh = np.cosh(up), np.sinh(up)
    low, high, sine = _ranges(middle - s.m_phase, along)
    m_low = s.m0 + s.m1 * np.minimum(low, low * cosh)
    m_high = s.m0 + s.m1 * np.maximum(high, high * cosh)
    m_imaginary = s.m1 * sine * sinh
    most_m = np.hypot(np.maximum(np.abs(m_low), np.abs(m_high)), m_imaginary)
    low, _, _ = _ranges(middle - s.q_phase, along)
    # A + B cos = (A − B) + B (1 + cos): near a disc's rim only that keeps its digits. Minus 1e-14 B for the phase's rounding.
    q_low = s.nearest * (1 - 1e-9) + s.q1 * (1.0 + low - 1e-14) - s.q1 * np.maximum(-low, 0.0) * (cosh - 1.0)
    root = np.sqrt(q_low)
    dy = s.y1 * cosh / root + (s.y0 + s.y1 * cosh) * 0.5 * s.q1 * cosh / (q_low * root)
    ahead = m_low > 0.0
    return _Within(most_m / root, (s.k_most + s.k1 * cosh) / q_low, dy, ahead, ahead & (m_imaginary <= m_low), q_low > 0.0)


def _ranges(middle: Array, half: Array) -> tuple[Array, Array, Array]:
    """Least and greatest cosine, and greatest |sine|, of middle ± half."""
    off = np.abs(middle - 2 * np.pi * np.round(middle / (2 * np.pi)))
    low, high = np.cos(np.minimum(off + half, np.pi)), np.cos(np.maximum(off - half, 0.0))
    side = np.abs(off - np.pi / 2)
    return low, high, np.cos(np.maximum(side - half, 0.0))


def _least(a: Array, b: Array) -> Array:
    """The smaller, a where b is no number."""
    return np.where(b < a, b, a)
