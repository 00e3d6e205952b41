"""Which side of a triangle is seen: decided in double, before the rasteriser moves corners to its grid."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from equilux_adapters._triangles.view import Mesh, View

Array = Any


def towards_eye(view: View, mesh: Mesh) -> Mesh:
    """Turn every triangle's front, and its normals, to the eye; leave out what the mesh itself is sure to hide.

    A rasteriser decides which side is seen after corners were moved to its grid, which turns slivers over. Triangles that all
    show their front can be drawn with back faces culled: what is turned over goes, and its neighbours cover the place.
    """
    front = faces_eye(view, mesh)
    if mesh.closed and not starts_inside(view, mesh):
        return replace(mesh, triangles=mesh.triangles[front])
    if front.all():
        return mesh
    back = mesh.triangles[~front, ::-1] + len(mesh.points)
    return replace(
        mesh,
        points=np.concatenate([mesh.points, mesh.points]),
        normals=np.concatenate([mesh.normals, -mesh.normals]),
        triangles=np.concatenate([mesh.triangles[front], back]),
    )


def faces_eye(view: View, mesh: Mesh) -> Array:
    """(m,) bool: whether a triangle's outside is on the eye's side."""
    a, b, c = (mesh.points[mesh.triangles[:, k]] for k in range(3))
    ray = view.forward if view.parallel else a
    return np.sum(np.cross(b - a, c - a) * ray, axis=1) < 0


def starts_inside(view: View, mesh: Mesh) -> bool:
    """Whether rays start inside a closed mesh; of a parallel view, whether they may."""
    if view.parallel:
        return bool(np.min(mesh.points @ view.forward) <= 0)
    # the solid angle that a triangle spans at the eye (Van Oosterom and Strackee, 1983); all together ±4π inside and 0 outside
    a, b, c = (mesh.points[mesh.triangles[:, k]] for k in range(3))
    la, lb, lc = (np.linalg.norm(corner, axis=1) for corner in (a, b, c))
    triple = np.sum(a * np.cross(b, c), axis=1)
    rest = la * lb * lc + np.sum(a * b, axis=1) * lc + np.sum(b * c, axis=1) * la + np.sum(c * a, axis=1) * lb
    return bool(abs(np.sum(2 * np.arctan2(triple, rest))) > 2 * np.pi)


def is_watertight(vertices: Array, faces: Array) -> bool:
    """Whether every edge of a mesh is shared by two triangles that run along it in opposite ways; corners in one place are
    one."""
    _, corner = np.unique(vertices, axis=0, return_inverse=True)
    corners = corner.reshape(-1)[faces]
    edges = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
    key, back = edges[:, 0] * (len(vertices) + 1) + edges[:, 1], edges[:, 1] * (len(vertices) + 1) + edges[:, 0]
    return len(np.unique(key)) == len(key) and bool(np.isin(key, back).all())
