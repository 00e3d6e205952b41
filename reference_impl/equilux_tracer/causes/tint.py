"""What a renderer makes of a term that it multiplies by the surface's colour."""

from __future__ import annotations

import math
from collections.abc import Mapping

from equilux_scenes.model import Material
from equilux_tracer.causes.rewrite import BLACK, BandTriple, times

TINTS: Mapping[str, str] = {
    "": "× K_diff",
    "albedo": "× π K_diff: the colour is a reflectance",
    "hue": "× K_diff / its largest band: the colour without its strength",
}
"""The readings that all terms share; "diffuse instead" is the fourth."""


def tinted(term: BandTriple, material: Material, reading: str) -> BandTriple:
    """The term as this reading of the tint has it."""
    diffuse = material.diffuse
    match reading:
        case "diffuse instead":
            return diffuse
        case "albedo":
            return times(term, diffuse, math.pi)
        case "hue":
            largest = max(diffuse)
            return times(term, diffuse, 1 / largest) if largest > 0 else BLACK
        case _:
            return times(term, diffuse)
