"""Triangle meshes in object space, with the normals that a scene asks for already worked out."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

CANCELLED = 1e-12
"""Share of the summed weight below which only rounding is left of a vertex normal."""


class MeshError(ValueError):
    """A mesh that cannot be shaded: `path` in the object's keys, what is `allowed` there, and a `note` on why."""

    def __init__(self, path: tuple[str | int, ...], allowed: str, note: str = "") -> None:
        super().__init__(f"{path}: allowed {allowed}{note}")
        self.path = path
        self.allowed = allowed
        self.note = note


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
        """Hex digest of everything above; −0.0 and 0.0 are one number."""
        digest = hashlib.sha256()
        for array in (self.vertices, self.faces, self.vertex_normals):
            digest.update(b"|" if array is None else f"|{array.shape}".encode() + np.ascontiguousarray(array + 0).tobytes())
        return digest.hexdigest()


def shaded(mesh: TriangleMesh, normals: Literal["flat", "smooth"]) -> TriangleMesh:
    """A mesh as read (its vertex normals as written, or None) → as it is shaded.

    `flat` drops vertex normals. `smooth` takes the given ones, made unit, else Σ area × angle × unit face normal over the
    triangles at each vertex. A vertex of no triangle with area is never shaded: its normal is made +z. Raises MeshError for a
    vertex that is shaded and whose normal is zero or cancels out.
    """
    if normals == "flat":
        return TriangleMesh(mesh.vertices, mesh.faces)
    summed, weight = summed_normals(mesh) if mesh.vertex_normals is None else _given_normals(mesh.vertex_normals)
    length = np.linalg.norm(summed, axis=1)
    usable = length > CANCELLED * weight
    lost = _seen_vertices(mesh) & ~usable
    if lost.any():
        vertex = int(np.flatnonzero(lost)[0])
        if mesh.vertex_normals is None:
            raise MeshError(("normals",), "flat", f" (smooth: the normals of the triangles at vertex {vertex} cancel out)")
        raise MeshError(("vertex_normals", vertex), "three numbers, not all 0")
    unit = np.where(usable[:, None], summed / np.where(usable, length, 1.0)[:, None], np.array([0.0, 0.0, 1.0]))
    return TriangleMesh(mesh.vertices, mesh.faces, unit)


def triangle_areas(mesh: TriangleMesh) -> Floats:
    """(m,) float64, in units of the largest coordinate, rounded down to a power of two, squared: never lost to underflow."""
    areas: Floats = np.linalg.norm(_crosses(mesh), axis=1) / 2
    return areas


def open_edge(mesh: TriangleMesh) -> tuple[int, int, int, int] | None:
    """An edge that keeps the mesh from being watertight: its vertices a and b, and how many triangles have it along and against.

    None where every edge belongs to exactly two triangles that are wound alike, vertices at one position counting as one.
    Triangles that then have fewer than three vertices bound nothing and are left out.
    """
    _, first, welded = np.unique(mesh.vertices + 0.0, axis=0, return_index=True, return_inverse=True)
    faces = welded.reshape(-1)[mesh.faces]
    faces = faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])]
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    count = len(first)
    codes, along = np.unique(edges.min(axis=1) * count + edges.max(axis=1), return_inverse=True)
    forward = np.bincount(along, weights=edges[:, 0] < edges[:, 1], minlength=len(codes))
    total = np.bincount(along, minlength=len(codes))
    wrong = np.flatnonzero((forward != 1) | (total != 2))
    if not len(wrong):
        return None
    low, high = divmod(int(codes[wrong[0]]), count)
    return int(first[low]), int(first[high]), int(forward[wrong[0]]), int(total[wrong[0]] - forward[wrong[0]])


def signed_volume(mesh: TriangleMesh) -> float:
    """Of a watertight mesh, in units as `triangle_areas` has them, cubed: positive where its triangles face outwards."""
    if not len(mesh.faces):
        return 0.0
    edges = _edge(mesh, 0, 1), _edge(mesh, 0, 2)
    start = mesh.faces[0, 0]
    corners = _edge(TriangleMesh(mesh.vertices, np.stack([np.full(len(mesh.faces), start), mesh.faces[:, 0]], axis=1)), 0, 1)
    return float(np.einsum("ij,ij->", corners, np.cross(*edges))) / 6


def summed_normals(mesh: TriangleMesh) -> tuple[Floats, Floats]:
    """Per vertex: (n, 3) Σ area × angle × unit face normal, and (n,) Σ area × angle to judge by how much is left of that sum."""
    crosses = _crosses(mesh)
    areas = np.linalg.norm(crosses, axis=1) / 2
    summed = np.zeros_like(mesh.vertices)
    weight = np.zeros(len(mesh.vertices))
    for corner in range(3):
        u, v = _edge(mesh, corner, (corner + 1) % 3), _edge(mesh, corner, (corner + 2) % 3)
        # atan2 of |u × v| and u · v: accurate for slivers, where the arc cosine is not
        angles = np.arctan2(2 * areas, np.einsum("ij,ij->i", u, v))
        np.add.at(summed, mesh.faces[:, corner], crosses / 2 * angles[:, None])
        np.add.at(weight, mesh.faces[:, corner], areas * angles)
    return summed, weight


def _edge(mesh: TriangleMesh, a: int, b: int) -> Floats:
    """(m, 3) from corner a to corner b of each triangle, the largest coordinate of the mesh scaled to 1 … 2.

    So products of tiny or huge coordinates neither vanish nor overflow; a power of two, so nothing is rounded.
    """
    largest = float(np.abs(mesh.vertices).max(initial=0.0))
    scale = math.ldexp(1.0, math.frexp(largest)[1] - 1) if largest > 0 else 1.0
    edge: Floats = mesh.vertices[mesh.faces[:, b]] / scale - mesh.vertices[mesh.faces[:, a]] / scale
    return edge


def _crosses(mesh: TriangleMesh) -> Floats:
    """(m, 3) edge × edge, scaled as edges are."""
    crosses: Floats = np.cross(_edge(mesh, 0, 1), _edge(mesh, 0, 2))
    return crosses


def _seen_vertices(mesh: TriangleMesh) -> npt.NDArray[np.bool_]:
    seen = np.zeros(len(mesh.vertices), dtype=np.bool_)
    seen[mesh.faces[np.any(_crosses(mesh) != 0, axis=1)].ravel()] = True
    return seen


def _given_normals(normals: Floats) -> tuple[Floats, Floats]:
    largest = np.abs(normals).max(axis=1, keepdims=True, initial=0.0)
    return normals / np.where(largest > 0, largest, 1.0), np.ones(len(normals))
