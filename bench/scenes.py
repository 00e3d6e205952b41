"""The scenes that are measured."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from equilux_scenes.case import Case
from equilux_scenes.mesh import TriangleMesh, shaded
from equilux_scenes.model import Scene

Spec = dict[str, Any]


def case_of(spec: Spec, meshes: Mapping[int, TriangleMesh] | None = None) -> Case:
    """The case of a spec without sweeps. meshes: by the objects' places; their files are not looked for."""
    scene = Scene.model_validate_json(json.dumps(spec))
    return Case(scene.name, scene, scene.name, meshes=dict(meshes or {}))


FILM_1080P = (1920, 1080)
AROUND, ALONG = 128, 512
"""Quadrilaterals of the ring: 2 × 128 × 512 = 131 072 triangles."""


def triangles(film: tuple[int, int] = FILM_1080P, *, around: int = AROUND, along: int = ALONG, **changes: Any) -> Case:
    """A rippled ring with smooth normals that shadows itself, and fills two thirds of the film.

    film: width and height in pixels. changes: of the spec's top level. 2 × around × along triangles.
    """
    spec = _lit("triangles", film) | {
        "camera": {"projection": "perspective", "eye": [0, -2.6, 2.0], "target": [0, -0.1, 0], "fov_y_deg": 30},
        "objects": [{"kind": "mesh", "file": "ring.ply", "normals": "smooth", "material": "glossy"}],
    }
    return case_of(spec | changes, {0: rippled_ring(around, along)})


def triangles_for_mitsuba(film: tuple[int, int] = FILM_1080P) -> Case:
    """The same ring, light and view in the model and with the BRDF that Mitsuba has: phong-cosine, no ambient light."""
    case = triangles(film)
    spec: Spec = json.loads(case.scene.model_dump_json(exclude_unset=True))
    for key in ("recursion_limit", "ambient"):
        del spec[key]
    for material in spec["materials"].values():
        del material["ambient"]
        material["brdf"] = "phong-cosine"
    return case_of(spec | {"model": "reflection-equation", "name": "triangles-phong-cosine"}, case.meshes)


def spheres(film: tuple[int, int] = FILM_1080P, *, count: int = 12, **changes: Any) -> Case:
    """count × count balls on a ball so large that it is a floor, with long shadows."""
    rng = np.random.default_rng(5)
    balls = []
    for row in range(count):
        for column in range(count):
            radius = 0.03 + 0.05 * rng.random() * 12 / count
            x, y = ((k + 0.5 + 0.3 * (rng.random() - 0.5)) / count * 3 - 1.5 for k in (column, row))
            balls.append({"kind": "sphere", "center": [x, y, radius], "radius": radius, "material": "glossy"})
    spec = _lit("spheres", film) | {
        "camera": {"projection": "perspective", "eye": [0, -2.6, 2.0], "target": [0, -0.1, 0], "fov_y_deg": 42},
        "objects": [{"kind": "sphere", "center": [0, 0, -100], "radius": 100, "material": "matt"}, *balls],
    }
    return case_of(spec | changes)


def _lit(name: str, film: tuple[int, int]) -> Spec:
    return {
        "equilux": 1,
        "name": name,
        "model": "raytraced",
        "recursion_limit": 0,
        "ambient": 0.1,
        "background": [0.05, 0.05, 0.1],
        "film": {"width": film[0], "height": film[1]},
        "lights": {"lamp": {"kind": "point", "position": [2.5, -1.5, 2.0], "intensity": 20}},
        "materials": {
            "glossy": {"ambient": 0.5, "diffuse": [0.5, 0.3, 0.2], "specular": 0.4, "exponent": 40},
            "matt": {"ambient": 0.5, "diffuse": [0.4, 0.45, 0.5], "specular": 0.2, "exponent": 10},
        },
    }


def rippled_ring(around: int, along: int) -> TriangleMesh:
    """A torus of radii 1 and 0.4 with ripples of a tenth of that: closed, with smooth normals."""
    u, v = np.meshgrid(np.arange(along) * (math.tau / along), np.arange(around) * (math.tau / around), indexing="ij")
    tube = 0.4 + 0.05 * np.sin(9 * u + 2 * v) * np.cos(5 * v)
    distance = 1 + tube * np.cos(v)
    vertices = np.stack([distance * np.cos(u), distance * np.sin(u), tube * np.sin(v)], axis=-1).reshape(-1, 3)
    corner = np.arange(along * around).reshape(along, around)
    next_u, next_v = np.roll(corner, -1, axis=0), np.roll(corner, -1, axis=1)
    opposite = np.roll(next_u, -1, axis=1)
    faces = np.stack([corner, next_u, opposite, corner, opposite, next_v], axis=-1).reshape(-1, 3)
    return shaded(TriangleMesh(vertices, faces.astype(np.int64)), "smooth")


def _wall(corner: list[float], edge_u: list[float], edge_v: list[float], material: str) -> Spec:
    return {"kind": "rectangle", "corner": corner, "edge_u": edge_u, "edge_v": edge_v, "material": material}


CORNELL: Spec = {
    "equilux": 1,
    "name": "cornell",
    "model": "raytraced",
    "recursion_limit": 8,
    "background": [0.05, 0.05, 0.1],
    "camera": {"projection": "perspective", "eye": [0, 1, 3.4], "target": [0, 1, 0], "fov_y_deg": 40},
    "film": {"width": 256, "height": 192},
    "lights": {
        "top": {"kind": "point", "position": [0, 1.9, 0.2], "intensity": 3},
        "side": {"kind": "point", "position": [0.5, 1.5, 0.9], "intensity": 1},
    },
    "materials": {
        "white": {"diffuse": 0.3},
        "red": {"diffuse": [0.3, 0.05, 0.05]},
        "green": {"diffuse": [0.05, 0.3, 0.05]},
        "mirror": {"specular": 0.5, "exponent": 50, "reflection": 0.9},
        "glass": {"specular": 0.5, "exponent": 80, "reflection": 0.1, "transmission": 0.95, "transparency": 0.9, "ior": 1.5},
    },
    "objects": [
        _wall([-1, 0, -1], [2, 0, 0], [0, 0, 2], "white"),
        _wall([-1, 2, -1], [0, 0, 2], [2, 0, 0], "white"),
        _wall([-1, 0, -1], [0, 2, 0], [2, 0, 0], "white"),
        _wall([-1, 0, -1], [0, 0, 2], [0, 2, 0], "red"),
        _wall([1, 0, -1], [0, 2, 0], [0, 0, 2], "green"),
        {"kind": "sphere", "center": [-0.45, 0.4, -0.3], "radius": 0.4, "material": "mirror"},
        {"kind": "sphere", "center": [0.45, 0.4, 0.3], "radius": 0.4, "material": "glass"},
        {"kind": "box", "min": [0.2, 0, -0.8], "max": [0.7, 1.1, -0.4], "material": "white"},
    ],
}
