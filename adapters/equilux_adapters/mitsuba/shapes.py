"""Objects → entries of Mitsuba's scene, as text, with what their transforms make of them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from equilux.adapter import Case
from equilux_adapters.mitsuba.lights import disc_placement, frame, rectangle_placement
from equilux_adapters.mitsuba.text import number, triple
from equilux_scenes.mesh import TriangleMesh
from equilux_scenes.model import Box, Cylinder, Disc, Mesh, Plane, Rectangle, Sphere
from equilux_scenes.transforms import matrix, unit

Floats = npt.NDArray[np.float64]

PLANE_RADIUS = 1e6
"""Of the disc in place of an infinite plane, in units of the scene's reach (Q11)."""


def mesh_file(index: int) -> str:
    """Name of the file that holds the mesh of object `index`."""
    return f"mesh_{index}.ply"


def entries(case: Case, index: int, bsdf: str, reach: float) -> Iterator[tuple[str, str]]:
    """(name, dictionary) of each of Mitsuba's shapes that make up one object; bsdf: a Python name. reach: of the scene."""
    obj = case.scene.objects[index]
    placed = matrix(obj)
    name, surface = f"object_{index}", f'"bsdf": {bsdf}'
    if isinstance(obj, Sphere | Cylinder):
        yield from _round(obj, placed, name, surface)
    elif isinstance(obj, Plane):
        point, normal = plane_in_world(obj)
        # at the foot of the eye, so that nothing that matters is far from its middle
        eye = np.asarray(case.scene.camera.eye)
        foot = eye - np.dot(eye - point, normal) * normal
        to_world = disc_placement(foot, tuple(normal), PLANE_RADIUS * reach)
        yield name, f'{{"type": "disk", "to_world": {to_world}, {surface}}}'
    elif isinstance(obj, Disc):
        yield name, f'{{"type": "disk", "to_world": {_disc(obj, placed)}, {surface}}}'
    elif isinstance(obj, Rectangle):
        linear = placed[:3, :3]
        corner = linear @ obj.corner + placed[:3, 3]
        to_world = rectangle_placement(corner, linear @ obj.edge_u, linear @ obj.edge_v)
        yield name, f'{{"type": "rectangle", "to_world": {to_world}, {surface}}}'
    elif isinstance(obj, Box):
        middle, half = np.add(obj.min, obj.max) / 2, np.subtract(obj.max, obj.min) / 2
        to_world = _placed(placed[:3, :3] * half, placed[:3, :3] @ middle + placed[:3, 3])
        yield name, f'{{"type": "cube", "to_world": {to_world}, {surface}}}'
    elif isinstance(obj, Mesh):
        flat = "True" if obj.normals == "flat" else "False"
        yield name, f'{{"type": "ply", "filename": beside("{mesh_file(index)}"), "face_normals": {flat}, {surface}}}'


def _round(obj: Sphere | Cylinder, placed: Floats, name: str, surface: str) -> Iterator[tuple[str, str]]:
    factor = similarity(placed)
    if factor is None:  # Q10
        parts = ", ".join(f'"{part}": {text}' for part, text in _round(obj, np.eye(4), f"{name}_part", surface))
        yield f"shapes_{name}", f'{{"type": "shapegroup", {parts}}}'
        stretched = f'"to_world": {_placed(placed[:3, :3], placed[:3, 3])}'
        yield name, f'{{"type": "instance", {stretched}, "shapes": {{"type": "ref", "id": "shapes_{name}"}}}}'
        return
    linear, shift = placed[:3, :3], placed[:3, 3]
    radius = f'"radius": {number(obj.radius * factor)}'
    if isinstance(obj, Sphere):
        yield name, f'{{"type": "sphere", "center": {_list(linear @ obj.center + shift)}, {radius}, {surface}}}'
        return
    base, top = linear @ obj.base + shift, linear @ obj.top + shift
    yield name, f'{{"type": "cylinder", "p0": {_list(base)}, "p1": {_list(top)}, {radius}, {surface}}}'
    if obj.capped:
        for end, center, outward in (("base", base, base - top), ("top", top, top - base)):
            to_world = disc_placement(center, tuple(outward), obj.radius * factor)
            yield f"{name}_{end}", f'{{"type": "disk", "to_world": {to_world}, {surface}}}'


def similarity(placed: Floats) -> float | None:
    """The factor by which a matrix scales all lengths; None where it has more than one."""
    factors = np.linalg.svd(placed[:3, :3], compute_uv=False)
    return float(factors[0]) if factors[0] - factors[2] <= 1e-12 * factors[0] else None


def plane_in_world(obj: Plane) -> tuple[Floats, Floats]:
    """A point and the unit normal."""
    placed = matrix(obj)
    normal = np.linalg.inv(placed[:3, :3]).T @ unit(obj.normal)
    return placed[:3, :3] @ obj.point + placed[:3, 3], normal / np.linalg.norm(normal)


def _disc(obj: Disc, placed: Floats) -> str:
    z = np.asarray(unit(obj.normal))
    x, y = (placed[:3, :3] @ axis * obj.radius for axis in frame(z))
    across = np.cross(x / np.max(np.abs(x)), y / np.max(np.abs(y)))
    columns = np.stack([x, y, across / np.linalg.norm(across)], axis=1)
    return _placed(columns, placed[:3, :3] @ obj.center + placed[:3, 3])


def _placed(columns: Floats, origin: Floats) -> str:
    return f"placed({', '.join(triple(column) for column in (*columns.T, origin))})"


def mesh_in_world(case: Case, index: int) -> TriangleMesh:
    """The mesh after its transform, in double; normals unit."""
    mesh, placed = case.meshes[index], matrix(case.scene.objects[index])
    vertices = mesh.vertices @ placed[:3, :3].T + placed[:3, 3]
    faces = mesh.faces[:, ::-1] if np.linalg.det(placed[:3, :3]) < 0 else mesh.faces
    if mesh.vertex_normals is None:
        return TriangleMesh(vertices=vertices, faces=faces)
    normals = mesh.vertex_normals @ np.linalg.inv(placed[:3, :3])
    return TriangleMesh(vertices=vertices, faces=faces, vertex_normals=normals / np.linalg.norm(normals, axis=1, keepdims=True))


def ply(mesh: TriangleMesh) -> bytes:
    """A binary PLY file in single precision, which is what Mitsuba keeps."""
    columns = [mesh.vertices] if mesh.vertex_normals is None else [mesh.vertices, mesh.vertex_normals]
    names = ["x", "y", "z", "nx", "ny", "nz"][: 3 * len(columns)]
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(mesh.vertices)}"]
    head += [f"property float {name}" for name in names]
    head += [f"element face {len(mesh.faces)}", "property list uchar int vertex_indices", "end_header", ""]
    faces = np.zeros(len(mesh.faces), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, mesh.faces
    return "\n".join(head).encode() + np.hstack(columns).astype("<f4").tobytes() + faces.tobytes()


def _list(values: Floats) -> str:
    return f"[{', '.join(number(value) for value in values)}]"
