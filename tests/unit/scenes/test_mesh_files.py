"""OBJ and PLY: every form read, every error at its line, every truncation noticed."""

from __future__ import annotations

import struct

import numpy as np
import pytest

from equilux_scenes.errors import SpecErrors
from equilux_scenes.limits import Limits
from equilux_scenes.mesh import TriangleMesh
from equilux_scenes.mesh_obj import IGNORED, read_obj
from equilux_scenes.mesh_ply import read_ply

SQUARE = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.25)]
FAN = [[0, 1, 2], [0, 2, 3]]


def _obj(text: str, **limits: int) -> TriangleMesh:
    return read_obj(text.encode(), "m.obj", Limits(**limits))


def _ply(content: bytes | str, **limits: int) -> TriangleMesh:
    return read_ply(content.encode() if isinstance(content, str) else content, "m.ply", Limits(**limits))


def _corners(mesh: TriangleMesh) -> list[list[list[float]]]:
    """The triangles as coordinates, whatever the vertex order."""
    corners: list[list[list[float]]] = mesh.vertices[mesh.faces].tolist()
    return corners


EXPECTED = [[list(SQUARE[i]) for i in face] for face in FAN]

# --- OBJ --------------------------------------------------------------------------------------------------------------

POSITIONS = "".join(f"v {x} {y} {z}\n" for x, y, z in SQUARE)
FACES = {
    "polygon": "f 1 2 3 4",
    "triangles": "f 1 2 3\nf 1 3 4",
    "relative": "f -4 -3 -2 -1",
    "texture": "vt 0 0\nf 1/1 2/1 3/1 4/1",
    "empty texture and normal": "f 1// 2// 3// 4//",
    "continued line": "f 1 2 \\\n 3 4",
    "comment": "f 1 2 3 4 # a square",
    "ignored statements": "".join(f"{word} 1 2\n" for word in sorted(IGNORED)) + "f 1 2 3 4",
    "windows line ends": "f 1 2 3\r\nf 1 3 4\r\n",
}


@pytest.mark.parametrize("name", FACES)
def test_obj_faces_in_every_form_give_the_same_triangles(name: str) -> None:
    mesh = _obj(POSITIONS + FACES[name] + "\n")
    assert _corners(mesh) == EXPECTED
    assert mesh.vertex_normals is None


@pytest.mark.parametrize("face", ["f 1//1 2//1 3//2 4//2", "vt 0 0\nf 1/1/1 2/1/1 3/1/2 4/1/2", "f 1//-2 2//-2 3//-1 4//-1"])
def test_obj_normals_go_with_their_corners(face: str) -> None:
    mesh = _obj(POSITIONS + "vn 0 0 1\nvn 0 3 4\n" + face)
    assert mesh.vertex_normals is not None
    assert mesh.vertex_normals[mesh.faces[0]].tolist() == [[0, 0, 1], [0, 0, 1], [0, 3, 4]]


def test_an_obj_vertex_with_two_normals_becomes_two_vertices() -> None:
    mesh = _obj(POSITIONS + "vn 0 0 1\nvn 0 1 0\nf 1//1 2//1 3//1\nf 1//2 3//2 4//2\n")
    assert len(mesh.vertices) == 6
    assert _corners(mesh) == EXPECTED


def test_obj_weights_and_colours_of_vertices_are_skipped() -> None:
    assert _corners(_obj("v 0 0 0 1\nv 1 0 0 1 0.5 0.5 0.5\nv 1 1 0 .1 .2 .3\nf 1 2 3\n")) == EXPECTED[:1]


OBJ_ERRORS = {
    "not a number": ("v 0 0 zero\n", "1:1: v: got 'zero', allowed a finite number"),
    "nan": ("v 0 0 nan\n", "1:1: v: got 'nan', allowed a finite number"),
    "overflow": ("v 0 0 1e400\n", "1:1: v: got '1e400', allowed a finite number"),
    "underscore": ("v 0 0 1_0\n", "1:1: v: got '1_0', allowed a finite number"),
    "two numbers": ("v 0 0\n", "1:1: v: got 2 numbers, allowed 3 (x y z)"),
    "normal of two numbers": ("vn 0 0\n", "1:1: vn: got 2 numbers, allowed 3 (x y z)"),
    "face of two": (POSITIONS + "f 1 2\n", "5:1: f: got 2 corners, allowed 3 or more"),
    "vertex 0": (POSITIONS + "f 0 1 2\n", "5:1: f: got vertex 0, allowed 1 to 4 or -4 to -1"),
    "vertex 5": (POSITIONS + "f 1 2 5\n", "5:1: f: got vertex 5, allowed 1 to 4 or -4 to -1"),
    "vertex -5": (POSITIONS + "f 1 2 -5\n", "5:1: f: got vertex -5, allowed 1 to 4 or -4 to -1"),
    "vertex below": ("f 1 2 3\n" + POSITIONS, "1:1: f: got vertex 1, allowed none, as no vertex stands above"),
    "normal 3": (POSITIONS + "vn 0 0 1\nf 1//1 2//1 3//3\n", "6:1: f: got vertex normal 3, allowed 1 to 1 or -1 to -1"),
    "mixed": (
        POSITIONS + "vn 0 0 1\nf 1//1 2//1 3//1\nf 1 2 3\n",
        "7:1: f: got '1', allowed a corner with a normal, as in the first face",
    ),
    "fraction": (POSITIONS + "f 1.0 2 3\n", "5:1: vertex: got '1.0', allowed an integer"),
    "four slashes": (POSITIONS + "f 1/2/3/4 2 3\n", "5:1: f: got '1/2/3/4', allowed v, v/vt, v//vn or v/vt/vn"),
    "no vertex": (POSITIONS + "f //1 2 3\n", "5:1: f: got '//1', allowed v, v/vt, v//vn or v/vt/vn"),
    "curve": ("cstype bezier\n", "1:1: statement 'cstype', allowed v, vn, f, bevel"),
    "binary": ("\x00\x01\x02\n", "1:1: statement '\\x00\\x01\\x02', allowed"),
    "no face": (POSITIONS, "5:1: no face, allowed at least one ('f')"),
    "empty": ("", "1:1: no face, allowed at least one ('f')"),
}


@pytest.mark.parametrize("name", OBJ_ERRORS)
def test_an_error_in_an_obj_file_is_located(name: str) -> None:
    text, expected = OBJ_ERRORS[name]
    with pytest.raises(SpecErrors) as caught:
        _obj(text)
    assert str(caught.value).startswith(f"m.obj:{expected}"), str(caught.value)


@pytest.mark.parametrize("limit", ["vertices", "triangles"])
def test_the_size_of_an_obj_mesh_is_bounded(limit: str) -> None:
    with pytest.raises(SpecErrors, match=rf"m\.obj:\d:1: {limit} of the mesh, got 2, allowed at most 1 \(limit '{limit}'"):
        _obj(POSITIONS + "f 1 2 3 4\n", **{limit: 1})


# --- PLY --------------------------------------------------------------------------------------------------------------


def _header(
    order: str, vertex: str = "float x|float y|float z", face: str = "list uchar int vertex_indices", faces: int = 2
) -> str:
    lines = ["ply", f"format {order} 1.0", "comment a square", "obj_info by hand", "element vertex 4"]
    lines += [f"property {item}" for item in vertex.split("|")]
    lines += [f"element face {faces}", *(f"property {item}" for item in face.split("|")), "end_header"]
    return "\n".join(lines) + "\n"


ASCII = _header("ascii") + "".join(f"{x} {y} {z}\n" for x, y, z in SQUARE) + "3 0 1 2\n3 0 2 3\n"


def _binary(mark: str, *, number: str = "f", index: str = "i", count: str = "B") -> bytes:
    order = {"<": "binary_little_endian", ">": "binary_big_endian"}[mark]
    names = {"f": "float", "d": "double", "i": "int", "B": "uchar", "H": "ushort", "I": "uint", "h": "short"}
    vertex = "|".join(f"{names[number]} {axis}" for axis in "xyz")
    header = _header(order, vertex, f"list {names[count]} {names[index]} vertex_indices").encode()
    body = b"".join(struct.pack(f"{mark}3{number}", *point) for point in SQUARE)
    return header + body + b"".join(struct.pack(f"{mark}{count}3{index}", 3, *face) for face in FAN)


@pytest.mark.parametrize("mark", ["<", ">"])
@pytest.mark.parametrize(
    ("number", "index", "count"), [("f", "i", "B"), ("d", "I", "B"), ("f", "H", "i"), ("f", "B", "H"), ("d", "h", "I")]
)
def test_binary_ply_of_every_type_and_byte_order_is_read(mark: str, number: str, index: str, count: str) -> None:
    assert _corners(_ply(_binary(mark, number=number, index=index, count=count))) == EXPECTED


def test_ascii_ply_is_read() -> None:
    mesh = _ply(ASCII)
    assert _corners(mesh) == EXPECTED
    assert mesh.vertex_normals is None
    assert _corners(_ply(ASCII.replace("\n", "\r\n"))) == EXPECTED
    assert _corners(_ply(ASCII.replace("vertex_indices", "vertex_index"))) == EXPECTED


def test_ply_polygons_of_any_size_become_fans_in_ascii_and_binary_alike() -> None:
    polygons = [[0, 1, 2], [0, 1, 2, 3], [1, 2, 3], [3, 2, 1, 0, 1], [0, 1, 2, 3]]
    text = _header("ascii", faces=5) + "".join(f"{x} {y} {z}\n" for x, y, z in SQUARE)
    text += "".join(f"{len(polygon)} {' '.join(map(str, polygon))}\n" for polygon in polygons)
    binary = _header("binary_big_endian", faces=5).encode() + b"".join(struct.pack(">3f", *point) for point in SQUARE)
    binary += b"".join(struct.pack(f">B{len(polygon)}i", len(polygon), *polygon) for polygon in polygons)
    expected = [[polygon[0], polygon[i], polygon[i + 1]] for polygon in polygons for i in range(1, len(polygon) - 1)]
    assert _ply(text).faces.tolist() == expected
    assert _ply(binary).faces.tolist() == expected


@pytest.mark.parametrize("order", ["ascii", "binary_little_endian"])
def test_ply_normals_are_read_and_other_properties_and_elements_skipped(order: str) -> None:
    vertex = "uchar red|double x|list uchar short tags|float y|float z|float nx|float ny|float nz|uint id"
    header = _header(order, vertex, "float area|list uchar int vertex_indices|uchar flag", faces=1)
    header = header.replace("element vertex", "element camera 2\nproperty float fov\nproperty list uchar int ids\nelement vertex")
    header = header.replace("end_header", "element edge 1\nproperty int a\nend_header")
    if order == "ascii":
        body = b"1.5 2 7 8\n2.5 0\n"
        body += b"".join(f"255 {x} 2 -1 -2 {y} {z} 0 0 {i + 1} {i}\n".encode() for i, (x, y, z) in enumerate(SQUARE))
        body += b"0.5 4 0 1 2 3 1\n9\n"
    else:
        body = struct.pack("<fB2ifB", 1.5, 2, 7, 8, 2.5, 0)
        body += b"".join(
            struct.pack("<BdB2h2f3fI", 255, x, 2, -1, -2, y, z, 0, 0, i + 1, i) for i, (x, y, z) in enumerate(SQUARE)
        )
        body += struct.pack("<fB4iB", 0.5, 4, 0, 1, 2, 3, 1) + struct.pack("<i", 9)
    mesh = _ply(header.encode() + body)
    assert _corners(mesh) == EXPECTED
    assert mesh.vertex_normals is not None
    assert mesh.vertex_normals.tolist() == [[0, 0, i + 1] for i in range(4)]


def test_every_truncation_of_a_ply_file_is_noticed() -> None:
    for whole in (ASCII.encode()[: len(ASCII) - 1], _binary("<"), _binary(">", number="d", count="I")):
        for length in range(len(whole)):
            with pytest.raises(SpecErrors) as caught:
                _ply(whole[:length])
            assert str(caught.value).startswith("m.ply:"), (length, str(caught.value))


PLY_ERRORS = {
    "not a ply": ("solid\n", "1:1: not a PLY file, allowed 'ply' as the first line"),
    "empty": ("", "1:1: not a PLY file"),
    "no end": ("ply\nformat ascii 1.0\n", "1:1: header without 'end_header' (truncated?)"),
    "no format": ("ply\nend_header\n", "2:1: header without 'format'"),
    "format": (ASCII.replace("format ascii 1.0", "format ascii 2.0"), "2:1: got 'format ascii 2.0', allowed format ascii,"),
    "header word": (ASCII.replace("obj_info", "objinfo"), "4:1: header line 'objinfo', allowed format,"),
    "type": (ASCII.replace("float y", "real y"), "7:1: got 'property real y', allowed property TYPE NAME"),
    "count": (ASCII.replace("vertex 4", "vertex four"), "5:1: count of element 'vertex': got 'four', allowed an integer"),
    "negative count": (ASCII.replace("vertex 4", "vertex -4"), "5:1: count of element 'vertex': got -4, allowed an integer ≥ 0"),
    "no vertex": (ASCII.replace("element vertex", "element vortex"), "11:1: no element 'vertex', allowed at least one"),
    "no face": (ASCII.replace("element face", "element tristrips"), "11:1: no element 'face', allowed at least one"),
    "no z": (ASCII.replace("float z", "float w"), "5:1: element 'vertex' without z, allowed x, y, z"),
    "no list": (
        ASCII.replace("vertex_indices", "indices"),
        "9:1: element 'face', allowed one list of integers named vertex_indices",
    ),
    "float list": (ASCII.replace("uchar int vertex", "uchar float vertex"), "9:1: element 'face', allowed one list of integers"),
    "float length": (
        ASCII.replace("uchar int vertex", "float int vertex"),
        "10:1: length of list 'vertex_indices': got type float",
    ),
    "property first": ("ply\nproperty float x\n", "2:1: property before any element"),
    "element twice": (ASCII.replace("end_header", "element face 1\nend_header"), "12:1: an element twice, allowed once each"),
    "property twice": (
        ASCII.replace("float y", "float x\nproperty float y"),
        "5:1: element 'vertex', allowed one or more properties, each name once",
    ),
    "nan": (ASCII.replace("0.25", "nan"), "15:1: z of vertex 3: got 'nan', allowed a finite number"),
    "too few values": (ASCII.replace("1.0 1.0 0.0", "1.0 1.0"), "14:1: vertex 2: got 2 values, allowed more (truncated?)"),
    "too many values": (ASCII.replace("1.0 1.0 0.0", "1.0 1.0 0.0 0.0"), "14:1: vertex 2: got 4 values, allowed 3"),
    "out of range": (ASCII.replace("3 0 2 3", "3 0 2 4"), "17:1: face 1: got vertex 4, allowed 0 to 3"),
    "negative index": (ASCII.replace("3 0 2 3", "3 0 2 -1"), "17:1: face 1: got vertex -1, allowed 0 to 3"),
    "face of two": (ASCII.replace("3 0 2 3", "2 0 2"), "17:1: face 1: got 2 corners, allowed 3 or more"),
    "fewer faces": (ASCII.replace("3 0 2 3\n", ""), "17:1: end of file before face 1, allowed 2 of them (truncated?)"),
    "negative length": (ASCII.replace("3 0 2 3", "-3 0 2 3"), "17:1: face 1: got 4 values, allowed more (truncated?)"),
}


@pytest.mark.parametrize("name", PLY_ERRORS)
def test_an_error_in_a_ply_file_is_located(name: str) -> None:
    text, expected = PLY_ERRORS[name]
    with pytest.raises(SpecErrors) as caught:
        _ply(text)
    assert str(caught.value).startswith(f"m.ply:{expected}"), str(caught.value)


def test_errors_in_binary_ply_name_the_element() -> None:
    good = _binary("<")
    wrong_index = good[:-4] + struct.pack("<i", 4)
    start = good.index(b"end_header\n") + 11
    nan = good[:start] + struct.pack("<f", float("nan")) + good[start + 4 :]
    for content, expected in (
        (wrong_index, "face 1: got vertex 4, allowed 0 to 3"),
        (nan, "x of vertex 0: got nan, allowed a finite number"),
    ):
        with pytest.raises(SpecErrors) as caught:
            _ply(content)
        assert str(caught.value) == f"m.ply:11:1: {expected}"


def test_a_header_that_promises_too_much_is_refused_before_memory_is_taken() -> None:
    for count in ("20000001", "999999999999999999"):
        with pytest.raises(SpecErrors, match="limit 'vertices'"):
            _ply(_binary("<").replace(b"vertex 4\n", f"vertex {count}\n".encode()))
    with pytest.raises(SpecErrors, match=r"truncated"):
        _ply(_binary("<").replace(b"vertex 4\n", b"vertex 20000000\n"))
    with pytest.raises(SpecErrors, match="vertex 4: got 4 values"):
        _ply(ASCII.replace("vertex 4\n", "vertex 20000000\n"))
    huge_list = _binary("<", count="I").replace(struct.pack("<I3i", 3, 0, 1, 2), struct.pack("<I3i", 2**32 - 1, 0, 1, 2))
    with pytest.raises(SpecErrors, match=r"truncated"):
        _ply(huge_list)


def test_a_large_binary_ply_of_mixed_polygons_is_read_fast_enough() -> None:
    count = 40_000
    header = _header("binary_little_endian", faces=count).encode()
    body = b"".join(struct.pack("<3f", *point) for point in SQUARE)
    body += (struct.pack("<B3i", 3, 0, 1, 2) + struct.pack("<B4i", 4, 0, 1, 2, 3)) * (count // 2)
    mesh = _ply(header + body)
    assert len(mesh.faces) == count // 2 * 3
    assert np.array_equal(mesh.faces[:3], [[0, 1, 2], [0, 1, 2], [0, 2, 3]])
