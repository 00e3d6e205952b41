"""The bands of a scene, of its materials and of what shines, read and replaced: for causes that scale or reorder them."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import Any, Literal

import numpy as np

from equilux_scenes.case import Case
from equilux_tracer.causes.rewrite import used_materials, with_scene
from equilux_tracer.causes.rule import Floats

Bands = tuple[float, float, float]
Which = Literal["materials", "lights"]

OF_MATERIALS = ("diffuse", "specular", "ambient", "emission", "reflection", "transmission")
OF_LIGHTS = ("intensity", "irradiance", "radiance", "ambient", "diffuse", "specular")


def with_materials(case: Case, keys: Collection[str], change: Callable[[Bands], Bands]) -> Case:
    """The case with these bands of every material changed."""
    materials = {name: _changed(material, keys, change) for name, material in case.scene.materials.items()}
    return with_scene(case, materials=materials)


def with_lights(case: Case, keys: Collection[str], change: Callable[[Bands], Bands]) -> Case:
    """The case with these bands of every light changed."""
    return with_scene(case, lights={name: _changed(light, keys, change) for name, light in case.scene.lights.items()})


def band_values(case: Case, which: Which) -> Floats:
    """(n, 3): every triple of bands of the materials in use, or of all that shines."""
    scene = case.scene
    if which == "materials":
        found = [getattr(material, key) for material in used_materials(scene) for key in OF_MATERIALS]
    else:
        found = [getattr(light, key) for light in scene.lights.values() for key in OF_LIGHTS if hasattr(light, key)]
        found += [scene.ambient, scene.background]
    return np.array(found, dtype=np.float64).reshape(-1, 3)


def with_bands_ordered(case: Case, which: str, order: tuple[int, ...]) -> Case:
    """The case with the bands of its materials, or of all that shines, in another order."""

    def ordered(bands: Bands) -> Bands:
        return bands[order[0]], bands[order[1]], bands[order[2]]

    if which == "materials":
        return with_materials(case, OF_MATERIALS, ordered)
    changed = with_lights(case, OF_LIGHTS, ordered)
    return with_scene(changed, ambient=ordered(case.scene.ambient), background=ordered(case.scene.background))


def _changed(part: Any, keys: Collection[str], change: Callable[[Bands], Bands]) -> Any:
    return part.model_copy(update={key: change(getattr(part, key)) for key in keys if hasattr(part, key)})
