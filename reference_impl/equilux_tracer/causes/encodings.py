"""Curves by which pictures are encoded for displays and files, and their inverses."""

from __future__ import annotations

import numpy as np

from equilux_tracer.causes.rule import Floats

CURVES: tuple[str, ...] = ("srgb", "2.2", "1.8", "2.4", "rec709", "2.0")
"""Names of curves: IEC 61966-2-1, the power laws that renderers offer, ITU-R BT.709."""


def encoded(linear: Floats, curve: str) -> Floats:
    """The curve's encoding of linear values ≥ 0, not cut off at 1; any number names a power law, L^(1/number)."""
    linear = np.maximum(linear, 0.0)
    if curve == "srgb":
        return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    if curve == "rec709":
        return np.where(linear < 0.018, 4.5 * linear, 1.099 * linear**0.45 - 0.099)
    result: Floats = linear ** (1 / float(curve))
    return result


def decoded(value: Floats, curve: str) -> Floats:
    """The inverse of `encoded`."""
    value = np.maximum(value, 0.0)
    if curve == "srgb":
        return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
    if curve == "rec709":
        return np.where(value < 0.081, value / 4.5, ((value + 0.099) / 1.099) ** (1 / 0.45))
    result: Floats = value ** float(curve)
    return result
