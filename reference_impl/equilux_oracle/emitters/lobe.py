"""Highlight of a region: ∫ (M·ω)^p dω and ∫ (M·ω)^p (N·ω) dω over its part with N·ω > 0 and M·ω > 0, for any real p ≥ 0.

Both become integrals along the contour by Stokes' theorem. With u = M·r and n = p + 1:

    ∫ u^p dω        = ∮ G_n(u) M·(r × dr),                                G_n(u) = (1 − u^n)/(n (1 − u²))
    ∫ u^p (N·ω) dω  = a ∮ G_{n+1}(u) M·(r × dr) − b/n ∮ u^n d(B·r),       N = a M + b T,  B = M × T

The first is the lobe in polar coordinates about M, where M·(r × dr) = (1 − u²) dφ. In the second T·ω = √(1 − u²) cos φ is
integrated over φ first, to ∮ u^p (B·r) du, and then by parts. G_n is smooth at u = 1 (its value is ½ there); on M's horizon u = 0
and what is left is 1/n per radian. Only there, for a p that is no integer, are the integrands not analytic, and then they are
u^n times an analytic function. So Gauss–Legendre panels converge geometrically wherever a panel keeps away from u = 0, and
`panels.py` makes panels by bisection until a proven bound says that they do, or that u^n is negligible.

Cf. J. Arvo, "Applications of irradiance tensors to the simulation of non-Lambertian phenomena", SIGGRAPH 1995: his axial
moments of polygons are the same integrals for integer p, there as a recurrence.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equilux_oracle.doubledouble import Array, Bools, Index
from equilux_oracle.emitters.arcs import Arcs
from equilux_oracle.emitters.frame import Frame

UNIT_ROUNDOFF = 2.0**-53


@dataclass(frozen=True)
class Curves:
    """k arcs with what their integrands need, every array (k,).

    Trigonometric polynomials (constant, cosine, sine): m = M·p, y = B·p, k = M·(p × p'), q = |p|²; and |p − √q M|² needs p
    itself, (9, k). n = p + 1; cosine: whether the integrand carries N·ω; a, b of the frame; owner: the point that the arc
    belongs to.
    """

    start: Array
    end: Array
    p: Array
    m: Array
    y: Array
    k: Array
    q: Array
    nearest: Array
    unsure: Array
    a: Array
    b: Array
    n: Array
    cosine: Bools
    owner: Index

    def __getitem__(self, chosen: Index) -> Curves:
        return Curves(*(getattr(self, name)[..., chosen] for name in self.__dataclass_fields__))


def curves(contour: list[Arcs], frame: Frame, exponent: Array, cosine: Bools) -> Curves:
    """The arcs of a contour that are not empty."""
    parts = []
    mirror = frame.mirror
    across = np.array([[0.0], [-1.0], [0.0]])
    for arcs in contour:
        owner = np.flatnonzero(arcs.end > arcs.start)
        c, e, f, axis = arcs.c[:, owner], arcs.e[:, owner], arcs.f[:, owner], mirror[:, owner]
        parts.append(
            Curves(
                arcs.start[owner],
                arcs.end[owner],
                np.concatenate([c, e, f]),
                np.stack([_dot(axis, v) for v in (c, e, f)]),
                np.stack([_dot(across, v) for v in (c, e, f)]),
                np.stack([_triple(axis, e, f), _triple(axis, c, f), -_triple(axis, c, e)]),
                np.stack([_dot(c, c) + _dot(e, e), 2 * _dot(c, e), 2 * _dot(c, f)]),
                arcs.nearest[owner],
                arcs.unsure[owner],
                frame.a[owner],
                frame.b[owner],
                exponent[owner] + 1.0,
                cosine[owner],
                owner,
            )
        )
    return Curves(*(np.concatenate([getattr(part, name) for part in parts], axis=-1) for name in Curves.__dataclass_fields__))


def integrand(of: Curves, t: Array) -> tuple[Array, Array]:
    """The integrand at t (k, nodes) of each curve, and the density of its rounding error in units of u, both (k, nodes).

    Density of the error: a direction of the contour is off by ε = 8 u (|c| + |e|)/|p|, which moves the border of the region,
    where the lobe is u^p, by that much per unit of length; evaluating G, k and q costs as much again, G being at most
    1/(n w), w = 1 − u, or ½. In all 16 u (u^p + G) (|c| + |e|) |e|/q.
    """
    cos_t, sin_t = np.cos(t), np.sin(t)

    def poly(coefficients: Array) -> Array:
        constant, cosine, sine = coefficients[:, :, np.newaxis]
        value: Array = constant + cosine * cos_t + sine * sin_t
        return value

    x, y, z = poly(of.p[0::3]), poly(of.p[1::3]), poly(of.p[2::3])
    q = x * x + y * y + z * z
    length = np.sqrt(q)
    a, b, n = of.a[:, np.newaxis], of.b[:, np.newaxis], of.n[:, np.newaxis]
    # 1 − u is half the chord squared, which keeps its digits at the peak.
    w = 0.5 * ((x / length - b) ** 2 + (y / length) ** 2 + (z / length - a) ** 2)
    inside = w < 1.0
    w = np.where(inside, w, 1.0)
    with np.errstate(divide="ignore"):
        log_u = np.log1p(-w)
    power = np.exp(n * log_u)
    lobe = _lobe(w, log_u, n)
    k = poly(of.k) / q
    value = lobe * k
    if of.cosine.any():
        dot_pp = 0.5 * (of.q[2][:, np.newaxis] * cos_t - of.q[1][:, np.newaxis] * sin_t)
        dy = (of.y[2][:, np.newaxis] * cos_t - of.y[1][:, np.newaxis] * sin_t + y * dot_pp / q) / length
        with_cosine = a * _lobe(w, log_u, n + 1.0) * k - b / n * power * dy
        value = np.where(of.cosine[:, np.newaxis], with_cosine, value)
    c, e = np.sqrt(np.sum(of.p[:3] ** 2, axis=0)), np.sqrt(np.sum(of.p[3:6] ** 2, axis=0))
    u_p = np.where(inside & (n > 1.0), np.exp((n - 1.0) * np.where(inside, log_u, 0.0)), np.where(inside, 1.0, 0.0))
    return value, 16.0 * (u_p + lobe) * ((c + e) * e * of.unsure)[:, np.newaxis] / q


def rotation_error(frame: Frame, exponent: Array) -> Array:
    """What an error of 8 u in M, and of 2 u in N, changes in a lobe's integral, in units of u, (n,).

    |∂/∂M ∫ u^p dω| ≤ 2π ∫ p u^(p−1) √(1 − u²) du = 2π (√π/4) p Γ(p/2)/Γ((p + 3)/2), which is at most 2π, and 2π · 1.26/√p.
    The horizons of N and M move as the contour does, and are counted there.
    """
    return np.where(exponent > 0.0, 8.0 * 2 * np.pi * np.minimum(1.0, 1.26 / np.sqrt(np.maximum(exponent, 1e-3))), 0.0)


def _lobe(w: Array, log_u: Array, n: Array) -> Array:
    """G_n(u) = (1 − u^n)/(n (1 − u²)) with w = 1 − u, ½ at w = 0."""
    small = w < 1e-300
    value: Array = np.where(small, 0.5, -np.expm1(n * log_u) / (n * np.where(small, 1.0, w) * (2.0 - w)))
    return value


def _dot(v: Array, w: Array) -> Array:
    result: Array = np.sum(v * w, axis=0)
    return result


def _triple(axis: Array, v: Array, w: Array) -> Array:
    return _dot(axis, np.cross(v, w, axis=0))
