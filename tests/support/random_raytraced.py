"""Random `raytraced` scenes: one seed, one scene. Spheres, boxes, discs, rectangles and cylinders over a plane; matt, mirrors and
glass.

Objects keep to cells of their own, so that transparent ones never overlap.
"""

from __future__ import annotations

import copy
import math
import random
from collections.abc import Sequence
from typing import Any

from support.random_scenes import random_spec

Spec = dict[str, Any]

SHAPES = ("sphere", "box", "disc", "rectangle")
CLOSED = ("sphere", "box", "cylinder")
CELL = 0.9
"""Side of a cell, metres; no object reaches farther than 0.42 from its middle."""


def random_raytraced(
    seed: int,
    *,
    shapes: Sequence[str] = SHAPES,
    objects: tuple[int, int] = (4, 8),
    recursion: tuple[int, int] = (0, 5),
    shadows: Sequence[str] = ("attenuate", "ignore"),
    glass: bool = True,
    behind: bool = True,
    exponents: tuple[float, float] = (1.0, 200.0),
    projections: Sequence[str] = ("perspective", "perspective", "orthographic"),
    plane: bool = True,
    film: tuple[int, int] = (24, 18),
) -> Spec:
    """A spec as a plain dict.

    glass: some materials let light through, the closed shapes (and the plane) with an index of refraction. behind: such materials
    also have a diffuse and a highlight term, which lights behind the surface then reach.
    """
    rng = random.Random(f"raytraced {seed}")
    base = random_spec(seed, objects=(0, 0), lights=(1, 3), exponents=exponents, film=film)
    materials = {
        **{f"matt{k}": _surface(rng, exponents) for k in range(2)},
        "mirror": {**_surface(rng, exponents, 0.3), "reflection": _between(rng, 0.3, 1.0)},
        "gloss": {**_surface(rng, exponents), "reflection": _between(rng, 0.0, 0.5)},
    }
    if glass:
        materials["glass"] = _glass(rng, exponents, behind, rng.uniform(1.2, 2.4))
        materials["bubble"] = _glass(rng, exponents, behind, rng.uniform(0.6, 0.9))
        materials["gauze"] = _glass(rng, exponents, behind, 1.0)
    cells = [[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
    things = []
    for cell in rng.sample(cells, rng.randint(*objects)):
        kind = rng.choice(list(shapes))
        allowed = [name for name in materials if kind in CLOSED or name not in ("glass", "bubble")]
        if kind in CLOSED and glass and rng.random() < 0.4:
            allowed = ["glass", "bubble"]
        middle = [CELL * c + rng.uniform(-0.02, 0.02) for c in cell]
        things.append({"kind": kind, "material": rng.choice(allowed), **_shape(rng, kind, middle)})
    if plane:
        floor = rng.choice(["matt0", "mirror", "gloss"])
        normal = [rng.uniform(-0.2, 0.2), rng.choice([-1.0, 1.0]), rng.uniform(-0.2, 0.2)]
        things.insert(rng.randint(0, len(things)), {"kind": "plane", "point": [0, -1.4, 0], "normal": normal, "material": floor})
    return {
        **base,
        "name": f"raytraced-{seed}",
        "model": "raytraced",
        "camera": _camera(rng, rng.choice(list(projections))),
        "recursion_limit": rng.randint(*recursion),
        "transparent_shadows": rng.choice(list(shadows)),
        "materials": materials,
        "objects": things,
    }


def _camera(rng: random.Random, projection: str) -> Spec:
    """Above the plane, with everything else in view."""
    around, height = rng.uniform(0, 2 * math.pi), rng.uniform(-0.4, 1.5)
    eye = [2.4 * math.sin(around), height, 2.4 * math.cos(around)]
    view = {"projection": projection, "eye": eye, "target": [rng.uniform(-0.2, 0.2) for _ in range(3)]}
    size = {"fov_y_deg": rng.uniform(30, 55)} if projection == "perspective" else {"height_m": rng.uniform(1.2, 2.4)}
    return {**view, **size}


def moved(spec: Spec, offset: Sequence[float]) -> Spec:
    """The whole scene somewhere else; offset in metres."""

    def there(point: Sequence[float]) -> list[float]:
        return [p + o for p, o in zip(point, offset, strict=True)]

    spec = copy.deepcopy(spec)
    spec["camera"] |= {key: there(spec["camera"][key]) for key in ("eye", "target")}
    for light in spec["lights"].values():
        if "position" in light:
            light["position"] = there(light["position"])
    for thing in spec["objects"]:
        if "transform" in thing:
            thing["transform"].append({"translate": list(offset)})
        else:
            key = "point" if thing["kind"] == "plane" else "center"
            thing[key] = there(thing[key])
    return spec


def _between(rng: random.Random, low: float, high: float) -> list[float]:
    return [rng.uniform(low, high) for _ in range(3)]


def _surface(rng: random.Random, exponents: tuple[float, float], share: float = 1.0) -> Spec:
    return {
        "diffuse": _between(rng, 0.0, share),
        "specular": _between(rng, 0.0, share),
        "exponent": rng.uniform(*exponents),
        "ambient": _between(rng, 0.0, 0.3 * share),
        "emission": _between(rng, 0.0, 0.1 * share),
    }


def _glass(rng: random.Random, exponents: tuple[float, float], behind: bool, ior: float) -> Spec:
    surface = _surface(rng, exponents, 0.4) if behind else {"emission": _between(rng, 0.0, 0.05)}
    return {
        **surface,
        "reflection": _between(rng, 0.0, 0.5),
        "transmission": _between(rng, 0.5, 1.0),
        "transparency": rng.choice([1.0, rng.uniform(0.5, 1.0)]),
        "ior": ior,
    }


def _shape(rng: random.Random, kind: str, middle: list[float]) -> Spec:
    turn = {"rotate": {"axis": [rng.uniform(0.1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)], "degrees": rng.uniform(-180, 180)}}
    place = {"transform": [turn, {"translate": middle}]}
    if kind == "sphere":
        if rng.random() < 0.5:
            return {"center": middle, "radius": rng.uniform(0.2, 0.42)}
        return {"center": [0, 0, 0], "radius": 0.42, "transform": [{"scale": _between(rng, 0.5, 1.0)}, *place["transform"]]}
    if kind == "box":
        return {"min": [-rng.uniform(0.1, 0.24) for _ in range(3)], "max": _between(rng, 0.1, 0.24), **place}
    if kind == "disc":
        return {"center": [0, 0, 0], "normal": [0, 0, 1], "radius": rng.uniform(0.2, 0.42), **place}
    if kind == "cylinder":
        ends = {"base": [0, 0, -rng.uniform(0.1, 0.3)], "top": [0, 0, rng.uniform(0.1, 0.3)]}
        return {**ends, "radius": rng.uniform(0.1, 0.29), **place}
    u, v = rng.uniform(0.3, 0.58), rng.uniform(0.3, 0.58)
    return {"corner": [-u / 2, -v / 2, 0], "edge_u": [u, 0, 0], "edge_v": [0, v, 0], **place}
