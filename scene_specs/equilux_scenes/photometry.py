"""Radiometric and photometric quantities: how flux, intensity, irradiance, radiance and the luminous ones hang together.

A luminous quantity is X_v = K_m ∫ V(λ) X_λ dλ. Of a picture in three bands it is a weighted sum, L_v = Σ w_b L_b
(`luminance_weights`). The bands are the linear Rec.709 primaries, scaled so that three equal bands of 1 have the luminous
quantity K_m: then w = K_m (0.2126…, 0.7152…, 0.0722…), the row of Y in the matrix from Rec.709 to CIE XYZ. Where a scene names
intervals of wavelengths, w_b is K_m times the mean of V over the interval: exact where the spectrum is flat over it.

Angles are in radians, areas in m²; W and lm alike: all these functions are linear in the quantity.
"""

from __future__ import annotations

import math

import numpy as np

from equilux_scenes.model import BandIntervals, Scene
from equilux_scenes.spectra import luminosity_over
from equilux_scenes.spectral_data import Floats

K_M = 683.002
"""K_m, lm/W: 683 at 540 THz, which is 555.016 nm in air, referred to the peak of V(λ) at 555 nm."""

K_M_OF_THE_LECTURE = 684.0
"""0.146 % more; a scene may choose it."""

K_M_NAMES = {K_M: "683.002 lm/W, the SI's", K_M_OF_THE_LECTURE: "684 lm/W, the lecture's, 0.146 % above the SI's 683.002"}
"""K_m → how a report calls it."""

# ITU-R BT.709-6, table 1: chromaticities x, y of R, G, B and of the white D65
_PRIMARIES = ((0.640, 0.330), (0.300, 0.600), (0.150, 0.060))
_WHITE = (0.3127, 0.3290)


def _rec709_to_xyz() -> Floats:
    columns = np.array([(x / y, 1.0, (1 - x - y) / y) for x, y in _PRIMARIES]).T
    x, y = _WHITE
    white = np.array([x / y, 1.0, (1 - x - y) / y])
    matrix: Floats = columns * np.linalg.solve(columns, white)
    return matrix


REC709_TO_XYZ = _rec709_to_xyz()
"""(3, 3): linear Rec.709 → CIE XYZ (1931 2°), white (1, 1, 1) → Y = 1. Its middle row is 0.2126390, 0.7151687, 0.0721923."""


def luminance_weights(scene: Scene) -> tuple[float, float, float]:
    """The w of L_v = Σ w_b L_b, lm/W: cd/m² from W/(m²·sr), and likewise cd, lx, lm from W/sr, W/m², W.

    Raises SpectraMissing where the scene names intervals of wavelengths and colour-science is not installed.
    """
    return weights_of(scene.k_m, scene.bands)


def weights_of(k_m: float, bands: BandIntervals | None) -> tuple[float, float, float]:
    """`luminance_weights` of any scene with this K_m and these bands (None: Rec.709)."""
    if bands is None:
        r, g, b = REC709_TO_XYZ[1] * k_m
    else:
        r, g, b = (k_m * luminosity_over((low, high)) / (high - low) for low, high in bands.intervals_nm)
    return float(r), float(g), float(b)


def k_m_text(scene: Scene) -> str:
    """The K_m that a scene's luminous quantities are made with, in words."""
    return K_M_NAMES[scene.k_m]


# --- one quantity from another --------------------------------------------------------------------------------------


def solid_angle_of_cone(half_angle: float) -> float:
    """Ω = 2π (1 − cos α) of a cone, and of the cap that it cuts out of a sphere; sr. 4π at α = π."""
    return 4 * math.pi * math.sin(half_angle / 2) ** 2


def flux_of_point(intensity: float) -> float:
    """Φ = 4π I."""
    return 4 * math.pi * intensity


def intensity_of_flux(flux: float) -> float:
    """I = Φ / 4π."""
    return flux / (4 * math.pi)


def beam_of_spot(half_angle: float, exponent: float) -> float:
    """Φ / I of a spot light: ∫ cos^e over the cone = 2π (1 − cos^(e+1) α) / (e + 1), sr."""
    # −expm1 keeps the digits that 1 − cos loses for a narrow cone: log cos α = log1p(−2 sin²(α/2))
    if half_angle >= math.pi / 2:
        return 2 * math.pi / (exponent + 1)
    log_cosine = math.log1p(-2 * math.sin(half_angle / 2) ** 2)
    return -2 * math.pi * math.expm1((exponent + 1) * log_cosine) / (exponent + 1)


def flux_of_spot(intensity: float, half_angle: float, exponent: float = 0.0) -> float:
    """Φ of a spot light of axial intensity I."""
    return intensity * beam_of_spot(half_angle, exponent)


def exitance(radiance: float) -> float:
    """M = π L of a surface that shines alike in all directions on one side."""
    return math.pi * radiance


def irradiance_of_point(intensity: float, distance: float) -> float:
    """E = I / r², on a surface that faces the light."""
    return intensity / distance**2


def irradiance_of_cone(radiance: float, half_angle: float) -> float:
    """E = π L sin²α, on a surface that faces a uniform source which fills a cone: a sphere seen under half-angle α, say."""
    return math.pi * radiance * math.sin(half_angle) ** 2
