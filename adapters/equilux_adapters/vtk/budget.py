"""The uncertainty budget of a script's picture. u = 2^-24, half a unit in the last place of single precision.

Constants are derived, not fitted: each reason says from what; tests show that none is exceeded and that each is approached.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from equilux.adapter import Bound, Budget, Case, Geometric, Image
from equilux_adapters._triangles.bounds import U, view_of
from equilux_adapters._triangles.displaced import reaches, set_back_of
from equilux_adapters.vtk.bounds_flat import horizon_of
from equilux_adapters.vtk.geometry import geometry_of
from equilux_adapters.vtk.knobs import VtkKnobs
from equilux_scenes.model import SpotLight

SNAP_PX = 1 / 256
"""Corners are moved to multiples of 1/256 pixel, so by 1/512 along either axis; an edge moves by √2/512 at most."""

DIRECTION_ROUNDINGS = 8
"""Of a unit vector in the shader (N, L or V): three interpolated or subtracted components at 2 u each, and the normalisation's
2 u."""

COSINE_ROUNDINGS = 6
"""Of a cosine near 1 in the shader: the lengths of two vectors made unit, 2 u each, and the sum of three products, 2 u. What
turns the vectors is in the direction term; what changes their length moves R·V even where turning them does not, at the top of
a highlight."""

LIGHT_ROUNDINGS = 12
"""Of one light's contribution beyond its cosines: r² (4 u), the attenuation's sum and quotient (3 u), three factors (3 u), log2
and exp2 (2 u)."""


POSITION_ROUNDINGS = 6
"""Of a point's coordinates relative to the eye: to single precision, the rotation into view coordinates, the interpolation;
likewise of a light's position."""


def facts_of(case: Case, knobs: VtkKnobs) -> dict[str, Any]:
    """JSON: what `budget_of` needs to know of the case; it travels with the program."""
    scene = case.scene
    segments = [knobs.tessellation] * len(scene.objects)
    facts: dict[str, Any] = {"facets": geometry_of(case, knobs), "set_back_m": set_back_of(case, segments)}
    facts["lights"] = len(scene.lights)
    exponents = [scene.materials[obj.material].exponent for obj in scene.objects if any(scene.materials[obj.material].specular)]
    exponents += [light.exponent for light in scene.delta_lights.values() if isinstance(light, SpotLight)]
    facts["exponent"] = max((min(exponent, 128.0) for exponent in exponents), default=0.0)  # Q5, Q7
    facts["reach_m"] = reaches(case)
    facts["cone_px"] = _cone_px(case)
    facts["horizon"] = horizon_of(case) if facts["reach_m"] else 0.0
    return facts


def _cone_px(case: Case) -> float:
    """How far on the film rounding displaces the border of a cone: its cosine is off by some u, its angle by that over its
    sine."""
    scene = case.scene
    view = view_of(scene.camera, scene.film)
    worst = 0.0
    for light in scene.delta_lights.values():
        if isinstance(light, SpotLight):
            angle = COSINE_ROUNDINGS * U / math.sin(math.radians(light.cone_half_angle_deg))
            away = float(np.linalg.norm(np.asarray(light.position) - view.eye))
            # as large as when the eye is as far from the border as the light is
            worst = max(worst, angle * view.pixels_per_unit * (away if view.parallel else 1.0))
    return worst


def budget_of(facts: Mapping[str, Any], largest: float) -> Budget:
    """The terms; largest: the picture's largest radiance. Constant colours (emission, ambient, background) are exact but for
    their storage."""
    facets = facts["facets"]
    terms: list[Bound | Geometric] = [
        Geometric("pixel grid", "corners are moved to multiples of 1/256 pixel", film_px=SNAP_PX + facts["cone_px"]),
    ]
    if facets["normal"] or facets["position_m"] or facets["film_px"]:
        reason = "flat facets in place of round surfaces; rounding on the film shifts what is interpolated"
        terms.append(Geometric("facets", reason, **_per_object(facets)))
    if facts["set_back_m"]:
        terms.append(Geometric("set back", "surfaces in one place are drawn apart", position_m=_by_index(facts["set_back_m"])))
    if facts["lights"]:
        # an error of L or V counts half as much as one of N, in R·V
        terms.append(
            Geometric(
                "single precision", "normals, positions and directions in the shader", normal=2 * DIRECTION_ROUNDINGS * U,
                position_m={index: POSITION_ROUNDINGS * U * reach for index, reach in _by_index(facts["reach_m"]).items()},
            )
        )
        roundings = LIGHT_ROUNDINGS + facts["lights"] + COSINE_ROUNDINGS * facts["exponent"]
        terms.append(Bound("shader arithmetic", "rounding of each light's terms and of their sum", rel=roundings * U))
    if facts["horizon"]:
        terms.append(Bound("horizon", "rounding on the film, where depth changes fastest", abs=facts["horizon"] * largest))
    return Budget(tuple(terms))


def _per_object(facets: Mapping[str, Any]) -> dict[str, Any]:
    return {"normal": _by_index(facets["normal"]), "position_m": _by_index(facets["position_m"]), "film_px": facets["film_px"]}


def _by_index(values: Mapping[str, float]) -> dict[int, float]:
    return {int(index): value for index, value in values.items()}


def of_storage(target: str, stored: Image, full_scale: float) -> Bound:
    """What a frame of half floats or of eight bits loses of the radiance that was computed (Q20)."""
    if target == "float16":
        held = np.clip(np.abs(stored) / full_scale, 0.0, float(np.finfo(np.float16).max))
        step = np.spacing(held.astype(np.float16)).astype(np.float64)
        reason = "half floats, cut off, not rounded: a unit in the last place of 11 bits"
        return Bound("half floats", reason, abs=np.where(np.isfinite(stored), step, 0.0) * full_scale)
    reason = "rounded to a code of 8 bits: half of 1/255 of the full scale"
    return Bound("eight bits", reason, abs=full_scale * (0.5 / 255 + 4 * U))
