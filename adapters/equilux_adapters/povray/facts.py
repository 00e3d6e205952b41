"""What the exposures and the budget are derived from: bounds over the whole picture."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from equilux_adapters._bounds import distances
from equilux_adapters._bounds.paths import BOUNDLESS, Paths, gain
from equilux_adapters.povray.frame import Frame, view
from equilux_adapters.povray.knobs import PovrayKnobs
from equilux_adapters.povray.lights import Lamp
from equilux_adapters.povray.materials import Coefficients
from equilux_adapters.povray.media import INDEX_STEP, Media, crossings
from equilux_adapters.povray.meshes import OBLIQUE, mesh_accuracy
from equilux_adapters.povray.textures import texture
from equilux_adapters.povray.truncation import Surface, below_weight
from equilux_scenes.case import Case
from equilux_scenes.model import Plane
from equilux_scenes.transforms import matrix


def facts(
    case: Case, frame: Frame, lights: Sequence[Lamp], materials: Mapping[str, Coefficients], insides: Media, knobs: PovrayKnobs
) -> dict[str, Any]:
    """Plain data for `render` and `read`."""
    scene = case.scene
    used = [materials[obj.material] for obj in scene.objects]
    passed = _shadow_gain(case, used)
    ceiling, strength, rounded_highlight = max(scene.background), 0.0, 0.0
    surfaces = []
    for index, m in enumerate(used):
        glow = max(e + a * light for e, a, light in zip(m.emission, m.ambient, scene.ambient, strict=True))
        arriving = sum(lamp.irradiance[index] for lamp in lights) * passed
        surfaces.append(Surface(min(float(glow + arriving * m.shine), BOUNDLESS), m))
        ceiling, strength = max(ceiling, surfaces[-1].local), max(strength, m.shine)
        if m.half_vector or float(np.float32(m.exponent)) != m.exponent:
            rounded_highlight = max(rounded_highlight, arriving * max(m.specular))
    bounces = scene.recursion_limit if {"reflection", "transparency"} & set(case.requires) else 0
    paths = Paths(surfaces, max(scene.background), bounces)
    every_hit = gain(paths.onward, bounces)
    meshes = {str(index): vars(mesh_accuracy(mesh, matrix(scene.objects[index]))) for index, mesh in case.meshes.items()}
    return {
        "width": scene.film.width,
        "height": scene.film.height,
        "ceiling": min(float(ceiling) * every_hit, BOUNDLESS),
        "strength": min(strength * passed * every_hit, BOUNDLESS),
        "rounded_highlight": min(float(rounded_highlight) * every_hit, BOUNDLESS),
        "half_vector": any(m.half_vector and any(m.specular) for m in used),
        "layered": any(texture(m).layered for m in used),
        "glowing": any(any(m.ambient) or any(m.emission) for m in used),
        "bounces": bounces,
        "lets_through": any(m.through is not None for m in used),
        "filters": _filters(case, used),
        "sources": sum(lamp.sources for lamp in lights),
        "fading": max([lamp.relative for lamp in lights], default=0.0),
        "cancelled": min(float(np.sum([lamp.cancelled for lamp in lights])) * strength * passed * every_hit, BOUNDLESS),
        "level_cut": paths.beyond(levels(case, knobs)),
        "weight_cut": below_weight(paths, knobs.adc_bailout),
        "film_px": frame.film_px,
        "meshes": meshes,
        "refraction": {str(index): _as_normal(error, used[index].ior) for index, error in insides.index_error.items() if error},
        "turned_px": _turned_px(case, insides),
        "horizon_px": _horizon_px(case, insides),
    }


def _shadow_gain(case: Case, used: Sequence[Coefficients]) -> float:
    """An upper bound of τ: transparent objects may brighten the light that crosses them."""
    if "shadow.attenuated" not in case.requires:
        return 1.0
    result = 1.0
    for index, m in enumerate(used):
        if m.through is not None and max(m.through) > 1:
            times = crossings(case.scene.objects[index], case.meshes.get(index))
            result *= math.exp(min(times * math.log(max(m.through)), math.log(BOUNDLESS)))
    return min(result, BOUNDLESS)


def _filters(case: Case, used: Sequence[Coefficients]) -> int:
    """How many surfaces a shadow ray may be filtered by."""
    if "shadow.attenuated" not in case.requires:
        return 0
    objects = [(obj, case.meshes.get(index)) for index, obj in enumerate(case.scene.objects) if used[index].through is not None]
    return sum(2 if mesh is not None else crossings(obj, mesh) for obj, mesh in objects)


def levels(case: Case, knobs: PovrayKnobs) -> int:
    """`max_trace_level`: the camera's ray is the first level (Q38)."""
    asked = case.scene.recursion_limit + 1
    return asked if knobs.max_trace_level == "scene" else min(asked, knobs.max_trace_level)


def _as_normal(error: float, ior: float) -> float:
    """The tilt of the normal that turns a refracted ray at least as much as the relative error of the index does (Q35).

    sin θ_t = η sin θ_i: an error ε of η turns the ray by ε tan θ_t, a tilt α by α |1 − η cos θ_i / cos θ_t|. α/ε is largest where
    light enters or leaves at some angle between; it is taken over angles of both passages.
    """
    ratios = []
    for eta in (ior, 1.0 / ior):
        sine = np.linspace(0.0, min(1.0, 1.0 / eta), 2000, endpoint=False)[1:]
        cosine_in, cosine_out = np.sqrt(1.0 - sine**2), np.sqrt(1.0 - (eta * sine) ** 2)
        ratios.append(np.max(eta * sine / cosine_out / np.abs(1.0 - eta * cosine_in / cosine_out)))
    return error * float(max(ratios))


def _turned_px(case: Case, insides: Media) -> float:
    """How far, pixels, a ray that goes through an index a step from 1 is turned: by tan θ of the step (Q34)."""
    if not insides.shared:
        return 0.0
    camera = view(case)
    if camera.perspective:
        return camera.film_px(INDEX_STEP * OBLIQUE)
    hulls = [hull for index in range(len(case.scene.objects)) if (hull := distances.extremes(case, index)) is not None]
    reach = max([float(np.linalg.norm(hull - camera.eye, axis=1).max()) for hull in hulls], default=camera.height)
    return camera.film_px(INDEX_STEP * OBLIQUE * reach)


def _horizon_px(case: Case, insides: Media) -> float:
    """How far, pixels, the horizon of a transparent plane moves: on entering an index a step below 1, light is totally
    reflected below the angle √(2 step) (Q34).
    """
    if not any(isinstance(case.scene.objects[index], Plane) for index in insides.shared):
        return 0.0
    return view(case).film_px(math.sqrt(2.0 * INDEX_STEP))
