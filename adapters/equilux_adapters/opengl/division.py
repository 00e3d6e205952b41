"""How finely round surfaces are divided, and what that leaves of their silhouettes."""

from __future__ import annotations

import math

import numpy as np

from equilux.adapter import Case
from equilux_adapters._triangles.bounds import Floats, view_of
from equilux_adapters._triangles.round import film_scale, sectors, sphere_division, sphere_scale
from equilux_adapters._triangles.shapes import cylinder_division
from equilux_adapters._triangles.view import View
from equilux_adapters.opengl.knobs import OpenGLKnobs
from equilux_scenes.model import Cylinder, Disc, Object, Sphere
from equilux_scenes.transforms import matrix

MOST_SEGMENTS = 1024
"""Around a sphere; what is larger on the film is divided further, flat."""


def segments_of(case: Case, knobs: OpenGLKnobs) -> list[int]:
    """Per object: so many that a sphere's facets are not longer than `triangle_px` on the film, and at least `tessellation`."""
    view = view_of(case.scene.camera, case.scene.film)
    result = []
    for obj in case.scene.objects:
        wanted = float(knobs.tessellation)
        if isinstance(obj, Sphere):
            radius_px = obj.radius * sphere_scale(view, obj.center, obj.radius, placed(obj)).large
            wanted = max(wanted, min(2 * math.pi * radius_px / knobs.triangle_px, MOST_SEGMENTS))
        result.append(math.ceil(wanted))
    return result


def placed(obj: Object) -> Floats | None:
    """The object's matrix, None where it has no transform."""
    return matrix(obj) if obj.transform else None


def silhouette_px(view: View, obj: Object, segments: int) -> float:
    """How far on the film the chords that stand for a circle stay off it: radius × angle² / 8. Corners lie on the silhouette."""
    if isinstance(obj, Sphere):
        _, meridian, counts = sphere_division(view, obj.center, obj.radius, segments, placed(obj), grazing=False)
        if not meridian.has_rim:
            return 0.0
        step = 2 * math.pi * math.sin(meridian.angles[meridian.rim]) / counts[meridian.rim]
        return _chord_px(step, obj.radius * sphere_scale(view, obj.center, obj.radius, placed(obj)).large)
    if isinstance(obj, Cylinder):
        _, half, scale = cylinder_division(view, obj.base, obj.top, obj.radius, segments, placed(obj), grazing=False)
        return _chord_px(float(np.max(np.diff(half.angles))), obj.radius * scale.large)
    if isinstance(obj, Disc):
        scale = film_scale(view, placed(obj), np.asarray(obj.center), obj.radius)
        return _chord_px(2 * math.pi / sectors(segments, obj.radius, scale), obj.radius * scale.large)
    return 0.0


def _chord_px(step: float, radius_px: float) -> float:
    return radius_px * step**2 / 8
