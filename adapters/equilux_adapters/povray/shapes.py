"""Objects as POV-Ray primitives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from equilux_scenes.mesh import TriangleMesh
from equilux_scenes.model import Box, Cylinder, Disc, Object, Plane, Rectangle, Sphere
from equilux_scenes.transforms import matrix, unit

from equilux_adapters.povray.frame import Frame
from equilux_adapters.povray.numbers import float32_rows, integer_rows, matrix_modifier, number, vector

Matrix = npt.NDArray[np.float64]

LEAST_SMOOTH = 1.5e-5  # radians; POV-Ray takes normals nearer than 1e-5 for equal and shades flat (Q21)


@dataclass(frozen=True)
class Written:
    """An object's text: the primitive without its closing brace and modifiers, and the matrix that is left to apply, if any."""

    text: str
    matrix: Matrix | None


def written(obj: Object, mesh: TriangleMesh | None, frame: Frame) -> Written:
    """`obj` in the written frame. Shapes without a transform get their place directly; the others keep their own coordinates."""
    if isinstance(obj, Rectangle):
        return _rectangle(obj, frame)
    if mesh is not None:
        return _mesh(mesh, frame.matrix(matrix(obj)))
    if obj.transform:
        return Written(_primitive(obj, Frame(np.zeros(3), 1.0, 0.0)), frame.matrix(matrix(obj)))
    return Written(_primitive(obj, frame), None)


def _primitive(obj: Object, frame: Frame) -> str:
    if isinstance(obj, Sphere):
        return f"sphere {{ {vector(frame.point(obj.center))}, {number(obj.radius * frame.scale)}"
    if isinstance(obj, Plane):
        normal = unit(obj.normal)
        return f"plane {{ {vector(normal)}, {number(np.dot(normal, frame.point(obj.point)))}"
    if isinstance(obj, Box):
        return f"box {{ {vector(frame.point(obj.min))}, {vector(frame.point(obj.max))}"
    if isinstance(obj, Disc):
        return f"disc {{ {vector(frame.point(obj.center))}, {vector(unit(obj.normal))}, {number(obj.radius * frame.scale)}"
    assert isinstance(obj, Cylinder)
    ends = f"{vector(frame.point(obj.base))}, {vector(frame.point(obj.top))}"
    return f"cylinder {{ {ends}, {number(obj.radius * frame.scale)}{'' if obj.capped else ' open'}"


def _rectangle(obj: Rectangle, frame: Frame) -> Written:
    """A plane cut to size by a box: exact edges, and coplanar rectangles at bitwise equal depths, so that the first in the file wins.

    A `polygon` has neither, and vanishes when its corners leave its plane by 1e-10 (Q18).
    """
    square = np.eye(4)
    square[:3] = np.stack([np.array(part, dtype=np.float64) for part in (obj.edge_u, obj.edge_v, np.zeros(3), obj.corner)], axis=1)
    placed = frame.matrix(matrix(obj) @ square)
    normal = np.array(unit(tuple(np.cross(placed[:3, 0], placed[:3, 1]))))
    placed[:3, 2] = normal
    surface = f"plane {{ {vector(normal)}, {number(np.dot(normal, placed[:3, 3]))}"
    return Written(f"{surface}\n  clipped_by {{ box {{ <0, 0, -1>, <1, 1, 1> {matrix_modifier(placed)} }} }}", None)


@dataclass(frozen=True)
class MeshAccuracy:
    """What float32 storage (Q20) makes of a mesh: bounds on |ΔN| of the shading normal and on |ΔP|, metres."""

    normal: float
    position_m: float


def centre(mesh: TriangleMesh) -> npt.NDArray[np.float64]:
    """The middle of a mesh, which its vertices are written relative to: float32 keeps most digits near zero (Q20)."""
    middle: npt.NDArray[np.float64] = (mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0)) / 2.0
    return middle


def _mesh(mesh: TriangleMesh, to_frame: Matrix) -> Written:
    middle = centre(mesh)
    shift = np.eye(4)
    shift[:3, 3] = middle
    vertices = float32_rows((mesh.vertices - middle).astype(np.float32))
    parts = [f"mesh2 {{\n  vertex_vectors {{ {len(mesh.vertices)},\n    {vertices} }}"]
    faces = integer_rows(mesh.faces)
    if mesh.vertex_normals is not None:
        normals, indices = smooth_normals(mesh)
        parts.append(f"  normal_vectors {{ {len(normals)},\n    {float32_rows(normals)} }}")
        parts.append(f"  face_indices {{ {len(mesh.faces)},\n    {faces} }}")
        if indices is not mesh.faces:
            parts.append(f"  normal_indices {{ {len(mesh.faces)},\n    {integer_rows(indices)} }}")
    else:
        parts.append(f"  face_indices {{ {len(mesh.faces)},\n    {faces} }}")
    return Written("\n".join(parts), to_frame @ shift)


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
    corner_normals = mesh.vertex_normals[mesh.faces]
    face_normals = _face_normals(mesh.vertices[mesh.faces])
    apart = np.maximum(*(np.linalg.norm(corner_normals[:, 0] - corner_normals[:, k], axis=1) for k in (1, 2)))
    turn = np.minimum(*(np.linalg.norm(corner_normals[:, 0] - side * face_normals, axis=1) for side in (1, -1)))
    flat: npt.NDArray[np.bool_] = (apart <= 1.01e-5) & (np.maximum(turn, apart) > 1e-7)
    return flat


def _face_normals(corners: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    normals: npt.NDArray[np.float64] = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return normals / np.where(length > 0, length, 1.0)


def mesh_accuracy(mesh: TriangleMesh, to_world: Matrix) -> MeshAccuracy:
    """Bounds for the mesh as POV-Ray stores it, in the world: σ of the matrix scale positions, their ratio normals."""
    sigma = np.linalg.svd(to_world[:3, :3], compute_uv=False)
    local = mesh.vertices - centre(mesh)
    stored = local.astype(np.float32).astype(np.float64)
    moved = float(np.linalg.norm(stored - local, axis=1).max())
    # vertices, the float32 plane normal times the extent, and the float32 plane distance
    extent = float(np.linalg.norm(local, axis=1).max())
    position = moved + 2.0 * 2.0**-24 * extent
    if mesh.vertex_normals is None:
        stored_normals = _face_normals(stored[mesh.faces]).astype(np.float32).astype(np.float64)
        solid = np.linalg.norm(np.cross(local[mesh.faces[:, 1]] - local[mesh.faces[:, 0]],
                                        local[mesh.faces[:, 2]] - local[mesh.faces[:, 0]]), axis=1) > 0
        difference = np.linalg.norm(stored_normals - _face_normals(local[mesh.faces]), axis=1)
        normal = float(difference[solid].max(initial=0.0)) + 2.0**-24
    else:
        turned = LEAST_SMOOTH * 1.01 if stuck_faces(mesh).any() else 0.0
        normal = 2.0 * 2.0**-24 + _interpolation(mesh, local, position) + turned
    return MeshAccuracy(normal * float(sigma[0] / sigma[-1]), position * float(sigma[0]))


def _interpolation(mesh: TriangleMesh, local: npt.NDArray[np.float64], moved: float) -> float:
    """How far a point displaced by `moved`, in weights rounded to float32, turns an interpolated normal, at most."""
    assert mesh.vertex_normals is not None
    corners, normals = local[mesh.faces], mesh.vertex_normals[mesh.faces]
    edges = np.stack([corners[:, (k + 1) % 3] - corners[:, k] for k in range(3)], axis=1)
    longest = np.linalg.norm(edges, axis=2).max(axis=1)
    area = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    spread = np.stack([np.linalg.norm(normals[:, (k + 1) % 3] - normals[:, k], axis=1) for k in range(3)], axis=1).max(axis=1)
    lowest = np.where(area > 0, area / np.where(longest > 0, longest, 1.0), np.inf)
    return float(((2.0 * moved / lowest + 4 * 2.0**-24 * longest / lowest) * spread).max(initial=0.0))
