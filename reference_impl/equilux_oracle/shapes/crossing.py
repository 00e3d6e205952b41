"""The result of crossing rays with a primitive, and the two ways of choosing among its crossings."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from equilux_oracle.doubledouble import DD, Array, Bools, where


@dataclass(frozen=True)
class Crossing:
    """For n rays: whether there is a crossing with t > 0, its parameter, and the outward normal there.

    The normal is in object space, not unit, (3, n). t and normal are arbitrary where there is no crossing.
    """

    hit: Bools
    t: DD
    normal: DD


@dataclass(frozen=True)
class Primitive:
    """One primitive in its own space.

    anchor: the point (3,) that ray origins are measured from. cross: origins relative to the anchor and directions → Crossing.
    bounding_radius: of a sphere about the anchor that holds it; inf for a plane.
    """

    anchor: Array
    bounding_radius: float
    cross: Callable[[DD, DD], Crossing]


def first_positive(near: DD, far: DD) -> tuple[Bools, DD]:
    """Of two ordered crossings of a convex body, the first with t > 0: the near one, or the far one seen from inside."""
    outside = near.hi > 0.0
    return far.hi > 0.0, where(outside, near, far)


def each_ray(v: DD, count: int) -> DD:
    """A vector shared by all rays, (3, 1), repeated for each, (3, count)."""
    return DD(np.broadcast_to(v.hi, (3, count)), np.broadcast_to(v.lo, (3, count)))


def vanishes(square: DD, scale: DD) -> Bools:
    """Whether a length is zero but for the rounding of the arithmetic (1e-28 of its scale): both given squared."""
    tiny: Bools = square.hi <= 1e-56 * scale.hi
    return tiny
