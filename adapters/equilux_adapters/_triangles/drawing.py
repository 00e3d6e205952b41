"""Which function of the kit draws an object, and with which arguments: said once, for scripts and for budgets."""

from __future__ import annotations

from typing import Any

from equilux.adapter import Case
from equilux_adapters._triangles import shapes
from equilux_adapters._triangles.view import Mesh, View
from equilux_scenes.model import Object
from equilux_scenes.transforms import matrix

_KEYS = {
    "sphere": {"center": "center", "radius": "radius"},
    "plane": {"point": "point", "normal": "normal"},
    "box": {"min": "low", "max": "high"},
    "disc": {"center": "center", "normal": "normal", "radius": "radius"},
    "rectangle": {"corner": "corner", "edge_u": "edge_u", "edge_v": "edge_v"},
    "cylinder": {"base": "base", "top": "top", "radius": "radius", "capped": "capped"},
    "mesh": {},
}
_TESSELLATED = {"sphere", "disc", "cylinder"}


def arguments(obj: Object, segments: int) -> dict[str, Any]:
    """Arguments of the kit's function of the object's kind, without the view and a mesh's arrays."""
    result = {to: getattr(obj, key) for key, to in _KEYS[obj.kind].items()}
    if obj.kind in _TESSELLATED:
        result["segments"] = segments
    if obj.transform:
        result["matrix"] = tuple(tuple(float(number) for number in row) for row in matrix(obj))
    return result


def build(case: Case, index: int, view: View, segments: int) -> Mesh:
    """What the script draws for an object."""
    obj, mesh = case.scene.objects[index], case.meshes.get(index)
    given = arguments(obj, segments)
    if mesh is not None:
        given |= {"vertices": mesh.vertices, "faces": mesh.faces, "vertex_normals": mesh.vertex_normals}
    made: Mesh = getattr(shapes, obj.kind)(view, **given)
    return made
