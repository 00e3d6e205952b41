"""What each light and each term of a material adds: values worked out by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from equilux_tracer import Tracer

FLOOR = {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}
DIFFUSE = {"diffuse": [0.5, 0.25, 1.0]}
MIRROR_LIKE = {"specular": 1.0, "exponent": 10}

# a handful of roundings of 2^-53 lie between a formula and its value
ULPS = 8 * 2.0**-53


def above(z, **light):
    return {"kind": "point", "position": [0, 0, z], "intensity": 12.0, **light}


def radiance(look, *lights, material=DIFFUSE, eye=(0, 0, 5), target=(0, 0, 0), **scene):
    return look(FLOOR, eye=eye, target=target, lights=lights, material=material, **scene)["radiance"]


def close(got, expected):
    np.testing.assert_allclose(got, expected, rtol=ULPS, atol=0)


def test_a_point_light_falls_off_with_the_square_of_its_distance(look):
    close(radiance(look, above(2)), 12 / 4 * np.array([0.5, 0.25, 1.0]))
    close(radiance(look, above(4)), 12 / 16 * np.array([0.5, 0.25, 1.0]))


def test_attenuation_adds_its_three_terms(look):
    light = above(2, attenuation={"constant": 1, "linear": 0.5, "quadratic": 0.25})
    close(radiance(look, light), 12 / (1 + 1 + 1) * np.array([0.5, 0.25, 1.0]))


def test_a_slanting_light_is_weighted_by_its_cosine(look):
    # light at (3, 0, 4): r = 5, N·L = 4/5
    light = {"kind": "point", "position": [3, 0, 4], "intensity": 25.0}
    close(radiance(look, light), 0.8 * np.array([0.5, 0.25, 1.0]))


def test_a_directional_light_has_neither_place_nor_distance(look):
    sun = {"kind": "directional", "direction": [0, -30, -40], "irradiance": 2.0}
    close(radiance(look, sun), 2 * 0.8 * np.array([0.5, 0.25, 1.0]))
    close(radiance(look, sun, eye=(1e3, 1e3, 5), target=(1e3, 1e3, 0)), 2 * 0.8 * np.array([0.5, 0.25, 1.0]))


def test_emission_and_ambient_need_no_light(look):
    material = {"emission": [1, 2, 3], "ambient": [0.5, 0.5, 0.25]}
    close(radiance(look, material=material, ambient=[2, 4, 8]), [2, 4, 5])


def test_a_miss_shows_the_background(look):
    seen = look(FLOOR, eye=(0, 0, 5), target=(0, 0, 9), background=[0.1, 0.2, 0.3])
    assert seen["object_id"] == -1
    np.testing.assert_array_equal(seen["radiance"], [0.1, 0.2, 0.3])


def test_the_highlight_is_the_power_of_the_mirrored_cosine(look):
    # L = (0, 0, 1) = R, V = (0, 3, 4)/5: R·V = 4/5
    close(radiance(look, above(2), material=MIRROR_LIKE, eye=(0, 3, 4)), 3 * 0.8**10 * np.ones(3))


def test_the_highlight_is_one_in_the_mirror_direction(look):
    close(radiance(look, above(2), material={"specular": 1.0, "exponent": 1e6}), 3 * np.ones(3))


@pytest.mark.parametrize(("light_x", "expected"), [(1, 1), (-1, 0)])
def test_exponent_zero_is_a_step_at_the_mirrored_horizon(look, light_x, expected):
    # V slants by 60° towards +x; light at ∓60°: R at ±60°, R·V = 1 or −1/2
    sun = {"kind": "directional", "direction": [light_x * math.sqrt(3), 0, -1], "irradiance": 1.0}
    eye = (math.sqrt(3), 0, 1)
    got = radiance(look, sun, material={"specular": 1.0, "exponent": 0}, eye=eye, up=(0, 1, 0))
    np.testing.assert_array_equal(got, expected * np.ones(3))


@pytest.mark.parametrize("exponent", [0, 0.5, 1, 20])
def test_there_is_no_highlight_where_the_mirror_direction_is_square_to_the_view(look, exponent):
    # L at 45° from +y, R at 45° towards −y, V at 45° from +y: R·V = 0 exactly
    sun = {"kind": "directional", "direction": [0, -1, -1], "irradiance": 1.0}
    got = radiance(look, sun, material={"specular": 1.0, "exponent": exponent}, eye=(0, 5, 5), up=(0, 0, 1))
    np.testing.assert_array_equal(got, np.zeros(3))


def test_no_highlight_from_a_light_behind_the_surface(look):
    # the light is below, the eye above: −L would mirror straight into the eye
    np.testing.assert_array_equal(radiance(look, above(-2), material={**DIFFUSE, **MIRROR_LIKE}), np.zeros(3))


@pytest.mark.parametrize("normal", [[0, 0, 1], [0, 0, -3]])
def test_both_faces_are_lit_alike(look, normal):
    floor = {**FLOOR, "normal": normal}
    seen = look(floor, eye=(0, 0, 5), target=(0, 0, 0), lights=[above(2)], material=DIFFUSE)
    close(seen["radiance"], 3 * np.array([0.5, 0.25, 1.0]))


@pytest.mark.parametrize("height", [0.0, 0.1, -3.7, 1e6])
def test_a_light_in_the_plane_of_a_surface_does_not_light_it(make_case, height):
    # ... anywhere on it, for the highlight at grazing angles would be bright
    floor = {"kind": "plane", "point": [0, 0, height], "normal": [0, 0, 1]}
    light = {"kind": "point", "position": [0.3, -40, height], "intensity": 1e4}
    view = {"eye": [0.1, 3, height + 2], "target": [0, -4, height], "up": [0, 0, 1]}
    camera = {"projection": "perspective", "fov_y_deg": 50, **view}
    material = {"diffuse": 1.0, "specular": 1.0, "exponent": 1}
    case = make_case(floor, lights=[light], material=material, camera=camera, film={"width": 24, "height": 18})
    image = Tracer(case).render()["radiance"]
    assert image.max() == 0, f"expected darkness, got {image.max()}"


def spot(half_angle, exponent=0.0, **more):
    return {
        "kind": "spot", "position": [0, 0, 1], "direction": [0, 0, -2], "intensity": 1.0, "cone_half_angle_deg": half_angle,
        "exponent": exponent, "attenuation": {"constant": 1}, **more,
    }  # fmt: skip


@pytest.mark.parametrize(("half_angle", "lit"), [(45, True), (44.999999999, False), (45.000000001, True)])
def test_the_cone_of_a_spot_includes_its_own_surface(look, half_angle, lit):
    # the point (1, 0, 0) is seen from (0, 0, 1) at 45° exactly
    seen = look(FLOOR, eye=(1, 0, 5), target=(1, 0, 0), lights=[spot(half_angle)], material={"diffuse": 1.0})
    assert (seen["radiance"][0] > 0) == lit, f"half-angle {half_angle}: radiance {seen['radiance'][0]}"


def test_a_spot_weakens_by_the_power_of_the_cosine_to_its_axis(look):
    for exponent in (0, 0.5, 1, 4, 300):
        seen = look(FLOOR, eye=(0.75, 0, 5), target=(0.75, 0, 0), lights=[spot(60, exponent)], material={"diffuse": 1.0})
        np.testing.assert_allclose(seen["radiance"], np.full(3, 0.8 * 0.8**exponent), rtol=0, atol=ULPS)


def test_a_hemispherical_spot_lights_what_lies_square_to_its_axis(look):
    # a wall at x = 1 faces the light; the axis is parallel to it: cos = 0, inclusive, and 0^0 = 1
    wall = {"kind": "plane", "point": [1, 0, 0], "normal": [1, 0, 0]}
    for exponent, expected in ((0, 1.0), (0.5, 0.0)):
        light = spot(90, exponent)
        seen = look(wall, eye=(-4, 0, 1), target=(1, 0, 1), up=(0, 0, 1), lights=[light], material={"diffuse": 1.0})
        np.testing.assert_array_equal(seen["radiance"], np.full(3, expected))


def test_a_light_at_the_very_point_it_would_shine_on_adds_nothing(look):
    np.testing.assert_array_equal(radiance(look, above(0), material={"diffuse": 1.0, "specular": 1.0}), np.zeros(3))


def test_terms_add_up_to_the_radiance(make_case):
    lights = [above(3), spot(50, 2), {"kind": "directional", "direction": [1, 2, -3], "irradiance": [1, 2, 3]}]
    material = {"diffuse": [0.1, 0.2, 0.3], "specular": 0.5, "exponent": 7, "ambient": 0.2, "emission": [0, 0.1, 0]}
    ball = {"kind": "sphere", "center": [0, 0, 0], "radius": 2.5}
    case = make_case(ball, lights=lights, material=material, ambient=0.3, background=0.25)
    seen = Tracer(case).render(["radiance", "emission", "ambient", "diffuse", "specular", "object_id"])
    assert seen["diffuse"].shape == (8, 8, 3, 3)
    hit = seen["object_id"] >= 0
    total = seen["emission"] + seen["ambient"] + (seen["diffuse"] + seen["specular"]).sum(axis=2)
    np.testing.assert_allclose(total[hit], seen["radiance"][hit], rtol=6 * 2.0**-53)  # six sums, in another order
    assert (total[~hit] == 0).all()
    assert (seen["radiance"][~hit] == 0.25).all()
