"""Vertex normals as renderers make them, and objects replaced by meshes."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np

from equilux_scenes.case import Case
from equilux_scenes.mesh import CANCELLED, TriangleMesh
from equilux_scenes.model import Mesh, Object
from equilux_tracer.causes.rule import Floats

Weight = Literal["area and angle", "area", "angle", "unweighted"]


def with_meshes(case: Case, meshes: Mapping[int, TriangleMesh]) -> Case:
    """The case with these objects replaced by meshes in their own object space; order, materials, transforms stay."""
    if not meshes:
        return case
    objects: list[Object] = list(case.scene.objects)
    for index, mesh in meshes.items():
        normals: dict[str, Any] = {"normals": "flat" if mesh.vertex_normals is None else "smooth"}
        obj = objects[index]
        if isinstance(obj, Mesh):
            objects[index] = obj.model_copy(update=normals)
        else:
            objects[index] = Mesh.model_construct(kind="mesh", material=obj.material, transform=obj.transform, **normals)
    scene = case.scene.model_copy(update={"objects": tuple(objects)})
    return dataclasses.replace(case, scene=scene, meshes={**case.meshes, **meshes})


def smooth(mesh: TriangleMesh, weight: Weight, *, merged: bool) -> TriangleMesh:
    """With vertex normals, Σ weight × unit face normal over the triangles at each vertex.

    merged: vertices at one position have one normal. A vertex at which nothing is left of the sum gets the normal of one of its
    triangles.
    """
    corners = mesh.vertices[mesh.faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    double_area = np.linalg.norm(cross, axis=1)
    unit = cross / np.where(double_area > 0, double_area, 1.0)[:, None]
    vertex_of = np.arange(len(mesh.vertices))
    if merged:
        vertex_of = np.unique(mesh.vertices + 0.0, axis=0, return_inverse=True)[1].reshape(-1)
    count = int(vertex_of.max(initial=-1)) + 1
    summed, total, any_normal = np.zeros((count, 3)), np.zeros(count), np.zeros((count, 3))
    for k in range(3):
        u, v = corners[:, (k + 1) % 3] - corners[:, k], corners[:, (k + 2) % 3] - corners[:, k]
        factor = np.where(double_area > 0, 1.0, 0.0)
        if "area" in weight:
            factor = factor * double_area
        if "angle" in weight:
            factor = factor * np.arctan2(double_area, np.einsum("ij,ij->i", u, v))
        at = vertex_of[mesh.faces[:, k]]
        np.add.at(summed, at, unit * factor[:, None])
        np.add.at(total, at, factor)
        any_normal[at] = unit
    length = np.linalg.norm(summed, axis=1)
    left = length > CANCELLED * total
    normals = np.where(left[:, None], summed / np.where(left, length, 1.0)[:, None], any_normal)
    normals[~normals.any(axis=1)] = (0.0, 0.0, 1.0)
    return TriangleMesh(mesh.vertices, mesh.faces, normals[vertex_of])


def one_normal_per_face(mesh: TriangleMesh, which: Literal["first", "last", "mean"]) -> TriangleMesh:
    """Each triangle shaded with one of its vertices' normals, or with the mean of them."""
    assert mesh.vertex_normals is not None
    of_corners: Floats = mesh.vertex_normals[mesh.faces]
    if which == "mean":
        chosen = of_corners.sum(axis=1)
        length = np.linalg.norm(chosen, axis=1, keepdims=True)
        chosen = np.where(length > CANCELLED, chosen / np.where(length > 0, length, 1.0), of_corners[:, 0])
    else:
        chosen = of_corners[:, 0 if which == "first" else 2]
    faces = np.arange(3 * len(mesh.faces), dtype=np.int64).reshape(-1, 3)
    return TriangleMesh(mesh.vertices[mesh.faces].reshape(-1, 3), faces, np.repeat(chosen, 3, axis=0))


def reversed_mesh(mesh: TriangleMesh) -> TriangleMesh:
    """Triangles wound the other way, vertex normals negated."""
    normals = None if mesh.vertex_normals is None else -mesh.vertex_normals
    return TriangleMesh(mesh.vertices, np.ascontiguousarray(mesh.faces[:, ::-1]), normals)


def box_mesh(low: tuple[float, ...], high: tuple[float, ...], *, shared: bool) -> TriangleMesh:
    """Twelve triangles facing outwards; 8 vertices, or, not shared, 4 for each face."""
    corners = np.array(
        [[(low, high)[x][0], (low, high)[y][1], (low, high)[z][2]] for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    )
    # corner number = 4 x + 2 y + z
    quads = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
    if not shared:
        corners, quads = corners[quads].reshape(-1, 3), np.arange(24).reshape(6, 4)
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int64)
    return TriangleMesh(corners, faces)


def rectangle_mesh(corner: Sequence[float], edge_u: Sequence[float], edge_v: Sequence[float]) -> TriangleMesh:
    """Two triangles."""
    start, u, v = (np.asarray(vector, np.float64) for vector in (corner, edge_u, edge_v))
    return TriangleMesh(np.stack([start, start + u, start + u + v, start + v]), np.array([[0, 1, 2], [0, 2, 3]]))


def turned_quads(mesh: TriangleMesh) -> TriangleMesh:
    """Of a mesh whose first half of triangles is a b c and whose second is a c d of the same quadrilaterals: cut from b to d."""
    half = len(mesh.faces) // 2
    (a, b, c), d = mesh.faces[:half].T, mesh.faces[half:, 2]
    return TriangleMesh(mesh.vertices, np.concatenate([np.stack([a, b, d], axis=1), np.stack([b, c, d], axis=1)]))
