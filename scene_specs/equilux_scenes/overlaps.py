"""Transparent objects that overlap, which the lighting model does not cover: each surface knows only its own index.

Looked at are spheres that stay spheres in the world, boxes that stay across the coordinate axes, and, where its index is not 1,
a plane with what lies behind it. Every overlap found is one; cylinders, meshes, ellipsoids and turned boxes are not looked at,
nor is a pair of planes, which may well be a slab. Surfaces that touch do not overlap.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from equilux_scenes.model import Box, Material, Object, Plane, Sphere
from equilux_scenes.transforms import Matrix, matrix, unit

TOUCHING = 1e-9
"""Of the sizes and coordinates involved: an overlap that is not deeper may be rounding of surfaces that touch."""


@dataclass(frozen=True)
class _Solid:
    """low, high: corners of the bounds, or of the box itself. radius: of a sphere, 0 for a box."""

    index: int
    low: Matrix
    high: Matrix
    radius: float = 0.0

    @property
    def center(self) -> Matrix:
        middle: Matrix = (self.low + self.high) / 2
        return middle


def overlapping(objects: Sequence[Object], materials: Mapping[str, Material]) -> Iterator[tuple[int, int]]:
    """Pairs of numbers of objects that overlap and let light through, the smaller number first, in no order."""
    clear = [(index, obj) for index, obj in enumerate(objects) if materials[obj.material].transparency > 0]
    if len(clear) < 2:
        return
    solids = [solid for index, obj in clear if (solid := _solid(index, obj)) is not None]
    solids.sort(key=lambda solid: float(solid.low[0]))
    for number, a in enumerate(solids):
        for b in solids[number + 1 :]:
            if b.low[0] >= a.high[0]:
                break
            if _overlap(a, b):
                yield min(a.index, b.index), max(a.index, b.index)
    for index, obj in clear:
        if isinstance(obj, Plane) and materials[obj.material].ior != 1:
            for solid in solids:
                if _reaches_behind(solid, obj):
                    yield min(index, solid.index), max(index, solid.index)


def _solid(index: int, obj: Object) -> _Solid | None:
    to_world = matrix(obj)
    linear, offset = to_world[:3, :3], to_world[:3, 3]
    if isinstance(obj, Sphere):
        gram = linear.T @ linear
        scale = float(np.sqrt(np.trace(gram) / 3))
        if np.abs(gram - scale**2 * np.eye(3)).max() > TOUCHING * scale**2:
            return None
        center, radius = linear @ obj.center + offset, scale * obj.radius
        return _Solid(index, center - radius, center + radius, radius)
    if isinstance(obj, Box):
        if any(np.count_nonzero(row) != 1 for row in (*linear, *linear.T)):
            return None
        corners = np.stack([linear @ obj.min + offset, linear @ obj.max + offset])
        return _Solid(index, corners.min(axis=0), corners.max(axis=0))
    return None


def _overlap(a: _Solid, b: _Solid) -> bool:
    """Whether the insides have a point in common."""
    size = max(float(np.abs([a.low, a.high, b.low, b.high]).max()), 0.0)
    if a.radius and b.radius:
        apart, reach = float(np.linalg.norm(a.center - b.center)), a.radius + b.radius
        return apart < reach - TOUCHING * size
    if a.radius or b.radius:
        ball, box = (a, b) if a.radius else (b, a)
        nearest = np.clip(ball.center, box.low, box.high)
        return float(np.linalg.norm(ball.center - nearest)) < ball.radius - TOUCHING * size
    return bool((np.minimum(a.high, b.high) - np.maximum(a.low, b.low) > TOUCHING * size).all())


def _reaches_behind(solid: _Solid, plane: Plane) -> bool:
    """Whether a part of the solid lies behind the plane, in the half-space that its index is of."""
    to_world = matrix(plane)
    point = to_world[:3, :3] @ plane.point + to_world[:3, 3]
    normal = np.array(unit(tuple(np.linalg.solve(to_world[:3, :3].T, plane.normal))))
    size = float(np.abs([solid.low, solid.high, point]).max())
    reach = solid.radius or float(np.abs(normal) @ (solid.high - solid.low)) / 2
    return float(normal @ (solid.center - point)) < reach - TOUCHING * size
