"""Random scenes for property tests: one seed, one scene, the same on every machine.

Scenes are plain dicts in the spec's own form, so that a test can change one thing and a failure can be saved as a file.
"""

from __future__ import annotations

import copy
import json
import math
import random
from collections.abc import Sequence
from typing import Any

from equilux_scenes.case import Case
from equilux_scenes.model import Scene

Spec = dict[str, Any]
Triple = list[float]

ANALYTIC = ("sphere", "plane", "box", "disc", "rectangle", "cylinder")
LIGHTS = ("point", "directional", "spot")


def case_of(spec: Spec) -> Case:
    """The case of a spec without sweeps."""
    scene = Scene.model_validate_json(json.dumps(spec))
    return Case(scene.name, scene, scene.name)


def random_spec(
    seed: int,
    *,
    shapes: Sequence[str] = ANALYTIC,
    objects: tuple[int, int] = (2, 5),
    lights: tuple[int, int] = (1, 3),
    light_kinds: Sequence[str] = LIGHTS,
    exponents: tuple[float, float] = (0.1, 1000.0),
    fov_deg: tuple[float, float] | None = (20.0, 90.0),
    transforms: bool = True,
    offset: Sequence[float] = (0.0, 0.0, 0.0),
    inverse_square: bool = False,
    film: tuple[int, int] = (24, 18),
) -> Spec:
    """A scene of about unit size around `offset`, seen from a random side.

    fov_deg: range of fields of view (log-uniform; the eye goes as far off as the field asks for), None for an orthographic view.
    exponents: range, log-uniform. inverse_square: every light falls off as 1/r², which scaling laws need.
    """
    rng = random.Random(f"equilux {seed}")
    materials = {f"m{k}": _material(rng, exponents) for k in range(3)}
    spec: Spec = {
        "equilux": 1,
        "name": f"random-{seed}",
        "model": "phong",
        "camera": _camera(rng, fov_deg, offset),
        "film": {"width": film[0], "height": film[1]},
        "ambient": _bands(rng, 1.0),
        "background": _bands(rng, 0.2),
        "lights": {f"l{k}": _light(rng, rng.choice(light_kinds), offset, inverse_square) for k in range(rng.randint(*lights))},
        "materials": materials,
        "objects": [],
    }
    for _ in range(rng.randint(*objects)):
        spec["objects"].append(_object(rng, rng.choice(shapes), offset, transforms and rng.random() < 0.5))
        spec["objects"][-1]["material"] = rng.choice(list(materials))
    return spec


def changed(spec: Spec, **parts: Any) -> Spec:
    """A deep copy with some top-level keys replaced."""
    return {**copy.deepcopy(spec), **copy.deepcopy(parts)}


# --- vectors ----------------------------------------------------------------------------------------------------------


def _uniform(rng: random.Random, low: float, high: float) -> Triple:
    return [rng.uniform(low, high) for _ in range(3)]


def _direction(rng: random.Random) -> Triple:
    while True:
        v = _uniform(rng, -1.0, 1.0)
        length = math.hypot(*v)
        if 0.1 < length < 1.0:
            return [c / length for c in v]


def _at(offset: Sequence[float], v: Sequence[float]) -> Triple:
    return [o + c for o, c in zip(offset, v, strict=True)]


def _cross(a: Sequence[float], b: Sequence[float]) -> Triple:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def _bands(rng: random.Random, high: float) -> Triple:
    return [0.0 if rng.random() < 0.1 else rng.uniform(0.0, high) for _ in range(3)]


def _log_uniform(rng: random.Random, low: float, high: float) -> float:
    return math.exp(rng.uniform(math.log(low), math.log(high)))


# --- parts ------------------------------------------------------------------------------------------------------------


def _camera(rng: random.Random, fov_deg: tuple[float, float] | None, offset: Sequence[float]) -> Spec:
    side, target, up = _direction(rng), _uniform(rng, -0.2, 0.2), _direction(rng)
    fov = None if fov_deg is None else _log_uniform(rng, *fov_deg)
    distance = 3.0 if fov is None else max(0.8, 1.2 / math.tan(math.radians(fov) / 2.0))
    view = {"target": _at(offset, target), "eye": _at(offset, [distance * c for c in side]), "up": up}
    if fov is None:
        return {"projection": "orthographic", "height_m": rng.uniform(1.5, 3.0), **view}
    return {"projection": "perspective", "fov_y_deg": fov, **view}


def _light(rng: random.Random, kind: str, offset: Sequence[float], inverse_square: bool) -> Spec:
    bands = _bands(rng, 6.0)
    side = _direction(rng)
    if kind == "directional":
        return {"kind": kind, "direction": side, "irradiance": bands}
    distance = rng.uniform(1.5, 4.0)
    light: Spec = {"kind": kind, "position": _at(offset, [distance * c for c in side]), "intensity": bands}
    if not inverse_square and rng.random() < 0.7:
        light["attenuation"] = {"constant": rng.uniform(0.1, 1), "linear": rng.uniform(0, 1), "quadratic": rng.uniform(0, 1)}
    if kind == "spot":
        light["direction"] = [-c + w for c, w in zip(side, _uniform(rng, -0.3, 0.3), strict=True)]
        light["cone_half_angle_deg"] = rng.uniform(10.0, 90.0)
        light["exponent"] = rng.choice([0.0, 1.0, rng.uniform(0.0, 60.0)])
    return light


def _material(rng: random.Random, exponents: tuple[float, float]) -> Spec:
    return {
        "diffuse": _bands(rng, 1.0),
        "specular": _bands(rng, 1.0),
        "exponent": _log_uniform(rng, *exponents),
        "ambient": _bands(rng, 0.3),
        "emission": _bands(rng, 0.1),
    }


def _object(rng: random.Random, kind: str, offset: Sequence[float], transformed: bool) -> Spec:
    position = _uniform(rng, -0.7, 0.7)
    center = position if transformed else _at(offset, position)
    shape: Spec = {"kind": kind, **_shape(rng, kind, center)}
    if transformed:
        scale = rng.uniform(0.6, 1.6) if rng.random() < 0.4 else _uniform(rng, 0.6, 1.6)
        rotate = {"axis": _direction(rng), "degrees": rng.uniform(-180.0, 180.0)}
        shape["transform"] = [{"scale": scale}, {"rotate": rotate}, {"translate": _at(offset, [0.0, 0.0, 0.0])}]
    return shape


def _shape(rng: random.Random, kind: str, center: Triple) -> Spec:
    axis, size = _direction(rng), rng.uniform(0.3, 0.8)
    if kind == "sphere":
        return {"center": center, "radius": size}
    if kind == "plane":
        return {"point": _at(center, [-c for c in axis]), "normal": axis}
    if kind == "box":
        return {"min": _at(center, [-rng.uniform(0.2, 0.6) for _ in range(3)]), "max": _at(center, _uniform(rng, 0.2, 0.6))}
    if kind == "disc":
        return {"center": center, "normal": axis, "radius": size}
    if kind == "cylinder":
        top, radius = _at(center, [size * c for c in axis]), rng.uniform(0.2, 0.5)
        return {"base": center, "top": top, "radius": radius, "capped": rng.random() < 0.5}
    across = _cross(axis, _direction(rng))
    length = math.hypot(*across)
    u = [c / length for c in across]
    v = _cross(axis, u)
    length_u, length_v = rng.uniform(0.5, 1.5), rng.uniform(0.5, 1.5)
    return {"corner": center, "edge_u": [length_u * c for c in u], "edge_v": [length_v * c for c in v]}
