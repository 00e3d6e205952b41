"""The bodies of a scene as what they cover of the directions around a point, and with which radiance.

A body covers a region of directions (regions.py) with its own radiance, instead of that of the environment behind it: an emitter
shines, everything else is black, since light is direct only. So a point receives the whole environment, plus for each other body
its region times what its radiance exceeds the environment's by. Bodies must not overlap as seen from the point (unblocked.py).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from equilux_oracle.doubledouble import DD, Array, Bools, cross, dot, vector
from equilux_oracle.emitters.frame import Frame
from equilux_oracle.emitters.regions import Polygon, Round, cap, disc, parallelogram
from equilux_scenes.model import (
    AreaEmitter,
    Box,
    Disc,
    DiscEmitter,
    Object,
    Plane,
    Rectangle,
    RectangleEmitter,
    Scene,
    Sphere,
    SphereEmitter,
)
from equilux_scenes.transforms import matrix

SIMILAR = 2.0**-50
"""How far a transform may be from a similarity, per unit, for a sphere to count as a sphere: rotations by an angle are rounded
so."""


@dataclass(frozen=True)
class Covered:
    """What one convex piece of a body covers from n points.

    region: None where it covers all directions (a point inside it). where: indices of the points that the piece is seen from,
    (k,), which is what the region is about. front: whether the shining side is seen, (k,).
    """

    region: Round | Polygon | None
    where: np.ndarray[tuple[int], np.dtype[np.intp]]
    front: Bools


Cover = Callable[[DD, Frame], Iterator[Covered]]
"""Points (3, n) relative to the eye, with their frames → pieces."""


def cover_of(body: Object | AreaEmitter, eye: tuple[float, float, float]) -> Cover | None:
    """What a body covers; None where that has no closed form here (cylinder, mesh, ellipsoid, elliptic disc)."""
    to_world = matrix(body) if isinstance(body, Sphere | Plane | Box | Disc | Rectangle) else np.eye(4)
    stretch = _similarity(to_world)
    if body.kind == "sphere" and stretch is not None:
        return _sphere(_placed(to_world, body.center, eye), DD(body.radius) * stretch)
    if body.kind == "disc" and stretch is not None:
        return _disc(_placed(to_world, body.center, eye), _normal(to_world, body.normal), body.radius * stretch)
    if body.kind == "rectangle":
        edges = _turned(to_world, body.edge_u), _turned(to_world, body.edge_v)
        return _rectangle(_Face.of(_placed(to_world, body.corner, eye), *edges))
    if isinstance(body, Plane):
        return _plane(_placed(to_world, body.point, eye), _normal(to_world, body.normal))
    if isinstance(body, Box):
        return _box(body, to_world, eye)
    return None


def emitter_shape(emitter: AreaEmitter) -> Object:
    """The emitter's surface as an object, for the camera to see."""
    match emitter:
        case SphereEmitter():
            return Sphere(kind="sphere", material="", center=emitter.center, radius=emitter.radius)
        case DiscEmitter():
            return Disc(kind="disc", material="", center=emitter.center, normal=emitter.normal, radius=emitter.radius)
        case RectangleEmitter():
            corner, u, v = emitter.corner, emitter.edge_u, emitter.edge_v
            return Rectangle(kind="rectangle", material="", corner=corner, edge_u=u, edge_v=v)


def with_emitters(scene: Scene) -> Scene:
    """The scene with its emitters' surfaces as further objects, after its own."""
    shapes = tuple(emitter_shape(emitter) for emitter in scene.area_emitters.values())
    return scene.model_copy(update={"objects": scene.objects + shapes})


def _similarity(to_world: Array) -> float | None:
    """The factor by which a matrix stretches everything alike; None if it does not."""
    linear = to_world[:3, :3]
    square = linear.T @ linear
    stretch2 = float(np.trace(square)) / 3
    return float(np.sqrt(stretch2)) if np.abs(square - stretch2 * np.eye(3)).max() <= SIMILAR * stretch2 else None


def _placed(to_world: Array, point: tuple[float, float, float], eye: tuple[float, float, float]) -> DD:
    """A point of a body relative to the eye, (3, 1), exact to double-double."""
    return vector(to_world[:3, 3]) - vector(eye) + _turned(to_world, point)


def _turned(to_world: Array, v: Sequence[float]) -> DD:
    """A difference of points in the world, (3, 1), exact to double-double."""
    turned = DD(np.zeros((3, 1)))
    for axis in range(3):
        turned = turned + vector(to_world[:3, axis]) * v[axis]
    return turned


def _normal(to_world: Array, normal: tuple[float, float, float]) -> Array:
    """A normal in the world, unit, (3, 1)."""
    direction = np.linalg.solve(to_world[:3, :3].T, np.asarray(normal) / max(abs(c) for c in normal))
    result: Array = (direction / np.linalg.norm(direction)).reshape(3, 1)
    return result


def _everywhere(frame: Frame) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    return np.arange(len(frame))


def _sphere(center: DD, radius: DD) -> Cover:
    def cover(point: DD, frame: Frame) -> Iterator[Covered]:
        towards = center - point
        square = dot(towards, towards)
        within = (square - radius * radius).hi
        inside, outside = np.flatnonzero(within <= 0.0), np.flatnonzero(within > 0.0)
        if len(inside):
            yield Covered(None, inside, np.zeros(len(inside), dtype=bool))
        distance = np.sqrt(square.hi[outside])
        axis = frame[outside].local(towards.hi[:, outside]) / distance
        region = cap(axis, np.sqrt(within[outside]) / distance, float(radius.hi) / distance)
        yield Covered(region, outside, np.ones(len(outside), dtype=bool))

    return cover


def _disc(center: DD, normal: Array, radius: float) -> Cover:
    def cover(point: DD, frame: Frame) -> Iterator[Covered]:
        towards, axis = frame.local((center - point).hi), frame.local(normal)
        side = _side(center - point, normal)
        yield Covered(disc(towards, axis, radius), _everywhere(frame), side < 0.0)

    return cover


@dataclass(frozen=True)
class _Face:
    """A parallelogram: its corners in order relative to the eye, each (3, 1), and u × v."""

    corners: tuple[DD, DD, DD, DD]
    normal: DD

    @classmethod
    def of(cls, corner: DD, u: DD, v: DD) -> _Face:
        return cls((corner, corner + u, corner + u + v, corner + v), cross(u, v))

    def side(self, point: DD) -> Array:
        """Height over the points along u × v: negative where they are on its side, (n,)."""
        return dot(self.corners[0] - point, self.normal).hi

    def region(self, point: DD, frame: Frame) -> Polygon:
        return parallelogram(np.stack([frame.local((corner - point).hi) for corner in self.corners]), self.side(point))


def _rectangle(face: _Face) -> Cover:
    def cover(point: DD, frame: Frame) -> Iterator[Covered]:
        yield Covered(face.region(point, frame), _everywhere(frame), face.side(point) < 0.0)

    return cover


def _plane(on_plane: DD, normal: Array) -> Cover:
    def cover(point: DD, frame: Frame) -> Iterator[Covered]:
        side = _side(on_plane - point, normal)
        axis = frame.local(np.where(side >= 0.0, 1.0, -1.0) * normal)
        yield Covered(cap(axis, np.zeros(len(frame)), np.ones(len(frame))), _everywhere(frame), side < 0.0)

    return cover


def _box(shape: Box, to_world: Array, eye: tuple[float, float, float]) -> Cover:
    """The faces seen from outside: together they are the box's silhouette, and none covers another."""
    low, high = vector(shape.min), vector(shape.max)
    corner = _placed(to_world, shape.min, eye)
    # A mirroring transform turns u × v to the other side.
    outward = 1.0 if np.linalg.det(to_world[:3, :3]) > 0 else -1.0
    edges = [_turned(to_world, [float(k == axis) for k in range(3)]) * (high - low)[axis] for axis in range(3)]
    faces = []
    for axis in range(3):
        u, v = edges[(axis + 1) % 3], edges[(axis + 2) % 3]
        faces += [(_Face.of(corner, v, u), outward), (_Face.of(corner + edges[axis], u, v), outward)]

    def cover(point: DD, frame: Frame) -> Iterator[Covered]:
        for face, sign in faces:
            seen = np.flatnonzero(sign * face.side(point) < 0.0)
            if len(seen):
                yield Covered(face.region(point[:, seen], frame[seen]), seen, np.ones(len(seen), dtype=bool))

    return cover


def _side(towards: DD, normal: Array) -> Array:
    """Height of a flat body over the points, along its normal: negative where they are on its normal's side, (n,)."""
    return dot(towards, DD(normal)).hi
