"""Wavefront OBJ → triangles: `v`, `vn` and `f` in all their forms; polygons must be convex and are split into fans.

A corner of OBJ pairs a position with a normal, a vertex of ours has one of each: corners with the same pair become one vertex.
Statements that do not change the shape are ignored knowingly (`IGNORED`); curves and surfaces are errors, as is anything unknown.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from equilux_scenes.errors import hint, shortened
from equilux_scenes.limits import Limits
from equilux_scenes.mesh import TriangleMesh
from equilux_scenes.mesh_text import MeshText, fan

IGNORED = frozenset(
    "vt g s o mg usemtl mtllib usemap maplib p l bevel c_interp d_interp lod shadow_obj trace_obj".split()  # noqa: SIM905
)
"""Texture coordinates, grouping, names, materials, points and lines, display hints: nothing of them is seen in equilux."""


@dataclass
class _Obj:
    text: MeshText
    limits: Limits
    positions: list[tuple[float, float, float]] = field(default_factory=list)
    normals: list[tuple[float, float, float]] = field(default_factory=list)
    vertex_of: dict[tuple[int, int | None], int] = field(default_factory=dict)
    faces: list[tuple[int, int, int]] = field(default_factory=list)
    with_normals: bool | None = None  # as the first face is

    def statement(self, words: list[str], line: int) -> None:
        keyword, *values = words
        if keyword == "v":
            self._position(values, line)
        elif keyword == "vn":
            self.normals.append(self._three(values[:3], line, "vn"))
        elif keyword == "f":
            self._face(values, line)
        elif keyword not in IGNORED:
            known = ["v", "vn", "f", *sorted(IGNORED)]
            raise self.text.stop(line, f"statement '{shortened(keyword)}', allowed {', '.join(known)}{hint(keyword, known)}")

    def _position(self, values: list[str], line: int) -> None:
        # a fourth value is a weight, three or four further ones a colour: neither moves the vertex of a polygon
        if len(values) not in (3, 4, 6, 7):
            raise self.text.stop(line, f"v: got {len(values)} numbers, allowed 3 (x y z)")
        self.positions.append(self._three(values[:3], line, "v"))
        self.text.bounded("vertices", len(self.positions), self.limits.vertices, line)

    def _three(self, values: list[str], line: int, what: str) -> tuple[float, float, float]:
        if len(values) != 3:
            raise self.text.stop(line, f"{what}: got {len(values)} numbers, allowed 3 (x y z)")
        x, y, z = (self.text.number(value, line, what) for value in values)
        return x, y, z

    def _face(self, values: list[str], line: int) -> None:
        if len(values) < 3:
            raise self.text.stop(line, f"f: got {len(values)} corners, allowed 3 or more")
        self.faces.extend(fan([self._corner(value, line) for value in values]))
        self.text.bounded("triangles", len(self.faces), self.limits.triangles, line)

    def _corner(self, value: str, line: int) -> int:
        parts = value.split("/")
        if len(parts) > 3 or not parts[0]:
            raise self.text.stop(line, f"f: got '{shortened(value)}', allowed v, v/vt, v//vn or v/vt/vn")
        position = self._index(parts[0], len(self.positions), line, "vertex")
        given = len(parts) == 3 and parts[2] != ""
        if self.with_normals is None:
            self.with_normals = given
        if given != self.with_normals:
            words = "with" if self.with_normals else "without"
            raise self.text.stop(line, f"f: got '{shortened(value)}', allowed a corner {words} a normal, as in the first face")
        normal = self._index(parts[2], len(self.normals), line, "vertex normal") if given else None
        return self.vertex_of.setdefault((position, normal), len(self.vertex_of))

    def _index(self, text: str, count: int, line: int, what: str) -> int:
        number = self.text.integer(text, line, what)
        index = number - 1 if number > 0 else count + number
        if number == 0 or not 0 <= index < count:
            allowed = f"1 to {count} or -{count} to -1" if count else f"none, as no {what} stands above"
            raise self.text.stop(line, f"f: got {what} {number}, allowed {allowed}")
        return index

    def mesh(self, last_line: int) -> TriangleMesh:
        if not self.faces:
            raise self.text.stop(last_line, "no face, allowed at least one ('f')")
        pairs = np.array([(position, normal or 0) for position, normal in self.vertex_of], dtype=np.int64)
        vertices = np.array(self.positions, dtype=np.float64)[pairs[:, 0]]
        normals = np.array(self.normals, dtype=np.float64)[pairs[:, 1]] if self.with_normals else None
        return TriangleMesh(vertices, np.array(self.faces, dtype=np.int64), normals)


def read_obj(content: bytes, file: str, limits: Limits) -> TriangleMesh:
    """The triangles of an OBJ file; `vertex_normals` as written, or None. Raises SpecErrors located in the file."""
    reader = _Obj(MeshText(file), limits)
    # names may be in any encoding; what is read here is ASCII
    lines = content.decode("utf-8", errors="replace").removeprefix("\ufeff").replace("\r\n", "\n").split("\n")
    pending = ""
    number = 0
    for number, line in enumerate(lines, start=1):
        pending += line.partition("#")[0]
        if pending.endswith("\\"):
            pending = pending[:-1] + " "
            continue
        if words := pending.split():
            reader.statement(words, number)
        pending = ""
    return reader.mesh(max(number, 1))
