"""Convex sets by their support: the farthest point in a direction. Enough to prove that two of them are apart.

All in plain double, in world coordinates: what is proven is separation by more than rounding (`TOUCHING`), or contact within it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from equilux_oracle.doubledouble import Array
from equilux_scenes.model import AreaEmitter, Box, Cylinder, Disc, Object, Plane, Rectangle, Sphere
from equilux_scenes.transforms import matrix

TOUCHING = 1e-12
"""Bodies that overlap by less than this share of their coordinates only touch: a sphere lying on a plane blocks nothing beneath
it."""

_STEPS = 1000


@dataclass(frozen=True)
class Convex:
    """farthest: the point with the greatest d·x, for d (3,); None where there is none. normals: directions in which it may be
    told from others. size: of its coordinates."""

    farthest: Callable[[Array], Array | None]
    normals: tuple[Array, ...]
    size: float

    def reach(self, d: Array) -> float:
        """Greatest d·x; Inf where there is none."""
        point = self.farthest(d)
        return np.inf if point is None else float(d @ point)


def hull(bodies: Sequence[Convex]) -> Convex:
    """The convex hull of several."""

    def farthest(d: Array) -> Array | None:
        points = [body.farthest(d) for body in bodies]
        finite = [point for point in points if point is not None]
        return max(finite, key=lambda point: float(d @ point)) if len(finite) == len(points) else None

    return Convex(farthest, tuple(n for body in bodies for n in body.normals), max(body.size for body in bodies))


def apart(a: Convex, b: Convex) -> bool:
    """Whether a and b are proven to have no inner point in common: some direction has all of a on one side and all of b on the
    other.

    Tried are the normals of both, and the steps of Gilbert's algorithm for the smallest vector between them (E. G. Gilbert, "An
    iterative procedure for computing the minimum of a quadratic form on a convex set", SIAM J. Control 4, 1966). False means
    not proven.
    """
    allowance = TOUCHING * max(a.size, b.size)
    for normal in (*a.normals, *b.normals):
        for d in (normal, -normal):
            if a.reach(d) + b.reach(-d) <= allowance:
                return True
    return any(a.reach(-v) + b.reach(v) < -allowance for v in _between(a, b))


def _between(a: Convex, b: Convex) -> Iterator[Array]:
    """Unit directions from b to a, better and better."""
    start = np.array([1.0, 0.0, 0.0])
    first, second = a.farthest(-start), b.farthest(start)
    if first is None or second is None:
        return
    v: Array = first - second
    for _ in range(_STEPS):
        length = float(np.linalg.norm(v))
        if length == 0.0:
            return
        yield v / length
        first, second = a.farthest(-v), b.farthest(v)
        if first is None or second is None:
            return
        step = first - second - v
        square = float(step @ step)
        if square == 0.0:
            return
        v = v + min(1.0, max(0.0, -float(v @ step) / square)) * step


def convex(body: Object | AreaEmitter) -> Convex:
    """An object or emitter, or the convex hull of what is not convex itself (an open cylinder). Raises TypeError for a mesh."""
    to_world = matrix(body) if isinstance(body, Sphere | Plane | Box | Disc | Rectangle | Cylinder) else np.eye(4)
    linear, move = to_world[:3, :3], to_world[:3, 3]
    if isinstance(body, Plane):
        return _plane(linear @ np.asarray(body.point) + move, _normal(linear, body.normal))
    if isinstance(body, Box):
        corners = [linear @ np.asarray(corner) + move for corner in product(*zip(body.min, body.max, strict=True))]
        return _points(corners, tuple(_normal(linear, axis) for axis in np.eye(3)))
    if body.kind == "rectangle":
        corner, u, v = np.asarray(body.corner), np.asarray(body.edge_u), np.asarray(body.edge_v)
        corners = [linear @ point + move for point in (corner, corner + u, corner + v, corner + u + v)]
        return _points(corners, (_normal(linear, np.cross(u / np.linalg.norm(u), v / np.linalg.norm(v))),))
    if body.kind == "sphere":
        return _swollen([linear @ np.asarray(body.center) + move], body.radius * linear, ())
    if body.kind == "disc":
        normal = np.asarray(body.normal) / max(abs(c) for c in body.normal)
        center = linear @ np.asarray(body.center) + move
        return _swollen([center], body.radius * linear @ _across(normal), (_normal(linear, normal),))
    if isinstance(body, Cylinder):
        ends = [np.asarray(body.base), np.asarray(body.top)]
        axis = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
        return _swollen([linear @ end + move for end in ends], body.radius * linear @ _across(axis), (_normal(linear, axis),))
    raise TypeError(f"{body.kind} is not known as a convex set")


def _points(points: list[Array], normals: tuple[Array, ...]) -> Convex:
    table = np.stack(points)
    return Convex(lambda d: table[int(np.argmax(table @ d))], normals, float(np.abs(table).max()))


def _swollen(points: list[Array], linear: Array, normals: tuple[Array, ...]) -> Convex:
    """Points plus the image of the unit ball under a matrix."""
    table = np.stack(points)

    def farthest(d: Array) -> Array:
        along = linear.T @ d
        length = float(np.linalg.norm(along))
        point: Array = table[int(np.argmax(table @ d))] + (linear @ along / length if length > 0.0 else 0.0)
        return point

    return Convex(farthest, normals, float(np.abs(table).max() + np.linalg.norm(linear)))


def _plane(point: Array, normal: Array) -> Convex:
    def farthest(d: Array) -> Array | None:
        return point if np.array_equal(d, normal) or np.array_equal(d, -normal) else None

    return Convex(farthest, (normal,), float(np.abs(point).max()))


def _across(normal: Array) -> Array:
    """The projection along a normal, (3, 3)."""
    unit = normal / np.linalg.norm(normal)
    result: Array = np.eye(3) - np.outer(unit, unit)
    return result


def _normal(linear: Array, normal: Sequence[float] | Array) -> Array:
    """A normal in the world, unit."""
    direction = np.linalg.solve(linear.T, np.asarray(normal, dtype=np.float64))
    result: Array = direction / np.linalg.norm(direction)
    return result
