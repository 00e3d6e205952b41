"""Following fewer bounces than the scene asks for, and what that may cost."""

from __future__ import annotations

import numpy as np

from equilux.adapter import Case
from equilux_adapters._bounds.distances import nearest
from equilux_adapters._bounds.paths import BOUNDLESS, Paths, Surface
from equilux_adapters.reference.knobs import ReferenceKnobs
from equilux_scenes.model import DeltaLight, DirectionalLight, Material


def depth_of(case: Case, knobs: ReferenceKnobs) -> int:
    """The recursion limit to trace with: never more than the scene's."""
    limit = case.scene.recursion_limit
    return limit if knobs.recursion_depth == "scene" else min(limit, knobs.recursion_depth)


def missing(case: Case, depth: int) -> float:
    """W/(m²·sr): the most that bounces deeper than `depth`, up to the scene's limit, may add to a pixel."""
    scene = case.scene
    if scene.model != "raytraced" or depth >= scene.recursion_limit:
        return 0.0
    surfaces = [_surface(case, index) for index in range(len(scene.objects))]
    if max((surface.onward for surface in surfaces), default=0.0) == 0:
        return 0.0
    return Paths(surfaces, max(scene.background), scene.recursion_limit).beyond(depth + 1)


def _surface(case: Case, index: int) -> Surface:
    """L = K_emit + K_amb L_amb + (1 − t) L_1 + t L_2, each part at its largest; a total reflection counts 1."""
    scene = case.scene
    material = scene.materials[scene.objects[index].material]
    t = material.transparency
    glow = max(e + k * around for e, k, around in zip(material.emission, material.ambient, scene.ambient, strict=True))
    shine = max(t, 1 - t) * max(d + s for d, s in zip(material.diffuse, material.specular, strict=True))
    arriving = sum(_largest_irradiance(case, index, light) for light in scene.delta_lights.values())
    local = glow + shine * arriving * _brightened(case) if shine else glow
    return Surface(min(local, BOUNDLESS), _onward(material))


def _onward(material: Material) -> float:
    t = material.transparency
    both = max((1 - t) * r + t * k for r, k in zip(material.reflection, material.transmission, strict=True))
    return max(both, 1.0) if t > 0 and material.ior != 1 else both


def _largest_irradiance(case: Case, index: int, light: DeltaLight) -> float:
    if isinstance(light, DirectionalLight):
        return max(light.irradiance)
    r, terms = nearest(case, index, np.asarray(light.position)), light.attenuation
    over = terms.constant + r * (terms.linear + r * terms.quadratic)
    return min(max(light.intensity) / over, BOUNDLESS) if over > 0 else BOUNDLESS


def _brightened(case: Case) -> float:
    """What crossing transparent objects may multiply light by: nothing above 1, unless some let through more than they get."""
    materials = [case.scene.materials[obj.material] for obj in case.scene.objects]
    gains = any(m.transparency * max(m.transmission) > 1 for m in materials)
    return BOUNDLESS if gains and "shadow.attenuated" in case.requires else 1.0
