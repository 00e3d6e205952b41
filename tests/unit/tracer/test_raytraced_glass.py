"""Transparency and refraction: where the ray goes, what it weighs, and when it is reflected instead."""

from __future__ import annotations

import math

import numpy as np
import pytest

from support.one_ray import box, channels, close, lamp, plane, radiance, sphere, sun

CLEAR = {"transparency": 1.0, "transmission": 1.0}
GLASS = {**CLEAR, "ior": 1.5}
SCREEN = {"diffuse": 1.0}
LAMP = [0.7, 0.3, -2.5]
"""A light close to the screen z = −3, on the near side, that tells where on it a ray ends."""


def screen_at(x, y=0.0, z=-3.0):
    """What the screen shows at (x, y, z): E cosθ of the lamp."""
    toward = np.subtract(LAMP, [x, y, z])
    return toward[2] / np.linalg.norm(toward) ** 3


def onto_screen(*objects, materials, **what):
    return radiance(
        *objects, plane([0, 0, -3], [0, 0, 1], "screen"), materials={**materials, "screen": SCREEN}, lights=[lamp(LAMP)], **what
    )


def test_a_slab_shifts_the_ray_in_parallel():
    angle, ior, thick = math.radians(50), 1.5, 0.8
    slope, slope_inside = math.tan(angle), math.tan(math.asin(math.sin(angle) / ior))
    at = slope * (2.0 - thick + 3.0 - 0.0) + slope_inside * thick  # from z = 2 to −3, of which `thick` in glass
    got = onto_screen(
        box([-9, -9, -0.8], [9, 9, 0], "glass"), materials={"glass": GLASS}, eye=[0, 0, 2], target=[slope, 0, 1],
        transparent_shadows="ignore",
    )  # fmt: skip
    close(got, screen_at(at), 1e-12)
    assert abs(screen_at(at) - screen_at(5 * slope)) > 1e-3  # and without glass it would be another picture


@pytest.mark.parametrize("ior", [1.0, 1.2, 1.5, 2.4, 0.8])
@pytest.mark.parametrize("height", [0.0, 0.05, 0.4, 0.75])
def test_a_ball_lens_bends_a_parallel_ray_across_its_axis(height, ior):
    # The ray leaves as far from the centre as it came, turned by twice the difference of the angles of incidence and refraction.
    turn = 2 * (math.asin(height) - math.asin(height / ior))
    at = height / math.cos(turn) - 3.0 * math.tan(turn)
    got = onto_screen(
        sphere([0, 0, 0], 1, "glass"), materials={"glass": {**GLASS, "ior": ior}}, eye=[height, 0, 4], target=[height, 0, 0],
        transparent_shadows="ignore",
    )  # fmt: skip
    close(got, screen_at(at), 1e-12)


def test_two_surfaces_weigh_what_is_behind_them_twice():
    glass = {"transparency": 0.6, "transmission": 0.9, "ior": 1.4, "emission": 0.05}
    got = radiance(sphere([0, 0, 0], 1, "g"), materials={"g": glass}, eye=[0, 0, 4], target=[0, 0, 0], background=2.0)
    close(got, 0.05 + 0.54 * (0.05 + 0.54 * 2.0))


WATER = {"transparency": 0.3, "transmission": 0.5, "reflection": 0.2, "ior": 1.5, "emission": 0.01}


def from_below(degrees):
    """Up through the surface y = 0 of water, at an angle to its normal, over a glowing floor."""
    angle = math.radians(degrees)
    return channels(
        plane([0, 0, 0], [0, 1, 0], "water"), plane([0, -2, 0], [0, 1, 0], "floor"),
        materials={"water": WATER, "floor": {"emission": 2.0}}, eye=[0, -1, 0], target=[math.sin(angle), math.cos(angle) - 1, 0],
        background=0.7,
    )  # fmt: skip


def test_below_the_critical_angle_both_secondary_rays_count_by_their_weights():
    critical = math.degrees(math.asin(1 / 1.5))
    close(float(from_below(critical - 1e-9)["radiance"][0]), 0.01 + 0.7 * 0.2 * 2.0 + 0.3 * 0.5 * 0.7)


def test_beyond_it_one_mirror_ray_of_weight_one_replaces_them():
    critical = math.degrees(math.asin(1 / 1.5))
    found = from_below(critical + 1e-9)
    close(float(found["radiance"][0]), 0.01 + 2.0)
    close(float(found["reflected"][0]), 2.0)
    assert found["transmitted"][0] == 0, found["transmitted"]
    assert found["signature"] != from_below(critical - 1e-9)["signature"]


def test_an_opaque_surface_with_an_index_reflects_by_its_own_weight():
    opaque = {"reflection": 0.2, "ior": 1.5, "emission": 0.01}
    got = radiance(
        plane([0, 0, 0], [0, 1, 0], "opaque"), plane([0, -2, 0], [0, 1, 0], "floor"),
        materials={"opaque": opaque, "floor": {"emission": 2.0}}, eye=[0, -1, 0], target=[5, -0.5, 0],
    )  # fmt: skip
    close(got, 0.01 + 0.2 * 2.0)


@pytest.mark.parametrize("height", [0.69, 0.71])
def test_a_bubble_reflects_totally_from_outside(height):
    # ior 0.7: the critical angle of the way in is asin 0.7
    got = radiance(
        sphere([0, 0, 0], 1, "bubble"), plane([0, 0, 6], [0, 0, 1], "behind us"),
        materials={"bubble": {**CLEAR, "ior": 0.7}, "behind us": {"emission": 3.0}}, eye=[height, 0, 4], target=[height, 0, 0],
        background=0.5,
    )  # fmt: skip
    # at 0.7 the mirrored ray leaves at 90.8° from the way back: past the plane behind us; below, the ray goes through
    close(got, 0.5)
    near_axis = radiance(
        sphere([0, 0, 0], 1, "b"), materials={"b": {**CLEAR, "ior": 0.7}}, eye=[height, 0, 4], target=[height, 0, 0],
        recursion_limit=1, background=0.5,
    )  # fmt: skip
    # with one ray allowed, the mirrored one is in the open, the refracted one is still inside and sees what is not followed
    assert near_axis == (0.5 if height > 0.7 else 0.0), near_axis


def test_from_the_middle_of_a_glass_ball_the_world_is_where_it_is():
    got = onto_screen(
        sphere([0.1, 0.2, 0.3], 1, "glass"), materials={"glass": {**GLASS, "transparency": 0.9}}, eye=[0.1, 0.2, 0.3],
        target=[0.4, 0.1, -3], transparent_shadows="ignore",
    )  # fmt: skip
    close(got, 0.9 * screen_at(0.4, 0.1), 1e-12)


def test_a_plane_is_a_half_space_behind_its_normal():
    angle = math.radians(60)
    inside = math.asin(math.sin(angle) / 1.33)
    at = 1.0 * math.tan(angle) + 3.0 * math.tan(inside)
    for normal, ior in (([0, 0, 1], 1.33), ([0, 0, -1], 1 / 1.33)):  # glass below the surface, or the rest above it
        got = onto_screen(
            plane([0, 0, 0], normal, "water"), materials={"water": {**CLEAR, "ior": ior}}, eye=[0, 0, 1],
            target=[math.tan(angle), 0, 0], transparent_shadows="ignore",
        )  # fmt: skip
        close(got, screen_at(at), 1e-12)


def test_index_one_bends_nothing_and_counts_as_a_ray_all_the_same():
    clear = {**CLEAR, "transmission": 0.5}
    view = {"materials": {"clear": clear}, "eye": [0.3, 0.4, 4], "target": [0.1, 0.2, 0], "background": 1.0}
    close(radiance(sphere([0, 0, 0], 1, "clear"), recursion_limit=2, **view), 0.25)
    assert radiance(sphere([0, 0, 0], 1, "clear"), recursion_limit=1, **view) == 0


def test_with_t_one_the_front_of_the_surface_shows_nothing():
    shiny = {"diffuse": 0.5, "specular": 0.5, "reflection": 0.9, **CLEAR}
    view = {"materials": {"m": shiny}, "eye": [0, 0, 4], "target": [0, 0, 0]}
    assert radiance(plane([0, 0, 0], [0, 0, 1], "m"), lights=[sun([0, 0.6, -0.8])], **view) == 0
    behind = channels(plane([0, 0, 0], [0, 0, 1], "m"), lights=[sun([0, 0, 1])], **view)
    close(float(behind["radiance"][0]), 0.5 + 0.5)  # |N·L| = 1, and T = V: straight through
    close(float(behind["diffuse"][0, 0]), 0.5)


@pytest.mark.parametrize("degrees", [0.0, 20.0, 40.0])
def test_the_highlight_of_a_light_behind_lies_where_its_light_comes_out(degrees):
    # light in glass below the surface, 1.5 times as steep outside
    inside = math.radians(degrees)
    outside = math.asin(1.5 * math.sin(inside))
    water = {"specular": 1.0, "exponent": 1000.0, "transparency": 0.25, "transmission": 0.0, "ior": 1.5}

    def seen_from(angle):
        eye = [4 * math.sin(angle), 4 * math.cos(angle), 0]
        return radiance(
            plane([0, 0, 0], [0, 1, 0], "w"), materials={"w": water}, eye=eye, target=[0, 0, 0],
            lights=[sun([math.sin(inside), math.cos(inside), 0])],
        )  # fmt: skip

    close(seen_from(outside), 0.25, 1e-12)
    aside = 0.01
    close(seen_from(outside + aside), 0.25 * math.cos(aside) ** 1000, 1e-10)


def test_no_highlight_where_the_light_behind_is_totally_reflected():
    water = {"specular": 1.0, "exponent": 0.0, "transparency": 0.25, "transmission": 0.0, "ior": 1.5}
    for degrees, expected in ((41.8, 0.25), (41.82, 0.0)):  # critical: 41.81°
        angle = math.radians(degrees)
        got = radiance(
            plane([0, 0, 0], [0, 1, 0], "w"), materials={"w": water}, eye=[4, 1, 0], target=[0, 0, 0],
            lights=[sun([math.sin(angle), math.cos(angle), 0])],
        )  # fmt: skip
        assert got == expected, f"got {got}, expected {expected} at {degrees}°"
