"""Where rays meet objects: nearest crossings with what shading needs, and all crossings for shadows. Plain NumPy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from equilux_scenes.case import Case
from equilux_scenes.mesh import TriangleMesh
from equilux_scenes.transforms import matrix
from support.plain_phong import CROSSINGS
from support.plain_raytraced import OUTWARD, _crossings

Array = npt.NDArray[np.float64]

RAYS_AT_A_TIME = 2048


@dataclass
class Hits:
    """Nearest crossings of n rays: parameter (inf: none), outward geometric and shading normal as stored (any length), object
    (−1: none), and for meshes the triangle (−1 elsewhere) and the weights of its corners.
    """

    t: Array
    geometric: Array
    shading: Array
    object_id: npt.NDArray[np.int64]
    triangle: npt.NDArray[np.int64]
    weights: Array


def nearest(case: Case, origin: Array, direction: Array, start: float) -> Hits:
    """The first crossing beyond t = start; at equal distance of the first object."""
    n = len(origin)
    hits = Hits(np.full(n, np.inf), *(np.zeros((n, 3)) for _ in range(2)), *(np.full(n, -1) for _ in range(2)), np.zeros((n, 3)))
    for index, obj in enumerate(case.scene.objects):
        if index in case.meshes:
            _nearer_triangle(hits, case, index, origin, direction, start)
            continue
        to_object = np.linalg.inv(matrix(obj))
        linear = to_object[:3, :3]
        o, d = origin @ linear.T + to_object[:3, 3], direction @ linear.T
        for t, normal in OUTWARD.get(obj.kind, CROSSINGS[obj.kind])(obj, o, d):
            nearer = (t > start) & (t < hits.t)
            outward = (normal @ linear)[nearer]
            hits.t[nearer], hits.object_id[nearer], hits.triangle[nearer] = t[nearer], index, -1
            hits.geometric[nearer], hits.shading[nearer] = outward, outward
    return hits


def _nearer_triangle(hits: Hits, case: Case, index: int, origin: Array, direction: Array, start: float) -> None:
    mesh = case.meshes[index]
    linear, o, d = _to_object(case, index, origin, direction)
    normal = _face_normals(mesh)
    for first in range(0, len(o), RAYS_AT_A_TIME):
        rows = np.arange(first, min(first + RAYS_AT_A_TIME, len(o)))
        t, corners = _triangles(mesh, o[rows], d[rows])
        t = np.where(t > start, t, np.inf)
        face = np.argmin(t, axis=1)
        least = t[np.arange(len(rows)), face]
        nearer = np.flatnonzero(least < hits.t[rows])
        rows, face, least = rows[nearer], face[nearer], least[nearer]
        weights = corners[:, nearer, face].T
        hits.t[rows], hits.object_id[rows], hits.triangle[rows], hits.weights[rows] = least, index, face, weights
        hits.geometric[rows] = normal[face] @ linear
        stored = normal[face]
        if mesh.vertex_normals is not None:
            stored = np.einsum("nk,nkx->nx", weights, mesh.vertex_normals[mesh.faces[face]])
        hits.shading[rows] = stored @ linear


def all_crossings(case: Case, index: int, origin: Array, direction: Array) -> Array:
    """Ray parameters of every crossing of the rays' lines with one object, (n, at most so many), inf where there is none."""
    if index not in case.meshes:
        return np.stack([t for t, *_ in _crossings(case, index, origin, direction)], axis=1)
    _, o, d = _to_object(case, index, origin, direction)
    parts = [slice(k, k + RAYS_AT_A_TIME) for k in range(0, len(o), RAYS_AT_A_TIME)]
    return np.concatenate([_triangles(case.meshes[index], o[part], d[part])[0] for part in parts])


def _to_object(case: Case, index: int, origin: Array, direction: Array) -> tuple[Array, Array, Array]:
    to_object = np.linalg.inv(matrix(case.scene.objects[index]))
    linear = to_object[:3, :3]
    return linear, origin @ linear.T + to_object[:3, 3], direction @ linear.T


def _face_normals(mesh: TriangleMesh) -> Array:
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    return np.cross(b - a, c - a)


def _triangles(mesh: TriangleMesh, o: Array, d: Array) -> tuple[Array, Array]:
    """n rays and m triangles: t (n, m), inf where the line passes by, and the weights of the corners (3, n, m).

    With q = o − a: t = −q·N / d·N, and the weights are N·((d × q) × …) written out, v = (c − a)·(q × d) / −d·N and so on.
    """
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    slope = -(d @ normal.T)
    t = (o @ normal.T - np.sum(a * normal, axis=1)) / slope
    # (o − a) × d = o × d − a × d; its product with an edge e: e·(o × d) − d·(e × a)
    moment = np.cross(o, d)
    second = (moment @ (c - a).T - d @ np.cross(c - a, a).T) / slope
    third = -(moment @ (b - a).T - d @ np.cross(b - a, a).T) / slope
    weights = np.array([1 - second - third, second, third])
    inside = np.all(weights >= 0, axis=0) & np.isfinite(t)
    return np.where(inside, t, np.inf), weights
