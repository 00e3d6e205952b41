"""Objects as POV-Ray primitives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from equilux_adapters.povray.frame import Frame
from equilux_adapters.povray.meshes import centre, mesh2
from equilux_adapters.povray.numbers import matrix_modifier, number, vector
from equilux_scenes.mesh import TriangleMesh
from equilux_scenes.model import Box, Cylinder, Disc, Object, Plane, Rectangle, Sphere
from equilux_scenes.transforms import matrix, unit

Matrix = npt.NDArray[np.float64]


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
        shift = np.eye(4)
        shift[:3, 3] = centre(mesh) * frame.scale
        return Written(mesh2(mesh, frame.scale), frame.matrix(matrix(obj)) @ shift)
    if obj.transform:
        return Written(_primitive(obj, Frame(np.zeros(3), frame.scale, 0.0)), frame.matrix(matrix(obj)))
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
    """A plane cut to size by a box: exact edges, and coplanar rectangles are hit at bitwise equal depths, so the first wins.

    A `polygon` has neither, and vanishes when its corners leave its plane by 1e-10 (Q18).
    """
    square = np.eye(4)
    square[:3] = np.array([obj.edge_u, obj.edge_v, (0.0, 0.0, 0.0), obj.corner]).T * frame.scale
    placed = frame.matrix(matrix(obj)) @ square
    normal = np.array(unit(tuple(np.cross(placed[:3, 0], placed[:3, 1]))))
    placed[:3, 2] = normal
    surface = f"plane {{ {vector(normal)}, {number(np.dot(normal, placed[:3, 3]))}"
    size = f"box {{ <0, 0, -1>, <1, 1, 1> {matrix_modifier(placed)} }}"
    return Written(f"{surface}\n  clipped_by {{ {size} }}", None)
