"""Axes of space: how large, how far from the origin, how narrow or wide a view, how unequal in depth."""

from __future__ import annotations

import math

from equilux.extremes.axes.pieces import (
    CLAY,
    MATT,
    orthographic,
    perspective,
    point_light,
    rectangle,
    spec,
    still_life,
    sun,
    tan_deg,
    times,
)
from equilux.extremes.axis import Axis, Spec, decades


def _scaled(scale: float, model: str) -> Spec:
    return still_life(scale)


def _scaled_with_shadows(scale: float, model: str) -> Spec:
    """The ball stands close to a wall and throws its shadow on it."""

    def at(x: float, y: float, z: float) -> list[float]:
        return times(scale, (x, y, z))

    return spec(
        perspective(at(0.25, 0.125, 3), at(0.125, 0, 0), 34),
        {"lamp": point_light(at(-1.5, 1, 2.5), 6 * scale**2)},
        {"clay": CLAY, "wall": {"diffuse": [0.1, 0.2, 0.3]}},
        [
            {"kind": "sphere", "center": at(0, 0, 0), "radius": 0.375 * scale, "material": "clay"},
            rectangle(at(-1, -0.75, -0.5), at(2, 0, 0), at(0, 1.5, 0), "wall"),
        ],
    )


def _displaced(distance: float, model: str) -> Spec:
    return still_life(1.0, (distance, -2 * distance, distance))


def _field_of_view(angle: float, model: str) -> Spec:
    """Two cards side by side, as wide as the view, 1 m away: nothing stands before anything."""
    half = tan_deg(angle / 2)  # half the height of what is seen at distance 1

    def at(x: float, y: float, z: float) -> list[float]:
        return [x * half, y * half, z]

    return spec(
        perspective((0, 0, 1), (0, 0, 0), angle),
        {"lamp": point_light((-0.5 * half, 0.6 * half, 0.9 * half), 1.5 * half**2)},
        {"wall": MATT, "card": {"diffuse": [0.05, 0.1, 0.2]}},
        [
            rectangle(at(-0.9, -0.8, 0), (1.0 * half, 0, 0), (0, 1.5 * half, 0), "wall"),
            rectangle(at(0.2, -0.3, 0), (half * 0.6, 0, 0), (0, half * 0.7, 0), "card"),
        ],
        background=0.0625,
    )  # fmt: skip


def _seen_at_an_angle(elevation: float, model: str) -> Spec:
    """Two cards in a plane, as long as makes its picture the same from every elevation."""
    length = 1 / math.sin(math.radians(elevation))
    eye = (0, 3 * math.sin(math.radians(elevation)), 3 * math.cos(math.radians(elevation)))
    return spec(
        orthographic(
            times(1 + length, eye), (0, 0, 0), 1.5, up=(0, math.cos(math.radians(elevation)), -math.sin(math.radians(elevation)))
        ),
        {"sun": sun((0.3, -0.8, -0.4), 1.0)},
        {"card": MATT, "mark": {"diffuse": [0.05, 0.1, 0.2]}},
        [
            rectangle((0.2, 0, 0.3 * length), (0.5, 0, 0), (0, 0, -0.5 * length), "mark"),
            rectangle((-0.7, 0, 0.5 * length), (0.8, 0, 0), (0, 0, -1 * length), "card"),
        ],
        background=0.0625,
    )


def _film(aspect: float, model: str) -> Spec:
    """aspect: width over height. Some 1600 pixels, at least one in each direction; what is seen keeps its longer side."""
    width = max(1, round(40 * math.sqrt(aspect)))
    height = max(1, round(40 / math.sqrt(aspect)))
    if min(width, height) == 1:
        width, height = (round(aspect), 1) if aspect > 1 else (1, round(1 / aspect))
    life = still_life()
    half = 0.27 * min(1.0, height / width)
    life["film"] = {"width": width, "height": height}
    life["camera"] = perspective((0.25, 0.125, 3), (0.25, 0, 0), 2 * math.degrees(math.atan(half)))
    return life


def _depth_range(ratio: float, model: str) -> Spec:
    """Two cards far away, one a tenth nearer than the other, and one near: what is seen decides depth alone."""
    return spec(
        perspective((0, 0, 0), (0, 0, -1), 40),
        {},
        {"near": {"emission": [0.2, 0.5, 0.9]}, "far": {"emission": [0.9, 0.4, 0.1]}, "farthest": {"emission": [0.1, 0.7, 0.3]}},
        [
            rectangle((-0.4, -0.3, -1), (0.3, 0, 0), (0, 0.4, 0), "near"),
            rectangle((-0.2 * ratio, -0.25 * ratio, -1.1 * ratio), (0.6 * ratio, 0, 0), (0, 0.5 * ratio, 0), "farthest"),
            rectangle((0.1 * ratio, -0.1 * ratio, -ratio), (0.4 * ratio, 0, 0), (0, 0.4 * ratio, 0), "far"),
        ],
        background=0.0625,
    )


AXES = (
    Axis(
        "scale", "scene scale", "m", 1.0, decades(-1, -18), decades(1, 18), _scaled,
        "Every length is multiplied, intensities by the square of it: the picture stays the same.",
        "absolute tolerances (POV-Ray's 1e-10, 1e-4 and 1e7), squares that leave float32 (1e±19)",
    ),
    Axis(
        "scale-shadows", "scale of a scene with shadows", "m", 1.0, decades(-1, -18), decades(1, 18), _scaled_with_shadows,
        "As scale, with a shadow on a wall close behind the ball.",
        "shadow tolerances that are lengths: blockers missed in small scenes, acne in large ones",
        models=("raytraced", "reflection-equation"),
    ),
    Axis(
        "offset", "distance from the origin", "scene sizes", 1.0, (), decades(1, 12), _displaced,
        "The whole scene, eye included, is moved away from the origin; its numbers stay exact in double.",
        "float32 positions lose the scene at 1e7 unless they are taken relative to the eye",
    ),
    Axis(
        "fov", "vertical field of view", "°", 30.0, (10.0, *decades(0, -4)), (90.0, 120.0, 150.0, 170.0, 179.0, 179.9, 179.99),
        _field_of_view,
        "What is seen grows with the tangent of half the angle, its light with it: the outline stays the same.",
        "rays that differ in the last digits of float32, rasterised depth, an angle of 180° rounded",
    ),
    Axis(
        "grazing-view", "elevation of the view", "°", 45.0, (10.0, *decades(0, -8)), (80.0, 89.0, 90.0), _seen_at_an_angle,
        "A card is seen ever more edge on and made longer by 1/sin: its picture stays the same.",
        "depth and crossing points along the card, facing decided by rounding",
    ),
    Axis(
        "film-aspect", "width over height of the film", "", 1.0, decades(-1, -4), decades(1, 4), _film,
        "A film of some 1600 pixels, later one pixel wide; the longer side of the view stays.",
        "viewport limits of rasterisers (8192 or 16384 pixels), fields of view near 0",
    ),
    Axis(
        "depth-range", "far distance over near distance", "", 10.0, (), decades(2, 15), _depth_range,
        "A card at 1 m; two more ever farther away, one a tenth nearer than the other, as large as they look.",
        "the depth buffer: beyond near/far of 2^-24 all far surfaces are at the same depth",
    ),
)  # fmt: skip
