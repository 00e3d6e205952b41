"""Lights given in lumens, candelas, lux, watts or by a spectrum → lights given in bands, which is all that renderers ever see.

A light has one strength: its bands (`intensity`, `irradiance`, `radiance`), or the luminous counterpart, or a flux, or a spectrum
that is absolute. A relative spectrum has its strength beside it, radiometric ones being integrals over all wavelengths. A
luminous quantity without a spectrum means three equal bands. See `photometry` for what the bands are.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from typing import Any, TypeVar

import numpy as np

from equilux_scenes.errors import hint, number_text
from equilux_scenes.model import (
    BandIntervals,
    DiscEmitter,
    Emitter,
    PointLight,
    RectangleEmitter,
    Scene,
    Spectrum,
    SphereEmitter,
    SpotLight,
    Strength,
)
from equilux_scenes.photometry import REC709_TO_XYZ, beam_of_spot, weights_of
from equilux_scenes.spectra import Blackbody, Density, Line, density_of
from equilux_scenes.spectral_data import Floats, SpectraMissing, illuminant_names

LUMINOUS = {"intensity": "luminous_intensity", "irradiance": "illuminance", "radiance": "luminance"}
"""Bands → their luminous counterpart."""

UNITS = {
    "intensity": "W/sr",
    "irradiance": "W/m²",
    "radiance": "W/(m²·sr)",
    "luminous_intensity": "cd",
    "illuminance": "lx",
    "luminance": "cd/m²",
    "flux": "W",
    "luminous_flux": "lm",
}
"""The unit of every strength."""

OTHER_THAN_BANDS = ("luminous_intensity", "illuminance", "luminance", "flux", "luminous_flux", "spectrum")
"""The keys that a light's bands may come from. They do not enter a picture beyond those."""

ROUNDING = 1e-12
"""Of the largest band: a negative one below it is 0 that was rounded."""


Light = TypeVar("Light", bound=Strength)


@dataclass(frozen=True)
class Units:
    """What of a scene decides how bands are made: K_m, lm/W, and the intervals that its bands are, None for Rec.709."""

    k_m: float = 683.002
    bands: BandIntervals | None = None


class CannotResolve(ValueError):
    """A strength that makes no bands: `path` in the light's keys, what is `allowed` there, and a `note` on why."""

    def __init__(self, path: tuple[str, ...], allowed: str, note: str = "") -> None:
        super().__init__(f"{'.'.join(path)}: allowed {allowed}{note}")
        self.path = path
        self.allowed = allowed
        self.note = note


def bands_key(light: type[Strength]) -> str:
    """The key of a kind of light's bands."""
    return next(key for key in LUMINOUS if key in light.model_fields)


def strengths(light: type[Strength]) -> tuple[str, ...]:
    """The keys that give a kind of light its strength, its bands first, without `spectrum`."""
    bands = bands_key(light)
    return tuple(key for key in (bands, LUMINOUS[bands], "flux", "luminous_flux") if key in light.model_fields)


def in_bands(light: Light, units: Units) -> Light:
    """The light with its bands worked out from what is given instead of them; itself where the bands are given.

    Its keys are consistent (`checks`). Raises CannotResolve.
    """
    given = next((key for key in strengths(type(light))[1:] if getattr(light, key) is not None), None)
    if light.spectrum is None and given is None:
        return light
    key = bands_key(type(light))
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        bands = _of_spectrum(light, light.spectrum, given, units) if light.spectrum else _plain(light, str(given), units)
    if not np.isfinite(bands).all():
        raise CannotResolve((given or "spectrum",), f"a value whose {key} stays finite")
    return light.model_copy(update={key: tuple(float(value) for value in bands)})


def _plain(light: Strength, key: str, units: Units) -> Floats:
    value: Any = getattr(light, key)
    if not _is_luminous(key):
        return np.array(value) / _beam(light, key)
    try:
        weight = sum(weights_of(units.k_m, units.bands)) if units.bands is not None else units.k_m
    except SpectraMissing as failed:
        raise CannotResolve((key,), "no luminous quantity", f" ({failed})") from None
    if weight == 0:
        raise CannotResolve((key,), "a radiometric quantity", " (nothing is seen in any of the scene's intervals)")
    return np.full(3, value / _beam(light, key) / weight)


def _of_spectrum(light: Strength, spectrum: Spectrum, key: str | None, units: Units) -> Floats:
    try:
        density = density_of(spectrum)
        bands = _bands(spectrum, units.bands)
    except SpectraMissing as failed:
        raise CannotResolve(("spectrum",), "bands", f" ({failed})") from None
    except KeyError:
        raise CannotResolve(("spectrum", "illuminant"), *_known(str(spectrum.illuminant))) from None
    scale = _scale(light, spectrum, density, key, units)
    if (bands < -ROUNDING * bands.max()).any():
        names = [name for name, value in zip("RGB", bands, strict=True) if value < -ROUNDING * bands.max()]
        raise CannotResolve(
            ("spectrum",),
            "one inside the colours of Rec.709",
            f" (band {' and '.join(names)} would be negative; intervals of wavelengths can hold it: bands: {{intervals_nm: …}})",
        )
    return np.maximum(bands, 0.0) * scale


def _scale(light: Strength, spectrum: Spectrum, density: Density, key: str | None, units: Units) -> float:
    """What the density is multiplied by."""
    if key is None and spectrum.total is None:
        if (
            isinstance(density, Line)
            or spectrum.illuminant
            or (isinstance(density, Blackbody) and not isinstance(light, Emitter))
        ):
            others = ", ".join(strengths(type(light))[1:])
            raise CannotResolve(("spectrum",), f"total in it, or beside it one of {others}", " (by itself it is relative)")
        return 1.0
    luminous = key is not None and _is_luminous(key)
    own = units.k_m * float(_xyz(spectrum)[1]) if luminous else density.total()
    if own <= 0:
        seen = "one that is seen: V(λ) is 0 over all of it" if luminous else "one that is not 0 everywhere"
        raise CannotResolve(("spectrum",), seen)
    if key is None:
        assert spectrum.total is not None
        return spectrum.total / own
    value: Any = getattr(light, key)
    return float((value if luminous else value[0]) / _beam(light, key) / own)


@cache
def _xyz(spectrum: Spectrum) -> Floats:
    return density_of(spectrum).xyz()


@cache
def _bands(spectrum: Spectrum, bands: BandIntervals | None) -> Floats:
    """(3,): of the density as it is, before any scale."""
    if bands is None:
        return np.asarray(np.linalg.solve(REC709_TO_XYZ, _xyz(spectrum)), dtype=np.float64)
    density = density_of(spectrum)
    return np.array([density.over(interval) for interval in bands.intervals_nm])


def _known(name: str) -> tuple[str, str]:
    names = list(illuminant_names())
    return "the name of a CIE illuminant", hint(name, names, otherwise=f": {', '.join(names)}")


def _is_luminous(key: str) -> bool:
    return key in ("luminous_flux", *LUMINOUS.values())


def _beam(light: Strength, key: str) -> float:
    """What a strength is divided by to get the light's bands, or their luminous counterpart."""
    if key not in ("flux", "luminous_flux"):
        return 1.0
    if isinstance(light, PointLight):
        return 4 * math.pi
    if isinstance(light, SpotLight):
        return beam_of_spot(math.radians(light.cone_half_angle_deg), light.exponent)
    return math.pi * _area(light)


def _area(light: Strength) -> float:
    """Of the side that shines, m²."""
    if isinstance(light, SphereEmitter):
        return 4 * math.pi * light.radius**2
    if isinstance(light, DiscEmitter):
        return math.pi * light.radius**2
    assert isinstance(light, RectangleEmitter), light.__class__
    return math.hypot(*light.edge_u) * math.hypot(*light.edge_v)


# --- what was written -------------------------------------------------------------------------------------------------


def written(light: Strength) -> str | None:
    """How a light's strength was given, where that is not by bands: `luminous_flux 800 lm, blackbody 2700 K`."""
    words = [f"{key} {_numbers(getattr(light, key))} {UNITS[key]}" for key in strengths(type(light))[1:] if _has(light, key)]
    if light.spectrum is not None:
        words.append(_spectrum_text(light.spectrum, UNITS[bands_key(type(light))]))
    return ", ".join(words) or None


def written_strengths(scene: Scene) -> dict[str, str]:
    """Light → how its strength was given, of those that are not given by bands."""
    texts = {name: written(light) for name, light in scene.lights.items()}
    return {name: text for name, text in texts.items() if text is not None}


def worked_out(scene: Scene) -> dict[str, dict[str, list[float]]]:
    """Light → its bands by their key, of those that are not given by bands."""
    found = {}
    for name in written_strengths(scene):
        key = bands_key(type(scene.lights[name]))
        found[name] = {key: list(getattr(scene.lights[name], key))}
    return found


def dumped_as_written(scene: Scene) -> dict[str, Any]:
    """The scene as a JSON-compatible dictionary that is a spec again, every light given by what it was given by."""
    content = scene.model_dump(mode="json", exclude_none=True)
    for name, bands in worked_out(scene).items():
        for key in bands:
            del content["lights"][name][key]
    return content


def dumped_in_bands(scene: Scene) -> dict[str, Any]:
    """The scene as a JSON-compatible dictionary that is a spec again, every light given by its bands."""
    content = scene.model_dump(mode="json", exclude_none=True)
    for light in content["lights"].values():
        for key in OTHER_THAN_BANDS:
            light.pop(key, None)
    return content


def _has(light: Strength, key: str) -> bool:
    return getattr(light, key) is not None


def _numbers(value: float | Iterable[float]) -> str:
    if isinstance(value, int | float):
        return number_text(value)
    values = tuple(value)
    return number_text(values[0]) if len(set(values)) == 1 else f"[{', '.join(map(number_text, values))}]"


def _spectrum_text(spectrum: Spectrum, unit: str) -> str:
    if spectrum.table is not None:
        first, last = spectrum.table[0][0], spectrum.table[-1][0]
        text = f"table of {len(spectrum.table)} samples from {number_text(first)} to {number_text(last)} nm"
    elif spectrum.blackbody is not None:
        text = f"blackbody {number_text(spectrum.blackbody)} K"
    elif spectrum.illuminant is not None:
        text = f"illuminant {spectrum.illuminant}"
    else:
        assert spectrum.line_nm is not None
        text = f"line {number_text(spectrum.line_nm)} nm"
    return text if spectrum.total is None else f"{text}, total {number_text(spectrum.total)} {unit}"
