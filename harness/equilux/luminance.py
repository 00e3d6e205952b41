"""The photometric view of a picture: luminance, cd/m², as a weighted sum of its three bands (`equilux_scenes.photometry`)."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from equilux.adapter import Case, Image
from equilux.results import Luminance, Photometry
from equilux_scenes.photometry import k_m_text, luminance_weights
from equilux_scenes.spectral_data import SpectraMissing
from equilux_scenes.units import written_strengths


def photometry_of(case: Case) -> Photometry | None:
    """How the case's bands weigh in luminance; None where the data for that (equilux[spectra]) is not installed."""
    scene = case.scene
    try:
        weights = luminance_weights(scene)
    except SpectraMissing:
        return None
    bands = "linear Rec.709 primaries" if scene.bands is None else _intervals(scene.bands.intervals_nm)
    lights = written_strengths(scene)
    return Photometry(k_m=scene.k_m, k_m_text=k_m_text(scene), bands=bands, luminance_weights=weights, lights=lights)


@lru_cache
def _intervals(intervals_nm: tuple[tuple[float, float], ...]) -> str:
    return ", ".join(f"{low:g} to {high:g} nm" for low, high in intervals_nm)


def luminance_of(image: Image, weights: tuple[float, float, float]) -> Luminance | None:
    """Smallest, mean and largest luminance over the pixels whose three bands are finite; None where there is none."""
    pixels = np.asarray(image, np.float64).reshape(-1, 3)
    pixels = pixels[np.isfinite(pixels).all(axis=1)]
    with np.errstate(over="ignore"):
        luminance = pixels @ np.asarray(weights)
    if not len(luminance) or not np.isfinite(luminance).all():
        return None
    return Luminance(min=float(luminance.min()), mean=float(luminance.mean()), max=float(luminance.max()))
