"""Axes of light: how far, how near, how strong, how low, how many, how narrow, how it fades."""

from __future__ import annotations

import math
from typing import Any

from equilux.extremes.axes.pieces import (
    MATT,
    floor,
    orthographic,
    perspective,
    point_light,
    rectangle,
    spec,
    still_life,
    sun,
    tan_deg,
)
from equilux.extremes.axis import Axis, Spec, decades

_ABOVE = orthographic((0.05, 3, 0.02), (0.05, 0, 0.02), 2.0, up=(0, 0, -1))
"""Straight down on the floor, off the axis, so that no pixel's centre lies below the lamp."""


def _lamp_at(distance: float, model: str) -> Spec:
    """A lamp above the floor at a distance that is pushed. Near: E → I d/r³, so I goes with 1/d; far: E → I/d²."""
    strength = 1 / distance if distance < 1 else distance**2
    return spec(_ABOVE, {"lamp": point_light((0, distance, 0), strength)}, {"clay": MATT}, [floor()])


def _strength(factor: float, model: str) -> Spec:
    return still_life(strength=factor)


def _low_sun(elevation: float, model: str) -> Spec:
    """The light's elevation over the floor; its strength goes with 1/sin, so that the floor stays as bright."""
    angle = math.radians(elevation)
    return spec(
        perspective((0.4, 2.5, 2), (0, 0, 0), 35),
        {"sun": sun((math.cos(angle), -math.sin(angle), 0.0), 2.0 / math.sin(angle))},
        {"clay": MATT, "mark": {"diffuse": [0.05, 0.1, 0.2]}},
        [rectangle((0.2, 0, 0.3), (0.7, 0, 0), (0, 0, -0.6), "mark"), rectangle((-1, 0, 0.7), (1.1, 0, 0), (0, 0, -1.5), "clay")],
        background=0.0625,
    )


def _many(count: float, model: str) -> Spec:
    """Lamps on a spiral above the ball, their strength shared out."""
    total = int(count)
    lights: dict[str, Any] = {}
    for index in range(total):
        part = (index + 0.5) / total
        turn = 2 * math.pi * 0.618033988749895 * index
        position = (1.5 * part * math.cos(turn), 1.5 + part, 2.5 + 1.5 * part * math.sin(turn))
        lights[f"lamp{index}"] = point_light(position, 8.0 / total)
    life = still_life()
    return life | {"lights": lights}


def _cone(half_angle: float, exponent: float, position: tuple[float, float, float], direction: tuple[float, float, float],
          intensity: float) -> dict[str, Any]:  # fmt: skip
    return {"kind": "spot", "position": list(position), "direction": list(direction), "intensity": intensity,
            "cone_half_angle_deg": half_angle, "exponent": exponent}  # fmt: skip


def _narrow_spot(half_angle: float, model: str) -> Spec:
    """A disc of light on a wall 1 m away; the film shrinks with it, and the wall is larger than the film."""
    radius = tan_deg(half_angle)
    return spec(
        orthographic((0.2 * radius, 0.1 * radius, 2), (0.2 * radius, 0.1 * radius, 0), 3 * radius),
        {"lamp": _cone(half_angle, 0.0, (0, 0, 1), (0, 0, -1), 1.0), "fill": sun((0.2, 0.3, -1), 0.2)},
        {"clay": MATT},
        [{"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "clay"}],
    )


def _wide_spot(half_angle: float, model: str) -> Spec:
    """A lamp that shines down, beside a wall: its cone's rim nears the horizontal line through it."""
    return spec(
        orthographic((0.05, 0, 3), (0.05, 0, 0), 2.0),
        {"lamp": _cone(half_angle, 1.0, (0, 0.2, 0.5), (0, -1, 0), 1.0)},
        {"clay": MATT},
        [{"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "clay"}],
    )


def _spot_exponent(exponent: float, model: str) -> Spec:
    """cos^e around the axis; the film shrinks with the lobe, 1/√e."""
    radius = math.sqrt(10 / max(exponent, 10.0))
    return spec(
        orthographic((0.2 * radius, 0.1 * radius, 2), (0.2 * radius, 0.1 * radius, 0), 1.5 * radius),
        {"lamp": _cone(80.0, exponent, (0, 0, 1), (0, 0, -1), 1.0)},
        {"clay": MATT},
        [{"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "clay"}],
    )


def _fading(constant: float, linear: float, quadratic: float) -> Spec:
    """A lamp 1 m above the floor; divided by what it fades to there."""
    fade = {"constant": constant, "linear": linear, "quadratic": quadratic}
    lamp = point_light((0, 1, 0), constant + linear + quadratic, attenuation=fade)
    return spec(_ABOVE, {"lamp": lamp}, {"clay": MATT}, [floor()])


def _constant(value: float, model: str) -> Spec:
    return _fading(value, 0.0, 1.0)


def _linear(value: float, model: str) -> Spec:
    return _fading(0.0, value, 1.0)


def _all_terms(value: float, model: str) -> Spec:
    return _fading(1.0, value, 1.0)


_FADING = "The lamp's strength goes with the sum of the terms, which is what it fades by at 1 m."

AXES = (
    Axis(
        "light-distance", "distance of the light", "m", 1.0, decades(-1, -12), decades(1, 18), _lamp_at,
        "A lamp over a floor. Its intensity goes with d² far away, where the floor becomes evenly lit, and with 1/d close to the "
        "floor, where the light grazes it.",
        "lights nearer than a shadow tolerance, 1/r² near a singularity, r² beyond float32, N·L below POV-Ray's 1e-10",
    ),
    Axis(
        "radiance", "radiance, in units of a plain scene's", "", 1.0, decades(-1, -45), decades(1, 38), _strength,
        "Light and background are multiplied: the picture is too, to the ends of float32 and below.",
        "lights below POV-Ray's 1e-10 are dropped; float32 loses digits below 1.2e-38 and ends at 3.4e38",
    ),
    Axis(
        "grazing-light", "elevation of the light", "°", 45.0, (10.0, *decades(0, -12)), (80.0, 89.0, 90.0), _low_sun,
        "A directional light ever lower over a floor, stronger by 1/sin: the floor stays as bright.",
        "N·L rounded in float32, N·L below POV-Ray's 1e-10, gates decided by rounding",
    ),
    Axis(
        "light-count", "number of lights", "", 1.0, (), decades(1, 3), _many,
        "Lamps on a spiral, their strength shared out.",
        "unrolled shaders, the eight lights of the fixed function, sums in float32",
    ),
    Axis(
        "spot-narrow", "half-angle of a narrow spot cone", "°", 30.0, (10.0, *decades(0, -8)), (), _narrow_spot,
        "A disc of light on a wall; the film shrinks with it.",
        "cosines of small angles are 1 in float32 below 0.02° and in double below 1e-6°",
    ),
    Axis(
        "spot-wide", "half-angle of a wide spot cone", "°", 45.0, (), (80.0, 89.0, 89.9, 89.99, 89.999, 89.9999, 89.99999, 90.0),
        _wide_spot,
        "A lamp beside a wall; the rim of its cone nears the horizontal line through the lamp.",
        "a cone of 90° taken for no cone at all (VTK)",
    ),
    Axis(
        "spot-exponent", "exponent of a spot", "", 10.0, (*decades(0, -8), 0.0), decades(2, 8), _spot_exponent,
        "cos^e around the axis; the film shrinks with the lobe.",
        "exponents clamped to 128 (VTK), powers in float32",
        ends={"opengl": 128.0},
    ),
    Axis(
        "attenuation-constant", "d_c over d_q", "", 1.0, decades(-1, -6), decades(1, 6), _constant, _FADING,
        "fade_distance of POV-Ray, sums in float32",
    ),
    Axis(
        "attenuation-linear", "d_l over d_q", "", 1.0, decades(-1, -6), decades(1, 6), _linear, _FADING,
        "two lights that nearly cancel (POV-Ray), sums in float32",
    ),
    Axis(
        "attenuation-all", "d_l, with d_c = d_q = 1", "", 10.0, decades(0, -6), decades(2, 6), _all_terms,
        _FADING, "two lights that nearly cancel; without two real roots POV-Ray has no form for it",
    ),
)  # fmt: skip
