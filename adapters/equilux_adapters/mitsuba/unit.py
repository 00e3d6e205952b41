"""The script's unit of length: a power of two of metres, in which the scene is about as large as Mitsuba takes scenes to be.

Mitsuba moves shadow rays off a surface by RayEpsilon × (1 + the point's largest coordinate) (Q9): the 1 is a length, and right
where a scene measures some units. Lengths times a power of two are exact; radiance and irradiance are what they were.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from equilux.adapter import Case, Unsupported
from equilux_adapters.mitsuba.geometry import extent_of, reach_of
from equilux_scenes.model import Attenuation, Part, PointLight, SpotLight, TransformStep

SMALLEST, LARGEST = 0, 6
"""Exponents of two: a scene of 1 to 64 units is left in metres. Where it is smaller, the constant part of the offset is more of
it than 1500 u; where it is larger, 1500 u come near to what 8 roundings of a coordinate are, 8 × 64 u."""

FARTHEST = 2.0**40
"""Units, of anything that has a place: the disc in place of a plane is 2^20 times as large, and single precision ends at 2^128,
the square of 2^64."""

_OF_VIEW_AND_LIGHTS = ("eye", "height_m", "target", "position", "center", "radius", "corner", "edge_u", "edge_v")
_OF_OBJECTS = ("point", "min", "max", "base", "top", "translate")
LENGTHS = frozenset(_OF_VIEW_AND_LIGHTS + _OF_OBJECTS)

P = TypeVar("P", bound=Part)


def units_per_metre(case: Case) -> float:
    """A power of two. Raises Unsupported for a scene that single precision cannot hold."""
    extent = extent_of(case) or reach_of(case)
    exponent = math.frexp(extent)[1] - 1  # 2^exponent ≤ extent < 2^(exponent + 1)
    shift = min(max(exponent, SMALLEST), LARGEST - 1) - exponent
    if abs(shift) > 300 or math.ldexp(reach_of(case), shift) > FARTHEST:
        reason = f"Mitsuba's single precision cannot hold lengths of {extent:.3g} m and of {reach_of(case):.3g} m in one scene"
        raise Unsupported(["model.reflection-equation"], reason)
    return math.ldexp(1.0, shift)


def in_units(case: Case, units: float) -> Case:
    """The case with all lengths in the script's unit; it looks the same, and its numbers are exact."""
    if units == 1:
        return case
    scene = case.scene
    changes = {
        "camera": _scaled(scene.camera, units),
        "lights": {key: _scaled(light, units) for key, light in scene.lights.items()},
        "objects": tuple(_scaled(obj, units) for obj in scene.objects),
    }
    meshes = {index: replace(mesh, vertices=mesh.vertices * units) for index, mesh in case.meshes.items()}
    return replace(case, scene=scene.model_copy(update=changes), meshes=meshes)


def _scaled(part: P, units: float) -> P:
    """A part of a scene, its lengths scaled; what is no length is left."""
    changes: dict[str, Any] = {}
    for name in type(part).model_fields:
        value = getattr(part, name)
        if name in LENGTHS and value is not None:
            changes[name] = _times(value, units)
        elif name == "transform":
            changes[name] = tuple(_scaled_step(step, units) for step in value)
    if isinstance(part, PointLight | SpotLight):
        changes["attenuation"] = _scaled_attenuation(part.attenuation, units)
    return part.model_copy(update=changes)


def _scaled_step(step: TransformStep, units: float) -> TransformStep:
    if step.matrix is None:
        return _scaled(step, units)
    rows = np.array(step.matrix)
    rows[:3, 3] *= units
    return step.model_copy(update={"matrix": tuple(tuple(row) for row in rows.tolist())})


def _scaled_attenuation(terms: Attenuation, units: float) -> Attenuation:
    """E = I / (constant + linear r + quadratic r²) is what it was: the coefficients take the unit on."""
    return Attenuation(constant=terms.constant, linear=terms.linear / units, quadratic=terms.quadratic / units / units)


def _times(value: Any, units: float) -> Any:
    return tuple(x * units for x in value) if isinstance(value, tuple) else value * units
