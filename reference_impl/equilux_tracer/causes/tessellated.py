"""Curved shapes drawn as triangles: smooth, faceted, or lit at the vertices."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import ClassVar

from equilux_scenes.case import Case
from equilux_scenes.mesh import TriangleMesh
from equilux_scenes.model import Box, Cylinder, Disc, Mesh, Rectangle, Sphere
from equilux_tracer.causes.mesh_normals import box_mesh, one_normal_per_face, rectangle_mesh, turned_quads, with_meshes
from equilux_tracer.causes.rule import Applied, Discrete, Evidence, Group, Rule
from equilux_tracer.causes.segments import best_tessellations
from equilux_tracer.causes.tessellation import Style, all_styles, tessellated_shape
from equilux_tracer.shading_rules import ShadingRules

_SMOOTH = {style.name: style for style in all_styles(("exact", "averaged", "averaged over edges"))}
_FLAT = {
    ", ".join(filter(None, ("tessellated", style.name.removesuffix("flat").strip(", ")))): style
    for style in all_styles(("flat",))
}
_LIT = {", ".join(filter(None, ("tessellated", style.name))): style for style in all_styles(("exact", "flat"))}


class Tessellated(Rule):
    """Curved shapes are drawn as triangles with interpolated normals, too few of them: spheres, cylinders, discs.

    The parameter is the number of segments around, or how often an icosphere is cut. What has finer silhouettes than facets is
    not tried.
    """

    id = "tessellated"
    group: ClassVar[Group] = "geometry"
    formula = ("|P − C| = r", "P on triangles with corners |P_k − C| = r;  N = unit(u N_a + v N_b + w N_c)")
    readings: ClassVar[Mapping[str, str]] = {name: style.description for name, style in _SMOOTH.items()} | {
        "flat": "as the first, shaded with face normals"
    }
    parameter = Discrete("segments")

    def hypotheses(self, case: Case) -> Sequence[Applied]:
        return [Applied(self.id)] if _curved(case) else []

    def estimates(self, hypothesis: Applied, evidence: Evidence) -> Sequence[Applied]:
        """By a coarse search over numbers and styles on some of the pixels; see `best_tessellations`."""
        return best_tessellations(self, _SMOOTH | {"flat": Style(normals="flat")}, _curved(evidence.case), evidence)

    def change_case(self, case: Case, applied: Applied) -> Case:
        style = _SMOOTH.get(applied.reading, Style(normals="flat"))
        return with_meshes(case, _tessellated(case, applied, style))


class FacetedNormals(Rule):
    """Smooth meshes are shaded with one normal per triangle: vertex normals get lost, or come from derivatives of the position.

    Curved shapes that become triangles on the way are faceted, too; then the parameter is the number of segments around.
    """

    id = "faceted-normals"
    group: ClassVar[Group] = "geometry"
    formula = ("N = unit(u N_a + v N_b + w N_c)", "N = unit((b − a) × (c − a))")
    readings: ClassVar[Mapping[str, str]] = {
        "": "every mesh is shaded with its face normals",
        "first vertex": "the normal of each triangle's first vertex",
        "last vertex": "the normal of each triangle's last vertex",
        "mean": "the mean of each triangle's vertex normals",
    } | {name: f"curved shapes, too: {style.description}" for name, style in _FLAT.items()}
    parameter = Discrete("segments")

    def hypotheses(self, case: Case) -> Sequence[Applied]:
        of_meshes = ["", "first vertex", "last vertex", "mean"] if _has_vertex_normals(case) else []
        of_curved = ["tessellated"] if _curved(case, flats=False) else []
        return [Applied(self.id, None, reading) for reading in (*of_meshes, *of_curved)]

    def estimates(self, hypothesis: Applied, evidence: Evidence) -> Sequence[Applied]:
        if hypothesis.reading not in _FLAT:
            return [hypothesis]
        return best_tessellations(self, _FLAT, _curved(evidence.case, flats=False), evidence)

    def change_case(self, case: Case, applied: Applied) -> Case:
        meshes = {index: mesh for index, mesh in case.meshes.items() if mesh.vertex_normals is not None}
        match applied.reading:
            case "first vertex" | "last vertex" | "mean":
                which = {"first vertex": "first", "last vertex": "last", "mean": "mean"}[applied.reading]
                return with_meshes(case, {index: one_normal_per_face(mesh, which) for index, mesh in meshes.items()})  # type: ignore[arg-type]
            case _:
                made = {index: TriangleMesh(mesh.vertices, mesh.faces) for index, mesh in meshes.items()}
                style = _FLAT.get(applied.reading)
                return with_meshes(case, made | ({} if style is None else _tessellated(case, applied, style)))


class VertexLighting(Rule):
    """Light is worked out at the vertices only and interpolated over the triangles: Gouraud shading, the fixed-function API.

    Curved shapes have become triangles then (the parameter is the number of segments around), and flat ones are lit at their
    corners. An infinite plane has none, and is shaded as always.
    """

    id = "vertex-lighting"
    group: ClassVar[Group] = "geometry"
    formula = ("L(V, N(P)) at every point P", "u L_a + v L_b + w L_c of the triangle's corners")
    readings: ClassVar[Mapping[str, str]] = {
        "": "meshes only",
        "corners": "meshes, rectangles and boxes, at their corners",
        "corners, other diagonals": "the same, cut along the other diagonal",
    } | {name: f"every shape but planes; {style.description}" for name, style in _LIT.items()}
    parameter = Discrete("segments")

    def hypotheses(self, case: Case) -> Sequence[Applied]:
        if not case.scene.lights:
            return []
        flats = any(isinstance(obj, Rectangle | Box) for obj in case.scene.objects)
        worth = [""] if case.meshes else []
        worth += ["corners", "corners, other diagonals"] if flats else []
        worth += ["tessellated"] if _curved(case) else []
        return [Applied(self.id, None, reading) for reading in worth]

    def estimates(self, hypothesis: Applied, evidence: Evidence) -> Sequence[Applied]:
        if hypothesis.reading not in _LIT:
            return [hypothesis]
        return best_tessellations(self, _LIT, _curved(evidence.case), evidence)

    def change_case(self, case: Case, applied: Applied) -> Case:
        style = _LIT.get(applied.reading)
        made = {} if style is None else _tessellated(case, applied, style)
        if applied.reading:
            other = "other diagonals" in applied.reading
            made |= {index: mesh for index, obj in enumerate(case.scene.objects) if (mesh := _corners(obj, other)) is not None}
        return with_meshes(case, made)

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        return replace(rules, vertex_lighting=True)


def _curved(case: Case, *, flats: bool = True) -> list[int]:
    """Indices of the objects that become polyhedra; flats: discs, which become polygons, too."""
    kinds = (Sphere, Cylinder, Disc) if flats else (Sphere, Cylinder)
    return [index for index, obj in enumerate(case.scene.objects) if isinstance(obj, kinds)]


def _tessellated(case: Case, applied: Applied, style: Style) -> dict[int, TriangleMesh]:
    if not isinstance(applied.parameter, int):
        raise ValueError(f"{applied.cause}: got parameter {applied.parameter!r}, allowed a number of segments")
    result = {}
    for index in _curved(case):
        obj = case.scene.objects[index]
        assert isinstance(obj, Sphere | Cylinder | Disc)
        result[index] = tessellated_shape(obj, applied.parameter, style)
    return result


def _has_vertex_normals(case: Case) -> bool:
    return any(
        isinstance(case.scene.objects[index], Mesh) and mesh.vertex_normals is not None for index, mesh in case.meshes.items()
    )


def _corners(obj: object, other_diagonals: bool) -> TriangleMesh | None:
    """A rectangle or box as its faces' triangles."""
    if isinstance(obj, Rectangle):
        mesh = rectangle_mesh(obj.corner, obj.edge_u, obj.edge_v)
    elif isinstance(obj, Box):
        mesh = box_mesh(obj.min, obj.max, shared=False)
    else:
        return None
    return turned_quads(mesh) if other_diagonals else mesh
