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
from equilux_tracer.causes.tessellation import PARTS, PLAIN, Style, tessellated_shape
from equilux_tracer.shading_rules import ShadingRules

TESSELLATED = "tessellated"
"""First part of the readings in which curved shapes have become triangles."""
FLAT = "tessellated, flat"


class Tessellated(Rule):
    """Curved shapes are drawn as triangles with interpolated normals, too few of them: spheres, cylinders, discs.

    The parameter is the number of segments around, or how often an icosphere is cut. Readings are combined: `n bands, about z`.
    """

    id = "tessellated"
    group: ClassVar[Group] = "geometry"
    formula = ("|P − C| = r", "P on triangles with corners |P_k − C| = r;  N = unit(u N_a + v N_b + w N_c)")
    readings: ClassVar[Mapping[str, str]] = {"": PLAIN} | {part: words for part, (_, _, words) in PARTS.items()}
    parameter = Discrete("segments")

    def hypotheses(self, case: Case) -> Sequence[Applied]:
        return [Applied(self.id), Applied(self.id, None, "flat")] if _curved(case) else []

    def estimates(self, hypothesis: Applied, evidence: Evidence) -> Sequence[Applied]:
        """By a coarse search over numbers and styles on some of the pixels; see `best_tessellations`."""
        if hypothesis.reading == "flat":
            return best_tessellations(self, "", ("flat",), evidence)
        return best_tessellations(self, "", ("exact", "averaged", "averaged over edges"), evidence)

    def change_case(self, case: Case, applied: Applied) -> Case:
        return with_meshes(case, _tessellated(case, applied, Style.named(applied.reading)))


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
        FLAT: "curved shapes, too: triangles, with the readings of `tessellated`, joined by commas",
    }
    parameter = Discrete("segments")

    def hypotheses(self, case: Case) -> Sequence[Applied]:
        of_meshes = ["", "first vertex", "last vertex", "mean"] if _has_vertex_normals(case) else []
        of_curved = [FLAT] if any(isinstance(obj, Sphere | Cylinder) for obj in case.scene.objects) else []
        return [Applied(self.id, None, reading) for reading in (*of_meshes, *of_curved)]

    def estimates(self, hypothesis: Applied, evidence: Evidence) -> Sequence[Applied]:
        if not hypothesis.reading.startswith(TESSELLATED):
            return [hypothesis]
        return best_tessellations(self, TESSELLATED, ("flat",), evidence)

    def change_case(self, case: Case, applied: Applied) -> Case:
        meshes = {index: mesh for index, mesh in case.meshes.items() if mesh.vertex_normals is not None}
        match applied.reading:
            case "first vertex" | "last vertex" | "mean":
                which = {"first vertex": "first", "last vertex": "last", "mean": "mean"}[applied.reading]
                return with_meshes(case, {index: one_normal_per_face(mesh, which) for index, mesh in meshes.items()})  # type: ignore[arg-type]
            case _:
                made = {index: TriangleMesh(mesh.vertices, mesh.faces) for index, mesh in meshes.items()}
                if applied.reading:
                    made |= _tessellated(case, applied, _style(applied))
                return with_meshes(case, made)


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
        TESSELLATED: "every shape but planes, with the readings of `tessellated`, joined by commas",
    }
    parameter = Discrete("segments")

    def hypotheses(self, case: Case) -> Sequence[Applied]:
        if not case.scene.lights:
            return []
        flats = any(isinstance(obj, Rectangle | Box) for obj in case.scene.objects)
        worth = [""] if case.meshes else []
        worth += ["corners", "corners, other diagonals"] if flats else []
        worth += [TESSELLATED] if _curved(case) else []
        return [Applied(self.id, None, reading) for reading in worth]

    def estimates(self, hypothesis: Applied, evidence: Evidence) -> Sequence[Applied]:
        if not hypothesis.reading.startswith(TESSELLATED):
            return [hypothesis]
        return best_tessellations(self, TESSELLATED, ("exact", "flat"), evidence)

    def change_case(self, case: Case, applied: Applied) -> Case:
        made = _tessellated(case, applied, _style(applied)) if applied.reading.startswith(TESSELLATED) else {}
        if applied.reading:
            other = "other diagonals" in applied.reading
            made |= {index: mesh for index, obj in enumerate(case.scene.objects) if (mesh := _corners(obj, other)) is not None}
        return with_meshes(case, made)

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        return replace(rules, vertex_lighting=True)


def _style(applied: Applied) -> Style:
    return Style.named(applied.reading.removeprefix(TESSELLATED).removeprefix(", "))


def _curved(case: Case) -> bool:
    return any(isinstance(obj, Sphere | Cylinder | Disc) for obj in case.scene.objects)


def _tessellated(case: Case, applied: Applied, style: Style) -> dict[int, TriangleMesh]:
    if not isinstance(applied.parameter, int):
        raise ValueError(f"{applied.cause}: got parameter {applied.parameter!r}, allowed a number of segments")
    return {
        index: tessellated_shape(obj, applied.parameter, style)
        for index, obj in enumerate(case.scene.objects)
        if isinstance(obj, Sphere | Cylinder | Disc) and obj.kind not in style.left_out
    }


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
