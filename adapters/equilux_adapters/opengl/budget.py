"""The uncertainty budget of a script's picture. u = 2^-24, half a unit in the last place of single precision.

Constants are derived, not fitted: each reason says from what; tests show that none is exceeded and that each is approached.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from equilux.adapter import Bound, Budget, Case, Geometric
from equilux_adapters._triangles.bounds import U, view_of
from equilux_adapters._triangles.displaced import set_back_of
from equilux_adapters.opengl.division import segments_of, silhouette_px
from equilux_adapters.opengl.interpolation import Left
from equilux_adapters.opengl.knobs import OpenGLKnobs
from equilux_adapters.opengl.lighting import light_of, local_viewer, surface_of
from equilux_scenes.model import Cylinder, Object, Sphere
from equilux_scenes.transforms import matrix

SNAP_PX = 1 / 256
"""Corners are moved to multiples of 1/256 pixel, so by 1/512 along either axis; an edge moves by √2/512 at most (Q5)."""

LIGHT_ROUNDINGS = 12
"""Of one light's contribution beyond its cosines: r² (4 u), the attenuation's sum and quotient (3 u), the product of light and
material and two factors (3 u), log2 and exp2 (2 u)."""

CONSTANT_ROUNDINGS = 6
"""Of emission and global ambient light, two numbers each, their product and sum (2 u); and of the interpolation: 1/depth, the
planes of value and nearness, and their quotient (4 u). The background is cleared to as it is."""


def facts_of(case: Case, knobs: OpenGLKnobs) -> dict[str, Any]:
    """JSON: what `read` needs to know of the case; it travels with the program."""
    scene = case.scene
    view, segments = view_of(scene.camera, scene.film), segments_of(case, knobs)
    lights = [light_of(light) for light in scene.delta_lights.values()]
    surfaces = [surface_of(scene.materials[obj.material]) for obj in scene.objects]
    return {
        "camera": scene.camera.model_dump(mode="json"),
        "film": scene.film.model_dump(mode="json"),
        "lights": [asdict(light) for light in lights],
        "surfaces": [asdict(surface) for surface in surfaces],
        "ambient": list(scene.ambient),
        "local_viewer": local_viewer(scene),
        "round": [_round(obj) for obj in scene.objects],
        "set_back_m": set_back_of(case, segments),
        "film_px": max((silhouette_px(view, obj, n) for obj, n in zip(scene.objects, segments, strict=True)), default=0.0),
    }


def _round(obj: Object) -> dict[str, Any] | None:
    """The true shape of what is round, see `interpolation.on_surface`."""
    if isinstance(obj, Sphere):
        return {"center": list(obj.center), "radius": obj.radius, "matrix": matrix(obj).tolist()}
    if isinstance(obj, Cylinder):
        axis = np.subtract(obj.top, obj.base) / np.linalg.norm(np.subtract(obj.top, obj.base))
        return {"center": list(obj.base), "axis": axis.tolist(), "radius": obj.radius, "matrix": matrix(obj).tolist()}
    return None


def budget_of(facts: Mapping[str, Any], left: Left) -> Budget:
    """The terms."""
    snapped = "corners are moved to multiples of 1/256 pixel, and circles are polygons"
    terms: list[Bound | Geometric] = [Geometric("silhouettes", snapped, film_px=SNAP_PX + facts["film_px"])]
    if facts["set_back_m"]:
        terms.append(Geometric("set back", "surfaces in one place are drawn apart", position_m=_by_index(facts["set_back_m"])))
    reason = "the formula is evaluated at the corners of triangles, and its value interpolated over them"
    terms.append(Bound("vertex lighting", reason, abs=left.interpolation))
    roundings = CONSTANT_ROUNDINGS
    if facts["lights"]:
        terms.append(Bound("single precision", "normals, positions and directions at corners", abs=left.rounding))
        roundings += LIGHT_ROUNDINGS + len(facts["lights"])
    terms.append(Bound("arithmetic", "rounding of each term, of their sum and of its interpolation", rel=roundings * U))
    return Budget(tuple(terms))


def _by_index(values: Mapping[str, float]) -> dict[int, float]:
    return {int(index): value for index, value in values.items()}
