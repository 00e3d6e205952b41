"""Emitters whose light single precision loses: so small that the density of directions to them has no number."""

from __future__ import annotations

import math

import numpy as np

from equilux.adapter import Case, Unsupported
from equilux_adapters.mitsuba.geometry import reach_of
from equilux_scenes.model import AreaEmitter, DiscEmitter, RectangleEmitter, SphereEmitter

SMALLEST_SPHERE = 2.0**-11
"""Radius, of the scene's reach. From as far, 1 − cos α is 2^-23, and half of the light may be missing; from three times as far
all of it: 1 − cos α rounds to 0 and the density is infinite (Q4)."""

SMALLEST_AREA = 2.0**-60
"""Of the scene's reach, squared. The power heuristic takes the density's square, and what is infinite counts as nothing: from
the opposite corner of the scene, at √12 of its reach, that is where the area is less than 12 × 2^-64 (Q2)."""


def check_sizes(case: Case) -> None:
    """Raises Unsupported naming the emitters that would bring no light, or light without digits."""
    reach = reach_of(case)
    lost = {key: light for key, light in case.scene.area_emitters.items() if _is_lost(light, reach)}
    if lost:
        features = sorted({f"light.{light.kind}" for light in lost.values()})
        reason = f"in a scene of {reach:.3g} units, Mitsuba's single precision has no density of directions to {', '.join(lost)}"
        raise Unsupported(features, reason)


def _is_lost(light: AreaEmitter, reach: float) -> bool:
    if isinstance(light, SphereEmitter):
        return light.radius < SMALLEST_SPHERE * reach
    return _area(light) < SMALLEST_AREA * reach**2


def _area(light: DiscEmitter | RectangleEmitter) -> float:
    if isinstance(light, DiscEmitter):
        return math.pi * light.radius**2
    return float(np.linalg.norm(light.edge_u) * np.linalg.norm(light.edge_v))
