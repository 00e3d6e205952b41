"""How well single precision knows a scene's geometry: what the budget's terms are made from. Lengths are the case's."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from equilux.adapter import Case
from equilux_adapters.mitsuba.shapes import mesh_in_world, plane_in_world
from equilux_scenes.mesh import TriangleMesh
from equilux_scenes.model import (
    Box,
    Cylinder,
    Disc,
    DiscEmitter,
    Emitter,
    Light,
    Mesh,
    Object,
    Plane,
    PointLight,
    Rectangle,
    RectangleEmitter,
    Sphere,
    SphereEmitter,
    SpotLight,
)
from equilux_scenes.transforms import matrix

Floats = npt.NDArray[np.float64]


def reach_of(case: Case) -> float:
    """The largest coordinate of anything that has a place; a plane counts by the foot of the eye on it."""
    return max([extent_of(case), *(_reach_of_light(light) for light in case.scene.lights.values())]) or 1.0


def extent_of(case: Case) -> float:
    """Likewise of the eye and of all objects, wherever the lights are; may be 0."""
    found = [_largest(np.array([case.scene.camera.eye]))]
    return max(found + [_reach_of_object(case, index, obj) for index, obj in enumerate(case.scene.objects)])


def _reach_of_light(light: Light) -> float:
    if isinstance(light, PointLight | SpotLight):
        return _largest(np.array([light.position]))
    if isinstance(light, SphereEmitter | DiscEmitter):
        return _largest(np.array([light.center])) + light.radius
    if isinstance(light, RectangleEmitter):
        return _largest(_corners(light.corner, light.edge_u, light.edge_v))
    return 0.0


def enclosure_of(light: Emitter) -> tuple[list[float] | None, float]:
    """Centre (None of the environment) and radius of a sphere around an emitter."""
    if isinstance(light, SphereEmitter | DiscEmitter):
        return list(light.center), light.radius
    if isinstance(light, RectangleEmitter):
        corners = _corners(light.corner, light.edge_u, light.edge_v)
        middle = corners.mean(axis=0)
        return middle.tolist(), float(np.linalg.norm(corners[0] - middle))
    return None, 0.0


def _reach_of_object(case: Case, index: int, obj: Object) -> float:
    placed = matrix(obj)
    if isinstance(obj, Plane):
        point, normal = plane_in_world(obj)
        eye = np.asarray(case.scene.camera.eye)
        return _largest((eye - np.dot(eye - point, normal) * normal)[None])
    around = 0.0
    if isinstance(obj, Sphere | Disc):
        points, around = np.array([obj.center]), obj.radius
    elif isinstance(obj, Cylinder):
        points, around = np.array([obj.base, obj.top]), obj.radius
    elif isinstance(obj, Box):
        points = np.stack(np.meshgrid(*zip(obj.min, obj.max, strict=True)), axis=-1).reshape(-1, 3)
    elif isinstance(obj, Rectangle):
        points = _corners(obj.corner, obj.edge_u, obj.edge_v)
    else:
        points = case.meshes[index].vertices
    factor = float(np.linalg.svd(placed[:3, :3], compute_uv=False)[0])
    return _largest(points @ placed[:3, :3].T + placed[:3, 3]) + around * factor


def _corners(corner: Any, edge_u: Any, edge_v: Any) -> Floats:
    first, u, v = (np.asarray(vector, dtype=np.float64) for vector in (corner, edge_u, edge_v))
    return np.stack([first, first + u, first + v, first + u + v])


def _largest(points: Floats) -> float:
    return float(np.max(np.abs(points), initial=0.0))


def curvature_of(case: Case, index: int) -> float:
    """How fast the shading normal turns with the point, at most, per length: what makes an error of position one of the normal.

    Of an ellipsoid with semi-axes a ≥ b ≥ c it is a/c².
    """
    obj = case.scene.objects[index]
    if isinstance(obj, Sphere | Cylinder):
        factors = np.linalg.svd(matrix(obj)[:3, :3], compute_uv=False)
        return float(factors[0] / (factors[2] ** 2 * obj.radius))
    if isinstance(obj, Mesh) and (mesh := mesh_in_world(case, index)).vertex_normals is not None:
        edges = [(mesh.faces[:, i], mesh.faces[:, (i + 1) % 3]) for i in range(3)]
        turns = [_ratio(_lengths(mesh.vertex_normals, a, b), _lengths(mesh.vertices, a, b)) for a, b in edges]
        return max(turns)
    return 0.0


def thinness_of(case: Case, index: int) -> float:
    """Per length: one over the least height of a mesh's triangles shaded flat, their normals from rounded corners; else 0."""
    if not isinstance(case.scene.objects[index], Mesh):
        return 0.0
    mesh = mesh_in_world(case, index)
    return 0.0 if mesh.vertex_normals is not None else _one_over_least_height(mesh)


def _one_over_least_height(mesh: TriangleMesh) -> float:
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    doubled = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    longest = np.max([np.linalg.norm(b - a, axis=1), np.linalg.norm(c - b, axis=1), np.linalg.norm(a - c, axis=1)], axis=0)
    return _ratio(longest, doubled)


def _lengths(points: Floats, a: npt.NDArray[np.int64], b: npt.NDArray[np.int64]) -> Floats:
    return np.asarray(np.linalg.norm(points[a] - points[b], axis=1))


def _ratio(above: Floats, below: Floats) -> float:
    """The largest quotient; triangles without area are never seen."""
    return float(np.max(above / np.where(below > 0, below, math.inf), initial=0.0))
