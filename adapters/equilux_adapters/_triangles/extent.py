"""Where objects are, roughly: what encloses them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from equilux.adapter import Case
from equilux_adapters._triangles.bounds import Floats, largest_factor
from equilux_scenes.model import Box, Cylinder, Disc, Mesh, Rectangle, Sphere
from equilux_scenes.transforms import matrix


def reach_of(case: Case, index: int) -> float:
    """How far from the eye the points of an object are, metres; inf for a plane."""
    obj = case.scene.objects[index]
    points, around = enclosure(case, index, obj)
    placed = matrix(obj)
    away = points @ placed[:3, :3].T + (placed[:3, 3] - np.asarray(case.scene.camera.eye))
    return float(np.max(np.linalg.norm(away, axis=1), initial=0.0)) + around * largest_factor(placed)


def enclosure(case: Case, index: int, obj: Any) -> tuple[Floats, float]:
    """Points such that the object lies within their convex hull widened by a length, in object space."""
    if isinstance(obj, Sphere | Disc):
        return np.array([obj.center]), obj.radius
    if isinstance(obj, Cylinder):
        return np.array([obj.base, obj.top]), obj.radius
    if isinstance(obj, Box):
        return np.stack(np.meshgrid(*zip(obj.min, obj.max, strict=True)), axis=-1).reshape(-1, 3), 0.0
    if isinstance(obj, Rectangle):
        corner, u, v = (np.asarray(x) for x in (obj.corner, obj.edge_u, obj.edge_v))
        return np.stack([corner, corner + u, corner + v, corner + u + v]), 0.0
    if isinstance(obj, Mesh):
        return case.meshes[index].vertices, 0.0
    return np.zeros((0, 3)), math.inf


def box_around(case: Case, index: int) -> tuple[Floats, Floats]:
    """Least and greatest coordinates of an object in the world, metres; infinite for a plane."""
    points, around = enclosure(case, index, case.scene.objects[index])
    if len(points) == 0:
        return np.full(3, -math.inf), np.full(3, math.inf)
    placed = matrix(case.scene.objects[index])
    world = points @ placed[:3, :3].T + placed[:3, 3]
    reach = around * largest_factor(placed)
    return world.min(axis=0) - reach, world.max(axis=0) + reach
