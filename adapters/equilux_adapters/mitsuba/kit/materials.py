"""Surfaces: literal coefficients in 1/sr → Mitsuba's BSDFs, on both faces."""

from __future__ import annotations

from typing import Any

import numpy as np


def bands(red: float, green: float, blue: float) -> dict[str, Any]:
    """Three numbers that Mitsuba neither bounds nor converts."""
    return {"type": "srgb", "color": [red, green, blue], "unbounded": True}


def lambert(k_diff: tuple[float, float, float]) -> dict[str, Any]:
    """f_r = K_diff. Mitsuba's `diffuse` is reflectance / π, and has one side."""
    return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": bands(*(np.pi * k for k in k_diff))}}


def black() -> dict[str, Any]:
    """What emitters reflect."""
    return {"type": "diffuse", "reflectance": bands(0, 0, 0)}
