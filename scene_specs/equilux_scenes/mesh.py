"""Triangle meshes in object space, with the normals that a scene asks for already worked out."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


class MeshError(ValueError):
    """A mesh that cannot be shaded; the message says which vertex or triangle and why."""


@dataclass(frozen=True, eq=False)
class TriangleMesh:
    """Triangles of one object, in object space.

    vertices: (n, 3) float64, metres. faces: (m, 3) int64, counter-clockwise seen from the side the geometric normal points to.
    vertex_normals: (n, 3) float64, unit; None exactly when the mesh is shaded flat, with its face normals.
    """

    vertices: Floats
    faces: Ints
    vertex_normals: Floats | None = None

    def content_hash(self) -> str:
        """Hex digest of everything above."""
        digest = hashlib.sha256()
        for array in (self.vertices, self.faces, self.vertex_normals):
            digest.update(b"|" if array is None else f"|{array.shape}".encode() + np.ascontiguousarray(array).tobytes())
        return digest.hexdigest()


@dataclass(frozen=True, eq=False)
class MeshData:
    """What a file or the spec gives: like `TriangleMesh`, but normals are as written and may be absent."""

    vertices: Floats
    faces: Ints
    vertex_normals: Floats | None = None


def resolve(data: MeshData, normals: Literal["flat", "smooth"]) -> TriangleMesh:
    """The mesh as it is shaded.

    `flat` drops vertex normals. `smooth` takes the given ones, made unit, else Σ area × angle × unit face normal over the triangles
    at each vertex. Raises MeshError for faces out of range, non-finite numbers, and a vertex of a triangle with area whose normal is
    zero or cancels out.
    """
    _check(data)
    if normals == "flat":
        return TriangleMesh(data.vertices, data.faces)
    crosses = np.cross(_edge(data, 0, 1), _edge(data, 0, 2))
    shaded = np.zeros(len(data.vertices), dtype=bool)
    shaded[data.faces[np.linalg.norm(crosses, axis=1) > 0].ravel()] = True
    summed, weight = _summed_normals(data, crosses) if data.vertex_normals is None else _given_normals(data.vertex_normals)
    length = np.linalg.norm(summed, axis=1)
    # below this share of the weight only rounding is left of the sum
    lost = shaded & (length <= 1e-12 * weight)
    if lost.any():
        vertex = int(np.flatnonzero(lost)[0])
        why = "the normals of its triangles cancel out" if data.vertex_normals is None else "the normal given is zero"
        raise MeshError(f"normal of vertex {vertex}, {why}, allowed a direction (or normals: flat)")
    usable = length > 1e-12 * weight
    unit = np.where(usable[:, None], summed / np.where(usable, length, 1.0)[:, None], np.array([0.0, 0.0, 1.0]))
    return TriangleMesh(data.vertices, data.faces, unit)


def _edge(data: MeshData, a: int, b: int) -> Floats:
    edge: Floats = data.vertices[data.faces[:, b]] - data.vertices[data.faces[:, a]]
    return edge


def _check(data: MeshData) -> None:
    for name, array in (("vertex", data.vertices), ("vertex normal", data.vertex_normals)):
        if array is not None and not np.isfinite(array).all():
            index = int(np.flatnonzero(~np.isfinite(array).all(axis=1))[0])
            raise MeshError(f"{name} {index}, got a number that is not finite, allowed finite numbers")
    if data.vertex_normals is not None and len(data.vertex_normals) != len(data.vertices):
        raise MeshError(f"vertex normals, got {len(data.vertex_normals)}, allowed one per vertex ({len(data.vertices)})")
    outside = (data.faces < 0) | (data.faces >= len(data.vertices))
    if outside.any():
        face, corner = (int(index) for index in np.argwhere(outside)[0])
        last = len(data.vertices) - 1
        raise MeshError(f"face {face}, got vertex {int(data.faces[face, corner])}, allowed 0 to {last}")


def _summed_normals(data: MeshData, crosses: Floats) -> tuple[Floats, Floats]:
    """Per vertex: Σ area × angle × unit face normal, and Σ area × angle, to judge how much of the sum is left."""
    areas = np.linalg.norm(crosses, axis=1) / 2
    summed = np.zeros_like(data.vertices)
    weight = np.zeros(len(data.vertices))
    for corner in range(3):
        u, v = _edge(data, corner, (corner + 1) % 3), _edge(data, corner, (corner + 2) % 3)
        # atan2 of |u × v| and u · v: accurate for slivers, where the arc cosine is not
        angles = np.arctan2(2 * areas, np.einsum("ij,ij->i", u, v))
        np.add.at(summed, data.faces[:, corner], crosses / 2 * angles[:, None])
        np.add.at(weight, data.faces[:, corner], areas * angles)
    return summed, weight


def _given_normals(normals: Floats) -> tuple[Floats, Floats]:
    largest = np.abs(normals).max(axis=1, keepdims=True, initial=0.0)
    scaled = normals / np.where(largest > 0, largest, 1.0)
    return scaled, np.ones(len(normals))
