"""Stanford PLY, ASCII and binary of both byte orders → triangles.

Read are x, y, z and, where all three are there, nx, ny, nz of the element `vertex`, and the list `vertex_indices` (or
`vertex_index`) of the element `face`; polygons must be convex and are split into fans. Other elements and properties are skipped.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from equilux_scenes.errors import hint, shortened
from equilux_scenes.limits import Limits
from equilux_scenes.mesh import TriangleMesh
from equilux_scenes.mesh_text import MeshText, fan

_TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4", "double": "f8",
    "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4", "float32": "f4", "float64": "f8",
}  # fmt: skip
_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_INDEX_NAMES = ("vertex_indices", "vertex_index")
_HEADER_LINES = 10_000


@dataclass(frozen=True)
class _Property:
    name: str
    type: str  # NumPy's code, without byte order
    count_type: str | None = None  # of a list


@dataclass
class _Element:
    name: str
    count: int
    line: int
    properties: list[_Property] = field(default_factory=list)


@dataclass
class _Header:
    order: str  # "" for ASCII
    elements: list[_Element]
    line: int  # of end_header
    end: int  # offset of what follows


Columns = dict[str, npt.NDArray[np.float64]]
Lists = list[npt.NDArray[np.int64]]


def read_ply(content: bytes, file: str, limits: Limits) -> TriangleMesh:
    """The triangles of a PLY file; `vertex_normals` as written, or None. Raises SpecErrors located in the file.

    Binary data has no lines: its errors stand at the line of `end_header` and name the element and the byte.
    """
    text = MeshText(file)
    header = _header(content, text)
    by_name = {element.name: element for element in header.elements}
    vertex, face = _required(by_name, text, header, limits)
    body = _Binary(content, text, header) if header.order else _Ascii(content, text, header)
    columns: Columns = {}
    faces: npt.NDArray[np.int64] | None = None
    for element in header.elements:
        if element is vertex:
            columns = body.columns(element)
        elif element is face:
            faces = body.triangles(element, vertex.count)
        else:
            body.skip(element)
    assert faces is not None
    text.bounded("triangles", len(faces), limits.triangles, face.line)
    return TriangleMesh(_stacked(columns, "x", "y", "z"), faces, _stacked(columns, "nx", "ny", "nz") if "nx" in columns else None)


def _stacked(columns: Columns, *names: str) -> npt.NDArray[np.float64]:
    return np.stack([columns[name] for name in names], axis=1)


# --- header -----------------------------------------------------------------------------------------------------------


def _header(content: bytes, text: MeshText) -> _Header:
    if not content.startswith((b"ply\n", b"ply\r\n")):
        raise text.stop(1, "not a PLY file, allowed 'ply' as the first line")
    order: str | None = None
    elements: list[_Element] = []
    offset = 0
    for line in range(1, _HEADER_LINES):
        end = content.find(b"\n", offset)
        if end < 0:
            break
        words = content[offset:end].decode("ascii", errors="replace").split()
        offset = end + 1
        if words == ["end_header"]:
            if order is None:
                raise text.stop(line, "header without 'format', allowed ascii, binary_little_endian or binary_big_endian")
            return _Header(order, elements, line, offset)
        if words and words[0] == "format":
            order = _order(words, text, line)
        elif words and words[0] == "element":
            elements.append(_element(words, text, line))
        elif words and words[0] == "property":
            if not elements:
                raise text.stop(line, "property before any element")
            elements[-1].properties.append(_property(words, text, line))
        elif words and words[0] not in ("ply", "comment", "obj_info"):
            known = ["format", "element", "property", "comment", "obj_info", "end_header"]
            raise text.stop(line, f"header line '{shortened(words[0])}', allowed {', '.join(known)}{hint(words[0], known)}")
    raise text.stop(1, "header without 'end_header' (truncated?)")


def _order(words: list[str], text: MeshText, line: int) -> str:
    if len(words) != 3 or words[1] not in _ORDERS or words[2] != "1.0":
        raise text.stop(line, f"got '{shortened(' '.join(words))}', allowed format {', '.join(_ORDERS)} 1.0")
    return _ORDERS[words[1]]


def _element(words: list[str], text: MeshText, line: int) -> _Element:
    if len(words) != 3:
        raise text.stop(line, f"got '{shortened(' '.join(words))}', allowed element NAME COUNT")
    count = text.integer(words[2], line, f"count of element '{shortened(words[1])}'")
    if count < 0:
        raise text.stop(line, f"count of element '{shortened(words[1])}': got {count}, allowed an integer ≥ 0")
    return _Element(words[1], count, line)


def _property(words: list[str], text: MeshText, line: int) -> _Property:
    is_list = len(words) == 5 and words[1] == "list"
    kinds = words[2:4] if is_list else words[1:2]
    if len(words) != (5 if is_list else 3) or any(kind not in _TYPES for kind in kinds):
        allowed = f"property TYPE NAME or property list TYPE TYPE NAME, TYPE one of {', '.join(_TYPES)}"
        raise text.stop(line, f"got '{shortened(' '.join(words))}', allowed {allowed}")
    if not is_list:
        return _Property(words[2], _TYPES[words[1]])
    if _TYPES[words[2]].startswith("f"):
        raise text.stop(line, f"length of list '{shortened(words[4])}': got type {words[2]}, allowed an integer type")
    return _Property(words[4], _TYPES[words[3]], _TYPES[words[2]])


def _required(by_name: dict[str, _Element], text: MeshText, header: _Header, limits: Limits) -> tuple[_Element, _Element]:
    for name in ("vertex", "face"):
        if name not in by_name or by_name[name].count == 0:
            raise text.stop(header.line, f"no element '{name}', allowed at least one")
    if len(by_name) != len(header.elements):
        raise text.stop(header.line, "an element twice, allowed once each")
    vertex, face = by_name["vertex"], by_name["face"]
    scalars = {item.name for item in vertex.properties if item.count_type is None}
    if missing := [name for name in ("x", "y", "z") if name not in scalars]:
        raise text.stop(vertex.line, f"element 'vertex' without {', '.join(missing)}, allowed x, y, z")
    lists = [item for item in face.properties if item.count_type is not None and item.name in _INDEX_NAMES]
    if len(lists) != 1 or lists[0].type.startswith("f"):
        raise text.stop(face.line, f"element 'face', allowed one list of integers named {' or '.join(_INDEX_NAMES)}")
    for element in header.elements:
        names = [item.name for item in element.properties]
        if len(set(names)) != len(names) or not names:
            raise text.stop(element.line, f"element '{shortened(element.name)}', allowed one or more properties, each name once")
    text.bounded("vertices", vertex.count, limits.vertices, vertex.line)
    text.bounded("triangles", face.count, limits.triangles, face.line)
    return vertex, face


def _wanted(element: _Element) -> list[str]:
    """The scalar properties to keep of a vertex."""
    scalars = {item.name for item in element.properties if item.count_type is None}
    return ["x", "y", "z", *(["nx", "ny", "nz"] if {"nx", "ny", "nz"} <= scalars else [])]


def _triangles(polygons: list[list[int]]) -> npt.NDArray[np.int64]:
    return np.array([triangle for polygon in polygons for triangle in fan(polygon)], dtype=np.int64).reshape(-1, 3)


def _check_polygon(polygon: list[int], vertices: int, text: MeshText, line: int, where: str) -> None:
    if len(polygon) < 3:
        raise text.stop(line, f"{where}: got {len(polygon)} corners, allowed 3 or more")
    for index in polygon:
        if not 0 <= index < vertices:
            raise text.stop(line, f"{where}: got vertex {index}, allowed 0 to {vertices - 1}")


# --- ASCII ------------------------------------------------------------------------------------------------------------


class _Ascii:
    """One line per element, as every writer does."""

    def __init__(self, content: bytes, text: MeshText, header: _Header) -> None:
        self.lines = content[header.end :].decode("ascii", errors="replace").replace("\r\n", "\n").rstrip().split("\n")
        self.first_line = header.line + 1
        self.next = 0
        self.text = text

    def _row(self, element: _Element, index: int) -> tuple[list[str], int]:
        while self.next < len(self.lines) and not self.lines[self.next].strip():
            self.next += 1
        line = self.first_line + self.next
        if self.next >= len(self.lines):
            raise self.text.stop(line, f"end of file before {element.name} {index}, allowed {element.count} of them (truncated?)")
        self.next += 1
        return self.lines[self.next - 1].split(), line

    def _values(self, element: _Element, index: int) -> tuple[dict[str, list[str]], int]:
        """Property → its texts, of one row."""
        words, line = self._row(element, index)
        found: dict[str, list[str]] = {}
        at = 0
        for item in element.properties:
            length = 1
            if item.count_type is not None and at < len(words):
                length = self.text.integer(words[at], line, f"length of {item.name}")
                at += 1
            if length < 0 or at + length > len(words):
                raise self.text.stop(line, f"{element.name} {index}: got {len(words)} values, allowed more (truncated?)")
            found[item.name] = words[at : at + length]
            at += length
        if at != len(words):
            raise self.text.stop(line, f"{element.name} {index}: got {len(words)} values, allowed {at}")
        return found, line

    def columns(self, element: _Element) -> Columns:
        names = _wanted(element)
        rows = np.empty((min(element.count, len(self.lines)), len(names)))
        for index in range(element.count):
            found, line = self._values(element, index)
            rows[index] = [self.text.number(found[name][0], line, f"{name} of vertex {index}") for name in names]
        return {name: rows[:, column].copy() for column, name in enumerate(names)}

    def triangles(self, element: _Element, vertices: int) -> npt.NDArray[np.int64]:
        name = next(item.name for item in element.properties if item.name in _INDEX_NAMES)
        polygons = []
        for index in range(element.count):
            found, line = self._values(element, index)
            polygon = [self.text.integer(word, line, f"face {index}") for word in found[name]]
            _check_polygon(polygon, vertices, self.text, line, f"face {index}")
            polygons.append(polygon)
        return _triangles(polygons)

    def skip(self, element: _Element) -> None:
        for index in range(element.count):
            self._row(element, index)


def _size(code: str) -> int:
    """Bytes of a NumPy type code."""
    return int(code[1])


# --- binary -----------------------------------------------------------------------------------------------------------


class _Binary:
    """Rows one after the other; those of one size are read at once, others one by one."""

    def __init__(self, content: bytes, text: MeshText, header: _Header) -> None:
        self.content = content
        self.order = header.order
        self.line = header.line
        self.at = header.end
        self.text = text

    def _truncated(self, element: _Element, index: int) -> Exception:
        words = f"end of file at byte {len(self.content)} before the end of {element.name} {index}"
        return self.text.stop(self.line, f"{words}, allowed {element.count} of them (truncated?)")

    def _dtype(self, element: _Element, lengths: dict[str, int]) -> np.dtype[np.void]:
        """Of one row whose lists have these lengths."""
        fields: list[tuple[str, str] | tuple[str, str, tuple[int]]] = []
        for item in element.properties:
            if item.count_type is not None:
                fields.append((f"length of {item.name}", self.order + item.count_type))
                fields.append((item.name, self.order + item.type, (lengths[item.name],)))
            else:
                fields.append((item.name, self.order + item.type))
        return np.dtype(fields)

    def _lengths(self, element: _Element, index: int) -> dict[str, int]:
        """The lengths of the lists of the row that begins here."""
        lengths: dict[str, int] = {}
        at = self.at
        for item in element.properties:
            size = _size(item.type)
            if item.count_type is not None:
                end = at + _size(item.count_type)
                lengths[item.name] = length = self._integer(self.content[at:end], item.count_type)
                at = end
                size *= length
            at += size
            if size < 0 or at > len(self.content):
                raise self._truncated(element, index)
        return lengths

    def _integer(self, content: bytes, code: str) -> int:
        return int.from_bytes(content, "little" if self.order == "<" else "big", signed=code[0] == "i")

    def _rows(self, element: _Element) -> list[npt.NDArray[np.void]]:
        """All rows, in stretches whose lists have equal lengths."""
        stretches: list[npt.NDArray[np.void]] = []
        dtypes: dict[tuple[int, ...], np.dtype[np.void]] = {}
        done = 0
        ahead = 1  # doubled as long as rows stay alike, so that a change of length costs no second look at all that follows
        while done < element.count:
            lengths = self._lengths(element, done)
            key = tuple(lengths.values())
            if key not in dtypes:
                dtypes[key] = self._dtype(element, lengths)
            dtype = dtypes[key]
            fit = min(ahead, element.count - done, (len(self.content) - self.at) // dtype.itemsize)
            rows = np.frombuffer(self.content, dtype, fit, self.at)
            alike = np.ones(fit, dtype=bool)
            for name, length in lengths.items():
                alike &= rows[f"length of {name}"] == length
            if not alike.all():
                rows, ahead = rows[: int(np.argmin(alike))], 1
            else:
                ahead = element.count if not lengths else ahead * 2
            if len(rows) == 0:
                raise self._truncated(element, done)
            stretches.append(rows)
            done += len(rows)
            self.at += len(rows) * dtype.itemsize
        return stretches

    def columns(self, element: _Element) -> Columns:
        stretches = self._rows(element)
        columns: Columns = {}
        for name in _wanted(element):
            column = np.concatenate([rows[name] for rows in stretches]).astype(np.float64)
            if not np.isfinite(column).all():
                index = int(np.flatnonzero(~np.isfinite(column))[0])
                raise self.text.stop(self.line, f"{name} of vertex {index}: got {column[index]}, allowed a finite number")
            columns[name] = column
        return columns

    def triangles(self, element: _Element, vertices: int) -> npt.NDArray[np.int64]:
        name = next(item.name for item in element.properties if item.name in _INDEX_NAMES)
        parts: list[npt.NDArray[np.int64]] = []
        index = 0
        for rows in self._rows(element):
            corners = rows[name].astype(np.int64)
            bad = ((corners < 0) | (corners >= vertices)).any(axis=1) if corners.shape[1] >= 3 else np.ones(len(rows), dtype=bool)
            if bad.any():
                row = int(np.flatnonzero(bad)[0])
                _check_polygon(corners[row].tolist(), vertices, self.text, self.line, f"face {index + row}")
            fans = [corners[:, [0, corner, corner + 1]] for corner in range(1, corners.shape[1] - 1)]
            parts.append(np.stack(fans, axis=1).reshape(-1, 3))
            index += len(rows)
        return np.concatenate(parts)

    def skip(self, element: _Element) -> None:
        self._rows(element)
