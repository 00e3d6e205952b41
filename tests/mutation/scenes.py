"""The scenes on which mutants are shown: some of the corpus on a small film, and stages on which every term of a model shows."""

from __future__ import annotations

import dataclasses
import json
import math
import random
from collections.abc import Iterator, Sequence
from functools import cache
from typing import Any

import numpy as np

from equilux_scenes.case import Case
from equilux_scenes.loader import corpus_folder, load_scenes
from equilux_scenes.mesh import TriangleMesh, shaded
from equilux_scenes.model import Scene

Spec = dict[str, Any]

FILM = (64, 48)
MODELS = ("phong", "opengl", "raytraced")
MOST_TRIANGLES = 600
"""Of a corpus scene: the plain renderer tries every triangle for every ray."""


# --- the corpus -------------------------------------------------------------------------------------------------------


@cache
def corpus() -> dict[str, Case]:
    """Every case of the corpus that the plain renderer can draw, by name, on a film of at most 64 × 48 pixels."""
    found = {}
    for file in load_scenes([corpus_folder()]):
        for case in file.cases:
            if _drawable(case):
                found[case.name] = on_small_film(case)
    return found


def on_small_film(case: Case, size: tuple[int, int] = FILM) -> Case:
    """The same view on fewer pixels: the film's form is kept as well as whole pixels allow."""
    film = case.scene.film
    shrink = min(size[0] / film.width, size[1] / film.height, 1.0)
    width, height = (max(1, round(shrink * n)) for n in (film.width, film.height))
    scene = case.scene.model_copy(update={"film": film.model_copy(update={"width": width, "height": height})})
    return dataclasses.replace(case, scene=scene)


def _drawable(case: Case) -> bool:
    if case.scene.model not in MODELS:
        return False
    triangles = sum(len(mesh.faces) for mesh in case.meshes.values())
    if case.scene.model == "raytraced":
        # recursion into glass doubles the rays at each bounce; meshes there are tried triangle by triangle
        clear = any(m.transparency > 0 for m in case.scene.materials.values())
        return triangles <= 60 and case.scene.recursion_limit <= (6 if clear else 40)
    return triangles <= MOST_TRIANGLES


# --- stages -----------------------------------------------------------------------------------------------------------


@cache
def stage(model: str, seed: int, variant: str = "") -> Case:
    """A floor and some things on it under three kinds of light, all random, seen by a tilted camera: no symmetry, and every term
    that the model has counts somewhere.

    variant: "parallel" (orthographic camera), "square" (film), "dim" (no pixel as bright as 1), "pool" (glass under water).
    """
    rng = random.Random(f"stage {model} {seed}")
    spec = _stage(rng, model, variant)
    spec["name"] = "-".join(filter(None, ("stage", model, variant, str(seed))))
    return case_of(spec)


def case_of(spec: Spec) -> Case:
    """The case of a spec without sweeps and with inline meshes."""
    scene = Scene.model_validate_json(json.dumps(spec))
    meshes = {}
    for index, obj in enumerate(spec["objects"]):
        if obj["kind"] == "mesh":
            given = TriangleMesh(np.array(obj["vertices"], float), np.array(obj["faces"]))
            meshes[index] = shaded(given, obj.get("normals", "flat"))
    return Case(scene.name, scene, scene.name, meshes=meshes)


def _stage(rng: random.Random, model: str, variant: str) -> Spec:
    azimuth, height = rng.uniform(-0.6, 0.6), rng.uniform(0.9, 1.6)
    eye = [3.4 * math.sin(azimuth), height, 3.4 * math.cos(azimuth)]
    view: Spec = {
        "eye": eye,
        "target": [rng.uniform(-0.15, 0.15), rng.uniform(-0.1, 0.1), 0.0],
        "up": [rng.uniform(-0.2, 0.2), 1, 0],
    }
    lens: Spec = {"projection": "perspective", "fov_y_deg": 38}
    if variant == "parallel":
        lens = {"projection": "orthographic", "height_m": 2.2}
    bright, gl = 0.25 if variant == "dim" else 1.0, model == "opengl"
    spec: Spec = {
        "equilux": 1,
        "model": model,
        "camera": {**lens, **view},
        "film": {"width": 48 if variant == "square" else FILM[0], "height": FILM[1]},
        "ambient": _bands(rng, 0.2, 0.5),
        "background": [round(bright * b, 3) for b in _bands(rng, 0.05, 0.4)],
        "lights": _lights(rng, model, bright),
        "materials": {name: _matt(rng, bright, gl) for name in ("clay", "wood", "paint", "floor")},
    }
    spec["objects"] = _things(rng, model)
    if model == "raytraced":
        _make_transport(rng, spec, variant)
    return spec


def _lights(rng: random.Random, model: str, bright: float) -> dict[str, Spec]:
    side = rng.choice([-1, 1])
    fall = {"constant": rng.uniform(0.2, 0.6), "linear": rng.uniform(0.1, 0.4), "quadratic": rng.uniform(0.3, 0.8)}
    spot_at = [-side * rng.uniform(0.4, 1.2), rng.uniform(1.4, 2.0), rng.uniform(0.5, 1.5)]
    aim = [rng.uniform(-0.4, 0.4), -0.4, rng.uniform(-0.2, 0.4)]
    exponent = rng.uniform(140, 220) if model != "opengl" and rng.random() < 0.3 else rng.uniform(4, 30)
    lamp = {
        "kind": "spot", "position": spot_at, "direction": [a - p for a, p in zip(aim, spot_at, strict=True)],
        "intensity": _bands(rng, 2 * bright, 6 * bright), "cone_half_angle_deg": rng.uniform(18, 28), "exponent": exponent,
    }  # fmt: skip
    sun = {"kind": "directional", "direction": [rng.uniform(-0.5, 0.5), -1, -side * rng.uniform(0.3, 0.8)]}
    lights: dict[str, Spec] = {
        "key": {
            "kind": "point", "position": [side * rng.uniform(1, 2), rng.uniform(1.2, 2.2), rng.uniform(0.8, 2)],
            "intensity": _bands(rng, 2 * bright, 4 * bright), "attenuation": fall,
        },
        "sun": {**sun, "irradiance": _bands(rng, 0.3 * bright, 0.9 * bright)},
        "lamp": lamp,
    }  # fmt: skip
    if model == "opengl":
        for light in lights.values():
            light |= {"ambient": _bands(rng, 0.05, 0.3), "diffuse": _bands(rng, 0.3, 1.0), "specular": _bands(rng, 0.3, 1.0)}
    return lights


def _matt(rng: random.Random, bright: float, gl: bool = False) -> Spec:
    exponent = round(math.exp(rng.uniform(1.5, 5.5)), 2) if rng.random() < 0.6 else rng.uniform(4, 40)
    return {
        "diffuse": _bands(rng, 0.2, 0.7), "specular": _bands(rng, 0.2, 0.6), "exponent": min(exponent, 128) if gl else exponent,
        "ambient": _bands(rng, 0.1, 0.5), "emission": [round(bright * b, 4) for b in _bands(rng, 0.01, 0.08)],
    }  # fmt: skip


def _things(rng: random.Random, model: str) -> list[Spec]:
    """A floor, a ball, a turned box, a tube, two sheets (one seen from behind), a gem of triangles, smooth or flat."""
    places = [[x, 0.0, z] for x in (-0.75, 0.0, 0.75) for z in (-0.55, 0.45)]
    rng.shuffle(places)
    ball, box, tube, disc, gem, sheet = ([p[0] + rng.uniform(-0.1, 0.1), 0.0, p[2] + rng.uniform(-0.1, 0.1)] for p in places)
    radius = rng.uniform(0.25, 0.36)
    size = [rng.uniform(0.12, 0.25) for _ in range(3)]
    turn = {"rotate": {"axis": [rng.uniform(0.1, 1), 1, rng.uniform(-1, 1)], "degrees": rng.uniform(20, 70)}}
    away = [rng.uniform(-0.5, 0.5), rng.uniform(0.1, 0.5), -1.0]  # from the eye
    up = [rng.uniform(-0.05, 0.05), 1, rng.uniform(-0.05, 0.05)]
    things: list[Spec] = [
        {"kind": "plane", "point": [0, -0.55, 0], "normal": up, "material": "floor"},
        {"kind": "sphere", "center": ball, "radius": radius, "material": "clay"},
        {"kind": "box", "min": [-s for s in size], "max": size, "transform": [turn, {"translate": box}], "material": "wood"},
        {"kind": "cylinder", "base": [tube[0], -0.4, tube[2]], "top": [tube[0] + rng.uniform(-0.2, 0.2), 0.2, tube[2]],
         "radius": rng.uniform(0.12, 0.2), "capped": True, "material": "paint"},
        {"kind": "disc", "center": disc, "normal": away, "radius": rng.uniform(0.2, 0.35), "material": "clay"},
        {"kind": "rectangle", "corner": sheet, "edge_u": [0.5, 0.1, 0], "edge_v": [-0.06, 0.3, -0.2], "material": "wood"},
    ]  # fmt: skip
    for normals, where, stretch in (("smooth", gem, 1.0), ("flat", [gem[0] - 0.2, 0.35, gem[2] - 0.5], 0.7)):
        vertices, faces = _gem(rng)
        step = [{"scale": [stretch * rng.uniform(0.22, 0.36) for _ in range(3)]}, turn, {"translate": where}]
        things.append(
            {"kind": "mesh", "vertices": vertices, "faces": faces, "normals": normals, "transform": step, "material": "paint"}
        )
    return things


def _gem(rng: random.Random) -> tuple[list[list[float]], list[list[int]]]:
    """A closed, dented octahedron with its edges halved: 32 triangles wound outward."""
    corners = [np.array(c, float) for c in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))]
    vertices, faces, halves = list(corners), [], {}

    def half(a: int, b: int) -> int:
        key = (min(a, b), max(a, b))
        if key not in halves:
            middle = vertices[a] + vertices[b]
            vertices.append(middle / np.linalg.norm(middle))
            halves[key] = len(vertices) - 1
        return halves[key]

    for x in (0, 1):
        for y in (2, 3):
            for z in (4, 5):
                a, b, c = (x, y, z) if (x + y + z) % 2 == 0 else (x, z, y)
                ab, bc, ca = half(a, b), half(b, c), half(c, a)
                faces += [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
    dented = [[round(float(c) * rng.uniform(0.85, 1.15), 6) for c in v] for v in vertices]
    return dented, faces


def _make_transport(rng: random.Random, spec: Spec, variant: str) -> None:
    """Mirrors, glass and gauze in place of some of the matt things."""
    glass = {"reflection": _bands(rng, 0.05, 0.3), "transmission": _bands(rng, 0.7, 1.0), "transparency": rng.uniform(0.7, 0.95)}
    local = {"diffuse": _bands(rng, 0.05, 0.3), "specular": _bands(rng, 0.2, 0.6), "exponent": rng.uniform(5, 40)}
    spec["materials"] |= {
        "mirror": {**_matt(rng, 0.5), "reflection": _bands(rng, 0.4, 0.8)},
        "glass": {**glass, **local, "ior": rng.uniform(1.3, 1.7)},
        "gauze": {**glass, **local, "transparency": rng.uniform(0.4, 0.7), "ior": 1},
    }
    spec["recursion_limit"] = rng.randint(4, 5)
    for thing, material in zip(
        spec["objects"], ("floor", "glass", "glass", "mirror", "gauze", "mirror", "paint", "clay"), strict=True
    ):
        thing["material"] = material
    spec["materials"]["floor"]["reflection"] = _bands(rng, 0.05, 0.25)
    if variant == "pool":
        water = {"transmission": [0.95, 0.97, 0.98], "reflection": [0.04, 0.04, 0.05], "transparency": 0.97, "ior": 1.33}
        spec["materials"]["water"] = water
        # in the water clear glass and nothing open: which medium begins behind a sheet of gauze is anybody's guess
        spec["materials"]["glass"] |= {"diffuse": 0.0, "specular": 0.0}
        spec["materials"]["gauze"] |= {"transparency": 0.0}
        spec["objects"].append({"kind": "plane", "point": [0, 0.15, 0], "normal": [0.02, 1, 0.03], "material": "water"})


def _bands(rng: random.Random, low: float, high: float) -> list[float]:
    return [round(rng.uniform(low, high), 4) for _ in range(3)]


# --- which scenes a mutant is tried on --------------------------------------------------------------------------------


def stages(models: Sequence[str], variant: str = "", count: int = 24) -> Iterator[Case]:
    """Stages of these models in turn."""
    for seed in range(count):
        for model in models:
            yield stage(model, seed, variant)
