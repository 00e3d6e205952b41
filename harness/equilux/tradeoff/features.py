"""What a feature costs: pairs of scenes that differ in it and in nothing else."""

from __future__ import annotations

import copy
import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from equilux.adapter import Case
from equilux_scenes.loader import load_scene_text

WIDTH, HEIGHT = 256, 192

_PHONG: dict[str, Any] = {
    "equilux": 1,
    "name": "plain",
    "about": "A ball on a floor under one light; diffuse, no shadow.",
    "model": "phong",
    "camera": {"projection": "perspective", "eye": [0.4, 1.2, 3], "target": [0, 0.3, 0], "up": [0, 1, 0], "fov_y_deg": 36},
    "film": {"width": WIDTH, "height": HEIGHT},
    "lights": {"key": {"kind": "point", "position": [-1, 2, 2], "intensity": 7.5}},
    "materials": {"clay": {"diffuse": 0.5}},
    "objects": [
        {"kind": "sphere", "center": [0, 0.4, 0], "radius": 0.4, "material": "clay"},
        {"kind": "plane", "point": [0, 0, 0], "normal": [0, 1, 0], "material": "clay"},
    ],
}
Scene = dict[str, Any]


@dataclass(frozen=True)
class Feature:
    """A feature, and the same scene with it and without."""

    id: str
    words: str
    present: Case
    absent: Case


def features() -> list[Feature]:
    """Those that are measured. The scenes without a feature are shared where they are the same."""
    plain = _PHONG
    shadowed = _with(plain, "shadowed", _shadows)
    flat = _with(plain, "flat-mesh", _as_mesh)
    delta = _with(plain, "point-emitter", _physical)
    fixed = _with(plain, "fixed-function", lambda scene: scene.update(model="opengl"))
    pairs = [
        ("highlight", "a Phong highlight on every surface", plain, _highlight),
        ("second light", "one more point light", plain, _second_light),
        ("spot", "the light has a cone, cos^4 inside", plain, _spot),
        ("attenuation", "all three terms of attenuation instead of the quadratic one alone", plain, _attenuation),
        ("shadows", "objects stand in the light's way: model raytraced instead of phong", plain, _shadows),
        ("mirror", "every surface mirrors 0.3, up to 8 times in succession", shadowed, _mirror),
        ("glass", "the ball is of glass, index 1.5", shadowed, _glass),
        ("smooth normals", "a mesh of 1920 triangles is shaded with interpolated normals, not with its faces'", flat, _smooth),
        ("extended light", "a sphere emits instead of a point: model reflection-equation", delta, _sphere_light),
        ("highlight, fixed-function", "the half-vector highlight of model opengl", fixed, _highlight),
        ("second light, fixed-function", "one more point light in model opengl", fixed, _second_light),
    ]
    cases: dict[str, Case] = {}

    def case(scene: Scene) -> Case:
        return cases.setdefault(scene["name"], load_scene_text(json.dumps(scene)).cases[0])

    return [
        Feature(name, words, case(_with(base, f"{name.replace(',', '').replace(' ', '-')}-on", change)), case(base))
        for name, words, base, change in pairs
    ]


def _with(scene: Scene, name: str, change: Callable[[Scene], Any]) -> Scene:
    changed = copy.deepcopy(scene)
    change(changed)
    return changed | {"name": name}


def _highlight(scene: Scene) -> None:
    scene["materials"]["clay"].update(specular=0.4, exponent=20)


def _shadows(scene: Scene) -> None:
    scene["model"] = "raytraced"


def _mirror(scene: Scene) -> None:
    scene["materials"]["clay"]["reflection"] = 0.3


def _second_light(scene: Scene) -> None:
    scene["lights"]["fill"] = {"kind": "point", "position": [2, 1.5, 1], "intensity": 2}


def _spot(scene: Scene) -> None:
    cone = {"kind": "spot", "direction": [1, -1.7, -2], "cone_half_angle_deg": 30, "exponent": 4}
    scene["lights"]["key"].update(cone)


def _attenuation(scene: Scene) -> None:
    scene["lights"]["key"]["attenuation"] = {"constant": 0.5, "linear": 3, "quadratic": 1}


def _glass(scene: Scene) -> None:
    scene["materials"]["glass"] = {"diffuse": 0.1, "transparency": 0.8, "transmission": 0.9, "ior": 1.5}
    scene["objects"][0]["material"] = "glass"


def _physical(scene: Scene) -> None:
    scene["model"] = "reflection-equation"


def _sphere_light(scene: Scene) -> None:
    radius = 0.2  # π r² L is the intensity of a small sphere: as bright as the point light that it replaces
    radiance = 7.5 / (math.pi * radius**2)
    scene["lights"]["key"] = {"kind": "sphere", "center": [-1, 2, 2], "radius": radius, "radiance": radiance}


def _smooth(scene: Scene) -> None:
    scene["objects"][0]["normals"] = "smooth"


def _as_mesh(scene: Scene) -> None:
    """The ball as a mesh of 64 × 16 quadrilaterals, shaded flat."""
    around, down = 64, 16
    (x, y, z), radius = scene["objects"][0]["center"], scene["objects"][0]["radius"]
    vertices = [[x, y + radius, z], [x, y - radius, z]]
    for i in range(1, down):
        polar = math.pi * i / down
        for j in range(around):
            turn = 2 * math.pi * j / around
            vertices.append(
                [x + radius * math.sin(polar) * math.sin(turn), y + radius * math.cos(polar),
                 z + radius * math.sin(polar) * math.cos(turn)]
            )  # fmt: skip

    def at(i: int, j: int) -> int:
        return 0 if i == 0 else 1 if i == down else 2 + (i - 1) * around + j % around

    faces = []
    for i in range(down):
        for j in range(around):
            a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
            faces += [[a, b, c]] if b != c else []
            faces += [[a, c, d]] if a != d else []
    scene["objects"][0] = {"kind": "mesh", "vertices": vertices, "faces": faces, "normals": "flat", "material": "clay"}
