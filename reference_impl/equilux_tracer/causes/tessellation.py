"""Curved shapes as triangles, in the ways in which renderers and libraries make them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np

from equilux_scenes.mesh import TriangleMesh
from equilux_scenes.model import Cylinder, Disc, Sphere
from equilux_tracer.causes.mesh_normals import smooth
from equilux_tracer.causes.rule import Floats

PARTS: Mapping[str, tuple[str, object, str]] = {
    "n bands": ("rows", "n", "spheres have n bands from pole to pole"),
    "n-1 bands": ("rows", "n-1", "n − 1 bands"),
    "n/2-1 bands": ("rows", "n/2-1", "n/2 − 1 bands"),
    "icosphere": ("rows", "icosphere", "every triangle of an icosahedron is cut in four, n times"),
    "about z": ("axis", "z", "the poles of spheres lie on z"),
    "about x": ("axis", "x", "the poles of spheres lie on x"),
    "other diagonals": ("other_diagonals", True, "quadrilaterals are cut along the other diagonal"),
    "from y": ("start", "y", "cylinders and discs start on y"),
    "from z": ("start", "z", "cylinders and discs start on z"),
    "from across": ("start", "across", "they start across the coordinate axis that is farthest from their own, and from it"),
    "turned": ("turn", "quarter", "they start a quarter turn on"),
    "half a step on": ("turn", "half a step", "they start half a segment on"),
    "discs round": ("left_out", ("disc",), "discs stay as they are"),
    "spheres only": ("left_out", ("disc", "cylinder"), "cylinders and discs stay as they are"),
    "averaged normals": ("normals", "averaged", "vertex normals are averaged over the triangles around"),
    "normals averaged over edges": ("normals", "averaged over edges", "the same, over a cylinder's rims, too"),
    "flat": ("normals", "flat", "face normals"),
}
"""Part of a reading's name → the field of `Style`, its value, and that in words."""

PLAIN = "n segments around; spheres have n/2 bands about y; vertex normals of the curved shape"


@dataclass(frozen=True)
class Style:
    """How spheres, cylinders and discs are divided into n segments around; `PARTS` has the words."""

    rows: Literal["n/2", "n", "n-1", "n/2-1", "icosphere"] = "n/2"
    axis: Literal["y", "z", "x"] = "y"
    other_diagonals: bool = False
    start: Literal["x", "y", "z", "across"] = "x"
    turn: Literal["", "quarter", "half a step"] = ""
    left_out: tuple[str, ...] = ()
    normals: Literal["exact", "averaged", "averaged over edges", "flat"] = "exact"

    @property
    def name(self) -> str:
        """What is not as in the plainest style, parts in the order of PARTS, joined by commas."""
        return ", ".join(part for part, (field, value, _) in PARTS.items() if getattr(self, field) == value)

    @classmethod
    def named(cls, name: str) -> Style:
        """The inverse of `name`. Raises KeyError for a part that does not exist."""
        fields = [PARTS[part] for part in name.split(", ") if part]
        return cls(**{field: value for field, value, _ in fields})  # type: ignore[arg-type]


def tessellated_shape(shape: Sphere | Cylinder | Disc, segments: int, style: Style) -> TriangleMesh:
    """The triangles of a shape, in object space, outward, inscribed."""
    match shape:
        case Sphere():
            unit, faces = _sphere(segments, style)
            return _shaded(np.asarray(shape.center) + shape.radius * unit, faces, unit, style)
        case Disc():
            return _disc(np.asarray(shape.center), np.asarray(shape.normal, np.float64), shape.radius, segments, style)
        case Cylinder():
            return _cylinder(shape, segments, style)


def _shaded(vertices: Floats, faces: np.ndarray, normals: Floats, style: Style) -> TriangleMesh:
    faces = np.ascontiguousarray(faces, dtype=np.int64)
    match style.normals:
        case "flat":
            return TriangleMesh(vertices, faces)
        case "exact":
            return TriangleMesh(vertices, faces, normals)
        case _:
            return smooth(TriangleMesh(vertices, faces), "area and angle", merged=style.normals == "averaged over edges")


@lru_cache(maxsize=64)
def _sphere(segments: int, style: Style) -> tuple[Floats, np.ndarray]:
    """Unit vectors and triangles."""
    if style.rows == "icosphere":
        points, faces = _icosphere(min(segments, 6))
    else:
        bands = {"n/2": segments // 2, "n": segments, "n-1": segments - 1, "n/2-1": segments // 2 - 1}[style.rows]
        points, faces = _rings(max(segments, 3), max(bands, 2), style.other_diagonals)
    # made about z; a cyclic change of the axes turns z to x, or to y, and mirrors nothing
    order = {"z": [0, 1, 2], "x": [2, 0, 1], "y": [1, 2, 0]}[style.axis]
    return np.ascontiguousarray(points[:, order]), faces


def _rings(segments: int, bands: int, other_diagonals: bool) -> tuple[Floats, np.ndarray]:
    polar = np.pi * np.arange(1, bands) / bands
    turn = 2 * np.pi * np.arange(segments) / segments
    x = np.sin(polar)[:, None] * np.cos(turn)
    y = np.sin(polar)[:, None] * np.sin(turn)
    z = np.broadcast_to(np.cos(polar)[:, None], x.shape)
    ring_points = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    points = np.concatenate([[[0.0, 0.0, 1.0]], ring_points, [[0.0, 0.0, -1.0]]])
    i = np.arange(segments)
    j = (i + 1) % segments
    faces = [np.stack([np.zeros_like(i), 1 + i, 1 + j], axis=1)]
    for k in range(bands - 2):
        upper, lower = 1 + k * segments, 1 + (k + 1) * segments
        faces.append(_quads(upper + i, lower + i, lower + j, upper + j, other_diagonals))
    last = 1 + (bands - 2) * segments
    faces.append(np.stack([last + i, np.full_like(i, len(points) - 1), last + j], axis=1))
    return points, np.concatenate(faces)


def _quads(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray, other: bool) -> np.ndarray:
    """Triangles of quadrilaterals a b c d, counter-clockwise, cut from a to c or from b to d."""
    first, second = ([a, b, d], [b, c, d]) if other else ([a, b, c], [a, c, d])
    return np.concatenate([np.stack(first, axis=1), np.stack(second, axis=1)])


def _icosphere(cuts: int) -> tuple[Floats, np.ndarray]:
    golden = (1 + 5**0.5) / 2
    points = np.array([[0.0, s, t * golden] for s in (1, -1) for t in (1, -1)])
    points = np.concatenate([np.roll(points, k, axis=1) for k in range(3)])
    # the faces are the triples at the edge's length, 2
    near = np.isclose(np.linalg.norm(points[:, None] - points[None], axis=-1), 2.0)
    triples = [(a, b, c) for a in range(12) for b in range(a) for c in range(b) if near[a, b] and near[b, c] and near[a, c]]
    faces = np.array([t if np.linalg.det(points[list(t)]) > 0 else t[::-1] for t in triples], dtype=np.int64)
    points = points / np.linalg.norm(points, axis=1, keepdims=True)
    for _ in range(cuts):
        edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
        unique, of_edge = np.unique(edges, axis=0, return_inverse=True)
        middles = points[unique].sum(axis=1)
        middle = len(points) + of_edge.reshape(3, -1)
        points = np.concatenate([points, middles / np.linalg.norm(middles, axis=1, keepdims=True)])
        ab, bc, ca = middle
        a, b, c = faces.T
        corners = ([a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca])
        faces = np.concatenate([np.stack(corner, axis=1) for corner in corners])
    return points, faces


def _circle(axis: Floats, segments: int, style: Style) -> Floats:
    """(n, 3) unit vectors around an axis, counter-clockwise seen from its tip; the first one as near as can be to a coordinate
    axis, or to the next one where that is the axis itself; or at a right angle to the coordinate axis farthest from the axis."""
    w = axis / np.linalg.norm(axis)
    if style.start == "across":
        u = np.cross(np.eye(3)[np.argmin(np.abs(w))], w)
    else:
        first = "xyz".index(style.start)
        start = np.eye(3)[first if abs(w[first]) < 0.9 else (first + 1) % 3]
        u = start - w * (w @ start)
    u /= np.linalg.norm(u)
    v = np.cross(w, u)
    if style.turn == "quarter":
        u, v = v, -u
    turn = 2 * np.pi * (np.arange(segments) + (0.5 if style.turn == "half a step" else 0.0)) / segments
    around: Floats = np.cos(turn)[:, None] * u + np.sin(turn)[:, None] * v
    return around


def _fan(center: Floats, rim: Floats, normal: Floats) -> tuple[Floats, np.ndarray, Floats]:
    """A flat polygon about its middle; the rim counter-clockwise seen from the normal's tip."""
    i = np.arange(len(rim))
    faces = np.stack([np.full_like(i, len(rim)), i, (i + 1) % len(rim)], axis=1)
    return np.concatenate([rim, center[None]]), faces, np.tile(normal / np.linalg.norm(normal), (len(rim) + 1, 1))


def _disc(center: Floats, normal: Floats, radius: float, segments: int, style: Style) -> TriangleMesh:
    vertices, faces, normals = _fan(center, center + radius * _circle(normal, max(segments, 3), style), normal)
    return _shaded(vertices, faces, normals, style)


def _cylinder(shape: Cylinder, segments: int, style: Style) -> TriangleMesh:
    base, top = np.asarray(shape.base, np.float64), np.asarray(shape.top, np.float64)
    around = _circle(top - base, max(segments, 3), style)
    lower, upper = base + shape.radius * around, top + shape.radius * around
    i = np.arange(len(around))
    j = (i + 1) % len(around)
    sides = _quads(i, j, len(i) + j, len(i) + i, style.other_diagonals)
    parts = [(np.concatenate([lower, upper]), sides, np.concatenate([around, around]))]
    if shape.capped:
        parts += [_fan(base, lower[::-1], base - top), _fan(top, upper, top - base)]
    starts = np.cumsum([0] + [len(vertices) for vertices, _, _ in parts])
    faces = np.concatenate([part[1] + start for part, start in zip(parts, starts[:-1], strict=True)])
    return _shaded(np.concatenate([part[0] for part in parts]), faces, np.concatenate([part[2] for part in parts]), style)
