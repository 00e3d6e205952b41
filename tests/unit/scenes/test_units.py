"""Lights in candelas, lux, lumens, watts and by spectrum: what bands they become, and what of them is an error."""

from __future__ import annotations

import json
import math
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from equilux_scenes import photometry
from equilux_scenes.errors import SpecErrors
from equilux_scenes.features import RESOLVED_FEATURES
from equilux_scenes.loader import load_scene_text
from equilux_scenes.model import Scene
from equilux_scenes.photometry import K_M, REC709_TO_XYZ, luminance_weights
from equilux_scenes.spectra import Blackbody, Table
from equilux_scenes.spectral_data import illuminant, matching_functions
from equilux_scenes.units import dumped_as_written, dumped_in_bands, written_strengths

Load = Callable[..., Any]
Only = Callable[..., str]

ROUNDING = 1e-14
"""Relative: a handful of products and quotients, 2^-53 each."""

POINT = "kind: point, position: [0, 5, 0]"
SPOT = "kind: spot, position: [0, 5, 0], direction: [0, -1, 0], cone_half_angle_deg: 25, exponent: 3"
SUN = "kind: directional, direction: [0, -1, 0]"
BALL = "kind: sphere, center: [0, 5, 0], radius: 0.5"
DISC = "kind: disc, center: [0, 5, 0], normal: [0, -1, 0], radius: 0.5"
PANEL = "kind: rectangle, corner: [0, 5, 0], edge_u: [2, 0, 0], edge_v: [0, 0, 3]"
SKY = "kind: environment"
EMITTERS = (BALL, DISC, PANEL, SKY)


def spec(light: str, rest: str = "") -> str:
    model = (
        "reflection-equation"
        if light.replace("«", "").startswith(("kind: sphere", "kind: disc", "kind: rectangle", "kind: env"))
        else "phong"
    )
    return f"""\
equilux: 1
name: lit
model: {model}
camera: {{projection: orthographic, eye: [0, 0, 3], target: [0, 0, 0], height_m: 2}}
film: {{width: 4, height: 3}}
{rest}lights: {{k: {{{light}}}}}
materials: {{m: {{diffuse: 1}}}}
objects: [{{kind: sphere, center: [0, 0, 0], radius: 1, material: m}}]
"""


def bands(light: str, rest: str = "") -> tuple[float, ...]:
    """What every renderer sees of the light."""
    (case,) = load_scene_text(spec(light, rest)).cases
    found = case.scene.lights["k"]
    return next(getattr(found, key) for key in ("intensity", "irradiance", "radiance") if hasattr(found, key))


def same(got: tuple[float, ...], expected: Any) -> None:
    assert got == pytest.approx(np.broadcast_to(expected, 3), rel=ROUNDING), f"got {got}, expected {expected}"


# --- without a spectrum -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("light", "key"),
    [(POINT, "luminous_intensity"), (SPOT, "luminous_intensity"), (SUN, "illuminance"), *((e, "luminance") for e in EMITTERS)],
)
def test_a_luminous_quantity_means_equal_bands_of_a_km_th(light: str, key: str) -> None:
    same(bands(f"{light}, {key}: 100"), 100 / 683.002)
    same(bands(f"{light}, {key}: 100", "k_m: 684\n"), 100 / 684)


@pytest.mark.parametrize("k_m", [683.002, 684])
def test_equal_bands_made_from_a_luminous_quantity_have_that_quantity_again(load: Load, k_m: float) -> None:
    scene = load(spec(f"{POINT}, luminous_intensity: 100", f"k_m: {k_m}\n")).scene
    assert np.dot(luminance_weights(scene), scene.lights["k"].intensity) == pytest.approx(100, rel=ROUNDING)


def test_the_flux_of_a_point_light_is_4_pi_times_its_intensity() -> None:
    same(bands(f"{POINT}, flux: [1, 2, 3]"), np.array([1, 2, 3]) / (4 * math.pi))
    same(bands(f"{POINT}, luminous_flux: 800"), 800 / (4 * math.pi) / K_M)


@pytest.mark.parametrize(("half_angle_deg", "exponent"), [(25, 3), (90, 0), (90, 2.5), (0.01, 0), (60, 200)])
def test_the_flux_of_a_spot_light_is_its_intensity_integrated_over_the_cone(half_angle_deg: float, exponent: float) -> None:
    alpha = math.radians(half_angle_deg)
    nodes, weights = np.polynomial.legendre.leggauss(400)
    theta = alpha * (nodes + 1) / 2
    integral = float(np.sum(weights * alpha / 2 * np.cos(theta) ** exponent * 2 * math.pi * np.sin(theta)))
    light = SPOT.replace("cone_half_angle_deg: 25, exponent: 3", f"cone_half_angle_deg: {half_angle_deg}, exponent: {exponent}")
    got = bands(f"{light}, flux: 10")
    assert got == pytest.approx((10 / integral,) * 3, rel=1e-11), f"got {got}, expected {10 / integral}"


@pytest.mark.parametrize(("light", "area"), [(BALL, 4 * math.pi * 0.25), (DISC, math.pi * 0.25), (PANEL, 6.0)])
def test_the_flux_of_an_emitter_is_pi_times_its_area_times_its_radiance(light: str, area: float) -> None:
    same(bands(f"{light}, flux: 10"), 10 / (math.pi * area))
    same(bands(f"{light}, luminous_flux: 10"), 10 / (math.pi * area) / K_M)


# --- with a spectrum, in Rec.709 --------------------------------------------------------------------------------------


def luminance(values: tuple[float, ...]) -> float:
    return float(K_M * (REC709_TO_XYZ[1] @ values))


@pytest.mark.parametrize("spectrum", ["blackbody: 2700", "illuminant: D65", "illuminant: A", "table: [[400, 1], [700, 2]]"])
def test_a_coloured_light_has_the_luminous_quantity_that_it_was_given_by(spectrum: str) -> None:
    for light, key, factor in [
        (POINT, "luminous_intensity", 1.0), (POINT, "luminous_flux", 4 * math.pi), (SUN, "illuminance", 1.0),
        (PANEL, "luminance", 1.0), (PANEL, "luminous_flux", 6 * math.pi),
    ]:  # fmt: skip
        got = bands(f"{light}, {key}: 250, spectrum: {{{spectrum}}}")
        assert luminance(got) * factor == pytest.approx(250, rel=1e-13)
        assert len(set(got)) == 3, "it should be coloured"


def test_daylight_of_a_thousand_lux_is_white_and_a_lamp_is_warm() -> None:
    r, g, b = bands(f"{SUN}, illuminance: 1000, spectrum: {{illuminant: D65}}")
    assert (r, g, b) == pytest.approx((1000 / K_M,) * 3, rel=5e-4)
    r, g, b = bands(f"{SUN}, illuminance: 1000, spectrum: {{blackbody: 2700}}")
    assert r > g > b > 0


def test_an_emitter_made_of_a_blackbody_has_its_radiance() -> None:
    xyz = Blackbody(4000.0).xyz()
    got = bands(f"{BALL}, spectrum: {{blackbody: 4000}}")
    assert REC709_TO_XYZ @ got == pytest.approx(xyz, rel=1e-12)


def test_a_blackbody_emitter_given_by_its_flux_is_the_absolute_one_where_the_flux_is_sigma_t4_times_its_area() -> None:
    flux = 5.670374419e-8 * 4000**4 * 4 * math.pi * 0.25
    by_flux = bands(f"{BALL}, flux: {flux!r}, spectrum: {{blackbody: 4000}}")
    absolute = bands(f"{BALL}, spectrum: {{blackbody: 4000}}")
    assert by_flux == pytest.approx(absolute, rel=1e-9)  # σ has ten digits


def test_the_flux_of_a_spectrum_counts_all_wavelengths() -> None:
    """A lamp of 60 W at 2800 K has 15.6 lm/W, not the 683 of light that is all at 555 nm."""
    got = bands(f"{POINT}, flux: 60, spectrum: {{blackbody: 2800}}")
    lumens = 4 * math.pi * luminance(got)
    expected = 60 * K_M * Blackbody(2800.0).xyz()[1] / Blackbody(2800.0).total()
    assert lumens == pytest.approx(expected, rel=1e-13)
    assert 800 < lumens < 1000


def test_a_table_is_absolute_and_total_makes_it_relative() -> None:
    table = "table: [[400, 0.1], [700, 0.3]]"
    absolute = bands(f"{POINT}, spectrum: {{{table}}}")
    relative = bands(f"{POINT}, spectrum: {{{table}, total: 60}}")  # ∫ = 0.2 × 300
    assert relative == pytest.approx(absolute, rel=ROUNDING)
    assert bands(f"{POINT}, spectrum: {{{table}, total: 30}}") == pytest.approx(np.array(absolute) / 2, rel=ROUNDING)
    assert bands(f"{POINT}, flux: {240 * math.pi!r}, spectrum: {{{table}}}") == pytest.approx(absolute, rel=ROUNDING)
    assert K_M * (REC709_TO_XYZ[1] @ absolute) == pytest.approx(
        K_M * Table(illuminant("E")).xyz()[1] * np.interp(560, [400, 700], [0.1, 0.3]) / 100, rel=0.02
    )  # roughly: V has its middle near 560 nm


# --- with intervals ---------------------------------------------------------------------------------------------------

INTERVALS = "bands: {intervals_nm: [[600, 700], [500, 600], [400, 500]]}\n"


def test_bands_in_intervals_are_integrals_over_them() -> None:
    got = bands(f"{POINT}, spectrum: {{table: [[400, 1], [500, 1], [600, 3], [700, 3]]}}", INTERVALS)
    assert got == pytest.approx((300, 200, 100), rel=1e-12)


def test_a_line_lies_in_its_interval_whole() -> None:
    same(bands(f"{POINT}, flux: 2, spectrum: {{line_nm: 555}}", INTERVALS), np.array([0, 1, 0]) * 2 / (4 * math.pi))


def test_a_watt_at_555_nm_has_683_lumens() -> None:
    narrow = "bands: {intervals_nm: [[600, 700], [554.5, 555.5], [400, 500]]}\n"
    scene = load_scene_text(spec(f"{POINT}, flux: 1, spectrum: {{line_nm: 555}}", narrow)).scene
    intensity = scene.lights["k"].intensity  # type: ignore[union-attr]
    lumens = 4 * math.pi * np.dot(luminance_weights(scene), intensity)
    # the mean of V over the band is 0.99990 of its peak
    assert lumens == pytest.approx(683.002, rel=2e-4)
    same(bands(f"{POINT}, luminous_flux: 683.002, spectrum: {{line_nm: 555}}", narrow), np.array([0, 1, 0]) / (4 * math.pi))


def test_in_intervals_equal_bands_have_the_luminous_quantity_that_they_were_given_by() -> None:
    scene = load_scene_text(spec(f"{POINT}, luminous_intensity: 100", INTERVALS)).scene
    intensity = scene.lights["k"].intensity  # type: ignore[union-attr]
    assert len(set(intensity)) == 1
    assert np.dot(luminance_weights(scene), intensity) == pytest.approx(100, rel=ROUNDING)


def test_the_luminance_weights_of_intervals_are_km_times_the_mean_of_v() -> None:
    scene = load_scene_text(spec(f"{POINT}, intensity: 1", "bands: {intervals_nm: [[900, 950], [554, 556], [300, 360]]}\n")).scene
    r, g, b = luminance_weights(scene)
    assert (r, b) == (0.0, 0.0)
    v = np.interp([554, 555, 556], matching_functions().wavelengths_nm, matching_functions().values[:, 1])
    assert g == pytest.approx(K_M * float(v[0] + 2 * v[1] + v[2]) / 4, rel=ROUNDING)


# --- what stays visible, and what does not count ----------------------------------------------------------------------


def test_what_was_written_stays_visible() -> None:
    spectrum = "{table: [[400, 0.1], [700, 0.3]], total: 60}"
    texts = {
        f"{POINT}, luminous_flux: 800, spectrum: {{blackbody: 2700}}": "luminous_flux 800 lm, blackbody 2700 K",
        f"{POINT}, flux: [1, 2, 3]": "flux [1, 2, 3] W",
        f"{SUN}, illuminance: 1e5": "illuminance 100000 lx",
        f"{POINT}, spectrum: {spectrum}": "table of 2 samples from 400 to 700 nm, total 60 W/sr",
        f"{PANEL}, luminance: 200, spectrum: {{illuminant: D65}}": "luminance 200 cd/m², illuminant D65",
    }
    for light, expected in texts.items():
        assert written_strengths(load_scene_text(spec(light)).scene) == {"k": expected}
    assert written_strengths(load_scene_text(spec(f"{POINT}, intensity: 1")).scene) == {}


ALL = [
    f"{POINT}, luminous_flux: 800, spectrum: {{blackbody: 2700}}",
    f"{SPOT}, flux: 3",
    f"{SUN}, spectrum: {{illuminant: D65, total: 3}}",
    f"{PANEL}, luminance: 200",
    f"{SKY}, spectrum: {{blackbody: 5000}}",
]


@pytest.mark.parametrize("light", ALL)
def test_the_units_of_a_light_do_not_enter_the_canonical_form(light: str) -> None:
    (case,) = load_scene_text(spec(light)).cases
    kind = light.split(", ")[0]
    key = {"kind: directional": "irradiance", "kind: point": "intensity", "kind: spot": "intensity"}.get(kind, "radiance")
    geometry = light
    for word in (", luminous_flux", ", flux", ", luminance", ", spectrum"):
        geometry = geometry.split(word)[0]
    (by_bands,) = load_scene_text(spec(f"{geometry}, {key}: {list(bands(light))}", "k_m: 684\n")).cases
    assert case.canonical() == by_bands.canonical()


@pytest.mark.parametrize("light", ALL)
def test_a_scene_in_units_survives_pickling_and_pydantic(light: str) -> None:
    (case,) = load_scene_text(spec(light)).cases
    assert pickle.loads(pickle.dumps(case)).canonical() == case.canonical()
    assert Scene.model_validate(case.scene.model_dump()) == case.scene


@pytest.mark.parametrize("light", ALL)
def test_the_scene_in_bands_and_as_written_is_a_spec_of_the_same_picture(light: str) -> None:
    (case,) = load_scene_text(spec(light)).cases
    (again,) = load_scene_text(json.dumps(dumped_in_bands(case.scene))).cases  # JSON is YAML
    assert again.canonical() == case.canonical()
    assert again.scene.lights["k"].spectrum is None
    (written,) = load_scene_text(json.dumps(dumped_as_written(case.scene))).cases
    assert written.scene == case.scene


def test_units_are_features_that_no_renderer_must_have() -> None:
    (case,) = load_scene_text(spec(f"{POINT}, luminous_flux: 8, spectrum: {{line_nm: 555}}", INTERVALS)).cases
    assert set(RESOLVED_FEATURES) == {"input.flux", "input.photometric", "input.spectrum", "bands.intervals"}
    assert set(RESOLVED_FEATURES) <= set(case.requires)
    assert not set(RESOLVED_FEATURES) & set(case.demands)
    (case,) = load_scene_text(spec(f"{POINT}, flux: 8")).cases
    assert set(RESOLVED_FEATURES) & set(case.requires) == {"input.flux"}
    (case,) = load_scene_text(spec(f"{POINT}, intensity: 8", "k_m: 684\n")).cases
    assert not set(RESOLVED_FEATURES) & set(case.requires)


# --- sweeps -----------------------------------------------------------------------------------------------------------


def test_a_luminous_intensity_can_be_swept() -> None:
    sweep = "sweep: {i: {path: lights.k.luminous_intensity, values: [1, 10]}}\n"
    one, ten = load_scene_text(spec(f"{POINT}, luminous_intensity: 5", sweep)).cases
    same(one.scene.lights["k"].intensity, 1 / K_M)  # type: ignore[union-attr]
    same(ten.scene.lights["k"].intensity, 10 / K_M)  # type: ignore[union-attr]


def test_a_temperature_can_be_swept() -> None:
    sweep = "sweep: {t: {path: lights.k.spectrum.blackbody, values: [2700, 10000]}}\n"
    light = f"{POINT}, luminous_intensity: 5, spectrum: {{blackbody: 4000}}"
    warm, cold = (case.scene.lights["k"].intensity for case in load_scene_text(spec(light, sweep)).cases)  # type: ignore[union-attr]
    assert warm[0] / warm[2] > 5 > 1 > cold[0] / cold[2], (warm, cold)


def test_k_m_can_be_swept_and_decides_for_every_case_anew() -> None:
    sweep = "sweep: {k: {path: k_m, values: [683.002, 684]}}\n"
    si, lecture = load_scene_text(spec(f"{POINT}, luminous_intensity: 5", sweep)).cases
    same(si.scene.lights["k"].intensity, 5 / 683.002)  # type: ignore[union-attr]
    same(lecture.scene.lights["k"].intensity, 5 / 684)  # type: ignore[union-attr]
    assert photometry.k_m_text(lecture.scene) == "684 lm/W, the lecture's, 0.146 % above the SI's 683.002"
    assert round((684 / 683.002 - 1) * 100, 3) == 0.146


# --- errors -----------------------------------------------------------------------------------------------------------

ERRORS = {
    "two strengths": (
        f"{POINT}, intensity: 1, luminous_intensity: «5",
        "luminous_intensity of light 'k': got 5, allowed one strength, and intensity is given",
    ),
    "two fluxes": (
        f"{POINT}, flux: 1, luminous_flux: «5",
        "luminous_flux of light 'k': got 5, allowed one strength, and flux is given",
    ),
    "bands and a spectrum": (
        f"{SUN}, irradiance: 1, spectrum: «{{blackbody: 5000}}",
        "spectrum of light 'k': got {blackbody: 5000}, allowed one strength, and irradiance is given",
    ),
    "a spectrum and bands": (
        f"{SUN}, spectrum: {{blackbody: 5000}}, irradiance: «1",
        "irradiance of light 'k': got 1, allowed one strength, and spectrum is given",
    ),
    "a total and a flux": (
        f"{POINT}, flux: 5, spectrum: {{blackbody: 5000, total: «1}}",
        "total of spectrum of light 'k': got 1, allowed one strength, and flux is given",
    ),
    "three fluxes of a spectrum": (
        f"{POINT}, flux: «[1, 2, 3], spectrum: {{blackbody: 5000}}",
        "flux of light 'k': got [1, 2, 3], allowed one number (the spectrum makes the bands)",
    ),
    "no strength": (
        f"«{POINT}",
        "missing key 'intensity' in light 'k', allowed one number ≥ 0 or three "
        "(or one of luminous_intensity, flux, luminous_flux, spectrum)",
    ),
    "three candelas": (
        f"{POINT}, luminous_intensity: «[1, 1, 1]",
        "luminous_intensity of light 'k': got [1, 1, 1], allowed a number ≥ 0",
    ),
    "negative lumens": (f"{POINT}, luminous_flux: «-1", "luminous_flux of light 'k': got -1, allowed a number ≥ 0"),
    "candelas of the sun": (
        f"{SUN}, irradiance: 1, «luminous_intensity: 1",
        "unknown key 'luminous_intensity' in light 'k', "
        "allowed spectrum, ambient, diffuse, specular, kind, direction, irradiance, illuminance",
    ),
    "relative blackbody": (
        f"{POINT}, spectrum: «{{blackbody: 3000}}",
        "spectrum of light 'k': got {blackbody: 3000}, "
        "allowed total in it, or beside it one of luminous_intensity, flux, luminous_flux (by itself it is relative)",
    ),
    "relative illuminant": (
        f"{SKY}, spectrum: «{{illuminant: D65}}",
        "spectrum of light 'k': got {illuminant: 'D65'}, "
        "allowed total in it, or beside it one of luminance (by itself it is relative)",
    ),
    "relative line": (
        f"{SKY}, spectrum: «{{line_nm: 555}}",
        "spectrum of light 'k': got {line_nm: 555}, "
        "allowed total in it, or beside it one of luminance (by itself it is relative)",
    ),
    "unknown illuminant": (
        f"{SUN}, spectrum: {{illuminant: «d65, total: 1}}",
        "illuminant of spectrum of light 'k': got 'd65', allowed the name of a CIE illuminant (did you mean 'D65'?)",
    ),
    "two spectra": (
        f"{SUN}, spectrum: «{{illuminant: D65, blackbody: 3000, total: 1}}",
        "spectrum of light 'k': got {illuminant: 'D65', blackbody: 3000, total: 1}, "
        "allowed exactly one of table, blackbody, illuminant, line_nm",
    ),
    "no spectrum": (
        f"{SUN}, spectrum: «{{total: 1}}",
        "spectrum of light 'k': got {total: 1}, allowed exactly one of table, blackbody, illuminant, line_nm",
    ),
    "cold": (
        f"{SUN}, spectrum: {{blackbody: «0, total: 1}}",
        "blackbody of spectrum of light 'k': got 0, allowed a temperature of 1 to 1e9 K",
    ),
    "one sample": (
        f"{SUN}, spectrum: {{table: «[[400, 1]]}}",
        "table of spectrum of light 'k': got [[400, 1]], "
        "allowed a list of at least two pairs [nm, value ≥ 0], the wavelengths ascending",
    ),
    "descending": (
        f"{SUN}, spectrum: {{table: «[[500, 1], [400, 1]]}}",
        "table of spectrum of light 'k': got [[500, 1], [400, 1]], "
        "allowed a list of at least two pairs [nm, value ≥ 0], the wavelengths ascending",
    ),
    "negative sample": (
        f"{SUN}, spectrum: {{table: [[400, 1], [500, «-1]]}}",
        "table[1][1] of spectrum of light 'k': got -1, allowed a wavelength of 0.001 to 1e9 nm, then a value ≥ 0",
    ),
    "wavelength 0": (
        f"{SUN}, spectrum: {{table: [[«0, 1], [500, 1]]}}",
        "table[0][0] of spectrum of light 'k': got 0, allowed a wavelength of 0.001 to 1e9 nm, then a value ≥ 0",
    ),
    "sample of three": (
        f"{SUN}, spectrum: {{table: [[400, 1], «[500, 1, 1]]}}",
        "table[1] of spectrum of light 'k': got [500, 1, 1], allowed a pair [nm, value ≥ 0]",
    ),
    "black table": (
        f"{SUN}, spectrum: «{{table: [[400, 0], [500, 0]], total: 1}}",
        "spectrum of light 'k': got {table: [[400, 0], [500, 0]], total: 1}, allowed one that is not 0 everywhere",
    ),
    "unseen lumens": (
        f"{SUN}, illuminance: 1, spectrum: «{{table: [[900, 1], [950, 1]]}}",
        "spectrum of light 'k': got {table: [[900, 1], [950, 1]]}, allowed one that is seen: V(λ) is 0 over all of it",
    ),
    "overflow": (
        BALL.replace("radius: 0.5", "radius: 1e-10") + ", flux: «1e300",
        "flux of light 'k': got 1e300, allowed a value whose radiance stays finite",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", ERRORS)
def test_a_light_that_contradicts_itself_is_an_error_at_the_value(only_error: Only, name: str) -> None:
    light, message = ERRORS[name]
    text = spec(light.replace("«", ""))
    at = text.index(light.replace("«", "")) + light.index("«")
    if light.startswith("«"):
        at -= 1  # the light's brace
    assert only_error(text[:at] + "«" + text[at:]) == message


@pytest.mark.parametrize(("spectrum", "negative"), [("line_nm: 520", "R"), ("blackbody: 1000", "B"), ("line_nm: 460", "G")])
def test_a_colour_outside_rec_709_is_an_error_that_names_the_alternative(only_error: Only, spectrum: str, negative: str) -> None:
    message = only_error(spec(f"{SUN}, spectrum: «{{{spectrum}, total: 1}}"))
    assert message.startswith(
        f"spectrum of light 'k': got {{{spectrum}, total: 1}}, allowed one inside the colours of Rec.709 (band "
    )
    assert negative in message.split("would be negative")[0].split("band ")[1], message
    assert "intervals of wavelengths can hold it: bands: {intervals_nm: …}" in message
    bands(f"{SUN}, spectrum: {{{spectrum}, total: 1}}", INTERVALS)


BANDS_ERRORS = {
    "empty interval": (
        "bands: {intervals_nm: [[600, 700], [500, «500], [400, 450]]}",
        "intervals_nm[1][1] of bands: got 500, allowed a wavelength > 500, which the interval starts at",
    ),
    "overlap": (
        "bands: {intervals_nm: [[600, 700], [500, 600], «[599, 601]]}",
        "intervals_nm[2] of bands: got [599, 601], allowed an interval that does not overlap interval 0",
    ),
    "two intervals": (
        "bands: {intervals_nm: «[[600, 700], [500, 600]]}",
        "intervals_nm of bands: got [[600, 700], [500, 600]], allowed three intervals [from, to] in nm",
    ),
    "word": ("bands: «rec709", "bands: got 'rec709', allowed a mapping"),
    "k_m": ("k_m: «683", "k_m of the scene: got 683, allowed 683.002 (the SI's) or 684 (the lecture's)"),
}


@pytest.mark.parametrize("name", BANDS_ERRORS)
def test_wrong_bands_are_errors_at_their_value(only_error: Only, name: str) -> None:
    rest, message = BANDS_ERRORS[name]
    if name == "overlap":
        rest = rest.replace("[500, 600], «", "[400, 500], «").replace("601]", "601]")
    assert only_error(spec(f"{POINT}, intensity: 1", rest + "\n")) == message


def test_lumens_where_nothing_is_seen_in_any_interval_are_an_error(only_error: Only) -> None:
    unseen = "bands: {intervals_nm: [[900, 950], [1000, 1100], [100, 200]]}\n"
    message = only_error(spec(f"{POINT}, luminous_flux: «1", unseen))
    assert message == (
        "luminous_flux of light 'k': got 1, allowed a radiometric quantity (nothing is seen in any of the scene's intervals)"
    )


HUGE = [
    "flux: 1e308, spectrum: {blackbody: 3000}",
    "spectrum: {blackbody: 1, total: 1}",
    "spectrum: {blackbody: 1e9, total: 1e308}",
    "spectrum: {table: [[0.001, 1e308], [1e9, 1e308]]}",
    "spectrum: {table: [[400, 5e-324], [700, 5e-324]], total: 3}",
    "luminous_flux: 5e-324",
    "spectrum: {line_nm: 1e9, total: 1}",
]


@pytest.mark.parametrize("strength", HUGE)
@pytest.mark.parametrize("rest", ["", "bands: {intervals_nm: [[0.001, 0.002], [500, 600], [1e8, 1e9]]}\n"])
@pytest.mark.filterwarnings("error")
def test_extreme_values_make_finite_bands_or_located_errors(strength: str, rest: str) -> None:
    try:
        assert all(math.isfinite(band) and band >= 0 for band in bands(f"{POINT}, {strength}", rest))
    except SpecErrors as failed:
        (error,) = failed.errors
        assert "stays finite" in error.message


def test_wrong_units_do_not_hide_other_errors(errors_of: Callable[..., list[Any]]) -> None:
    text = spec(f"{SUN}, spectrum: {{line_nm: 520, total: 1}}").replace("radius: 1", "radius: -1").replace("width: 4", "width: 0")
    assert len(errors_of(text)) == 3
