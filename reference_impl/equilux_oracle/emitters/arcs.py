"""Arcs on the sphere of directions around a point: what the boundary of a visible region is made of.

An arc is p(t) = c + e cos t + f sin t, seen in the direction r = p/|p|, with e ⟂ f and |e| = |f|:

- rim of a sphere's cap: c = C cos α, |e| = sin α, so |p| = 1;
- part of a great circle (an edge of a polygon, a horizon): c = 0, |e| = 1;
- rim of a disc: c its centre, |e| its radius.

Then every quantity that an integrand needs is a trigonometric polynomial of first degree: a component of p, the density
M·(p × p') = M·(e×f) + M·(c×f) cos t − M·(c×e) sin t of Lambert's form, and |p|² = A + 2 c·e cos t + 2 c·f sin t.

Arcs run counter-clockwise about the region's own directions (as the horizon does about N), which makes
∫_Ω ω dω = ½ ∮ r × dr.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equilux_oracle.doubledouble import Array, Bools


@dataclass(frozen=True)
class Arcs:
    """n arcs in local frames (`frame.py`): c, e, f are (3, n), start and end of t (n,). An arc with end ≤ start is empty.

    nearest: min |p|² over the whole curve, (n,); it is given because A − |B| would lose it near a disc's rim.
    unsure: how much worse than usual the curve itself is known, (n,), ≥ 1: see `edge_arc`.
    """

    c: Array
    e: Array
    f: Array
    start: Array
    end: Array
    nearest: Array
    unsure: Array

    def at(self, t: Array) -> Array:
        """p(t), (3, n)."""
        point: Array = self.c + self.e * np.cos(t) + self.f * np.sin(t)
        return point

    def between(self, start: Array, end: Array) -> Arcs:
        """Another part of the same curves."""
        return Arcs(self.c, self.e, self.f, start, end, self.nearest, self.unsure)

    def __getitem__(self, chosen: Bools) -> Arcs:
        along = (self.start[chosen], self.end[chosen], self.nearest[chosen], self.unsure[chosen])
        return Arcs(self.c[:, chosen], self.e[:, chosen], self.f[:, chosen], *along)

    @property
    def length(self) -> Array:
        """Of the parameter, 0 where empty."""
        return np.maximum(self.end - self.start, 0.0)

    def gap(self) -> Array:
        """r(end) − r(start), (3, n): over the arcs of a closed contour these add up to 0."""
        first, last = self.at(self.start), self.at(self.end)
        difference: Array = last / _length(last) - first / _length(first)
        return np.where(self.end > self.start, difference, 0.0)


def positive_part(l0: Array, lc: Array, ls: Array) -> tuple[Array, Array]:
    """Where l0 + lc cos t + ls sin t > 0 on a closed curve: |t − centre| < half; half is 0 for nowhere, π for everywhere."""
    amplitude = np.hypot(lc, ls)
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = np.pi / 2 + np.arcsin(np.clip(l0 / amplitude, -1.0, 1.0))
    half = np.where(l0 >= amplitude, np.where(l0 > 0.0, np.pi, 0.0), np.where(l0 <= -amplitude, 0.0, crossing))
    return np.arctan2(ls, lc), half


def both(first: tuple[Array, Array], second: tuple[Array, Array]) -> list[tuple[Array, Array]]:
    """The common part of two intervals |t − centre| < half of a circle: pieces (start, end), of which some are empty."""
    (c1, h1), (c2, h2) = first, second
    apart = _wrapped(c2 - c1)
    return [
        (c1 + np.maximum(-h1, apart + turn - h2), c1 + np.minimum(h1, apart + turn + h2)) for turn in (-2 * np.pi, 0.0, 2 * np.pi)
    ]


def circle_arc(axis_x: Array, axis_y: Array, start: Array, end: Array) -> Arcs:
    """Part of the great circle r = x cos t + y sin t; axes (3, n), orthonormal."""
    return Arcs(np.zeros_like(axis_x), axis_x, axis_y, start, end, *np.ones((2, axis_x.shape[1])))


def edge_arc(first: Array, last: Array, start: Array, end: Array) -> Arcs:
    """The great-circle arc that part of a straight edge is seen as, points (3, n).

    The edge from `first` to `last` says which circle, `start` and `end` on it which part. Seen under an angle Θ, an error ε of
    either corner's direction turns the circle by ε/sin Θ, which over an arc of length Θ makes Θ/sin Θ of it: from close to a
    long edge, Θ is nearly π.
    """
    normal = np.cross(first, last, axis=0)
    product = _length(first) * _length(last)
    sine = _length(normal)
    used = (sine > 0.0) & np.any(start != end, axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        x = np.where(used, first / _length(first), np.array([[1.0], [0.0], [0.0]]))
        z = np.where(used, normal / sine, np.array([[0.0], [0.0], [1.0]]))
        seen_under = np.arctan2(sine, np.sum(first * last, axis=0))
        unsure = np.where(used, np.maximum(1.0, seen_under * product / sine), 1.0)
    y = np.cross(z, x, axis=0)
    low, high = (np.where(used, np.arctan2(np.sum(y * p, axis=0), np.sum(x * p, axis=0)), 0.0) for p in (start, end))
    return Arcs(np.zeros_like(x), x, y, low, np.maximum(low, high), np.ones(x.shape[1]), unsure)


def _length(v: Array) -> Array:
    result: Array = np.sqrt(np.sum(v**2, axis=0))
    return result


def _wrapped(angle: Array) -> Array:
    """The same angle in [−π, π]."""
    return angle - 2 * np.pi * np.round(angle / (2 * np.pi))
