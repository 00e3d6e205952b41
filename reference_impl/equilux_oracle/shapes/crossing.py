"""Where lines meet a primitive: at most two crossings each, since all primitives are convex or lie on a convex one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from equilux_oracle.doubledouble import DD, Array, Bools, where


@dataclass(frozen=True)
class Meeting:
    """For n lines: the crossings' parameters, in order, whether each exists, and the normals.

    t and exists: one entry where a line can cross but once, else two, the near one first; t is arbitrary where there is none.
    normal: parameters (n,) and whether they are the last crossing's (n,) → the outward normals there, in object space, not unit,
    (3, n) or (3, 1).
    """

    t: tuple[DD, ...]
    exists: tuple[Bools, ...]
    normal: Callable[[DD, Bools], DD]

    def first(self, start: Array | float) -> Crossing:
        """The first crossing with t > start."""
        counts = [exists & (t.hi > start) for t, exists in zip(self.t, self.exists, strict=True)]
        t = where(counts[0], self.t[0], self.t[-1])
        return Crossing(counts[0] | counts[-1], t, self.normal(t, ~counts[0]))

    def close_to(self, start: Array | float, own: Bools) -> Bools:
        """Where a crossing lies so near to `start` that another reading of what coincides would take it otherwise, (n,).

        own: where the line starts on this very primitive, whose other crossing is in doubt all the way from there.
        """
        near = [exists & (t.hi > 0.5 * start) & (t.hi < 4.0 * start) for t, exists in zip(self.t, self.exists, strict=True)]
        thin = own & (len(self.t) == 2) & self.exists[0] & self.exists[-1]
        doubtful: Bools = np.any(near, axis=0) | thin & (self.t[-1].hi > -start) & (self.t[-1].hi < 4.0 * start) & (
            (self.t[-1] - self.t[0]).hi < 4.0 * start
        )
        return doubtful

    def number_between(self, start: Array | float, end: Array | float) -> Array:
        """How many crossings have start < t < end, (n,)."""
        counts = [exists & (t.hi > start) & (t.hi < end) for t, exists in zip(self.t, self.exists, strict=True)]
        number: Array = np.sum(counts, axis=0, dtype=np.float64)
        return number


@dataclass(frozen=True)
class Crossing:
    """For n rays: whether there is a crossing, its parameter, and the outward normal there.

    The normal is in object space, not unit, (3, n). t and normal are arbitrary where there is no crossing.
    """

    hit: Bools
    t: DD
    normal: DD


@dataclass(frozen=True)
class Primitive:
    """One primitive in its own space.

    anchor: the point (3,) that ray origins are measured from. meet: origins relative to the anchor and directions → Meeting.
    bounding_radius: of a sphere about the anchor that holds it; inf for a plane. curvature: the largest of its surface, 1/m.
    """

    anchor: Array
    bounding_radius: float
    meet: Callable[[DD, DD], Meeting]
    curvature: float = 0.0

    def cross(self, origin: DD, direction: DD) -> Crossing:
        """The first crossing with t > 0."""
        return self.meet(origin, direction).first(0.0)


def each_ray(v: DD, count: int) -> DD:
    """A vector shared by all rays, (3, 1), repeated for each, (3, count)."""
    return DD(np.broadcast_to(v.hi, (3, count)), np.broadcast_to(v.lo, (3, count)))


def vanishes(square: DD, scale: DD) -> Bools:
    """Whether a length is zero but for the rounding of the arithmetic (1e-28 of its scale): both given squared."""
    tiny: Bools = square.hi <= 1e-56 * scale.hi
    return tiny
