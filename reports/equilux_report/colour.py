"""The report's colour maps, built in OKLCh so that equal steps of value look like equal steps of lightness.

The pages get these tables as data: thumbnails made here and pictures drawn in the browser show the same colours.
"""

from __future__ import annotations

import base64

import numpy as np
import numpy.typing as npt

Table = npt.NDArray[np.uint8]
Floats = npt.NDArray[np.float64]

NAN_COLOUR = (255, 0, 255)
PLUS_INF_COLOUR = (0, 255, 0)
MINUS_INF_COLOUR = (255, 255, 0)
"""No map below and no tone-mapped grey comes near these: a non-finite pixel cannot be overlooked."""

HEAT_DECADES = 4
"""|E_n| of 10^4 and above has the strongest colour."""


def srgb_encode(linear: Floats) -> Floats:
    """Linear [0, 1] → sRGB [0, 1] (IEC 61966-2-1)."""
    clipped = np.clip(linear, 0, 1)
    return np.where(clipped <= 0.0031308, 12.92 * clipped, 1.055 * np.power(clipped, 1 / 2.4) - 0.055)


def oklch_to_linear(lightness: Floats, chroma: Floats, hue_deg: Floats) -> Floats:
    """(n, 3) linear sRGB, possibly out of gamut. Source: B. Ottosson, "A perceptual color space for image processing", 2020."""
    a, b = chroma * np.cos(np.radians(hue_deg)), chroma * np.sin(np.radians(hue_deg))
    long = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3
    medium = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3
    short = (lightness - 0.0894841775 * a - 1.2914855480 * b) ** 3
    return np.stack(
        [
            4.0767416621 * long - 3.3077115913 * medium + 0.2309699292 * short,
            -1.2684380046 * long + 2.6097574011 * medium - 0.3413193965 * short,
            -0.0041960863 * long - 0.7034186147 * medium + 1.7076147010 * short,
        ],
        axis=-1,
    )


def _table(lightness: Floats, chroma: Floats, hue_deg: Floats) -> Table:
    """sRGB bytes, keeping lightness and hue and giving up chroma where the gamut ends."""
    chroma = chroma.copy()
    for _ in range(60):
        linear = oklch_to_linear(lightness, chroma, hue_deg)
        outside = ((linear < -1e-4) | (linear > 1 + 1e-4)).any(axis=-1)
        if not outside.any():
            break
        chroma[outside] *= 0.95
    return np.round(255 * srgb_encode(linear)).astype(np.uint8)


def sequential() -> Table:
    """(256, 3): violet → blue → green → yellow, lightness strictly rising."""
    t = np.linspace(0, 1, 256)
    return _table(0.15 + 0.80 * t, 0.08 + 0.12 * np.sin(np.pi * np.clip(t * 1.05, 0, 1)), 300 - 195 * t)


def diverging() -> Table:
    """(511, 3): blue for negative, near black at zero (index 255), orange for positive; both arms of equal lightness."""
    t = np.linspace(0, 1, 256)
    lightness, chroma = 0.19 + 0.66 * t**0.85, 0.165 * np.minimum(1, 2.2 * t) * (1 - 0.35 * t)
    negative = _table(lightness, chroma, 262 - 42 * t)
    positive = _table(lightness, chroma, 38 + 40 * t)
    return np.concatenate([negative[:0:-1], positive])


def heat_position(en: Floats) -> Floats:
    """Where a normalised error lies on the diverging map, [-1, 1].

    Within the uncertainty the colour stays dim (up to 0.28); at |E_n| = 1 it jumps to 0.45 and from there grows with the
    logarithm, so that what diverges is told from what agrees at a glance, and 10 from 1000.
    """
    size = np.abs(en)
    with np.errstate(divide="ignore"):
        beyond = 0.45 + 0.55 * np.minimum(1, np.log10(np.maximum(size, 1)) / HEAT_DECADES)
    return np.sign(en) * np.where(size <= 1, 0.28 * size, beyond)


def diverging_lookup(position: Floats, table: Table) -> Table:
    """Colours (…, 3) of positions in [-1, 1]."""
    return table[255 + np.rint(255 * np.clip(position, -1, 1)).astype(np.intp)]


def encode(table: Table) -> str:
    """A table as base64, for the page."""
    return base64.b64encode(table.tobytes()).decode("ascii")
