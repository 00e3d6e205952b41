"""Rules of how a value is written down, against NumPy done to the true picture."""

from __future__ import annotations

import math

import numpy as np
import pytest

from equilux_tracer.causes import RULES, Applied, is_neutral
from support.cause_scenes import SPEC, lopsided
from support.faulty import assert_same, estimated, evidence_of, picture, tried, with_cause

CASE = lopsided()
TRUE = picture(CASE)


def best_of(cause, reading, shown, case=CASE):
    """The first estimate of the hypothesis with this reading."""
    return RULES[cause].estimates(Applied(cause, None, reading), evidence_of(case, shown))[0]


def test_a_power_law_encodes_every_band():
    assert_same(with_cause(CASE, "gamma-encoded", "2.2"), TRUE ** (1 / 2.2))
    assert_same(with_cause(CASE, "gamma-encoded", "1.8", "decoded"), TRUE**1.8)
    assert_same(with_cause(CASE, "gamma-encoded", "2.4", "clipped"), np.minimum(TRUE, 1) ** (1 / 2.4))
    assert TRUE.max() > 1, "nothing in the scene is clipped"


def test_srgb_is_linear_below_its_toe_and_a_power_above():
    expected = np.where(TRUE <= 0.0031308, 12.92 * TRUE, 1.055 * TRUE ** (1 / 2.4) - 0.055)
    assert_same(with_cause(CASE, "gamma-encoded", "srgb"), expected)
    assert_same(with_cause(CASE, "gamma-encoded", "rec709"), np.where(TRUE < 0.018, 4.5 * TRUE, 1.099 * TRUE**0.45 - 0.099))


@pytest.mark.parametrize("curve", ["srgb", "2.2", "1.8", "2.4", "rec709"])
@pytest.mark.parametrize("reading", ["", "clipped", "decoded"])
def test_the_curve_is_found_by_its_name(curve, reading):
    assert best_of("gamma-encoded", reading, with_cause(CASE, "gamma-encoded", curve, reading)).parameter == curve


def test_an_unusual_power_is_found_to_nine_digits():
    found = float(best_of("gamma-encoded", "", TRUE ** (1 / 1.37)).parameter)
    assert found == pytest.approx(1.37, rel=1e-9)


def test_clamping_limits_bands_the_largest_band_or_luminance():
    assert_same(with_cause(CASE, "clamped", 0.5), np.minimum(TRUE, 0.5))
    assert_same(with_cause(CASE, "clamped", 0.3, "from below"), np.maximum(TRUE, 0.3))
    largest = TRUE.max(axis=2, keepdims=True)
    assert_same(with_cause(CASE, "clamped", 0.5, "by the largest band"), TRUE * np.minimum(0.5 / largest, 1))
    luminance = (TRUE @ [0.2126, 0.7152, 0.0722])[..., None]
    assert_same(with_cause(CASE, "clamped", 0.5, "by luminance"), TRUE * np.minimum(0.5 / luminance, 1))


@pytest.mark.parametrize("reading", ["", "from below", "by the largest band", "by luminance"])
def test_the_limit_is_read_off_the_picture(reading):
    assert estimated(CASE, "clamped", 0.25, reading)[0] == pytest.approx(0.25, rel=1e-9)


def test_a_picture_as_bright_as_the_model_is_not_clamped():
    assert RULES["clamped"].estimates(Applied("clamped"), evidence_of(CASE, 2 * TRUE)) == []


HEX = 2.0**8 - 1


@pytest.mark.parametrize(
    ("reading", "formula"),
    [
        ("", lambda v: np.rint(np.minimum(v, 1) * HEX) / HEX),
        ("unclipped", lambda v: np.rint(v * HEX) / HEX),
        ("floor", lambda v: np.floor(np.minimum(v, 1) * HEX) / HEX),
        ("equal steps", lambda v: np.minimum(np.floor(v * 256), 255) / HEX),
        ("power of two", lambda v: np.rint(v * 256) / 256),
        ("middle of steps", lambda v: np.minimum((np.floor(np.minimum(v, 1) * 256) + 0.5) / 256, 1)),
        ("encoded by 2.2", lambda v: (np.rint(np.minimum(v, 1) ** (1 / 2.2) * HEX) / HEX) ** 2.2),
    ],
)
def test_eight_bits_are_recognised_however_they_are_rounded(reading, formula):
    shown = formula(TRUE)
    assert_same(with_cause(CASE, "quantised", 8, reading), shown)
    found = best_of("quantised", "", shown)
    assert (found.parameter, found.reading) == (8, reading)


@pytest.mark.parametrize("bits", [1, 4, 5, 10, 12, 16])
def test_any_number_of_bits_is_found(bits):
    assert estimated(CASE, "quantised", bits)[0] == bits


def test_half_floats_and_other_short_mantissas_are_recognised():
    found = best_of("quantised", "", TRUE.astype(np.float16).astype(np.float64))
    assert (found.parameter, found.reading) == (16, "half float")
    mantissa, exponent = np.frexp(TRUE)
    found = best_of("quantised", "", np.ldexp(np.rint(mantissa * 256) / 256, exponent))
    assert (found.parameter, found.reading) == (8, "significant")


def test_bits_of_the_pictures_own_range_come_with_its_largest_value():
    top = float(TRUE.max())
    found = best_of("quantised", "", np.rint(TRUE / top * HEX) / HEX * top)
    assert found.reading == "of the range"
    assert found.parameter == (8, pytest.approx(top, rel=1e-12))


def test_bgr_is_the_picture_whose_first_band_is_blue():
    assert_same(with_cause(CASE, "bands-swapped", "bgr"), TRUE[..., ::-1])
    assert_same(with_cause(CASE, "bands-swapped", "gbr"), TRUE[..., [1, 2, 0]])


def test_bands_of_materials_alone_are_those_of_a_scene_with_other_materials():
    materials = {
        "clay": {key: value[::-1] if isinstance(value, list) else value for key, value in SPEC["materials"]["clay"].items()}
    }
    assert_same(with_cause(CASE, "bands-swapped", "bgr", "materials"), picture(lopsided(materials=materials)))
    lights = {"key": {**SPEC["lights"]["key"], "intensity": [18, 16, 14]}}
    other = lopsided(lights=lights, ambient=SPEC["ambient"][::-1], background=SPEC["background"][::-1])
    assert_same(with_cause(CASE, "bands-swapped", "bgr", "lights"), picture(other))


def test_orders_of_equal_bands_are_not_tried():
    grey = lopsided(
        ambient=0.1, background=0, lights={"key": {**SPEC["lights"]["key"], "intensity": 7}}, materials={"clay": {"diffuse": 0.5}}
    )
    assert tried(grey, "bands-swapped") == []
    of_materials_only = lopsided(ambient=0, background=0, lights=grey.scene.model_dump(exclude_none=True)["lights"])
    assert {reading for _, reading in tried(of_materials_only, "bands-swapped")} == {""}


@pytest.mark.parametrize("k", [math.pi, 1 / math.pi, 4 * math.pi, 683.002, 255 / 256])
def test_a_factor_is_found_to_nine_digits(k):
    assert estimated(CASE, "scaled", k)[0] == pytest.approx(k, rel=1e-9)


@pytest.mark.parametrize("reading", ["lights", "diffuse", "highlight", "surfaces"])
def test_a_factor_of_one_part_is_that_of_the_scene_with_other_numbers(reading):
    k = 1 / math.pi
    clay = dict(SPEC["materials"]["clay"])
    for key in {"diffuse": ["diffuse"], "highlight": ["specular"], "surfaces": ["diffuse", "specular"]}.get(reading, []):
        clay[key] = [k * value for value in clay[key]]
    lights = (
        {"key": {**SPEC["lights"]["key"], "intensity": [k * value for value in (14, 16, 18)]}}
        if reading == "lights"
        else SPEC["lights"]
    )
    shown = picture(lopsided(materials={"clay": clay}, lights=lights))
    assert_same(with_cause(CASE, "scaled", k, reading), shown)
    assert best_of("scaled", reading, shown).parameter == pytest.approx(k, rel=1e-9)


def test_each_band_may_have_its_own_factor():
    factors = (1.0, 0.5, 2.0)
    assert_same(with_cause(CASE, "scaled", factors, "each band"), TRUE * factors)
    assert best_of("scaled", "each band", TRUE * factors).parameter == pytest.approx(factors, rel=1e-9)


def test_a_factor_is_found_though_a_quarter_of_the_picture_is_something_else():
    shown = 1.5 * TRUE
    shown[:, :6] = 0.123
    assert best_of("scaled", "", shown).parameter == pytest.approx(1.5, rel=1e-9)


def test_the_factor_1_is_neutral():
    assert is_neutral(RULES["scaled"], Applied("scaled", 1.0))
    assert_same(with_cause(CASE, "scaled", 1.0), TRUE)


def test_a_part_that_is_left_out_altogether_is_no_factor():
    dark = picture(lopsided(materials={"clay": {**SPEC["materials"]["clay"], "specular": 0}}))
    assert RULES["scaled"].estimates(Applied("scaled", None, "highlight"), evidence_of(CASE, dark)) == []
