"""Pieces that the scenes of several axes are made of."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from equilux.extremes.axis import Spec

Vector = Sequence[float]

FILM = {"width": 48, "height": 36}
"""Small: what breaks is seen on any film, and a push renders hundreds of pictures."""


def times(factor: float, vector: Vector) -> list[float]:
    return [factor * component for component in vector]


def plus(one: Vector, other: Vector) -> list[float]:
    return [a + b for a, b in zip(one, other, strict=True)]


def perspective(eye: Vector, target: Vector, fov_y_deg: float, up: Vector = (0, 1, 0)) -> dict[str, Any]:
    return {"projection": "perspective", "eye": list(eye), "target": list(target), "up": list(up), "fov_y_deg": fov_y_deg}


def orthographic(eye: Vector, target: Vector, height_m: float, up: Vector = (0, 1, 0)) -> dict[str, Any]:
    return {"projection": "orthographic", "eye": list(eye), "target": list(target), "up": list(up), "height_m": height_m}


def point_light(position: Vector, intensity: float, **rest: Any) -> dict[str, Any]:
    return {"kind": "point", "position": list(position), "intensity": intensity, **rest}


def sun(direction: Vector, irradiance: float) -> dict[str, Any]:
    """direction: the way the light travels."""
    return {"kind": "directional", "direction": list(direction), "irradiance": irradiance}


def rectangle(corner: Vector, edge_u: Vector, edge_v: Vector, material: str) -> dict[str, Any]:
    return {"kind": "rectangle", "corner": list(corner), "edge_u": list(edge_u), "edge_v": list(edge_v), "material": material}


def floor(material: str = "clay", height: float = 0.0) -> dict[str, Any]:
    return {"kind": "plane", "point": [0, height, 0], "normal": [0, 1, 0], "material": material}


def spec(
    camera: Mapping[str, Any], lights: Mapping[str, Any], materials: Mapping[str, Any], objects: Sequence[Mapping[str, Any]],
    film: Mapping[str, int] = FILM, **rest: Any,
) -> Spec:  # fmt: skip
    """A spec; `lights` may be empty."""
    out: Spec = {"camera": dict(camera), "film": dict(film)}
    if lights:
        out["lights"] = dict(lights)
    return out | {"materials": dict(materials), "objects": [dict(each) for each in objects], **rest}


CLAY = {"diffuse": [0.28, 0.2, 0.12], "specular": 0.2, "exponent": 12}
MATT = {"diffuse": [0.28, 0.2, 0.12]}


def still_life(scale: float = 1.0, offset: Vector = (0, 0, 0), strength: float = 1.0, material: Mapping[str, Any] = CLAY) -> Spec:
    """A ball in front of a wall under one lamp, without any symmetry; numbers that are multiples of 2^-6, so that they stay exact
    under a large integer offset.

    scale: of every length; intensities go with its square, so that the picture stays the same. offset: added to every position,
    metres. strength: multiplies the light.
    """

    def at(x: float, y: float, z: float) -> list[float]:
        return plus(times(scale, (x, y, z)), offset)

    return spec(
        perspective(at(0.25, 0.125, 3), at(0.125, 0, 0), 30),
        {"lamp": point_light(at(-1, 1.5, 2.5), 6 * strength * scale**2)},
        {"clay": material, "wall": {"diffuse": [0.05, 0.1, 0.2]}},
        [
            {"kind": "sphere", "center": at(0.25, 0, 0), "radius": 0.5 * scale, "material": "clay"},
            rectangle(at(-0.75, -0.625, -0.75), times(scale, (1.25, 0, 0)), times(scale, (0, 1, 0)), "wall"),
        ],
        background=0.0625 * strength,
    )


def tan_deg(angle: float) -> float:
    return math.tan(math.radians(angle))
