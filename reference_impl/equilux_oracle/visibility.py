"""What each ray sees: the nearest crossing of all objects, ties to the first object in file order.

No acceleration structure: every object is crossed with every ray that passes through its bounding sphere.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equilux_oracle.camera import Rays
from equilux_oracle.doubledouble import DD, Array, Bools, Index, dot, unit, where
from equilux_oracle.placement import Placement, placement
from equilux_oracle.shapes import Primitive, primitive_of
from equilux_oracle.shapes.crossing import each_ray
from equilux_scenes.model import Scene
from equilux_scenes.transforms import matrix

TIE = 2.0**-50
"""Crossings nearer to each other than this share of the distance and of the eye's coordinates are one crossing. Surfaces that a
spec makes coincide do so only up to the rounding of the numbers that describe them, and which of them is seen must not depend on
that rounding (Q2 of the oracle adapter's QUIRKS.md)."""


@dataclass(frozen=True)
class Visible:
    """For n rays: the object's index (−1: none), the point relative to the eye, N on the viewer's side, and V; both unit."""

    object_id: np.ndarray[tuple[int], np.dtype[np.int64]]
    point: DD
    normal: DD
    to_viewer: DD


@dataclass(frozen=True)
class Body:
    """An object ready to be crossed: its closed form, where it stands, and its world bounding sphere relative to the eye."""

    primitive: Primitive
    placement: Placement
    center: Array
    radius: float


def bodies(scene: Scene) -> list[Body]:
    """All objects of a scene, in file order."""
    result = []
    for shape in scene.objects:
        primitive, place = primitive_of(shape), placement(matrix(shape), scene.camera.eye)
        around = place.sphere_to_world(primitive.anchor, primitive.bounding_radius, np.asarray(scene.camera.eye))
        result.append(Body(primitive, place, *around))
    return result


def first_seen(objects: list[Body], rays: Rays, eye_distance: float) -> Visible:
    """The visible point of each ray; `eye_distance`, from the origin, says how finely the scene's coordinates are rounded."""
    object_id = np.full(rays.count, -1)
    t, normal = DD(np.full(rays.count, np.inf)), DD(np.zeros((3, rays.count)))
    # A ray that misses leaves Inf and NaN behind in quantities that only hits use.
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        coordinates = np.broadcast_to(eye_distance / np.linalg.norm(rays.direction.hi, axis=0), (rays.count,))
        for index, body in enumerate(objects):
            near = np.flatnonzero(_passes(body, rays))
            if len(near) == 0:
                continue
            crossing = body.primitive.cross(*body.placement.to_object(rays[near], DD(body.primitive.anchor.reshape(3, 1))))
            nearer = crossing.hit & ((object_id[near] < 0) | ((t[near] - crossing.t).hi > TIE * (coordinates[near] + t.hi[near])))
            chosen = near[nearer]
            object_id[chosen] = index
            _assign(t, chosen, crossing.t[nearer])
            _assign(normal, np.s_[:, chosen], each_ray(body.placement.normal_to_world(crossing.normal[:, nearer]), len(chosen)))
    return _seen(object_id, rays, t, normal)


def _assign(target: DD, index: Index, value: DD) -> None:
    target.hi[index], target.lo[index] = value.hi, value.lo


def _passes(body: Body, rays: Rays) -> Bools:
    """Whether the ray's line comes within the bounding sphere, with a generous margin for plain double."""
    if np.isinf(body.radius):
        return np.ones(rays.count, dtype=bool)
    offset, direction = rays.offset.hi, rays.direction.hi
    to_center = body.center[:, np.newaxis] - offset
    distance2 = np.sum(np.cross(to_center, direction, axis=0) ** 2, axis=0) / np.sum(direction**2, axis=0)
    reach = body.radius * (1 + 1e-6) + 1e-6 * np.sqrt(np.sum(to_center**2, axis=0))
    passes: Bools = np.broadcast_to(distance2 <= reach**2, (rays.count,))
    return passes


def _seen(object_id: np.ndarray[tuple[int], np.dtype[np.int64]], rays: Rays, t: DD, normal: DD) -> Visible:
    """Points, normals turned to the viewer, and V; arbitrary finite values where nothing was hit."""
    hit = object_id >= 0
    depth = where(hit, t, DD(1.0))
    normal = where(hit, normal, DD(np.ones((3, 1))))
    away = where(dot(normal, rays.direction).hi > 0.0, -normal, normal)
    return Visible(object_id, rays.offset + rays.direction * depth, unit(away), each_ray(unit(-rays.direction), rays.count))
