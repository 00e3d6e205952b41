"""Rules of where a pixel looks, against NumPy done to the true picture."""

from __future__ import annotations

import math

import numpy as np
import pytest

from equilux_tracer import Tracer
from equilux_tracer.causes import RULES, Applied, is_neutral
from support.cause_scenes import SPEC, lopsided
from support.faulty import assert_same, estimated, evidence_of, picture, tried, with_cause

WIDE = lopsided()
SQUARE = lopsided(film={"width": 16, "height": 16})
TRUE = picture(WIDE)


def seen_at(case, x, y):
    """Radiance of the model at film positions of the same shape as the film."""
    film_xy = np.stack([x.ravel(), y.ravel()], axis=1)
    return Tracer(case).evaluate(film_xy)["radiance"].reshape(*x.shape, 3)


def centres(case):
    rows, columns = np.mgrid[0 : case.scene.film.height, 0 : case.scene.film.width]
    return columns + 0.5, rows + 0.5


def test_flips_turn_the_arrays_rows_and_columns_about():
    assert_same(with_cause(WIDE, "flipped-x"), TRUE[:, ::-1])
    assert_same(with_cause(WIDE, "flipped-y"), TRUE[::-1])


def test_a_flip_of_a_single_column_or_row_is_not_tried():
    assert tried(lopsided(film={"width": 1, "height": 9}), "flipped-x") == []
    assert tried(lopsided(film={"width": 9, "height": 1}), "flipped-y") == []


def test_a_square_picture_is_transposed_about_either_diagonal():
    true = picture(SQUARE)
    assert_same(with_cause(SQUARE, "transposed"), true.swapaxes(0, 1))
    assert_same(with_cause(SQUARE, "transposed", None, "other diagonal"), true[::-1, ::-1].swapaxes(0, 1))
    assert [reading for _, reading in tried(SQUARE, "transposed")] == ["", "other diagonal"]


def test_numbers_filled_in_in_the_wrong_order_transpose_what_is_not_square():
    height, width = TRUE.shape[:2]
    assert_same(with_cause(WIDE, "transposed", None, "read by columns"), TRUE.reshape(width, height, 3).swapaxes(0, 1))
    assert_same(with_cause(WIDE, "transposed", None, "written by columns"), TRUE.swapaxes(0, 1).reshape(height, width, 3))


def test_a_transposed_picture_is_cut_and_filled_up_with_black():
    size = min(TRUE.shape[:2])
    expected = np.zeros_like(TRUE)
    expected[:size, :size] = TRUE[:size, :size].swapaxes(0, 1)
    shown = with_cause(WIDE, "transposed", None, "black")
    # columns beyond the film's height are beyond the true picture: black; so is what a cut picture never had
    assert_same(shown[:, :size], expected[:, :size])
    assert not shown[:, size:].any()


@pytest.mark.parametrize(("dx", "dy"), [(3, -2), (-1, 0), (0, 5)])
def test_whole_pixels_move_the_array_to_the_right_and_downwards(dx, dy):
    parameter = (float(dx), float(dy))
    assert_same(with_cause(WIDE, "shifted", parameter, "wrapped"), np.roll(TRUE, (dy, dx), axis=(0, 1)))
    padded = np.pad(TRUE, ((6, 6), (6, 6), (0, 0)), mode="edge")
    assert_same(with_cause(WIDE, "shifted", parameter, "repeated"), np.roll(padded, (dy, dx), axis=(0, 1))[6:-6, 6:-6])
    mirrored = np.pad(TRUE, ((6, 6), (6, 6), (0, 0)), mode="symmetric")
    assert_same(with_cause(WIDE, "shifted", parameter, "mirrored"), np.roll(mirrored, (dy, dx), axis=(0, 1))[6:-6, 6:-6])
    black = np.pad(TRUE, ((6, 6), (6, 6), (0, 0)))
    assert_same(with_cause(WIDE, "shifted", parameter, "black"), np.roll(black, (dy, dx), axis=(0, 1))[6:-6, 6:-6])
    beyond = ~np.roll(np.pad(np.ones(TRUE.shape[:2], bool), 6), (dy, dx), axis=(0, 1))[6:-6, 6:-6]
    background = with_cause(WIDE, "shifted", parameter, "background")
    assert_same(background[beyond], np.broadcast_to(SPEC["background"], background[beyond].shape))
    assert_same(with_cause(WIDE, "shifted", parameter, "kept")[beyond], TRUE[beyond])


def test_half_a_pixel_is_what_sampling_the_corner_in_place_of_the_centre_makes():
    x, y = centres(WIDE)
    assert_same(with_cause(WIDE, "shifted", (0.5, 0.5)), seen_at(WIDE, x - 0.5, y - 0.5))


def test_a_shift_of_nothing_is_neutral():
    assert is_neutral(RULES["shifted"], Applied("shifted", (0.0, 0.0)))
    assert not is_neutral(RULES["shifted"], Applied("shifted", (0.0, 0.5)))
    assert_same(with_cause(WIDE, "shifted", (0.0, 0.0)), TRUE)


@pytest.mark.parametrize("shift", [(0.5, 0.5), (-0.5, 0.0), (3.0, -2.0), (0.3, -0.15)])
def test_a_shift_is_found_to_a_thousandth_of_a_pixel(shift):
    case = lopsided(film={"width": 48, "height": 36})
    found = estimated(case, "shifted", shift)[0]
    assert math.dist(found, shift) < 1e-3, f"found {found}, moved by {shift}"


@pytest.mark.parametrize("reading", ["wrapped", "black", "repeated", "kept"])
def test_the_border_tells_what_comes_in(reading):
    floor = {"kind": "plane", "point": [0, -0.7, 0], "normal": [0.2, 1, 0.1], "material": "clay"}
    case = lopsided(film={"width": 48, "height": 36}, objects=[*SPEC["objects"], floor])
    shown = with_cause(case, "shifted", (-9.0, 4.0), reading)
    best = RULES["shifted"].estimates(Applied("shifted"), evidence_of(case, shown))[0]
    assert (best.parameter, best.reading) == ((-9.0, 4.0), reading)


def test_a_uniform_picture_is_known_to_be_displaced_by_its_black_border():
    sheet = {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "glow"}
    case = lopsided(objects=[sheet], lights={}, materials={"glow": {"emission": 0.7}}, ambient=0)
    shown = with_cause(case, "shifted", (-2.0, 1.0), "black")
    best = RULES["shifted"].estimates(Applied("shifted"), evidence_of(case, shown))[0]
    assert (best.parameter, best.reading) == ((-2.0, 1.0), "black")


def test_the_field_of_view_on_the_horizontal_axis_is_that_of_a_camera_with_the_vertical_one_worked_out():
    half = math.tan(math.radians(38) / 2)
    for reading, tangent in [("", half * 16 / 24), ("converted", half * 24 / 16), ("diagonal", half * 16 / math.hypot(24, 16))]:
        fov = 2 * math.degrees(math.atan(tangent))
        other = lopsided(camera={**SPEC["camera"], "fov_y_deg": fov})
        assert_same(with_cause(WIDE, "fov-other-axis", None, reading), picture(other), relative=1e-9)
    degrees = lopsided(camera={**SPEC["camera"], "fov_y_deg": 38 * 16 / 24})
    assert_same(with_cause(WIDE, "fov-other-axis", None, "by degrees"), picture(degrees), relative=1e-9)


def test_the_width_of_an_orthographic_camera_is_given_as_its_height():
    camera = {"projection": "orthographic", "eye": [0.4, 0.6, 3], "target": [0, 0, 0], "up": [0, 1, 0], "height_m": 2.4}
    case, other = lopsided(camera=camera), lopsided(camera={**camera, "height_m": 2.4 * 16 / 24})
    assert_same(with_cause(case, "fov-other-axis"), picture(other), relative=1e-9)
    assert not any(reading.startswith("by degrees") for _, reading in tried(case, "fov-other-axis"))


def test_a_forgotten_aspect_stretches_one_axis_only():
    x, y = centres(WIDE)
    assert_same(with_cause(WIDE, "fov-other-axis", None, "aspect left out"), seen_at(WIDE, 12 + (x - 12) * 16 / 24, y))
    assert_same(with_cause(WIDE, "fov-other-axis", None, "height by width"), seen_at(WIDE, x, 8 + (y - 8) * 24 / 16))


def test_the_axis_of_the_field_of_view_is_not_asked_for_on_a_square_film():
    assert tried(SQUARE, "fov-other-axis") == []
