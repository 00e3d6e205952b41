"""What is too large or too small for double-double: such scenes are refused, in words."""

from __future__ import annotations

import math
from collections.abc import Iterator

from equilux_scenes.model import PointLight, Scene, Shape, SpotLight

LARGEST = 1e60
"""Lengths in metres, and indices of refraction. Fourth powers of it and of its inverse are doubles; nothing physical is lost."""

NARROWEST_DEG = 1e-12
"""Half angle of a cone: below, the directions of light and axis do not tell any more what is inside."""


def out_of_reach(scene: Scene) -> list[str]:
    """What of a scene cannot be computed with, each in words; empty where all can."""
    return list(_found(scene))


def _found(scene: Scene) -> Iterator[str]:
    if not max(map(abs, (*scene.camera.eye, *scene.camera.target))) < LARGEST:
        yield "camera: eye or target is farther than 1e60 m from the origin"
    for name, light in scene.delta_lights.items():
        if isinstance(light, PointLight | SpotLight) and not max(map(abs, light.position)) < LARGEST:
            yield f"light '{name}': it is farther than 1e60 m from the origin"
        if isinstance(light, SpotLight) and light.cone_half_angle_deg < NARROWEST_DEG:
            yield f"light '{name}': its cone is narrower than 1e-12 degrees"
    for index, shape in enumerate(scene.objects):
        lengths = [abs(number) for number in _numbers(shape) if number]
        if lengths and not (max(lengths) < LARGEST and max(lengths) > 1 / LARGEST):
            yield f"objects[{index}]: its size or place is beyond 1e60 m, or below 1e-60 m"
        ior = scene.materials[shape.material].ior
        if not 1 / LARGEST < ior < LARGEST:
            yield f"objects[{index}]: its index of refraction is beyond 1e60 or below 1e-60"


def _numbers(shape: Shape) -> Iterator[float]:
    """The lengths that an object is given by, short of its directions."""
    for key, value in shape:
        if key in ("center", "point", "min", "max", "corner", "edge_u", "edge_v", "base", "top") and isinstance(value, tuple):
            yield from (float(number) for number in value)
        elif key == "radius" and isinstance(value, float) and math.isfinite(value):
            yield value
