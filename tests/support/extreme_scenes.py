"""Small scenes with one quantity pushed to where arithmetic has an end, for tests/conformance/test_reference_at_the_extremes.py.

Each axis is a function of one number, mostly a power of ten: the scene, a plain dict in the spec's own form, and the film
positions at which it is looked at.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

Spec = dict[str, Any]
Position = tuple[float, float]

FILM = {"width": 12, "height": 8}
MATERIALS = {
    "matt": {"diffuse": [0.31, 0.2, 0.05], "specular": 0.4, "exponent": 20},
    "plain": {"diffuse": 0.3},
    "mirror": {"diffuse": 0.1, "reflection": [0.9, 0.8, 0.7]},
    "glass": {"diffuse": 0.05, "transparency": 0.9, "transmission": [0.9, 0.95, 1.0], "ior": 1.5, "reflection": 0.1},
}


@dataclass(frozen=True)
class Look:
    """A scene and where on its film to look."""

    spec: Spec
    film_xy: tuple[Position, ...]


def scene(objects: list[Spec], lights: list[Spec], camera: Spec, **more: Any) -> Spec:
    """A spec with those materials that its objects name."""
    spec = {
        "equilux": 1,
        "name": "extreme",
        "model": "phong",
        "camera": {"projection": "perspective", "target": [0, 0, 0], "up": [0.1, 1, 0], "fov_y_deg": 40, **camera},
        "film": FILM,
        "lights": {f"l{k}": light for k, light in enumerate(lights)},
        "materials": MATERIALS,
        "objects": [{"material": "matt", **shape} for shape in objects],
        **more,
    }
    spec["materials"] = {name: spec["materials"][name] for name in {shape["material"]: 0 for shape in spec["objects"]}}
    return spec


def grid(columns: int = 4, rows: int = 3, width: float = 12, height: float = 8) -> tuple[Position, ...]:
    """Positions spread over the film, none of them special."""
    return tuple((width * (i + 0.37) / columns, height * (j + 0.41) / rows) for j in range(rows) for i in range(columns))


# --- one scene with everything in it ----------------------------------------------------------------------------------


def everything(length: float = 1.0, away: tuple[float, float, float] = (0, 0, 0), **more: Any) -> Spec:
    """All shapes under all kinds of light, all lengths times `length`, all places moved by `away`.

    Intensities are W/sr at lights some lengths away: times length² they leave the picture as it is.
    """

    def at(x: float, y: float, z: float) -> list[float]:
        return [away[0] + x * length, away[1] + y * length, away[2] + z * length]

    def along(x: float, y: float, z: float) -> list[float]:
        return [x * length, y * length, z * length]

    power = more.pop("power", length**2)
    spec = scene(
        [
            {"kind": "sphere", "center": at(-1.1, 0.5, 0), "radius": 0.6 * length},
            {"kind": "box", "min": at(0.1, -0.4, -0.5), "max": at(0.7, 0.4, 0.3)},
            {"kind": "disc", "center": at(1.2, 0.7, 0.2), "normal": [0.2, 0.5, 1], "radius": 0.4 * length},
            {"kind": "rectangle", "corner": at(-0.4, 0.5, 0.1), "edge_u": along(0.7, 0, 0), "edge_v": along(0, 0.4, 0.3)},
            {"kind": "cylinder", "base": at(-0.5, -0.6, 0), "top": at(-0.2, 0, 0.4), "radius": 0.25 * length},
            {
                "kind": "mesh",
                "vertices": [at(0.8, -0.8, 0.6), at(1.5, -0.6, 0.1), at(1.2, 0.2, 0.3)],
                "faces": [[0, 1, 2]],
                "material": "plain",
            },
            {"kind": "plane", "point": at(0, -0.9, 0), "normal": [0.05, 1, 0.1]},
        ],
        [
            {"kind": "point", "position": at(1, 2.5, 2), "intensity": [power * 5, power * 4, power * 3]},
            {"kind": "directional", "direction": [0.4, -1, -0.6], "irradiance": 0.7},
            {
                "kind": "spot",
                "position": at(-1.5, 2, 2.5),
                "direction": [0.5, -0.8, -1],
                "intensity": 6 * power,
                "cone_half_angle_deg": 50,
                "exponent": 3,
            },
        ],
        {"eye": at(0.2, 0.3, 4), "target": at(0, 0, 0)},
        ambient=0.1,
        background=0.02,
    )
    return {**spec, **more}


def without_mesh(spec: Spec) -> Spec:
    """The same for the oracle, which has no meshes."""
    return {**spec, "objects": [shape for shape in spec["objects"] if shape["kind"] != "mesh"]}


def raytraced(spec: Spec) -> Spec:
    """The same with shadows, and with mirrors and glass among its objects."""
    of = {"sphere": "mirror", "box": "glass", "disc": "mirror"}
    objects = [{**shape, "material": of.get(shape["kind"], shape["material"])} for shape in spec["objects"]]
    return {**spec, "model": "raytraced", "recursion_limit": 4, "objects": objects, "materials": MATERIALS}


def scale(k: float) -> Look:
    return Look(everything(10.0**k), grid())


def scale_alone(k: float) -> Look:
    """Intensities stay, and irradiances go with 1/r²."""
    return Look(everything(10.0**k, power=1.0), grid())


def scale_raytraced(k: float) -> Look:
    return Look(raytraced(everything(10.0**k)), grid())


def offset(k: float) -> Look:
    far = 10.0**k
    return Look(everything(1.0, (far, -0.7 * far, 0.4 * far)), grid())


def offset_raytraced(k: float) -> Look:
    return Look(raytraced(offset(k).spec), grid())


def radiance(k: float) -> Look:
    """Every emitted quantity times 10^k."""
    spec = everything()
    for light in spec["lights"].values():
        for key in ("intensity", "irradiance"):
            if key in light:
                value = light[key]
                light[key] = [v * 10.0**k for v in value] if isinstance(value, list) else value * 10.0**k
    return Look({**spec, "ambient": 0.1 * 10.0**k, "background": 0.02 * 10.0**k}, grid())


def radiance_raytraced(k: float) -> Look:
    return Look(raytraced(radiance(k).spec), grid())


# --- lights -----------------------------------------------------------------------------------------------------------

BALL = {"kind": "sphere", "center": [0, 0, 0], "radius": 1}
FLOOR = {"kind": "plane", "point": [0, 0, 0], "normal": [0, 1, 0]}
TILTED = {"kind": "plane", "point": [0, 0, 0], "normal": [0.3, 1, 0.2]}


def light_distance(k: float) -> Look:
    """From the surface; below one length the light stands over the middle of the film."""
    r = 10.0**k
    camera = {"eye": [0, 3, 2], "fov_y_deg": math.degrees(2 * math.atan(min(1.0, r) / 3))}
    return Look(scene([FLOOR], [{"kind": "point", "position": [0, r, 0], "intensity": r * r}], camera), grid())


def light_distance_alone(k: float) -> Look:
    """Above a ball, with I = 1: E = 1/r² goes through as many decades twice."""
    r = 10.0**k
    light = {"kind": "point", "position": [0.6 * r, 0.8 * (1 + r), 0.3 * r], "intensity": 1}
    return Look(scene([BALL, {**FLOOR, "point": [0, -1, 0]}], [light], {"eye": [0, 1, 4]}), grid())


def light_distance_raytraced(k: float) -> Look:
    """The light comes nearer than the blocker, which stands above it, and then the other way round."""
    r = 10.0**k
    lid = {"kind": "disc", "center": [0, 0.5, 0], "normal": [0, 1, 0], "radius": 0.3}
    light = {"kind": "point", "position": [0, r, 0], "intensity": r * r}
    camera = {"eye": [0.1, 0.3, 2], "target": [0, 0, 0], "fov_y_deg": 30}
    return Look(scene([FLOOR, lid], [light], camera, model="raytraced"), grid())


def lights(count: float) -> Look:
    """So many point lights over a floor and a ball; not one light's share may be lost."""
    n = int(count)
    each = [
        {
            "kind": "point",
            "position": [3 * math.cos(2.399 * i), 1.5 + (i % 7) / 3, 3 * math.sin(2.399 * i)],
            "intensity": 1.0 / (1 + i % 13) / n,
        }
        for i in range(n)
    ]
    return Look(scene([BALL, {**FLOOR, "point": [0, -1, 0]}], each, {"eye": [0, 1, 4]}), grid(2, 2))


def attenuation(k: float) -> Look:
    """One coefficient at 10^k beside another at 1, in all pairs, one light each."""
    c = 10.0**k
    laws = [
        {"constant": c, "quadratic": 1},
        {"constant": c, "linear": 1},
        {"linear": c, "quadratic": 1},
        {"constant": 1, "linear": c},
        {"quadratic": c},
        {"constant": 1, "linear": 1, "quadratic": c},
    ]
    each = [
        {"kind": "point", "position": [i - 2, 2, 1.5], "intensity": list(np.eye(3)[i % 3]), "attenuation": law}
        for i, law in enumerate(laws)
    ]
    return Look(scene([BALL, {**FLOOR, "point": [0, -1, 0]}], each, {"eye": [0, 1, 4]}), grid())


def spot_cone(k: float) -> Look:
    """Half angle 10^k degrees, the film as wide as the cone; with an exponent that leaves half at the rim, and one of 0."""
    half = min(10.0**k, 90.0)
    sharp = math.log(2) / -math.log1p(-2 * math.sin(math.radians(half) / 2) ** 2) if half < 89 else 1.0
    spot = {"kind": "spot", "position": [0.1, 2, 0], "direction": [-0.1, -2, 0], "intensity": 4, "cone_half_angle_deg": half}
    width = 1.5 * min(2 * math.tan(math.radians(min(half, 60.0))), 3.0)
    camera = {"projection": "orthographic", "eye": [0, 3, 0], "up": [0, 0, -1], "height_m": width}
    spec = scene([TILTED], [{**spot, "exponent": sharp}, spot], camera)
    del spec["camera"]["fov_y_deg"]
    return Look(spec, grid(6, 4))


# --- materials --------------------------------------------------------------------------------------------------------


def exponent(k: float) -> Look:
    """A highlight on a ball, looked at from its top down its flank: at fractions of its own width."""
    p = 10.0**k if k >= 0 else 0.0
    width = min(1 / math.sqrt(max(p, 1.0)), 0.5)
    eye = (0.3, 1.2, 4.7)
    materials = {"matt": {"diffuse": 0.3, "specular": 0.7, "exponent": p}}
    light = {"kind": "point", "position": [0.30001, 1.2001, 4.7], "intensity": 30}
    camera = {"eye": list(eye), "fov_y_deg": math.degrees(2 * math.atan(0.3 * width))}
    return Look(scene([BALL], [light], camera, materials=materials), grid())


def exponent_below_one(k: float) -> Look:
    """p = 10^k down to where every cosine counts as 1."""
    materials = {"matt": {"specular": 0.7, "exponent": 10.0**k}}
    light = {"kind": "point", "position": [3, 1, 0], "intensity": 30}
    return Look(scene([BALL], [light], {"eye": [0, 0, 4], "fov_y_deg": 25}, materials=materials), grid(6, 4))


# --- angles -----------------------------------------------------------------------------------------------------------


def grazing_light(k: float) -> Look:
    """A sun so many radians above a tilted plane, seen from above: N·L is all that is left of the picture."""
    angle = 10.0**k
    n = (0.3 / math.sqrt(1.13), 1 / math.sqrt(1.13), 0.2 / math.sqrt(1.13))
    along = (1.0, -0.3, 0.0)  # n·along = 0 but for rounding
    size = math.hypot(*along)
    to_light = [along[i] / size * math.cos(angle) + n[i] * math.sin(angle) for i in range(3)]
    sun = {"kind": "directional", "direction": [-c for c in to_light], "irradiance": 1}
    return Look(scene([{**TILTED, "material": "plain"}], [sun], {"eye": [0, 5, 1]}), grid(3, 2))


def grazing_lamp(k: float) -> Look:
    """A lamp so near to the plane of a floor, at distance 1."""
    lamp = {"kind": "point", "position": [1, 10.0**k, 0], "intensity": 1}
    return Look(scene([FLOOR], [lamp], {"eye": [0, 5, 1], "fov_y_deg": 5}), grid(3, 2))


def grazing_view(k: float) -> Look:
    """The eye so many radians above a floor, the film as high as that angle."""
    angle = 10.0**k
    lamp = {"kind": "point", "position": [-0.5, 1, 0.5], "intensity": 3}
    camera = {"eye": [1, angle, 0], "up": [0, 1, 0], "fov_y_deg": math.degrees(angle) / 2}
    return Look(scene([FLOOR, {**BALL, "center": [-3, 0, 0]}], [lamp], camera), grid())


def grazing_view_raytraced(k: float) -> Look:
    spec = raytraced(grazing_view(k).spec)
    return Look({**spec, "objects": [{**spec["objects"][0], "material": "mirror"}, *spec["objects"][1:]]}, grid())


def field_of_view(degrees: float) -> Look:
    """Seen from where the scene fills the film, or from amid it."""
    half = math.tan(math.radians(degrees) / 2)
    distance = max(1.5 / half, 1.2)
    spec = everything()
    spec["camera"] = {**spec["camera"], "eye": [0.1 * distance, 0.1 * distance, distance], "fov_y_deg": degrees}
    return Look(spec, grid(6, 4))


def film_aspect(k: float) -> Look:
    """10^k columns to each row (or, below 0, rows to each column)."""
    n = round(10.0 ** abs(k))
    width, height = (n, 1) if k > 0 else (1, n)
    spec = everything()
    fov = math.degrees(2 * math.atan(0.3 / n)) if k > 0 else 40.0
    camera = {**spec["camera"], "fov_y_deg": fov}
    film = {"width": width, "height": height}
    return Look({**spec, "camera": camera, "film": film}, grid(5, 2, width, height) if k > 0 else grid(2, 5, width, height))


# --- geometry ---------------------------------------------------------------------------------------------------------


def gap(k: float) -> Look:
    """A disc so high above a floor, under a lamp: its shadow is its own size; it is all lit; nothing leaks."""
    disc = {"kind": "disc", "center": [0, 10.0**k, 0], "normal": [0, 1, 0], "radius": 0.3}
    lamp = {"kind": "point", "position": [0.3, 2, 0.2], "intensity": 4}
    camera = {"eye": [0, 2, 3], "fov_y_deg": 25}
    return Look(scene([FLOOR, disc], [lamp], camera, model="raytraced"), grid(6, 4))


def gap_of_ball(k: float) -> Look:
    """A box lid so high above a ball, and a ball so far above a floor, seen from the side."""
    h = 10.0**k
    lid = {"kind": "box", "min": [-0.2, 1 + h, -0.2], "max": [0.2, 1.3, 0.2]}
    floor = {**FLOOR, "point": [0, -1 - h, 0]}
    lamp = {"kind": "point", "position": [0.9, 3, 1.2], "intensity": 9}
    return Look(scene([floor, BALL, lid], [lamp], {"eye": [0, 0.5, 5], "fov_y_deg": 40}, model="raytraced"), grid(6, 4))


def triangle_size(k: float) -> Look:
    """A triangle of size 10^k that fills the film, seen from a distance of 1."""
    a = 10.0**k
    mesh = {"kind": "mesh", "vertices": [[-a, -a, 0], [a, -a, 0.2 * a], [0, 1.2 * a, -0.1 * a]], "faces": [[0, 1, 2]]}
    lamp = {"kind": "point", "position": [0.5, 1, 1], "intensity": 3}
    return Look(scene([mesh], [lamp], {"eye": [0.1, 0, 1], "fov_y_deg": math.degrees(2 * math.atan(a))}), grid())


def triangle_slenderness(k: float) -> Look:
    """Two triangles that share their long edge, 10^k high and 1 long; the film 10^k wide; a floor behind would show a leak."""
    h = 10.0**k
    mesh = {
        "kind": "mesh",
        "vertices": [[-1, -0.3, 0.1], [1, 0.4, -0.2], [0.1, 0.05 + h, 0], [-0.1, -0.03 - h, -0.05]],
        "faces": [[0, 1, 2], [1, 0, 3]],
    }
    lamp = {"kind": "point", "position": [0.5, 1, 2], "intensity": 3}
    fov = math.degrees(2 * math.atan(h / 3))
    camera = {"eye": [0.1, 0, 3], "target": [0, 0.05, -0.05], "up": [-0.35, 1, 0], "fov_y_deg": fov}
    behind = {"kind": "plane", "point": [0, 0, -1], "normal": [0, 0, 1], "material": "plain"}
    return Look(scene([mesh, behind], [lamp], camera), grid(4, 6))


# --- paths ------------------------------------------------------------------------------------------------------------


def recursion(depth: float) -> Look:
    """Two parallel mirrors, and the rays between them."""
    walls = [{"kind": "plane", "point": [0, 0, z], "normal": [0, 0, 1], "material": "mirror"} for z in (-1.0, 1.0)]
    materials = {**MATERIALS, "mirror": {"diffuse": 0.1, "reflection": [0.999, 0.9, 0.5]}}
    lamp = {"kind": "point", "position": [0.5, 1, 0.2], "intensity": 3}
    camera = {"eye": [0.1, 0, 0.3], "target": [0.3, 0.1, -1], "fov_y_deg": 40}
    spec = scene(walls, [lamp], camera, model="raytraced", recursion_limit=int(depth), materials=materials)
    return Look(spec, grid(2, 2))


def refracting(ior: float) -> Look:
    """A ball and a slab of that index before a ground."""
    materials = {**MATERIALS, "glass": {**MATERIALS["glass"], "ior": ior}}
    objects = [
        {**BALL, "material": "glass"},
        {"kind": "box", "min": [-3, 1.2, -1], "max": [3, 1.5, 1], "material": "glass"},
        {"kind": "plane", "point": [0, 0, -4], "normal": [0.1, 0.2, 1]},
    ]
    lamp = {"kind": "point", "position": [1, 3, 3], "intensity": 9}
    spec = scene(objects, [lamp], {"eye": [0, 0.4, 5]}, model="raytraced", recursion_limit=6, materials=materials)
    return Look(spec, grid())


def index_above_one(k: float) -> Look:
    return refracting(1 + 10.0**k)


def index_below_one(k: float) -> Look:
    return refracting(1 - 10.0**k)


def index(k: float) -> Look:
    return refracting(10.0**k)


def critical_angle(off: float) -> Look:
    """From within glass, so many radians beyond the angle of total reflection."""
    angle = math.asin(1 / 1.5) + off
    glass = {"diffuse": 0.05, "transparency": 0.9, "transmission": 0.9, "ior": 1.5, "reflection": 0.3}
    objects = [
        {**FLOOR, "material": "glass"},
        {"kind": "plane", "point": [0, 3, 0], "normal": [0, 1, 0]},
        {"kind": "plane", "point": [0, -4, 0], "normal": [0, 1, 0]},
    ]
    lamp = {"kind": "point", "position": [-1, 2, 1], "intensity": 9}
    camera = {"eye": [-2 * math.sin(angle), -2 * math.cos(angle), 0], "fov_y_deg": abs(math.degrees(off)) / 2}
    materials = {"glass": glass, "matt": MATERIALS["matt"]}
    return Look(scene(objects, [lamp], camera, model="raytraced", recursion_limit=4, materials=materials), grid(3, 2))


def below_critical(k: float) -> Look:
    return critical_angle(-(10.0**k))


def above_critical(k: float) -> Look:
    return critical_angle(10.0**k)


def ball_size(k: float) -> Look:
    """A ball of radius 10^k that fills the film, its centre at a distance of 1 + radius."""
    r = 10.0**k
    lamp = {"kind": "point", "position": [0.5, 1, 1], "intensity": 3}
    camera = {"eye": [0.1 * min(r, 1), 0, 1], "fov_y_deg": math.degrees(2 * math.atan(r / (1 + r)))}
    return Look(scene([{**BALL, "center": [0, 0, -r], "radius": r}], [lamp], camera), grid())


def eye_distance(k: float) -> Look:
    """The eye 10^k from a scene of unit size, which fills the film; shadows and mirrors included."""
    far = 10.0**k
    spec = raytraced(everything())
    camera = {**spec["camera"], "eye": [0.1 * far, 0.2 * far, far], "fov_y_deg": math.degrees(2 * math.atan(1.4 / far))}
    return Look({**spec, "camera": camera}, grid(6, 4))


def film_height(k: float) -> Look:
    """An orthographic film 10^k high."""
    spec = raytraced(everything())
    camera = {key: value for key, value in spec["camera"].items() if key != "fov_y_deg"}
    return Look({**spec, "camera": {**camera, "projection": "orthographic", "height_m": 10.0**k}}, grid(6, 4))


def fixed_function(spec: Spec) -> Spec:
    """The same in model `opengl`."""
    shares = {"ambient": 0.1, "diffuse": 0.9, "specular": 0.7}
    return {**spec, "model": "opengl", "lights": {name: {**light, **shares} for name, light in spec["lights"].items()}}


def scale_opengl(k: float) -> Look:
    return Look(fixed_function(scale(k).spec), grid())


def offset_opengl(k: float) -> Look:
    return Look(fixed_function(offset(k).spec), grid())


def transformed(k: float) -> Look:
    """Objects given at unit size and brought to 10^k by their transforms."""
    spec = raytraced(everything(10.0**k))
    small = raytraced(everything())
    step = [{"scale": 10.0**k}]
    return Look({**spec, "objects": [{**shape, "transform": step} for shape in small["objects"]]}, grid())


def slab(k: float) -> Look:
    """A pane of glass 10^k thick before a ground."""
    objects = [
        {"kind": "box", "min": [-3, -3, 0], "max": [3, 3, 10.0**k], "material": "glass"},
        {"kind": "plane", "point": [0, 0, -4], "normal": [0.1, 0.2, 1]},
    ]
    lamp = {"kind": "point", "position": [1, 3, 3], "intensity": 9}
    return Look(scene(objects, [lamp], {"eye": [0, 0.4, 5]}, model="raytraced", recursion_limit=6), grid(4, 3))


def coefficient(k: float) -> Look:
    """K at 10^k under light of 10^-k."""
    c = 10.0**k
    materials = {"matt": {"diffuse": 0.3 * c, "specular": 0.4 * c, "exponent": 20, "ambient": c, "emission": 0.01}}
    lamp = {"kind": "point", "position": [1, 3, 3], "intensity": 9 / c}
    return Look(scene([BALL], [lamp], {"eye": [0, 0.4, 5], "fov_y_deg": 20}, materials=materials, ambient=0.1 / c), grid())


def coincident(k: float) -> Look:
    """A disc in a plane, so far from the world's origin that their points differ by the rounding of coordinates: one surface."""
    far = 10.0**k
    away = (far, -0.7 * far, 0.4 * far)
    n = (0.3, 1.0, 0.2)
    along = (1.0, -0.5, 1.0)  # n·along = 0
    center = [away[i] + 0.3137 * along[i] for i in range(3)]
    camera = {"eye": [away[0], away[1] + 3, away[2] + 1], "target": list(away)}
    lamp = {"kind": "point", "position": [away[0] + 1, away[1] + 2, away[2]], "intensity": 4}
    plane = {"kind": "plane", "point": list(away), "normal": list(n), "material": "plain"}
    disc = {"kind": "disc", "center": center, "normal": list(n), "radius": 5.0}
    return Look(scene([plane, disc], [lamp], camera, model="raytraced"), grid())
