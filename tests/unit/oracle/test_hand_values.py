"""Pixels that can be computed on paper."""

from __future__ import annotations

import math

import numpy as np
import pytest

import equilux_oracle

FLOOR = {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}
SUN = {"kind": "directional", "direction": [0, 0, -1], "irradiance": [3, 2, 1]}
LAMP = {"kind": "point", "position": [0, 0, 2], "intensity": [8, 4, 2]}
ROUNDING = 1e-14
"""Some forty roundings of 1.1e-16 on values of order one."""


def at(case, x_m, y_m):
    """Radiance where the downward view of 8 × 8 m on 8 × 8 px meets (x, y)."""
    return equilux_oracle.evaluate(case, [[4 + x_m, 4 - y_m]])[0]


def assert_bands(got, true, where=""):
    assert np.allclose(got, true, rtol=ROUNDING, atol=0), f"oracle {got.tolist()}, by hand {list(true)} {where}"


def test_emission_and_ambient_add_where_no_light_shines(make_case):
    case = make_case(FLOOR, {"emission": [0.5, 0.25, 0], "ambient": [0.5, 1, 0.25]}, ambient=[0.5, 0.25, 1])
    assert_bands(at(case, 0, 0), [0.75, 0.5, 0.25])


def test_a_missing_ray_sees_the_background(make_case):
    case = make_case({"kind": "disc", "center": [0, 0, 0], "normal": [0, 0, 1], "radius": 1}, {}, background=[1, 2, 3])
    assert at(case, 1.5, 0).tolist() == [1, 2, 3]
    assert at(case, 0.5, 0).tolist() == [0, 0, 0]


def test_lambert_under_a_sun_at_the_zenith_is_e_times_k(make_case):
    assert_bands(at(make_case(FLOOR, {"diffuse": [0.5, 0.25, 1]}, SUN), 1, 1), [1.5, 0.5, 1])


def test_at_the_mirror_direction_the_whole_formula_is_e_times_both_coefficients(make_case):
    for exponent in (0, 0.1, 1, 20, 1000):
        case = make_case(FLOOR, {"diffuse": 0.5, "specular": [0.25, 0.5, 1], "exponent": exponent}, LAMP)
        assert_bands(at(case, 0, 0), [2 * 0.75, 1 * 1.0, 0.5 * 1.5], f"exponent {exponent}")


def test_the_lamp_falls_by_inverse_square_and_cosine(make_case):
    # At (2, 0): r² = 8, E = 1, ½, ¼; N·L = 1/√2; R = (1, 0, 1)/√2, V = +z, R·V = 1/√2.
    case = make_case(FLOOR, {"diffuse": 0.5, "specular": 0.25, "exponent": 4}, LAMP)
    value = 0.5 / math.sqrt(2) + 0.25 / 4
    assert_bands(at(case, 2, 0), [value, value / 2, value / 4])
    assert_bands(at(case, 0, -2), [value, value / 2, value / 4])


def test_attenuation_is_the_sum_of_its_three_terms(make_case):
    # At (0, 1.5): r = 2.5; 8 / (1 + 2·2.5 + 4·6.25) = 8/31; N·L = 2/2.5.
    lamp = {**LAMP, "attenuation": {"constant": 1, "linear": 2, "quadratic": 4}}
    assert_bands(at(make_case(FLOOR, {"diffuse": 1}, lamp), 0, 1.5), np.array([8, 4, 2]) / 31 * 0.8)


def test_both_faces_are_lit_alike_and_only_from_the_viewers_side(make_case):
    below = {**LAMP, "position": [0, 0, -2]}
    for normal in ([0, 0, 1], [0, 0, -1]):
        floor = {**FLOOR, "normal": normal}
        assert_bands(at(make_case(floor, {"diffuse": 1}, LAMP), 0, 0), [2, 1, 0.5], f"normal {normal}")
        assert at(make_case(floor, {"diffuse": 1, "specular": 1, "exponent": 0}, below), 0, 0).tolist() == [0, 0, 0]


def test_nothing_occludes_in_the_local_model(make_case):
    roof = {"kind": "rectangle", "corner": [1, 1, 1], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0], "material": "m"}
    case = make_case(FLOOR, {"diffuse": 1}, SUN, objects=[{**FLOOR, "material": "m"}, roof])
    assert_bands(at(case, 0.5, 0.5), [3, 2, 1])


def test_the_highlight_ends_where_the_mirror_direction_is_upright_to_the_view(make_case):
    # V = +z. A wall whose normal is 75° off V: lit along its normal, R = N and R·V = cos 75°; lit from the eye, R·V = cos 150°.
    angle = math.radians(75)
    normal = [math.sin(angle), 0, math.cos(angle)]
    wall = {"kind": "plane", "point": [0, 0, 0], "normal": normal}
    for exponent in (0, 0.5, 3):
        material = {"specular": 1, "exponent": exponent}
        lit = at(make_case(wall, material, {**SUN, "direction": [-c for c in normal]}), 0, 0)
        assert_bands(lit, np.array([3, 2, 1]) * math.cos(angle) ** exponent, f"exponent {exponent}")
        dark = at(make_case(wall, material, SUN), 0, 0)
        assert dark.tolist() == [0, 0, 0], f"exponent {exponent}: R·V = cos 150° gave {dark.tolist()}"


def test_orthographic_views_have_one_view_direction(make_case):
    # Same sun, same V: a highlight on a plane is the same all over it.
    case = make_case(FLOOR, {"specular": 1, "exponent": 50}, {**SUN, "direction": [0.2, 0.1, -1]})
    picture = equilux_oracle.radiance(case)
    assert np.ptp(picture, axis=(0, 1)).max() <= ROUNDING * picture.max(), f"from {picture.min()} to {picture.max()}"


def test_the_picture_is_not_mirrored_nor_turned(make_case):
    case = make_case({"kind": "sphere", "center": [2.5, 1.5, 0], "radius": 0.4}, {"emission": 1})
    row, column = np.argwhere(equilux_oracle.radiance(case)[:, :, 0] > 0)[0]
    assert (row, column) == (2, 6), f"a ball at x = 2.5, y = 1.5 of an 8 × 8 m view was seen in row {row}, column {column}"


@pytest.mark.parametrize("fov", [1.0, 30.0, 150.0])
def test_perspective_spreads_the_film_by_the_tangent(make_case, fov):
    view = {"projection": "perspective", "eye": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y_deg": fov}
    half = 5 * math.tan(math.radians(fov) / 2)
    case = make_case({"kind": "disc", "center": [0, 0, 0], "normal": [0, 0, 1], "radius": half}, {"emission": 1}, camera=view)
    inside, outside = equilux_oracle.evaluate(case, [[4, 1e-9], [4, -1e-9]])[:, 0]
    assert (inside, outside) == (1, 0), f"half the film height should reach {half} m"
