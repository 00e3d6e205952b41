"""Random lit points and emitters, the same on every machine: for tests of model `reflection-equation`."""

from __future__ import annotations

import math
import random

from equilux_scenes.model import AreaEmitter, DiscEmitter, RectangleEmitter, SphereEmitter

Triple = tuple[float, float, float]


def random_direction(rng: random.Random) -> Triple:
    """Unit, uniform."""
    while True:
        x, y, z = (rng.uniform(-1, 1) for _ in range(3))
        length = math.hypot(x, y, z)
        if 0.1 < length < 1:
            return x / length, y / length, z / length


def random_emitter(rng: random.Random, kind: str, direction: Triple, distance: float, size: float) -> AreaEmitter:
    """An emitter in some direction from the origin, shining towards it. size: of its half-width, relative to its distance."""
    center = _times(distance, direction)
    if kind == "sphere":
        return SphereEmitter(kind="sphere", center=center, radius=size * distance, radiance=(1, 1, 1))
    normal = random_direction(rng)
    if _dot(normal, center) > 0:
        normal = _times(-1, normal)
    if kind == "disc":
        return DiscEmitter(kind="disc", center=center, normal=normal, radius=size * distance, radiance=(1, 1, 1))
    across = _unit(_cross(normal, random_direction(rng)))
    u, v = _times(2 * size * distance * rng.uniform(0.3, 1), across), _times(2 * size * distance, _cross(normal, across))
    x, y, z = (c - (a + b) / 2 for c, a, b in zip(center, u, v, strict=True))
    return RectangleEmitter(kind="rectangle", corner=(x, y, z), edge_u=u, edge_v=v, radiance=(1, 1, 1))


def at_the_horizon(rng: random.Random, axis: Triple, spread: float) -> Triple:
    """A direction whose angle to the plane across `axis` is at most about `spread`, radians."""
    side = _unit(_cross(axis, random_direction(rng)))
    lift = rng.uniform(-spread, spread)
    return _unit((side[0] + lift * axis[0], side[1] + lift * axis[1], side[2] + lift * axis[2]))


def between_the_horizons(first: Triple, second: Triple) -> Triple:
    """One of the two directions that lie in both planes across two axes."""
    return _unit(_cross(first, second))


def _times(k: float, a: Triple) -> Triple:
    return k * a[0], k * a[1], k * a[2]


def _dot(a: Triple, b: Triple) -> float:
    return sum(p * q for p, q in zip(a, b, strict=True))


def _cross(a: Triple, b: Triple) -> Triple:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _unit(a: Triple) -> Triple:
    return _times(1 / math.hypot(*a), a)
