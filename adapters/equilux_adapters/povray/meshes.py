"""Triangle meshes as POV-Ray's `mesh2`, and what its float32 storage makes of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from equilux_adapters.povray.numbers import float32_rows, integer_rows
from equilux_scenes.mesh import TriangleMesh

Floats = npt.NDArray[np.float64]

LEAST_SMOOTH = 1.5e-5  # radians; POV-Ray takes normals nearer than 1e-5 for equal and shades flat (Q21)
ROUNDING = 2.0**-24  # relative, float32
OBLIQUE = 10.0  # tangent of the angle of view up to which the bounds hold: 84° off the normal


def centre(mesh: TriangleMesh) -> Floats:
    """The middle of a mesh, which its vertices are written relative to: float32 keeps most digits near zero (Q20)."""
    middle: Floats = (mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0)) / 2.0
    return middle


def mesh2(mesh: TriangleMesh, scale: float) -> str:
    """The text of `mesh` around its centre, in `scale` units per metre, without modifiers and closing brace."""
    faces = f"  face_indices {{ {len(mesh.faces)},\n    {integer_rows(mesh.faces)} }}"
    parts = [f"mesh2 {{\n  vertex_vectors {{ {len(mesh.vertices)},\n    {float32_rows(_stored(mesh, scale))} }}", faces]
    if mesh.vertex_normals is not None:
        normals, indices = smooth_normals(mesh)
        parts.insert(1, f"  normal_vectors {{ {len(normals)},\n    {float32_rows(normals)} }}")
        if indices is not mesh.faces:
            parts.append(f"  normal_indices {{ {len(indices)},\n    {integer_rows(indices)} }}")
    return "\n".join(parts)


def _stored(mesh: TriangleMesh, scale: float) -> npt.NDArray[np.float32]:
    return ((mesh.vertices - centre(mesh)) * scale).astype(np.float32)


def smooth_normals(mesh: TriangleMesh) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.int64]]:
    """Normals and their indices per face, such that POV-Ray interpolates wherever that differs from the face's own normal.

    A triangle whose three normals agree to 1e-5 is shaded flat (Q21). Where the face's normal is another one, its first corner
    gets a normal of its own, turned by LEAST_SMOOTH; `mesh_accuracy` states that angle.
    """
    assert mesh.vertex_normals is not None
    stuck = stuck_faces(mesh)
    normals = mesh.vertex_normals.astype(np.float32)
    if not stuck.any():
        return normals, mesh.faces
    indices = mesh.faces.copy()
    own = mesh.vertex_normals[mesh.faces[stuck, 0]]
    helper = np.eye(3)[np.abs(own).argmin(axis=1)]
    sideways = np.cross(own, helper)
    sideways /= np.linalg.norm(sideways, axis=1, keepdims=True)
    turned = (own + LEAST_SMOOTH * sideways).astype(np.float32)
    indices[stuck, 0] = len(normals) + np.arange(len(turned))
    return np.concatenate([normals, turned]), indices


def stuck_faces(mesh: TriangleMesh) -> npt.NDArray[np.bool_]:
    """(m,) faces that POV-Ray would shade flat although their vertex normals say otherwise."""
    assert mesh.vertex_normals is not None
    at_corners = mesh.vertex_normals[mesh.faces]
    own = _face_normals(mesh.vertices[mesh.faces])
    apart = np.maximum(*(np.linalg.norm(at_corners[:, 0] - at_corners[:, k], axis=1) for k in (1, 2)))
    turn = np.minimum(*(np.linalg.norm(at_corners[:, 0] - side * own, axis=1) for side in (1, -1)))
    flat: npt.NDArray[np.bool_] = (apart <= 1.01e-5) & (np.maximum(turn, apart) > 1e-7)
    return flat


def _face_normals(corners: Floats) -> Floats:
    """(m, 3) unit normals of triangles (m, 3, 3); zero for a triangle without area."""
    normals: Floats = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return normals / np.where(length > 0, length, 1.0)


@dataclass(frozen=True)
class MeshAccuracy:
    """Bounds on |ΔN| of the unit shading normal and on |ΔP|, metres, in the world."""

    normal: float
    position_m: float


def mesh_accuracy(mesh: TriangleMesh, to_world: Floats) -> MeshAccuracy:
    """What float32 storage makes of `mesh`, largest over its triangles: σ of the matrix scale positions, their ratio normals."""
    sigma = np.linalg.svd(to_world[:3, :3], compute_uv=False)
    exact = (mesh.vertices - centre(mesh))[mesh.faces]
    # rounding is relative: the unit of length makes no difference
    stored = _stored(mesh, 1.0).astype(np.float64)[mesh.faces]
    # displaced by its vertices, and along an oblique ray by the distance from its plane
    moved = np.linalg.norm(stored - exact, axis=2).max(axis=1) + OBLIQUE * _off_plane(stored)
    if mesh.vertex_normals is None:
        normal = _flat_error(exact, stored)
    else:
        turned = LEAST_SMOOTH * 1.01 if stuck_faces(mesh).any() else 0.0
        normal = 2.0 * ROUNDING + _smooth_error(exact, mesh.vertex_normals[mesh.faces], moved) + turned
    return MeshAccuracy(normal * float(sigma[0] / sigma[-1]), float(moved.max(initial=0.0)) * float(sigma[0]))


def _off_plane(stored: Floats) -> Floats:
    """(m,) how far the corners are from the plane that is hit: its normal and its distance are float32."""
    normals = _face_normals(stored)
    distance = np.einsum("ij,ij->i", normals, stored[:, 0]).astype(np.float32).astype(np.float64)
    rounded = normals.astype(np.float32).astype(np.float64)
    off: Floats = np.abs(np.einsum("ij,ikj->ik", rounded, stored) - distance[:, None]).max(axis=1)
    return off


def _flat_error(exact: Floats, stored: Floats) -> float:
    """The largest difference of the face normals, which POV-Ray computes from the stored vertices and stores in float32."""
    solid = np.linalg.norm(_face_normals(exact), axis=1) > 0
    difference = np.linalg.norm(_face_normals(stored).astype(np.float32) - _face_normals(exact), axis=1)
    return float(difference[solid].max(initial=0.0)) + 2.0 * ROUNDING


def _smooth_error(corners: Floats, normals: Floats, moved: Floats) -> float:
    """How far an interpolated normal turns when its point moves by `moved` (m,), and its weights are float32: |∇N| times the way.

    ∇N = Σ Nᵢ ⊗ ∇λᵢ, ∇λᵢ = n × eᵢ / |n|², n the cross product of two edges, eᵢ the edge opposite corner i. The float32 vector that
    POV-Ray interpolates with errs as a displacement by 2 √3 roundings of the longest edge would (2: along a coordinate axis).
    """
    edges = np.roll(corners, 1, axis=1) - np.roll(corners, -1, axis=1)
    n = np.cross(edges[:, 0], edges[:, 1])
    square = np.einsum("ij,ij->i", n, n)
    gradients = np.cross(n[:, None], edges) / np.where(square > 0, square, np.inf)[:, None, None]
    slope = np.linalg.norm(np.einsum("nik,nil->nkl", normals, gradients), axis=(1, 2))
    middle = normals.mean(axis=1)
    middle /= np.maximum(np.linalg.norm(middle, axis=1, keepdims=True), 0.1)
    shortest = np.maximum(np.einsum("nik,nk->ni", normals, middle).min(axis=1), 0.1)
    way = moved + 2.0 * np.sqrt(3.0) * ROUNDING * np.linalg.norm(edges, axis=2).max(axis=1)
    return float((slope * way / shortest).max(initial=0.0))
