"""How near a point is to the surface of an object: lower bounds, for choosing fade distances, units and exposures."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from equilux_scenes.case import Case
from equilux_scenes.mesh import TriangleMesh
from equilux_scenes.model import Box, Cylinder, Disc, Object, Plane, Rectangle, Sphere
from equilux_scenes.transforms import matrix, unit

Vector = npt.NDArray[np.float64]


def nearest(case: Case, index: int, point: Vector) -> float:
    """A lower bound of the distance, metres, from `point` (world) to the surface of object `index`; exact without a transform.

    With a transform M, |M v| ≥ σ_min |v| carries the object-space distance to the world.
    """
    obj = case.scene.objects[index]
    if not obj.transform:
        return _surface_distance(obj, case.meshes.get(index), point)
    to_world = matrix(obj)
    inside = np.linalg.solve(to_world, np.append(point, 1.0))[:3]
    smallest = float(np.linalg.svd(to_world[:3, :3], compute_uv=False)[-1])
    return smallest * _surface_distance(obj, case.meshes.get(index), inside)


def extremes(case: Case, index: int) -> Vector | None:
    """(n, 3) world points whose convex hull contains object `index`; None for a plane, which is infinite."""
    obj = case.scene.objects[index]
    local = _hull(obj, case.meshes.get(index))
    if local is None:
        return None
    to_world = matrix(obj)
    world: Vector = local @ to_world[:3, :3].T + to_world[:3, 3]
    return world


def _length(vector: npt.ArrayLike) -> float:
    return float(np.linalg.norm(np.asarray(vector, dtype=np.float64)))


def _hull(obj: Object, mesh: TriangleMesh | None) -> Vector | None:
    if isinstance(obj, Plane):
        return None
    if isinstance(obj, Sphere | Disc):
        return _corners(np.subtract(obj.center, obj.radius), np.add(obj.center, obj.radius))
    if isinstance(obj, Box):
        return _corners(np.array(obj.min), np.array(obj.max))
    if isinstance(obj, Rectangle):
        corner, u, v = (np.array(part) for part in (obj.corner, obj.edge_u, obj.edge_v))
        return np.array([corner, corner + u, corner + v, corner + u + v])
    if isinstance(obj, Cylinder):
        ends = np.array([obj.base, obj.top])
        return _corners(ends.min(axis=0) - obj.radius, ends.max(axis=0) + obj.radius)
    assert mesh is not None
    return _corners(mesh.vertices.min(axis=0), mesh.vertices.max(axis=0))


def _corners(low: Vector, high: Vector) -> Vector:
    return np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])


def _surface_distance(obj: Object, mesh: TriangleMesh | None, point: Vector) -> float:
    if isinstance(obj, Sphere):
        return abs(_length(point - np.array(obj.center)) - obj.radius)
    if isinstance(obj, Plane):
        return abs(float(np.dot(unit(obj.normal), point - np.array(obj.point))))
    if isinstance(obj, Box):
        return _to_box(np.array(obj.min), np.array(obj.max), point)
    if isinstance(obj, Disc):
        return _to_disc(np.array(obj.center), np.array(unit(obj.normal)), obj.radius, point)
    if isinstance(obj, Rectangle):
        return _to_rectangle(obj, point)
    if isinstance(obj, Cylinder):
        return _to_cylinder(obj, point)
    assert mesh is not None
    return to_triangles(mesh.vertices[mesh.faces], point)


def _to_box(low: Vector, high: Vector, point: Vector) -> float:
    outside = np.maximum(np.maximum(low - point, point - high), 0.0)
    if outside.any():
        return _length(outside)
    return float(min((point - low).min(), (high - point).min()))


def _to_disc(center: Vector, normal: Vector, radius: float, point: Vector) -> float:
    height = float(np.dot(point - center, normal))
    beyond = max(0.0, _length(point - center - height * normal) - radius)
    return float(np.hypot(height, beyond))


def _to_rectangle(obj: Rectangle, point: Vector) -> float:
    offset = point - np.array(obj.corner)
    for edge in (np.array(obj.edge_u), np.array(obj.edge_v)):
        offset = offset - np.clip(np.dot(offset, edge) / np.dot(edge, edge), 0.0, 1.0) * edge
    return _length(offset)


def _to_cylinder(obj: Cylinder, point: Vector) -> float:
    base, top = np.array(obj.base), np.array(obj.top)
    height = _length(top - base)
    axis = (top - base) / height
    along = float(np.dot(point - base, axis))
    radial = _length(point - base - along * axis)
    side = float(np.hypot(radial - obj.radius, max(0.0, -along, along - height)))
    if not obj.capped:
        return side
    return min(side, *(_to_disc(end, axis, obj.radius, point) for end in (base, top)))


def to_triangles(corners: npt.NDArray[np.float64], point: Vector) -> float:
    """The smallest distance from `point` to triangles `corners` (n, 3, 3)."""
    # no triangle farther than the nearest corner, by its centre and radius, can be nearest
    to_corners = corners - point
    nearest_corner = np.sqrt(np.einsum("nij,nij->ni", to_corners, to_corners).min())
    middles = corners.mean(axis=1)
    radii = np.linalg.norm(corners - middles[:, None], axis=2).max(axis=1)
    close = corners[np.linalg.norm(middles - point, axis=1) - radii <= nearest_corner]
    return min(_to_edges(close, point), _to_interiors(close, point))


def _to_edges(corners: npt.NDArray[np.float64], point: Vector) -> float:
    edges = np.roll(corners, -1, axis=1) - corners
    offsets = point - corners
    squares = np.einsum("nij,nij->ni", edges, edges)
    along = np.einsum("nij,nij->ni", offsets, edges) / np.where(squares > 0, squares, 1.0)
    return float(np.linalg.norm(offsets - np.clip(along, 0.0, 1.0)[..., None] * edges, axis=2).min())


def _to_interiors(corners: npt.NDArray[np.float64], point: Vector) -> float:
    edges = np.roll(corners, -1, axis=1) - corners
    normals = np.cross(edges[:, 0], edges[:, 1])
    lengths = np.linalg.norm(normals, axis=1)
    inwards = np.cross(normals[:, None], edges)
    over = (lengths > 0) & (np.einsum("nij,nij->ni", point - corners, inwards) >= 0).all(axis=1)
    heights = np.einsum("ij,ij->i", point - corners[over, 0], normals[over]) / lengths[over]
    return float(np.abs(heights).min(initial=np.inf))
