"""Spectral integrals against closed forms and against plain sums, each claim with both numbers."""

from __future__ import annotations

import math
import subprocess
import sys
import time

import numpy as np
import pytest

from equilux_scenes import photometry, spectra, spectral_data
from equilux_scenes.model import Spectrum
from equilux_scenes.spectra import Blackbody, Line, Table, density_of, luminosity_over
from equilux_scenes.spectral_data import Sampled, illuminant, illuminant_names, matching_functions

ROUNDING = 1e-12
"""Relative: the sums have some thousand terms of one sign, 2^-53 each, and Gauss points of relative 1e-15."""


def test_nearly_all_of_a_blackbody_lies_in_a_wide_interval() -> None:
    """1 to 1e9 nm: x = hc/λkT runs from 5000 to 5e-6; below it, 5x³/π⁴ = 6e-18 of the whole is left."""
    body = Blackbody(2856.0)
    assert body.over((1.0, 1e9)) == pytest.approx(body.total(), rel=1e-12)


@pytest.mark.parametrize("temperature_k", [300.0, 1000.0, 2856.0, 5772.0, 20000.0])
def test_the_integral_of_plancks_law_over_all_wavelengths_is_sigma_t4_over_pi(temperature_k: float) -> None:
    body = Blackbody(temperature_k)
    # in u = hc/λkT, where the integrand x³/(e^x − 1) is smooth; cut where e^-x < 1e-20 and x³ < 1e-21
    u = np.linspace(1e-7, 60, 2_000_001)
    scale = spectra.PLANCK * spectra.LIGHT_SPEED / (spectra.BOLTZMANN * temperature_k)
    nm = scale / u * 1e9
    integral = float(np.trapezoid(body.at(nm) * nm / u, u))
    assert integral == pytest.approx(body.total(), rel=1e-10)  # trapezoid, h = 3e-5: h²/12 × (f'(0) = 0.15) < 1e-10
    assert body.total() == pytest.approx(5.670374419e-8 * temperature_k**4 / math.pi, rel=1e-9)  # σ as CODATA prints it


def test_the_bands_of_a_blackbody_do_not_change_when_the_cells_are_halved(monkeypatch: pytest.MonkeyPatch) -> None:
    for temperature_k in (1000.0, 2000.0, 6500.0):
        body = Blackbody(temperature_k)
        coarse = (body.over((400.0, 700.0)), *body.xyz())
        with monkeypatch.context() as patched:
            patched.setattr(spectra, "_CELL", spectra._CELL / 2)
            fine = (body.over((400.0, 700.0)), *body.xyz())
        assert coarse == pytest.approx(fine, rel=ROUNDING)


def test_wiens_displacement_law_holds() -> None:
    nm = np.linspace(400, 700, 300_001)
    peak = float(nm[np.argmax(Blackbody(5772.0).at(nm))])
    assert peak == pytest.approx(2.897771955e6 / 5772, abs=0.001)


def test_a_table_is_integrated_exactly_between_its_samples() -> None:
    triangle = Table(Sampled(np.array([500.0, 520.0, 530.0]), np.array([0.0, 4.0, 0.0])))
    assert triangle.total() == 60.0
    assert triangle.over((490.0, 540.0)) == pytest.approx(60.0, rel=ROUNDING)
    assert triangle.over((500.0, 510.0)) == pytest.approx(10.0, rel=ROUNDING)
    assert triangle.over((515.5, 515.75)) == pytest.approx(0.25 * 0.2 * 15.625, rel=ROUNDING)
    assert triangle.over((540.0, 600.0)) == 0.0


def test_two_intervals_side_by_side_hold_what_both_together_hold() -> None:
    for density in (Blackbody(3000.0), Table(illuminant("D65"))):
        parts = density.over((400.0, 512.3)) + density.over((512.3, 700.0))
        assert parts == pytest.approx(density.over((400.0, 700.0)), rel=ROUNDING)


def test_a_table_at_the_functions_own_samples_gives_their_product_rule() -> None:
    """∫ of two functions linear on one cell: h/6 (2 a₀b₀ + a₀b₁ + a₁b₀ + 2 a₁b₁), summed by hand."""
    functions = matching_functions()
    nm, y = functions.wavelengths_nm, functions.values[:, 1]
    values = 1.0 + np.sin(nm / 20)
    a0, a1, b0, b1 = values[:-1], values[1:], y[:-1], y[1:]
    expected = float(np.sum(2 * a0 * b0 + a0 * b1 + a1 * b0 + 2 * a1 * b1) / 6)
    assert Table(Sampled(nm, values)).xyz()[1] == pytest.approx(expected, rel=ROUNDING)


def test_v_is_1_at_555_nm_and_0_outside_the_table() -> None:
    assert Line(555.0).xyz()[1] == 1.0
    assert photometry.K_M * Line(555.0).xyz()[1] == 683.002
    assert list(Line(300.0).xyz()) == [0.0, 0.0, 0.0]


def test_540_thz_has_683_lumens_per_watt() -> None:
    """The definition of the candela: exactly 683 lm/W at 540 THz, 555.016 nm in air of index 1.00028."""
    in_air_nm = spectra.LIGHT_SPEED / 540e12 / 1.00028 * 1e9
    assert in_air_nm == pytest.approx(555.016, abs=0.001)
    # K_m is rounded to 683.002, and V is linear between 555 and 556 nm instead of flat at its peak
    assert photometry.K_M * Line(in_air_nm).xyz()[1] == pytest.approx(683.0, rel=1e-6)


def test_a_flat_spectrum_over_an_interval_has_its_mean_v() -> None:
    low, high = 540.0, 560.0
    flat = Table(Sampled(np.array([low, high]), np.array([1.0, 1.0])))
    assert flat.xyz()[1] == pytest.approx(luminosity_over((low, high)), rel=ROUNDING)


def test_daylight_is_white() -> None:
    """R = G = B for D65 within what the four digits of Rec.709's white, x = 0.3127 and y = 0.3290, leave open."""
    xyz = density_of(Spectrum(illuminant="D65")).xyz()
    x, y, _ = xyz / xyz.sum()
    assert (x, y) == pytest.approx((0.3127, 0.3290), abs=5e-5)
    rgb = np.linalg.solve(photometry.REC709_TO_XYZ, xyz / xyz[1])
    whites = [(0.3127 + dx, 0.3290 + dy) for dx in (-5e-5, 5e-5) for dy in (-5e-5, 5e-5)]
    off = [np.linalg.solve(photometry.REC709_TO_XYZ, (x / y, 1, (1 - x - y) / y)) - 1 for x, y in whites]
    bound = np.abs(off).max()
    assert 2e-4 < bound < 2e-3
    assert np.abs(rgb - 1).max() <= bound, f"got {rgb}, allowed 1 ± {bound}"


def test_illuminant_a_is_a_blackbody_of_2856_k() -> None:
    """CIE 15 defines A by Planck's law at 2848 K with c₂ = 1.435e-2, which is 2855.5 K with today's c₂."""
    c2 = spectra.PLANCK * spectra.LIGHT_SPEED / spectra.BOLTZMANN
    a = Table(illuminant("A"))
    body = Blackbody(2848 * c2 / 1.435e-2)
    ratio = a.at(np.array([400.0, 560.0, 700.0])) / body.at(np.array([400.0, 560.0, 700.0]))
    assert ratio / ratio[1] == pytest.approx([1, 1, 1], rel=1e-5)  # A is printed to six digits


def test_the_luminous_efficacy_of_a_blackbody_has_its_known_peak() -> None:
    """K = K_m ∫V M / ∫M is 95 lm/W at its largest, near 6600 K (CIE 15; any textbook of lighting)."""
    efficacy = {t: photometry.K_M * Blackbody(t).xyz()[1] / Blackbody(t).total() for t in (2800.0, 5000.0, 6600.0, 8000.0)}
    assert max(efficacy, key=lambda t: efficacy[t]) == 6600.0
    assert efficacy[6600.0] == pytest.approx(95.5, abs=1.0)
    assert efficacy[2800.0] == pytest.approx(15.5, abs=1.0)


def test_the_names_of_illuminants_are_those_of_the_cie() -> None:
    assert {"A", "D50", "D65", "E", "FL1", "LED-B1"} <= set(illuminant_names())


# --- loaded only when needed ------------------------------------------------------------------------------------------

SCENE = """\
equilux: 1
name: s
model: phong
camera: {projection: orthographic, eye: [0, 0, 3], target: [0, 0, 0], height_m: 2}
film: {width: 4, height: 3}
lights: {k: {kind: point, position: [0, 0, 5], %s}}
materials: {m: {diffuse: 1}}
objects: [{kind: sphere, center: [0, 0, 0], radius: 1, material: m}]
"""


@pytest.mark.parametrize(
    ("strength", "loaded"),
    [
        ("intensity: 1", False),
        ("luminous_flux: 800", False),
        ("spectrum: {table: [[400, 0.1], [700, 0.1]]}", True),
    ],
)
def test_colour_science_is_loaded_only_for_a_spectrum_and_without_a_word(strength: str, loaded: bool) -> None:
    program = (
        "import sys; from equilux_scenes.loader import load_scene_text; load_scene_text(sys.argv[1]); "
        "print('colour' in sys.modules, 'matplotlib' in sys.modules)"
    )
    begun = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-c", program, SCENE % strength], capture_output=True, text=True, check=True, timeout=120
    )
    assert done.stdout.split()[0] == str(loaded), f"after {time.perf_counter() - begun:.1f} s"
    assert done.stderr == ""


def test_the_plots_of_colour_science_are_loaded_when_they_are_used() -> None:
    program = (
        "import sys; from equilux_scenes.spectral_data import matching_functions; matching_functions(); "
        "import colour; print('matplotlib' in sys.modules); colour.plotting.plot_single_sd; print('matplotlib' in sys.modules); "
        "from colour.plotting import plot_single_sd; print(colour.plotting.__file__.endswith('__init__.py'))"
    )
    done = subprocess.run([sys.executable, "-W", "ignore", "-c", program], capture_output=True, text=True, timeout=120)
    assert done.stdout.split() == ["False", "True", "True"], done.stderr


def test_a_spectrum_without_colour_science_is_an_error_that_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, only_error: object
) -> None:
    for cached in (spectral_data._colorimetry, spectral_data.matching_functions):
        cached.cache_clear()
    monkeypatch.setitem(sys.modules, "colour.colorimetry", None)
    from equilux_scenes import units

    units._xyz.cache_clear()
    units._bands.cache_clear()
    try:
        message = only_error(SCENE % "spectrum: «{blackbody: 3000.5, total: 1}")  # type: ignore[operator]
    finally:
        spectral_data._colorimetry.cache_clear()
    assert message == (
        "spectrum of light 'k': got {blackbody: 3000.5, total: 1}, allowed bands "
        "(spectra need colour-science: pip install 'equilux[spectra]')"
    )
