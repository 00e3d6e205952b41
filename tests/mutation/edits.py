"""Faults in what the renderer takes the scene to be: lights, materials, meshes, the camera."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from equilux_scenes.case import Case
from equilux_scenes.mesh import TriangleMesh
from equilux_scenes.model import Mesh, PointLight

CaseEdit = Callable[[Case], Case]


def with_scene(case: Case, **update: Any) -> Case:
    return dataclasses.replace(case, scene=case.scene.model_copy(update=update))


def materials(change: Callable[[Any], dict[str, Any]]) -> CaseEdit:
    """Every material with some coefficients replaced."""

    def edit(case: Case) -> Case:
        changed = {name: m.model_copy(update=change(m)) for name, m in case.scene.materials.items()}
        return with_scene(case, materials=changed)

    return edit


def lights(change: Callable[[Any], Any], kinds: tuple[str, ...] = ("point", "directional", "spot")) -> CaseEdit:
    """Every light of these kinds replaced by what `change` makes of it; None leaves it out."""

    def edit(case: Case) -> Case:
        changed = {name: change(light) if light.kind in kinds else light for name, light in case.scene.lights.items()}
        return with_scene(case, lights={name: light for name, light in changed.items() if light is not None})

    return edit


def product(a: Any, b: Any) -> tuple[float, ...]:
    return tuple(p * q for p, q in zip(a, b, strict=True))


# --- lights -----------------------------------------------------------------------------------------------------------


def without_light(which: int) -> CaseEdit:
    """The light at this place in the file left out (counted round)."""

    def edit(case: Case) -> Case:
        names = list(case.scene.lights)
        left = {name: light for name, light in case.scene.lights.items() if name != names[which % len(names)]}
        return with_scene(case, lights=left)

    return edit


def falloff(**terms: float) -> CaseEdit:
    """Terms of the attenuation replaced."""
    return lights(lambda light: _with_falloff(light, terms), ("point", "spot"))


def _with_falloff(light: Any, terms: dict[str, float]) -> Any:
    fall = light.attenuation.model_copy(update=terms)
    if fall.constant == fall.linear == fall.quadratic == 0:
        fall = fall.model_copy(update={"constant": 1.0})  # nobody divides by 0: no term is left, and nothing falls off
    return light.model_copy(update={"attenuation": fall})


def spots(**update: Any) -> CaseEdit:
    return lights(lambda light: light.model_copy(update=update), ("spot",))


def spots_by(change: Callable[[Any], dict[str, Any]]) -> CaseEdit:
    return lights(lambda light: light.model_copy(update=change(light)), ("spot",))


def as_point(light: Any) -> Any:
    """The same light, shining alike in all directions."""
    colours = {term: getattr(light, term) for term in ("ambient", "diffuse", "specular")}
    return PointLight.model_construct(
        kind="point", position=light.position, intensity=light.intensity, attenuation=light.attenuation, **colours
    )


# --- geometry ---------------------------------------------------------------------------------------------------------


def meshes(change: Callable[[TriangleMesh], TriangleMesh]) -> CaseEdit:
    return lambda case: dataclasses.replace(case, meshes={index: change(mesh) for index, mesh in case.meshes.items()})


def faceted(mesh: TriangleMesh) -> TriangleMesh:
    return TriangleMesh(mesh.vertices, mesh.faces, None)


def smoothed(weight: str) -> Callable[[TriangleMesh], TriangleMesh]:
    """Flat meshes get vertex normals: sums over the triangles of their normals, each weighted by its area, by its angle at the
    vertex, by both, or not at all.
    """

    def change(mesh: TriangleMesh) -> TriangleMesh:
        if mesh.vertex_normals is not None:
            return mesh
        total = np.zeros_like(mesh.vertices)
        for face in mesh.faces:
            corners = mesh.vertices[face]
            normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
            area = np.linalg.norm(normal) / 2
            for k in range(3):
                u, v = corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]
                angle = math.acos(float(np.clip(u @ v / np.linalg.norm(u) / np.linalg.norm(v), -1, 1)))
                part = (area if "area" in weight else 1.0) * (angle if "angle" in weight else 1.0)
                total[face[k]] += part * normal / (2 * area)
        return TriangleMesh(mesh.vertices, mesh.faces, total / np.linalg.norm(total, axis=1, keepdims=True))

    return change


def in_triangles(
    around: int, *, smooth: bool, axis: int = 2, kinds: tuple[str, ...] = ("sphere", "cylinder", "disc")
) -> CaseEdit:
    """Spheres become `around` × `around`/2 quadrilaterals of longitude and latitude about a coordinate axis, cylinders `around`
    sides, each cut in two triangles; discs a fan.
    """

    def edit(case: Case) -> Case:
        objects, arrays = list(case.scene.objects), dict(case.meshes)
        for index, obj in enumerate(objects):
            if obj.kind not in kinds:
                continue
            if obj.kind == "sphere":
                arrays[index] = _ball(obj, around, smooth, axis)
            elif obj.kind == "cylinder":
                arrays[index] = _tube(obj, around, smooth)
            else:
                arrays[index] = _fan(obj, around, smooth)
            objects[index] = Mesh.model_construct(kind="mesh", material=obj.material, transform=obj.transform, normals="flat")
        return dataclasses.replace(with_scene(case, objects=tuple(objects)), meshes=arrays)

    return edit


def _ball(sphere: Any, around: int, smooth: bool, axis: int) -> TriangleMesh:
    rings = around // 2
    theta = np.pi * np.arange(rings + 1) / rings
    phi = 2 * np.pi * np.arange(around) / around
    grid = np.stack(
        [np.outer(np.sin(theta), np.cos(phi)), np.outer(np.sin(theta), np.sin(phi)), np.outer(np.cos(theta), np.ones(around))], -1
    )
    unit = np.roll(grid.reshape(-1, 3), axis - 2, axis=1)
    faces = []
    for ring in range(rings):
        for k in range(around):
            a, b = ring * around + k, ring * around + (k + 1) % around
            if ring > 0:
                faces.append((a, b + around, b))
            if ring < rings - 1:
                faces.append((a, a + around, b + around))
    return TriangleMesh(np.array(sphere.center) + sphere.radius * unit, np.array(faces), unit if smooth else None)


def _tube(cylinder: Any, around: int, smooth: bool) -> TriangleMesh:
    base, top = np.array(cylinder.base, float), np.array(cylinder.top, float)
    axis = (top - base) / np.linalg.norm(top - base)
    out = _circle(axis, around)
    vertices, normals, faces = [*(base + cylinder.radius * out), *(top + cylinder.radius * out)], [*out, *out], []
    for k in range(around):
        a, b = k, (k + 1) % around
        faces += [(a, b, b + around), (a, b + around, a + around)]
    if cylinder.capped:
        for end, normal, turn in ((base, -axis, -1), (top, axis, 1)):
            first = len(vertices)
            vertices += [end, *(end + cylinder.radius * out)]
            normals += [normal] * (around + 1)
            rim = [(first + 1 + k, first + 1 + (k + 1) % around) for k in range(around)]
            faces += [(first, a, b) if turn > 0 else (first, b, a) for a, b in rim]
    return TriangleMesh(np.array(vertices), np.array(faces), np.array(normals) if smooth else None)


def _fan(disc: Any, around: int, smooth: bool) -> TriangleMesh:
    normal = np.array(disc.normal, float) / np.linalg.norm(disc.normal)
    center = np.array(disc.center, float)
    vertices = np.array([center, *(center + disc.radius * _circle(normal, around))])
    faces = np.array([(0, 1 + k, 1 + (k + 1) % around) for k in range(around)])
    return TriangleMesh(vertices, faces, np.tile(normal, (around + 1, 1)) if smooth else None)


def _circle(axis: Any, around: int) -> Any:
    """Unit vectors across an axis, the first one across the coordinate axis that is farthest from it, too."""
    u = np.cross(np.eye(3)[int(np.argmin(np.abs(axis)))], axis)
    u /= np.linalg.norm(u)
    phi = 2 * np.pi * np.arange(around) / around
    return np.outer(np.cos(phi), u) + np.outer(np.sin(phi), np.cross(axis, u))


# --- handedness -------------------------------------------------------------------------------------------------------


def mirrored_world(case: Case) -> Case:
    """z of everything in the scene turned about, but not of the camera: coordinates read as left-handed."""
    mirror = np.diag([1.0, 1.0, -1.0, 1.0])
    return _placed(case, mirror, lambda v: (v[0], v[1], -v[2]))


def mirrored_with_camera(case: Case) -> Case:
    """z of everything turned about, the camera's too: the picture comes out mirrored."""
    case = mirrored_world(case)
    camera = case.scene.camera
    changed = {key: (v[0], v[1], -v[2]) for key in ("eye", "target", "up") if (v := getattr(camera, key))}
    return with_scene(case, camera=camera.model_copy(update=changed))


def _placed(case: Case, world: Any, there: Callable[[Any], Any]) -> Case:
    from equilux_scenes.model import TransformStep

    step = TransformStep.model_construct(matrix=tuple(tuple(row) for row in world.tolist()))
    objects = tuple(obj.model_copy(update={"transform": (*obj.transform, step)}) for obj in case.scene.objects)
    changed = {}
    for name, light in case.scene.lights.items():
        update = {key: there(getattr(light, key)) for key in ("position", "direction") if hasattr(light, key)}
        changed[name] = light.model_copy(update=update)
    return with_scene(case, objects=objects, lights=changed)
