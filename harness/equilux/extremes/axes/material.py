"""Axes of materials: exponents and coefficients."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from equilux.extremes.axes.pieces import perspective, point_light, spec, still_life
from equilux.extremes.axis import Axis, Spec, decades


def _exponent(exponent: float, model: str) -> Spec:
    """A wall with a highlight in its middle; the film shrinks with the highlight, 1/√p."""
    radius = math.sqrt(10 / max(exponent, 10.0))
    return spec(
        perspective(
            (0.1 * radius, 0.05 * radius, 3), (0.1 * radius, 0.05 * radius, 0), 2 * math.degrees(math.atan(0.6 * radius / 3))
        ),
        {"lamp": point_light((0.2 * radius, -0.1 * radius, 1), 1.0)},
        {"gloss": {"diffuse": 0.05, "specular": [0.5, 0.3, 0.2], "exponent": exponent}},
        [{"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "gloss"}],
    )


def _coefficient(value: float, model: str) -> Spec:
    """K_diff and K_spec multiplied, the light divided."""
    life = still_life(strength=1 / value)
    materials = {name: _times(value, material) for name, material in life["materials"].items()}
    return life | {"materials": materials, "background": 0.0625}


def _times(factor: float, material: Mapping[str, Any]) -> dict[str, Any]:
    """The material with its coefficients multiplied."""
    return {
        key: term if key == "exponent" else [factor * band for band in term] if isinstance(term, list) else factor * term
        for key, term in material.items()
    }


AXES = (
    Axis(
        "exponent", "exponent of the highlight", "", 10.0, (*decades(0, -8), 0.0), decades(2, 8), _exponent,
        "A wall under a lamp; the film shrinks with the highlight, so that its profile fills it.",
        "exponents clamped to 128 (VTK), R·V raised before the power below p = 1 (VTK), R·V rounded to float32: (1 − 2^-24)^p",
        ends={"opengl": 128.0},
    ),
    Axis(
        "coefficient", "K_diff and K_spec", "× plain", 1.0, decades(-1, -20), decades(1, 20), _coefficient,
        "Coefficients are multiplied, the light divided by it: the picture stays the same.",
        "coefficients clamped to 1, products that leave float32",
    ),
)  # fmt: skip
