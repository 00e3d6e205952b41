"""How far what is drawn is from where it is: by rounding of positions, and by drawing coincident surfaces apart."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from equilux.adapter import Case
from equilux_adapters._triangles.bounds import view_of
from equilux_adapters._triangles.clip import in_frame
from equilux_adapters._triangles.coincident import set_backs
from equilux_adapters._triangles.depth import set_back
from equilux_adapters._triangles.drawing import build
from equilux_adapters._triangles.extent import reach_of
from equilux_scenes.model import DirectionalLight


def light_reach(case: Case) -> float:
    """How far from the eye, in metres, positions matter; 0 where no light is at a point.

    Beyond twice the distance of the farthest light from the eye, a light is at least half as far from a point as the eye is, and
    rounding of the position changes the light's distance and direction by less than what is stated for directions anyway.
    """
    eye = np.asarray(case.scene.camera.eye)
    lights = [light for light in case.scene.delta_lights.values() if not isinstance(light, DirectionalLight)]
    return max((2 * float(np.linalg.norm(np.asarray(light.position) - eye)) for light in lights), default=0.0)


def reaches(case: Case) -> dict[str, float]:
    """Per object index (as text), the distance from the eye that rounding of its positions is relative to."""
    farthest = light_reach(case)
    return {str(index): min(reach_of(case, index), farthest) for index in range(len(case.scene.objects))} if farthest else {}


def set_back_of(case: Case, segments: Sequence[int]) -> dict[str, float]:
    """How far, in metres, coincident objects are drawn from where they are, per object index (as text); see `depth.set_back`.

    segments: of each object.
    """
    steps = set_backs(case)
    if not any(steps):
        return {}
    view = view_of(case.scene.camera, case.scene.film)
    meshes = [build(case, index, view, count) for index, count in enumerate(segments)]
    moved = set_back(view, meshes, steps)
    return {
        str(index): float(np.max(np.linalg.norm(after.points - in_frame(view, before).points, axis=1), initial=0.0))
        for index, (before, after) in enumerate(zip(meshes, moved, strict=True))
        if steps[index]
    }
