"""The world taken for a left-handed one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np

from equilux_scenes.case import Case
from equilux_scenes.model import (
    Box,
    Cylinder,
    DirectionalLight,
    Disc,
    DiscEmitter,
    Light,
    Object,
    Plane,
    PointLight,
    RectangleEmitter,
    Sphere,
    SphereEmitter,
    SpotLight,
    TransformStep,
)
from equilux_tracer.causes.rewrite import with_scene
from equilux_tracer.causes.rule import Applied, Floats, Group, Rule

_AXES = {"z": np.diag([1.0, 1.0, -1.0]), "x": np.diag([-1.0, 1.0, 1.0]), "y": np.diag([1.0, -1.0, 1.0])}
_EXCHANGED = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])


def _readings() -> dict[str, str]:
    result = {"": "camera's right = up × forward: everything is mirrored, and so the picture is"}
    for axis in _AXES:
        result[axis] = f"{axis} → −{axis} of objects and lights; the camera stays"
    for axis in _AXES:
        result[f"camera {axis}"] = f"{axis} → −{axis} of the camera; objects and lights stay"
    for axis in _AXES:
        result[f"lights {axis}"] = f"{axis} → −{axis} of lights; objects and camera stay"
    for axis in _AXES:
        result[f"objects {axis}"] = f"{axis} → −{axis} of objects; lights and camera stay"
    result["y and z"] = "y and z are exchanged, of objects and lights; the camera stays"
    result["rotations"] = "rotations turn the other way"
    return result


class MirroredHandedness(Rule):
    """The world is taken to be left-handed: x right, y up, and z into the screen, as in POV-Ray and Direct3D.

    Where everything is taken so, camera, objects and lights, the picture is mirrored, and nothing tells this from `flipped-x`.
    Translations that mend only a part of it mirror that part.
    """

    id = "mirrored-handedness"
    group: ClassVar[Group] = "geometry"
    suspects = "translation"
    formula = ("right = forward × up", "right = up × forward; or z → −z of a part of the scene")
    readings: ClassVar[Mapping[str, str]] = _readings()

    def hypotheses(self, case: Case) -> Sequence[Applied]:
        scene = case.scene
        located = any(not isinstance(light, DirectionalLight) or any(light.direction) for light in scene.delta_lights.values())
        located = located or bool(scene.area_emitters)
        worth = [""] if scene.film.width > 1 else []
        for axis, mirror in _AXES.items():
            objects = not all(_is_symmetric(obj, mirror) for obj in scene.objects)
            lights = located and any(_mirrored_light(light, mirror) != light for light in scene.lights.values())
            worth += [axis] if objects or lights else []
            worth += [f"camera {axis}"] if _mirrored_camera(scene.camera, mirror) != scene.camera else []
            # one without the other is a reading of its own only where both change
            worth += [f"lights {axis}", f"objects {axis}"] if objects and lights else []
        worth += ["y and z"]
        if any(step.rotate is not None for obj in scene.objects for step in obj.transform):
            worth += ["rotations"]
        return [Applied(self.id, None, reading) for reading in self.readings if reading in worth]

    def change_film(self, film_xy: Floats, case: Case, applied: Applied) -> Floats:
        if applied.reading:
            return film_xy
        return np.stack([case.scene.film.width - film_xy[:, 0], film_xy[:, 1]], axis=1)

    def change_case(self, case: Case, applied: Applied) -> Case:
        scene = case.scene
        if applied.reading == "rotations":
            return with_scene(case, objects=tuple(_turned_back(obj) for obj in scene.objects))
        part, _, axis = applied.reading.rpartition(" ")
        if not axis:
            return case
        mirror, part = (_EXCHANGED, "") if applied.reading == "y and z" else (_AXES[axis], part)
        if part == "camera":
            return with_scene(case, camera=_mirrored_camera(scene.camera, mirror))
        changed: dict[str, Any] = {}
        if part != "lights":
            changed["objects"] = tuple(_mirrored_object(obj, mirror) for obj in scene.objects)
        if part != "objects":
            changed["lights"] = {name: _mirrored_light(light, mirror) for name, light in scene.lights.items()}
        return with_scene(case, **changed)


def _mirrored_object(obj: Object, mirror: Floats) -> Object:
    matrix = np.eye(4)
    matrix[:3, :3] = mirror
    step = TransformStep.model_construct(matrix=tuple(tuple(row) for row in matrix.tolist()))
    return obj.model_copy(update={"transform": (*obj.transform, step)})


def _turned_back(obj: Object) -> Object:
    steps = []
    for step in obj.transform:
        if step.rotate is not None:
            step = step.model_copy(update={"rotate": step.rotate.model_copy(update={"degrees": -step.rotate.degrees})})
        steps.append(step)
    return obj.model_copy(update={"transform": tuple(steps)})


def _mirrored_camera(camera: Any, mirror: Floats) -> Any:
    return camera.model_copy(update={key: _mirrored(getattr(camera, key), mirror) for key in ("eye", "target", "up")})


def _mirrored_light(light: Light, mirror: Floats) -> Light:
    match light:
        case PointLight():
            keys: Sequence[str] = ("position",)
        case SpotLight():
            keys = ("position", "direction")
        case DirectionalLight():
            keys = ("direction",)
        case SphereEmitter():
            keys = ("center",)
        case DiscEmitter():
            keys = ("center", "normal")
        case RectangleEmitter():
            # edges change places, so that the side that shines is the mirrored one
            u, v = _mirrored(light.edge_u, mirror), _mirrored(light.edge_v, mirror)
            return light.model_copy(update={"corner": _mirrored(light.corner, mirror), "edge_u": v, "edge_v": u})
        case _:
            return light
    return light.model_copy(update={key: _mirrored(getattr(light, key), mirror) for key in keys})


def _mirrored(vector: Sequence[float], mirror: Floats) -> tuple[float, float, float]:
    x, y, z = (mirror @ np.asarray(vector, np.float64) + 0.0).tolist()
    return x, y, z


def _is_symmetric(obj: Object, mirror: Floats) -> bool:
    """Whether mirroring certainly leaves the object what it is."""

    def stays(vector: Sequence[float], sign: float = 1.0) -> bool:
        return bool(np.array_equal(mirror @ np.asarray(vector), sign * np.asarray(vector)))

    if obj.transform:
        return False
    match obj:
        case Sphere():
            return stays(obj.center)
        case Plane():
            # a normal in the mirror leaves the whole plane in place, one across it only a plane that is the mirror
            return stays(obj.normal) or (stays(obj.normal, -1) and stays(obj.point))
        case Disc():
            return stays(obj.center) and (stays(obj.normal) or stays(obj.normal, -1))
        case Box():
            middle = np.add(obj.min, obj.max).tolist()
            return stays(middle)
        case Cylinder():
            return stays(obj.base) and stays(obj.top)
        case _:
            return False
