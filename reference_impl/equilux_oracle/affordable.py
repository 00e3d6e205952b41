"""Whether the rays of a `raytraced` case are few enough to be followed (Q7 of the oracle adapter's QUIRKS.md)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import lru_cache

import numpy as np

from equilux_oracle.doubledouble import Array
from equilux_oracle.examination import Examination
from equilux_oracle.transport import Allowance, TooManyRays, examine_raytraced
from equilux_scenes.case import Case
from equilux_scenes.model import Material, Scene

CROSSINGS = 1e7
"""Of rays with objects, towards lights included, that one picture may cost: ten to twenty seconds of one core."""

_EACH = 8
"""Rays per film position that are always allowed."""

_SAMPLES = (12, 9)
_SHARE = 64
"""Of the film's positions, one in so many is followed to count its rays, in a grid of at most 12 × 9."""

_MISJUDGED = 5.0
"""By how much a sample may be wrong before the picture is given up."""


def too_deep(case: Case) -> Mapping[str, str]:
    """The features that make a case cost too much, with the reason; empty where it does not.

    Where the worst case is too much, a grid of positions all over the film is followed and counted.
    """
    scene = case.scene
    if scene.film.width * scene.film.height * _most_rays(scene) <= rays_allowed(scene):
        return {}
    # What does not change the picture does not change the count, which is asked for several times.
    if _counts_too_many(scene.model_dump_json(exclude={"name", "about", "shows", "sweep", "expect"})):
        return dict.fromkeys(_multiplying(scene), _reason(scene, rays_allowed(scene)))
    return {}


@lru_cache(maxsize=256)
def _counts_too_many(scene_json: str) -> bool:
    """Whether a grid of positions says so."""
    scene = Scene.model_validate_json(f'{{"name":"counted",{scene_json[1:]}')
    width, height = scene.film.width, scene.film.height
    columns, rows = (max(1, min(size // math.isqrt(_SHARE), most)) for size, most in zip((width, height), _SAMPLES, strict=True))
    y, x = np.mgrid[0:rows, 0:columns]
    at = np.stack([(x.ravel() + 0.5) / columns * width, (y.ravel() + 0.5) / rows * height], axis=1)
    try:
        examine_raytraced(Case(scene.name, scene, scene.name), at, Allowance(rays_allowed(scene) * len(at) / (width * height)))
    except TooManyRays:
        return True
    return False


def examine_within_reason(case: Case, positions: Array) -> Examination:
    """`examine_raytraced`, but ValueError where the sample has missed that it costs much more than is allowed."""
    allowed = _MISJUDGED * max(rays_allowed(case.scene), float(_EACH * len(positions)))
    try:
        return examine_raytraced(case, positions, Allowance(allowed))
    except TooManyRays:
        raise ValueError(f"{case.name}: {_reason(case.scene, allowed)}") from None


def rays_allowed(scene: Scene) -> float:
    """How many rays a picture may have, after the cost of each; a large film is no reason to refuse."""
    by_cost = CROSSINGS / (len(scene.objects) * (1 + len(scene.delta_lights)))
    return max(by_cost, float(_EACH * scene.film.width * scene.film.height))


def _reason(scene: Scene, allowed: float) -> str:
    return f"recursion_limit {scene.recursion_limit} asks for more than {allowed:.2g} rays"


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
