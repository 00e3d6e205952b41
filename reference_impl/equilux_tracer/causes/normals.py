"""Faults of normals: whose they are, and which way they point."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import ClassVar, Literal, cast

import numpy as np

from equilux_scenes.case import Case
from equilux_scenes.mesh import TriangleMesh
from equilux_scenes.model import Box, Cylinder, Disc, DiscEmitter, Mesh, Plane, Rectangle, RectangleEmitter, Sphere
from equilux_scenes.transforms import matrix
from equilux_tracer.causes.mesh_normals import Weight, box_mesh, reversed_mesh, smooth, with_meshes
from equilux_tracer.causes.rewrite import used_materials, with_scene
from equilux_tracer.causes.rule import Applied, Group, Rule
from equilux_tracer.shading_rules import ShadingRules

_WEIGHTS: tuple[Weight, ...] = ("area and angle", "area", "angle", "unweighted")


def _smoothed_readings() -> dict[str, str]:
    result = {"": "Σ area × angle × face normal over the triangles that share the vertex; of boxes, too"}
    result["merged"] = "the same, vertices at one position counting as one"
    for weight in _WEIGHTS[1:]:
        formula = "Σ face normal" if weight == "unweighted" else f"Σ {weight} × face normal"
        result[weight] = f"{formula} over the triangles that share the vertex"
        result[f"{weight}, merged"] = "the same, vertices at one position counting as one"
    for name, words in list(result.items()):
        result[", ".join(filter(None, ("meshes only", name)))] = words.split(";")[0] + "; boxes as they are"
    result["from the centre"] = "a box's normals point away from its centre"
    result["given"] = "the vertex normals that the file gives"
    return result


class SmoothedNormals(Rule):
    """Flat meshes and boxes are shaded with vertex normals, as importers make them that weld vertices and smooth everything."""

    id = "smoothed-normals"
    group: ClassVar[Group] = "geometry"
    formula = ("N = unit((b − a) × (c − a))", "N = unit(u N_a + v N_b + w N_c)")
    readings: ClassVar[Mapping[str, str]] = _smoothed_readings()

    def hypotheses(self, case: Case) -> Sequence[Applied]:
        flat = [index for index, obj in enumerate(case.scene.objects) if isinstance(obj, Mesh) and obj.normals == "flat"]
        boxes = any(isinstance(obj, Box) for obj in case.scene.objects)
        worth = []
        for reading in self.readings:
            if reading == "from the centre":
                useful = boxes
            elif reading == "given":
                useful = any(_given(case, index) is not None for index in flat)
            elif "merged" in reading:
                useful = any(_has_copies(case.meshes[index]) for index in flat)
            elif reading.startswith("meshes only"):
                useful = bool(flat) and boxes
            else:
                useful = bool(flat) or boxes
            if useful and ("meshes only" not in reading or boxes):
                worth.append(Applied(self.id, None, reading))
        return worth

    def change_case(self, case: Case, applied: Applied) -> Case:
        reading = applied.reading
        meshes: dict[int, TriangleMesh] = {}
        for index, obj in enumerate(case.scene.objects):
            if isinstance(obj, Box) and "meshes only" not in reading and reading != "given":
                meshes[index] = _smooth_box(obj, reading)
            elif isinstance(obj, Mesh) and obj.normals == "flat" and reading != "from the centre":
                given = _given(case, index) if reading == "given" else None
                made = given or (
                    None if reading == "given" else smooth(case.meshes[index], _weight(reading), merged="merged" in reading)
                )
                meshes |= {} if made is None else {index: made}
        return with_meshes(case, meshes)


def _smooth_box(box: Box, reading: str) -> TriangleMesh:
    mesh = box_mesh(box.min, box.max, shared=True)
    if reading != "from the centre":
        return smooth(mesh, _weight(reading), merged=False)
    away = mesh.vertices - (np.asarray(box.min) + np.asarray(box.max)) / 2
    # all corners are equally far away: interpolated, this is the direction from the centre at every point
    return TriangleMesh(mesh.vertices, mesh.faces, away / np.linalg.norm(away, axis=1, keepdims=True))


def _weight(reading: str) -> Weight:
    name = ", ".join(part for part in reading.split(", ") if part not in ("meshes only", "merged"))
    return cast(Weight, name) if name else "area and angle"


def _given(case: Case, index: int) -> TriangleMesh | None:
    """A flat mesh with the normals that the spec itself gives; those in a file are not looked for."""
    obj = case.scene.objects[index]
    if not isinstance(obj, Mesh) or obj.vertex_normals is None:
        return None
    normals = np.asarray(obj.vertex_normals, dtype=np.float64)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    mesh = case.meshes[index]
    return TriangleMesh(mesh.vertices, mesh.faces, normals / np.where(length > 0, length, 1.0))


def _has_copies(mesh: TriangleMesh) -> bool:
    return len(np.unique(mesh.vertices + 0.0, axis=0)) < len(mesh.vertices)


class ReversedNormals(Rule):
    """Normals point away from the viewer: triangles wound clockwise, a normal matrix with a wrong sign, a forgotten flip."""

    id = "reversed-normals"
    group: ClassVar[Group] = "geometry"
    formula = ("N on the viewer's side", "−N")
    readings: ClassVar[Mapping[str, str]] = {
        "": "N → −N, after the viewer's side has been chosen",
        "as given": "N → −N of the outward normal, and the viewer's side is never chosen",
        "meshes": "meshes are wound the other way, vertex normals negated, and the viewer's side is never chosen",
        "media": "planes and meshes have their inside outside: where refraction asks for a side",
        "emitters": "disc and rectangle emitters shine on the other side",
    }

    def hypotheses(self, case: Case) -> Sequence[Applied]:
        scene = case.scene
        lit = bool(scene.lights) and any(any(m.diffuse) or any(m.specular) for m in used_materials(scene))
        refracting = any(
            isinstance(obj, Plane | Mesh)
            and scene.materials[obj.material].transparency > 0
            and scene.materials[obj.material].ior != 1
            for obj in scene.objects
        )
        worth = {
            "": lit,
            "as given": lit and _sees_both_sides(case),
            "meshes": lit and any(isinstance(obj, Mesh) for obj in scene.objects),
            "media": scene.model == "raytraced" and refracting,
            "emitters": any(isinstance(light, DiscEmitter | RectangleEmitter) for light in scene.lights.values()),
        }
        return [Applied(self.id, None, reading) for reading, useful in worth.items() if useful]

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        match applied.reading:
            case "":
                return replace(rules, normals_reversed=not rules.normals_reversed)
            case "as given":
                return replace(rules, normals_reversed=not rules.normals_reversed, normal_side="as-given")
            case "meshes":
                return replace(rules, normal_side="as-given")
            case _:
                return rules

    def change_case(self, case: Case, applied: Applied) -> Case:
        if applied.reading == "emitters":
            return with_scene(case, lights={name: _turned(light) for name, light in case.scene.lights.items()})
        if applied.reading not in ("meshes", "media"):
            return case
        changed = with_meshes(case, {index: reversed_mesh(mesh) for index, mesh in case.meshes.items()})
        if applied.reading == "meshes":
            return changed
        objects = [
            obj.model_copy(update={"normal": tuple(-x for x in obj.normal)}) if isinstance(obj, Plane) else obj
            for obj in changed.scene.objects
        ]
        return with_scene(changed, objects=tuple(objects))


def _turned(light: object) -> object:
    if isinstance(light, DiscEmitter):
        return light.model_copy(update={"normal": tuple(-x for x in light.normal)})
    if isinstance(light, RectangleEmitter):
        return light.model_copy(update={"edge_u": light.edge_v, "edge_v": light.edge_u})
    return light


class NormalSide(Rule):
    """The normal is not taken on the viewer's side: surfaces are lit on the side that their outward normal points to, or the side
    is chosen by another normal than the geometric one.
    """

    id = "normal-side"
    group: ClassVar[Group] = "geometry"
    formula = ("N with N·N_g > 0, N_g the geometric normal on the viewer's side", "N as it is given")
    readings: ClassVar[Mapping[str, str]] = {
        "": "the outward normal, a mesh's as stored, however it is seen",
        "facing the viewer": "the interpolated normal is turned until N·V ≥ 0",
    }

    def hypotheses(self, case: Case) -> Sequence[Applied]:
        if not case.scene.lights:
            return []
        worth = [Applied(self.id)] if _sees_both_sides(case) else []
        smooth_meshes = any(mesh.vertex_normals is not None for mesh in case.meshes.values())
        return worth + ([Applied(self.id, None, "facing the viewer")] if smooth_meshes else [])

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        side: Literal["as-given", "facing-viewer"] = "facing-viewer" if applied.reading else "as-given"
        return replace(rules, normal_side=side)


def _sees_both_sides(case: Case) -> bool:
    """Whether a surface may be seen from behind: not opaque closed shapes from outside, nor flat ones from the front."""
    scene = case.scene
    camera = scene.camera
    if any(material.transparency > 0 for material in used_materials(scene)):
        return True
    mirrors = any(any(material.reflection) for material in used_materials(scene))
    for obj in scene.objects:
        eye, backwards = np.asarray(camera.eye), np.asarray(camera.eye) - np.asarray(camera.target)
        if obj.transform:
            inverse = np.linalg.inv(matrix(obj))
            eye, backwards = inverse[:3, :3] @ eye + inverse[:3, 3], inverse[:3, :3] @ backwards
        match obj:
            case Plane() | Disc() | Rectangle():
                point = obj.point if isinstance(obj, Plane) else obj.center if isinstance(obj, Disc) else obj.corner
                normal = np.cross(obj.edge_u, obj.edge_v) if isinstance(obj, Rectangle) else np.asarray(obj.normal)
                seen_from = backwards if camera.projection == "orthographic" else eye - np.asarray(point)
                if mirrors or float(normal @ seen_from) <= 0:
                    return True
            case Mesh():
                return True
            case Cylinder():
                if not obj.capped or camera.projection == "orthographic" or np.linalg.norm(eye - obj.base) < _reach(obj):
                    return True
            case Sphere():
                if camera.projection == "orthographic" or float(np.linalg.norm(eye - np.asarray(obj.center))) <= obj.radius:
                    return True
            case Box():
                inside = all(a <= x <= b for a, x, b in zip(obj.min, eye, obj.max, strict=True))
                if camera.projection == "orthographic" or inside:
                    return True
    return False


def _reach(cylinder: Cylinder) -> float:
    return float(np.linalg.norm(np.subtract(cylinder.top, cylinder.base))) + cylinder.radius
