"""Whether the rays of a `raytraced` case are few enough to be followed."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from equilux_oracle.transport import Allowance, TooManyRays, examine_raytraced
from equilux_scenes.case import Case
from equilux_scenes.model import Material, Scene

CROSSINGS = 1e7
"""Of rays with objects, towards lights included, that one picture may cost: ten to twenty seconds of one core."""

_SAMPLES = (12, 9)
_SHARE = 64
"""Of the film's positions, one in so many is followed to count its rays, in a grid of at most 12 × 9."""


def too_deep(case: Case) -> Mapping[str, str]:
    """The features that make a case cost too much, with the reason; empty where it does not.

    Where the worst case is too much, a grid of positions all over the film is followed and counted.
    """
    scene = case.scene
    film = scene.film.width * scene.film.height
    allowed = rays_allowed(scene)
    if film * _most_rays(scene) <= allowed:
        return {}
    columns, rows = (
        max(1, min(size // math.isqrt(_SHARE), most))
        for size, most in zip((scene.film.width, scene.film.height), _SAMPLES, strict=True)
    )
    y, x = np.mgrid[0:rows, 0:columns]
    at = np.stack([(x.ravel() + 0.5) / columns * scene.film.width, (y.ravel() + 0.5) / rows * scene.film.height], axis=1)
    try:
        examine_raytraced(case, at, Allowance(allowed * len(at) / film))
    except TooManyRays:
        reason = f"recursion_limit {scene.recursion_limit} asks for more than {allowed:.2g} rays"
        return dict.fromkeys(_multiplying(scene), reason)
    return {}


def rays_allowed(scene: Scene) -> float:
    return CROSSINGS / (len(scene.objects) * (1 + len(scene.delta_lights)))


def _most_rays(scene: Scene) -> float:
    """Of one position, at worst: two more from each surface that mirrors and lets through, else one."""
    limit = scene.recursion_limit
    used = [scene.materials[shape.material] for shape in scene.objects]
    if not any(_mirrors(m) or _lets_through(m) for m in used):
        return 1.0
    if any(_mirrors(m) and _lets_through(m) for m in used):
        return 2.0 ** min(limit + 1, 1000)
    return limit + 1.0


def _multiplying(scene: Scene) -> list[str]:
    used = [scene.materials[shape.material] for shape in scene.objects]
    return [
        *(["reflection"] if any(_mirrors(m) for m in used) else []),
        *(["transparency"] if any(_lets_through(m) for m in used) else []),
    ]


def _mirrors(material: Material) -> bool:
    return any(material.reflection) and material.transparency < 1.0


def _lets_through(material: Material) -> bool:
    return material.transparency > 0.0
