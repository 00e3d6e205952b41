"""Whole pictures: single pixels against brute integration, and the laws of light that need no other truth."""

from __future__ import annotations

import copy
import math

import numpy as np
import pytest
from mpmath import mp, mpf

import equilux_oracle
from equilux_oracle import emitters
from equilux_oracle.emitters.precise import radiance_at
from support.random_scenes import case_of

FLOOR = {"kind": "plane", "point": [0, 0, 0], "normal": [0, 1, 0], "material": "m"}
BALL = {"kind": "sphere", "center": [0, 0.4, 0], "radius": 0.4, "material": "m"}
BALL_LAMP = {"kind": "sphere", "center": [0.3, 0.9, -0.4], "radius": 0.3, "radiance": [3, 2, 1]}
DISC_LAMP = {"kind": "disc", "center": [-0.5, 0.6, 0.1], "normal": [1, -0.8, 0.1], "radius": 0.35, "radiance": [1, 2, 3]}
PANEL = {"kind": "rectangle", "corner": [-1, 0.1, -0.6], "edge_u": [1.2, 0, 0.3], "edge_v": [0, 0.9, 0], "radiance": 2}
SKY = {"kind": "environment", "radiance": [0.5, 0.75, 1.0]}
GLOSS = {"diffuse": [0.1, 0.2, 0.3], "specular": [0.4, 0.2, 0.3], "exponent": 7.5, "brdf": "phong-cosine"}
CHALK = {"diffuse": [0.1, 0.2, 0.3], "brdf": "lambert"}


def spec_of(lights, material=CHALK, objects=(FLOOR,), **more):
    return {
        "equilux": 1,
        "name": "one",
        "model": "reflection-equation",
        "camera": {"projection": "perspective", "eye": [0.4, 1.1, 2.2], "target": [0, 0.2, 0], "up": [0, 1, 0], "fov_y_deg": 50},
        "film": {"width": 12, "height": 9},
        "lights": {f"l{k}": light for k, light in enumerate(lights)},
        "materials": {"m": material} if objects else {},
        "objects": list(objects),
        **more,
    }


def picture(spec):
    return emitters.radiance_with_bound(case_of(spec))


# --- against integration ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("lights", "material", "objects", "position"),
    [
        ([BALL_LAMP], GLOSS, (FLOOR,), (5.3, 6.1)),
        ([DISC_LAMP], {**GLOSS, "brdf": "phong-classic", "emission": [0.1, 0, 0.2]}, (FLOOR,), (6.2, 7.7)),
        ([PANEL], {**GLOSS, "exponent": 4.0}, (FLOOR,), (7.1, 5.2)),
        ([PANEL], CHALK, (BALL,), (5.6, 4.0)),
        ([SKY], {**GLOSS, "exponent": 2.0}, (BALL,), (6.1, 3.5)),
    ],
)
def test_a_pixel_against_integration(lights, material, objects, position):
    case = case_of(spec_of(lights, material, objects))
    found = emitters.examine(case, [position])
    true = radiance_at(case, *position)
    assert true is not None, "the position sees no object"
    for band in range(3):
        apart = float(abs(mpf(found.radiance[0, band]) - true[band]))
        value, bound = found.radiance[0, band], found.bound[0, band]
        assert apart <= bound, f"band {band}: closed form {value!r}, integrated {mp.nstr(true[band], 18)}, bound {bound}"


# --- what is seen -----------------------------------------------------------------------------------------------------


def test_the_camera_sees_emitters_black_behind_and_the_environment_elsewhere():
    away = {**DISC_LAMP, "center": [0, 0.2, 0], "normal": [0, 0, -1]}
    view = {"projection": "perspective", "eye": [0, 0.2, 2], "target": [0, 0.2, 0], "up": [0, 1, 0], "fov_y_deg": 40}
    middle, corner = [6, 4.5], [0.1, 0.1]
    for lamp, seen in ((away, [0, 0, 0]), ({**away, "normal": [0, 0, 1]}, [1, 2, 3])):
        case = case_of(spec_of([lamp, SKY], objects=(), camera=view))
        found = emitters.evaluate(case, [middle, corner])
        assert found[0].tolist() == seen, f"in the middle {found[0]}, radiance {seen}"
        assert found[1].tolist() == SKY["radiance"], f"in the corner {found[1]}, environment {SKY['radiance']}"


def test_a_sphere_is_black_from_inside_and_lights_nothing_there():
    inside = {"kind": "sphere", "center": [0, 0.2, 0], "radius": 5, "radiance": 4}
    value, _ = picture(spec_of([inside], objects=(BALL,)))
    assert not value.any(), f"inside an outward-shining sphere {value.max()}, black"


def test_the_nearest_of_objects_and_emitters_is_seen():
    near = {**BALL_LAMP, "center": [0.2, 0.65, 1.1], "radius": 0.2}
    value = emitters.evaluate(case_of(spec_of([near])), [[6, 4.5]])
    assert value[0].tolist() == near["radiance"], f"{value[0]}, the lamp before the floor {near['radiance']}"


# --- laws -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("reflectance", [0.1, 0.5, 1.0])
@pytest.mark.parametrize(
    "body",
    [
        BALL,
        {"kind": "box", "min": [-0.3, 0, -0.4], "max": [0.3, 0.5, 0.2], "material": "m"},
        {"kind": "cylinder", "base": [0, 0, 0], "top": [0.1, 0.6, 0], "radius": 0.3, "material": "m"},
        {**BALL, "transform": [{"scale": [1, 0.5, 1.3]}]},
    ],
)
def test_in_the_furnace_a_convex_body_shows_its_reflectance(reflectance, body):
    value, bound = picture(spec_of([{**SKY, "radiance": 1}], {"diffuse": reflectance / math.pi, "brdf": "lambert"}, (body,)))
    off = np.abs(value - np.where(value == 1.0, 1.0, reflectance))
    assert np.all(off <= bound + 2**-52), f"shows {value[np.unravel_index(off.argmax(), off.shape)]!r}, ρ = {reflectance}"


def test_an_emitter_as_bright_as_the_environment_disappears():
    # What it covers shines as what it hides: a receiver cannot tell, but for light from below its own plane.
    sky = {"kind": "environment", "radiance": 1}
    ball = {**BALL_LAMP, "radiance": 1}
    for material in (CHALK, GLOSS):
        alone, bound = picture(spec_of([sky], material))
        both, more = picture(spec_of([sky, ball], material))
        floor = alone != 1.0
        assert floor.any()
        assert np.all(np.abs(alone - both)[floor & (both != 1.0)] <= (bound + more)[floor & (both != 1.0)])


def test_radiance_is_linear_in_the_emitters():
    one, bound_one = picture(spec_of([BALL_LAMP], GLOSS))
    twice, bound_twice = picture(spec_of([{**BALL_LAMP, "radiance": [6, 4, 2]}], GLOSS))
    assert np.all(np.abs(twice - 2 * one) <= bound_twice + 2 * bound_one), f"apart {np.abs(twice - 2 * one).max()}"


def test_the_parts_of_a_panel_add_up_to_it():
    left = {**PANEL, "edge_u": [0.6, 0, 0.15]}
    right = {**left, "corner": [-0.4, 0.1, -0.45]}
    black = {"l0": left, "l1": right}
    for material in (CHALK, GLOSS):
        # A film that sees the floor alone.
        down = {"projection": "perspective", "eye": [0, 3, 0.8], "target": [0, 0, 0.8], "up": [0, 0, -1], "fov_y_deg": 20}
        whole, bound = picture(spec_of([PANEL], material, camera=down))
        halves = [picture(spec_of([half], material, camera=down)) for half in black.values()]
        total, more = sum(value for value, _ in halves), sum(error for _, error in halves)
        assert whole.min() > 0
        assert np.all(np.abs(whole - total) <= bound + more), f"apart {np.abs(whole - total).max()}"


@pytest.mark.parametrize("lamp", [BALL_LAMP, DISC_LAMP, PANEL])
def test_a_scene_that_is_moved_and_scaled_looks_the_same(lamp):
    def moved(v):
        return [1000 + 8 * v[0], -500 + 8 * v[1], 8 * v[2]]

    def stretched(v):
        return [8 * c for c in v]

    here = spec_of([lamp], GLOSS)
    there = copy.deepcopy(here)
    there["camera"] |= {name: moved(here["camera"][name]) for name in ("eye", "target")}
    there["objects"][0]["point"] = moved([0, 0, 0])
    for light in there["lights"].values():
        light |= {name: moved(light[name]) for name in ("center", "corner") if name in light}
        light |= {name: stretched(light[name]) for name in ("edge_u", "edge_v") if name in light}
        if "radius" in light:
            light["radius"] *= 8
    (one, bound_one), (two, bound_two) = picture(here), picture(there)
    apart = np.abs(one - two)
    # The moved numbers are rounded: 1000 + 8x by 2^-43, that is 2^-46 of a scene of size 1.
    assert np.all(apart <= bound_one + bound_two + 2**-44 * one.max()), f"apart {apart.max()}"


def test_a_shrinking_sphere_becomes_a_point_light():
    point = {"kind": "point", "position": BALL_LAMP["center"], "intensity": [3, 2, 1]}
    classic = {**GLOSS, "brdf": "phong-classic"}
    down = {"projection": "perspective", "eye": [0, 3, 0.8], "target": [0, 0, 0.8], "up": [0, 0, -1], "fov_y_deg": 20}
    limit, _ = picture(spec_of([point], classic, camera=down))
    apart = []
    for radius in (0.1, 0.01, 0.001):
        radiance = [band / (math.pi * radius**2) for band in (3, 2, 1)]
        value, _ = picture(spec_of([{**BALL_LAMP, "radius": radius, "radiance": radiance}], classic, camera=down))
        apart.append(float(np.abs(value / limit - 1).max()))
    # The highlight's second-order term: ten times smaller, a hundred times nearer.
    assert apart[0] / apart[1] == pytest.approx(100, rel=0.05), f"relative distances {apart}"
    assert apart[1] / apart[2] == pytest.approx(100, rel=0.05), f"relative distances {apart}"


DELTA = [
    {"kind": "point", "position": [-1, 1.2, 0.8], "intensity": [2, 1.5, 1]},
    {"kind": "directional", "direction": [-0.5, -1, -0.6], "irradiance": [0.4, 0.5, 0.7]},
    {"kind": "spot", "position": [0.8, 1.6, 0.6], "direction": [-0.3, -1, -0.3], "intensity": 3, "cone_half_angle_deg": 24},
]


@pytest.mark.parametrize("brdf", ["lambert", "phong-classic"])
def test_lights_without_extent_are_the_local_model_where_nothing_is_blocked(brdf):
    material = CHALK if brdf == "lambert" else {**GLOSS, "brdf": brdf}
    spec = spec_of(DELTA, material, (BALL,))
    physical, bound = picture(spec)
    local = copy.deepcopy(spec) | {"model": "phong"}
    local["materials"]["m"].pop("brdf")
    value, more = equilux_oracle.radiance_with_bound(case_of(local))
    assert np.all(np.abs(physical - value) <= bound + more), f"apart {np.abs(physical - value).max()}"


def test_the_cosine_form_carries_the_receivers_cosine():
    sun = {"kind": "directional", "direction": [0, -1, -1], "irradiance": 1}
    highlight = {"specular": 1, "exponent": 3, "brdf": "phong-classic"}
    classic, bound = picture(spec_of([sun], highlight))
    cosine, more = picture(spec_of([sun], {**highlight, "brdf": "phong-cosine"}))
    apart = np.abs(cosine - classic / math.sqrt(2))
    assert np.all(apart <= bound + more), f"apart {apart.max()}"


def test_a_blocked_light_without_extent_casts_a_shadow():
    lamp = {"kind": "point", "position": [0, 2, 0], "intensity": 1}
    down = {"projection": "perspective", "eye": [1.5, 2, 0], "target": [0.1, 0, 0], "up": [0, 0, -1], "fov_y_deg": 5}
    small = {**BALL, "center": [0, 1, 0], "radius": 0.2}
    assert emitters.supports(case_of(spec_of([lamp], objects=(FLOOR, small)))) == []
    value, _ = picture(spec_of([lamp], objects=(FLOOR, small), camera=down))
    assert not value.any(), f"in the ball's shadow {value.max()}"


@pytest.mark.parametrize("material", [CHALK, GLOSS])
def test_bodies_hide_the_sky_as_black_emitters_would(material):
    # A black ball that hides the sky, as an object and as an emitter of radiance 0.
    objects = (FLOOR, {**BALL, "material": "black"})
    materials = {"m": material, "black": {"brdf": "lambert"}}
    as_object, bound = picture(spec_of([SKY], material, objects, materials=materials))
    lamp = {"kind": "sphere", "center": BALL["center"], "radius": BALL["radius"], "radiance": 0}
    as_emitter, more = picture(spec_of([SKY, lamp], material))
    assert np.all(np.abs(as_object - as_emitter) <= bound + more), f"apart {np.abs(as_object - as_emitter).max()}"
    open_sky, _ = picture(spec_of([SKY], material))
    assert as_object.min() < 0.7 * open_sky.min(), f"darkest under the ball {as_object.min()}, open floor {open_sky.min()}"


def test_a_box_hides_as_much_of_the_sky_as_its_six_faces_seen_from_outside():
    # The box as one object, and as six black rectangles: their normals point outward, so that none hides behind another.
    box = {"kind": "box", "min": [-0.4, 0.2, -0.3], "max": [0.3, 0.7, 0.2], "material": "m"}
    down = {"projection": "perspective", "eye": [0.9, 0.6, 1.2], "target": [0.6, 0, 0.8], "up": [0, 1, 0], "fov_y_deg": 30}
    material = {**CHALK, "emission": 0.01}
    both, _ = picture(spec_of([SKY], material, (FLOOR, box), camera=down))
    floor, _ = picture(spec_of([SKY], material, camera=down))
    hidden = floor - both
    faces = 0.0
    for u, v, corner in (
        ([0.7, 0, 0], [0, 0.5, 0], [-0.4, 0.2, 0.2]),  # towards +z
        ([0, 0.5, 0], [0, 0, 0.5], [0.3, 0.2, -0.3]),  # towards +x
    ):
        panel = {"kind": "rectangle", "corner": corner, "edge_u": u, "edge_v": v, "radiance": SKY["radiance"]}
        faces = faces + picture(spec_of([panel], CHALK, camera=down))[0]
    # And its bottom, seen from the floor.
    bottom = {"kind": "rectangle", "corner": [-0.4, 0.2, -0.3], "edge_u": [0.7, 0, 0], "edge_v": [0, 0, 0.5]}
    faces = faces + picture(spec_of([{**bottom, "radiance": SKY["radiance"]}], CHALK, camera=down))[0]
    assert hidden.min() > 0
    assert np.allclose(hidden, faces, rtol=0, atol=1e-13), f"hidden {hidden.max()}, faces {faces.max()}"


def test_the_oracle_asks_this_package_for_its_model():
    case = case_of(spec_of([BALL_LAMP], GLOSS))
    value, bound = equilux_oracle.radiance_with_bound(case)
    mine, own = emitters.radiance_with_bound(case)
    assert np.array_equal(value, mine)
    assert np.array_equal(bound, own)
    found = equilux_oracle.examine(case, [[6, 6.5]])
    assert found.object_id.tolist() == [0]
    assert np.array_equal(found.radiance, equilux_oracle.evaluate(case, [[6, 6.5]]))
    assert np.all(found.scale >= found.radiance), f"scale {found.scale}, radiance {found.radiance}"


def test_a_pixel_that_sees_an_emitter_has_its_number():
    near = {**BALL_LAMP, "center": [0.2, 0.65, 1.1], "radius": 0.2}
    found = emitters.examine(case_of(spec_of([PANEL, near], {"brdf": "lambert"})), [[6, 4.5]])
    assert found.object_id.tolist() == [2], f"one object, two emitters, the second of them seen: {found.object_id}"


@pytest.mark.parametrize(
    ("written_out", "transformed"),
    [
        (
            {"kind": "box", "min": [-0.3, 0.2, -0.3], "max": [0.4, 0.7, 0.2]},
            {"kind": "box", "min": [-0.4, 0.2, -0.3], "max": [0.3, 0.7, 0.2], "transform": [{"scale": [-1, 1, 1]}]},
        ),
        (
            {"kind": "sphere", "center": [0.2, 0.6, 0], "radius": 0.4},
            {"kind": "sphere", "center": [0.1, 0.3, 0], "radius": 0.2, "transform": [{"scale": 2}]},
        ),
        (
            {"kind": "disc", "center": [0, 0.6, 0.2], "normal": [0.5, 1, 0], "radius": 0.4},
            {"kind": "disc", "center": [0, 0.4, 0.2], "normal": [0.5, 1, 0], "radius": 0.4,
             "transform": [{"translate": [0, 0.2, 0]}]},
        ),
        (
            {"kind": "rectangle", "corner": [-0.4, 0.5, 0.3], "edge_u": [0.8, 0, 0], "edge_v": [0, 0.2, -0.6]},
            {"kind": "rectangle", "corner": [-0.2, 0.5, 0.3], "edge_u": [0.4, 0, 0], "edge_v": [0, 0.2, -0.6],
             "transform": [{"scale": [2, 1, 1]}]},
        ),
    ],
)  # fmt: skip
def test_a_transformed_body_hides_what_it_hides_written_out(written_out, transformed):
    materials = {"m": GLOSS, "black": {"brdf": "lambert"}}
    (one, bound), (two, more) = (
        picture(spec_of([SKY], GLOSS, (FLOOR, {**body, "material": "black"}), materials=materials))
        for body in (written_out, transformed)
    )
    open_sky, _ = picture(spec_of([SKY], GLOSS))
    # The written numbers are rounded: 0.4 is not quite 0.2 + 0.2.
    assert np.all(np.abs(one - two) <= bound + more + 2**-50), f"apart {np.abs(one - two).max()}"
    assert np.any((open_sky - one)[one > 0] > 1e-3), "hides nothing"
