"""Model `reflection-equation`: what closed forms and simple arguments say about extended emitters."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

from equilux_scenes.case import Case
from equilux_tracer import Tracer
from support.random_scenes import case_of

Spec = dict[str, Any]

FLOOR = {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "m"}
LAMBERT = {"diffuse": 1.0, "brdf": "lambert"}
SHEET = {"kind": "rectangle", "corner": [-0.4, -0.7, 2.0], "edge_u": [0, 1.4, 0], "edge_v": [0.8, 0, 0], "radiance": 1.0}
SKY = {"kind": "environment", "radiance": 1.0}
BOUND = 1e-9
"""Relative; the integrals are asked for 1e-10."""


def case(objects: Sequence[Spec], lights: Sequence[Spec], material: Spec = LAMBERT, **scene: Any) -> Case:
    return case_of(
        {
            "equilux": 1,
            "name": "some",
            "model": "reflection-equation",
            "camera": look_at((3.0, 0.2, 1.0), (0, 0, 0)),
            "film": {"width": 1, "height": 1},
            "lights": {f"l{k}": light for k, light in enumerate(lights)},
            "materials": {"m": material, "black": {}, "other": LAMBERT},
            "objects": [{"material": "m", **obj} for obj in objects],
            **scene,
        }
    )


def look_at(eye: Sequence[float], target: Sequence[float], fov_y_deg: float = 1e-3) -> Spec:
    up = [0, 0, 1] if abs(eye[2] - target[2]) < 5 * math.hypot(eye[0] - target[0], eye[1] - target[1]) else [0, 1, 0]
    return {"projection": "perspective", "eye": list(eye), "target": list(target), "up": up, "fov_y_deg": fov_y_deg}


def seen(objects: Sequence[Spec], lights: Sequence[Spec], material: Spec = LAMBERT, **scene: Any) -> float:
    """The first band of the middle of the film. With diffuse 1 and lambert it is the irradiance."""
    return float(radiance(case(objects, lights, material, **scene))[0, 0, 0])


def radiance(made: Case, error_target: float = 1e-10) -> np.ndarray:
    return np.asarray(Tracer(made, error_target=error_target).render()["radiance"])


def brick(*center: float, half: float = 0.1) -> Spec:
    return {"kind": "box", "min": [c - half for c in center], "max": [c + half for c in center], "material": "other"}


# --- form factors -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("radius", [1e-3, 0.1, 0.7, 1.9])
def test_a_sphere_overhead_gives_pi_sin2_of_its_half_angle(radius):
    sphere = {"kind": "sphere", "center": [0, 0, 2], "radius": radius, "radiance": 1.0}
    low = look_at((3.0, 0.2, 0.05), (0, 0, 0))
    assert seen([FLOOR], [sphere], camera=low) == pytest.approx(math.pi * (radius / 2) ** 2, rel=BOUND)


@pytest.mark.parametrize("angle_deg", [20.0, 50.0, 60.0])
def test_a_sphere_aside_that_is_all_above_the_horizon_gives_that_times_the_cosine(angle_deg):
    angle = math.radians(angle_deg)
    sphere = {"kind": "sphere", "center": [2 * math.sin(angle), 0, 2 * math.cos(angle)], "radius": 0.5, "radiance": 1.0}
    eye = look_at((-1.0, 2.0, 3.0), (0, 0, 0))
    assert seen([FLOOR], [sphere], camera=eye) == pytest.approx(math.pi / 16 * math.cos(angle), rel=BOUND)


@pytest.mark.parametrize("radius", [1e-3, 0.5, 3.0, 200.0])
def test_a_disc_on_axis_gives_pi_r2_over_r2_plus_h2(radius):
    disc = {"kind": "disc", "center": [0, 0, 2], "normal": [0, 0, -3], "radius": radius, "radiance": 1.0}
    assert seen([FLOOR], [disc]) == pytest.approx(math.pi * radius**2 / (radius**2 + 4), rel=BOUND)


@pytest.mark.parametrize(("a", "b"), [(0.7, 0.4), (0.01, 3.0), (50.0, 50.0), (1e-3, 1e-3)])
def test_a_rectangle_overhead_gives_its_form_factor(a, b):
    h = 2.0
    sheet = {"kind": "rectangle", "corner": [-a, -b, h], "edge_u": [0, 2 * b, 0], "edge_v": [2 * a, 0, 0], "radiance": 1.0}
    one_side = a / math.hypot(a, h) * math.atan(b / math.hypot(a, h)) + b / math.hypot(b, h) * math.atan(a / math.hypot(b, h))
    assert seen([FLOOR], [sheet]) == pytest.approx(2 * one_side, rel=BOUND)


def test_half_an_emitter_below_the_horizon_gives_the_upper_half():
    """A sphere whose centre is on the horizon: irradiance α − sin α cos α, α its half-angle."""
    sphere = {"kind": "sphere", "center": [2, 0, 0], "radius": 1.0, "radiance": 1.0}
    wall = {"kind": "rectangle", "corner": [-0.1, -0.1, 0], "edge_u": [0.2, 0, 0], "edge_v": [0, 0.2, 0]}
    alpha = math.asin(0.5)
    got = seen([wall], [sphere], camera=look_at((-1.0, 0.5, 2.0), (0, 0, 0)))
    assert got == pytest.approx(alpha - math.sin(alpha) * math.cos(alpha), rel=BOUND)


# --- environment ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "shape",
    [
        {"kind": "sphere", "center": [0, 0, 0], "radius": 1.0},
        {"kind": "sphere", "center": [0, 0, 0], "radius": 1.0, "transform": [{"scale": [1.0, 0.5, 1.2]}]},
        {"kind": "box", "min": [-0.5, -0.5, -0.5], "max": [0.5, 0.5, 0.5]},
        {"kind": "cylinder", "base": [0, 0, -0.5], "top": [0, 0.2, 0.5], "radius": 0.6},
    ],
)
def test_a_convex_lambert_object_in_a_furnace_shows_its_albedo(shape):
    albedo = 0.6
    camera = look_at((3, 4, 2), (0, 0, 0), 40)
    made = case(
        [shape], [{**SKY, "radiance": 1.0}], {"diffuse": albedo / math.pi}, camera=camera, film={"width": 16, "height": 12}
    )
    channels = Tracer(made).render(["radiance", "object_id"])
    on_it = channels["object_id"] == 0
    assert np.count_nonzero(on_it) > 10
    assert np.abs(channels["radiance"][on_it] - albedo).max() < 1e-13
    assert (channels["radiance"][~on_it] == 1).all()


@pytest.mark.parametrize("exponent", [0.0, 0.3, 1.0, 2.5, 10.0, 1000.0, 1e5])
@pytest.mark.parametrize(("brdf", "more"), [("phong-classic", 1), ("phong-cosine", 2)])
def test_a_lobe_seen_along_the_normal_reflects_two_pi_over_p_plus_one_or_two(exponent, brdf, more):
    material = {"specular": 1.0, "exponent": exponent, "brdf": brdf}
    got = seen([FLOOR], [SKY], material, camera=look_at((0, 0, 5), (0, 0, 0)))
    assert got == pytest.approx(2 * math.pi / (exponent + more), rel=1e-11)


def test_a_half_space_that_is_blocked_takes_half_of_the_sky():
    """On a wall that stands on an infinite black floor."""
    wall = {"kind": "rectangle", "corner": [-1, 0, 0], "edge_u": [2, 0, 0], "edge_v": [0, 0, 2]}
    got = seen([{**FLOOR, "material": "black"}, wall], [SKY], camera=look_at((0.1, -3, 1.1), (0.2, 0, 1)))
    assert got == pytest.approx(math.pi / 2, rel=BOUND)


# --- visibility -------------------------------------------------------------------------------------------------------


def test_what_covers_half_of_an_emitter_takes_its_half():
    """A sheet in the plane x = 0 divides the emitter as it divides the view: only x < 0 is left."""
    screen = {"kind": "rectangle", "corner": [0, -5, 1], "edge_u": [5, 0, 0], "edge_v": [0, 10, 0], "material": "black"}
    eye = look_at((-3.0, 0.2, 0.5), (0, 0, 0))
    half = seen([FLOOR, screen], [SHEET], camera=eye)
    assert half == pytest.approx(seen([FLOOR], [SHEET], camera=eye) / 2, rel=BOUND)


def test_what_covers_all_of_an_emitter_takes_all():
    screen = {"kind": "disc", "center": [0, 0, 1], "normal": [0.1, 0, 1], "radius": 0.9, "material": "black"}
    assert seen([FLOOR, screen], [SHEET]) == 0


@pytest.mark.parametrize("behind", [brick(0, 0, 2.5, half=0.4), brick(0, 0, -1, half=0.4), brick(2.5, 1, 0.5)])
def test_what_is_behind_below_or_beside_takes_nothing(behind):
    assert seen([FLOOR, behind], [SHEET]) == pytest.approx(seen([FLOOR], [SHEET]), rel=1e-14)


def test_a_sphere_in_front_of_a_concentric_sphere_leaves_the_ring():
    """π sin² of the outer cone minus that of the inner one."""
    lamp = {"kind": "sphere", "center": [0, 0, 3], "radius": 1.0, "radiance": 1.0}
    ball = {"kind": "sphere", "center": [0, 0, 1], "radius": 0.2, "material": "black"}
    assert seen([FLOOR, ball], [lamp]) == pytest.approx(math.pi * (1 / 9 - 0.04), rel=BOUND)


@pytest.mark.parametrize("capped", [True, False])
def test_a_cylinder_in_front_of_a_strip_hides_what_a_sheet_between_its_tangents_hides(capped):
    """Along a very long thin sheet a cylinder hides as much as the rectangle between the two lines of sight that touch it."""
    lamp = {"kind": "rectangle", "corner": [-50, -1e-3, 2], "edge_u": [0, 2e-3, 0], "edge_v": [100, 0, 0], "radiance": 1.0}
    pole = {"kind": "cylinder", "base": [0, -9, 1], "top": [0, 9, 1], "radius": 0.25, "capped": capped, "material": "black"}
    touch = math.tan(math.asin(0.25))
    slab = {
        "kind": "rectangle",
        "corner": [-touch, -9, 1],
        "edge_u": [2 * touch, 0, 0],
        "edge_v": [0, 18, 0],
        "material": "black",
    }
    hidden = [seen([FLOOR], [lamp]) - seen([FLOOR, blocker], [lamp]) for blocker in (pole, slab)]
    assert hidden[0] == pytest.approx(hidden[1], rel=1e-7)


def test_a_room_from_the_inside_hides_what_is_outside_and_nothing_else():
    room = {"kind": "box", "min": [-3, -3, 0], "max": [3, 3, 2.5]}
    lamp_outside = {**SHEET, "corner": [-0.4, -0.7, 3.0]}
    eye = look_at((1.0, 0.2, 1.0), (0, 0, 0))
    assert seen([room], [SHEET], camera=eye) == pytest.approx(seen([FLOOR], [SHEET], camera=eye), rel=1e-13)
    assert seen([room], [lamp_outside], camera=eye) == 0


def test_a_lamp_flush_with_the_ceiling_is_not_hidden_by_it():
    ceiling = {"kind": "rectangle", "corner": [-2, -2, 2], "edge_u": [0, 4, 0], "edge_v": [4, 0, 0], "material": "other"}
    slab = {"kind": "box", "min": [-2, -2, 2], "max": [2, 2, 2.2], "material": "other"}
    eye = look_at((3.0, 0.2, 1.0), (0, 0, 0))
    for hung in (ceiling, slab):
        assert seen([FLOOR, hung], [SHEET], camera=eye) == pytest.approx(seen([FLOOR], [SHEET], camera=eye), rel=1e-9)


def test_meshes_hide_what_the_box_that_they_describe_hides():
    box = brick(0.2, 0.1, 1.0, half=0.3)
    low, high = box["min"], box["max"]
    vertices = [[(low, high)[i & 1][0], (low, high)[i >> 1 & 1][1], (low, high)[i >> 2 & 1][2]] for i in range(8)]
    faces = [
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ]
    mesh = {"kind": "mesh", "vertices": vertices, "faces": faces, "material": "other"}
    for lamp in (SHEET, {"kind": "sphere", "center": [0, 0, 2], "radius": 0.6, "radiance": 1.0}, SKY):
        expected = seen([FLOOR, box], [lamp])
        assert 0 < expected < seen([FLOOR], [lamp])
        made = case([FLOOR, mesh], [lamp])
        meshed = Case(made.name, made.scene, made.scene_name, meshes={1: _arrays(vertices, faces)})
        assert radiance(meshed)[0, 0, 0] == pytest.approx(expected, rel=1e-8)


def _arrays(vertices: list[list[float]], faces: list[list[int]]) -> Any:
    from equilux_scenes.mesh import TriangleMesh

    return TriangleMesh(np.array(vertices, dtype=float), np.array(faces, dtype=np.int64), None)


def test_one_emitter_hides_another():
    """A black-backed disc lamp that shines upwards lies between the floor and the sheet: as a black disc would."""
    lid = {"kind": "disc", "center": [0.1, 0, 1], "normal": [0, 0, 1], "radius": 0.2, "radiance": 5.0}
    black = {"kind": "disc", "center": [0.1, 0, 1], "normal": [0, 0, 1], "radius": 0.2, "material": "black"}
    assert seen([FLOOR], [SHEET, lid]) == pytest.approx(seen([FLOOR, black], [SHEET]), rel=BOUND)


def test_an_emitter_hides_the_sky_and_puts_its_own_light_there():
    lamp = {"kind": "sphere", "center": [0.5, 0, 1.5], "radius": 0.5, "radiance": 3.0}
    alone = seen([FLOOR], [lamp])
    assert seen([FLOOR], [lamp, SKY]) == pytest.approx(math.pi + alone * (1 - 1 / 3), rel=BOUND)


def test_a_light_without_extent_is_hidden_by_objects_and_by_emitters():
    sun = {"kind": "directional", "direction": [0, 0, -1], "irradiance": 2.0}
    lamp = {"kind": "point", "position": [0, 0, 2], "intensity": 4.0}
    back = {"kind": "disc", "center": [0, 0, 1], "normal": [0, 0, 1], "radius": 0.2, "radiance": 1.0}
    for light, arriving in ((sun, 2.0), (lamp, 1.0)):
        assert seen([FLOOR], [light]) == pytest.approx(arriving, rel=1e-14)
        assert seen([FLOOR, brick(0, 0, 1)], [light]) == 0
        assert seen([FLOOR, brick(0, 0, 3)], [light]) == (0 if light is sun else pytest.approx(1.0, rel=1e-14))
        assert seen([FLOOR], [light, back]) == 0


@pytest.mark.parametrize(("brdf", "cosines"), [("phong-classic", 0), ("phong-cosine", 1)])
def test_the_highlight_of_a_light_without_extent_has_the_cosine_that_its_brdf_has(brdf, cosines):
    light = {"kind": "directional", "direction": [1, 0, -1], "irradiance": 3.0}
    material = {"specular": 0.5, "exponent": 4.0, "brdf": brdf}
    got = seen([FLOOR], [light], material, camera=look_at((0, 0, 5), (0, 0, 0)))
    cosine = math.sqrt(0.5)
    assert got == pytest.approx(1.5 * cosine**4 * cosine**cosines, rel=1e-13)


# --- emitters seen ----------------------------------------------------------------------------------------------------


def test_an_emitter_is_seen_with_its_radiance_from_in_front_and_black_from_behind():
    disc = {"kind": "disc", "center": [0, 0, 0], "normal": [0, 0, 1], "radius": 1.0, "radiance": [1.0, 2.0, 3.0]}
    sheet = {"kind": "rectangle", "corner": [-1, -1, 0], "edge_u": [2, 0, 0], "edge_v": [0, 2, 0], "radiance": [1.0, 2.0, 3.0]}
    for lamp in (disc, sheet):
        assert radiance(case([], [lamp], camera=look_at((0, 0.1, 2), (0, 0, 0))))[0, 0].tolist() == [1, 2, 3]
        assert radiance(case([], [lamp], camera=look_at((0, 0.1, -2), (0, 0, 0))))[0, 0].tolist() == [0, 0, 0]
    sphere = {"kind": "sphere", "center": [0, 0, 0], "radius": 1.0, "radiance": [1.0, 2.0, 3.0]}
    assert radiance(case([], [sphere], camera=look_at((0, 0.1, 2), (0, 0, 0))))[0, 0].tolist() == [1, 2, 3]
    assert radiance(case([], [sphere], camera=look_at((0, 0.1, 0.5), (0, 0, 0))))[0, 0].tolist() == [0, 0, 0]


def test_the_back_of_an_emitter_gives_no_light():
    for normal, lit in (([0, 0, -1], True), ([0, 0, 1], False)):
        disc = {"kind": "disc", "center": [0, 0, 2], "normal": normal, "radius": 0.5, "radiance": 1.0}
        assert (seen([FLOOR], [disc]) > 0) == lit


def test_emitters_are_numbered_after_the_objects_and_an_object_in_their_place_is_seen_first():
    disc = {"kind": "disc", "center": [0, 0, 0], "normal": [0, 0, 1], "radius": 1.0, "radiance": 5.0}
    camera = look_at((0, 0.1, 2), (0, 0, 0))
    for objects, number in (([], 0), ([brick(9, 9, 9), brick(8, 8, 8)], 2), ([brick(9, 9, 9), FLOOR], 1)):
        got = Tracer(case(objects, [disc], camera=camera)).render(["object_id"])["object_id"]
        assert got[0, 0] == number


def test_radiance_does_not_change_with_the_distance_it_is_seen_from():
    lamp = {"kind": "sphere", "center": [0, 0, 2], "radius": 0.5, "radiance": 1.0}
    near, far = (seen([FLOOR], [lamp], camera=look_at((d * 3.0, d * 0.4, d * 1.5), (0.3, 0.2, 0))) for d in (1, 1000))
    assert near == pytest.approx(far, rel=1e-9)


def test_both_sides_of_a_sheet_reflect_what_is_in_front_of_them():
    sheet = {"kind": "rectangle", "corner": [-1, -1, 0], "edge_u": [2, 0, 0], "edge_v": [0, 2, 0]}
    above = {**SHEET, "corner": [-0.4, -0.7, 2.0]}
    below = {**SHEET, "corner": [-0.4, -0.7, -2.0], "edge_u": SHEET["edge_v"], "edge_v": SHEET["edge_u"]}
    top, bottom = (seen([sheet], [above, below], camera=look_at((1, 0.2, z), (0, 0, 0))) for z in (1.0, -1.0))
    assert top == pytest.approx(bottom, rel=1e-12)
    assert top == pytest.approx(seen([FLOOR], [above], camera=look_at((1, 0.2, 1.0), (0, 0, 0))), rel=1e-12)


# --- channels ---------------------------------------------------------------------------------------------------------


def test_the_terms_of_all_lights_add_up_to_the_radiance():
    sun = {"kind": "directional", "direction": [1, 0.3, -0.5], "irradiance": 0.5}
    ball = {"kind": "sphere", "center": [0.3, 0.2, 0.4], "radius": 0.3}
    lights = [SKY, SHEET, sun]
    material = {"diffuse": 0.2, "specular": 0.1, "exponent": 12.0, "emission": [0.1, 0.0, 0.3]}
    made = case([FLOOR, ball], lights, material, camera=look_at((2, 2, 2), (0, 0, 0.3), 30), film={"width": 12, "height": 9})
    got = Tracer(made).render(["radiance", "emission", "diffuse", "specular", "object_id"])
    assert got["diffuse"].shape == (9, 12, 3, 3)
    hit = got["object_id"] >= 0
    total = got["emission"] + (got["diffuse"] + got["specular"]).sum(axis=2)
    np.testing.assert_allclose(total[hit], got["radiance"][hit], rtol=1e-14)
    only_sun = Tracer(
        case([FLOOR, ball], [sun], material, camera=look_at((2, 2, 2), (0, 0, 0.3), 30), film={"width": 12, "height": 9})
    )
    np.testing.assert_array_equal(got["diffuse"][:, :, 0], only_sun.render(["diffuse"])["diffuse"][:, :, 0])


def test_the_picture_does_not_depend_on_the_number_of_threads():
    ball = {"kind": "sphere", "center": [0.3, 0.2, 0.4], "radius": 0.3}
    made = case([FLOOR, ball], [SHEET, SKY], camera=look_at((2, 2, 2), (0, 0, 0.3), 40), film={"width": 32, "height": 24})
    pictures = [Tracer(made).render(["radiance", "quadrature"], threads=threads) for threads in (1, 3)]
    for name in ("radiance", "quadrature"):
        np.testing.assert_array_equal(pictures[0][name], pictures[1][name])


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_scaling_a_scene_changes_nothing(scale):
    def at(k: float) -> Callable[..., list[float]]:
        return lambda *v: [k * c for c in v]

    def picture(k: float) -> np.ndarray:
        p = at(k)
        floor = {**FLOOR, "point": p(0, 0, 0)}
        ball = {"kind": "sphere", "center": p(0.3, 0.2, 0.4), "radius": 0.3 * k}
        lamp = {"kind": "disc", "center": p(0.1, 0.2, 1.5), "normal": [0, 0.1, -1], "radius": 0.4 * k, "radiance": 1.0}
        camera = look_at(p(2, 2, 2), p(0, 0, 0.3), 30)
        camera["up"] = [0, 0, 1]
        made = case(
            [floor, ball],
            [lamp],
            {"diffuse": 0.3, "specular": 0.2, "exponent": 30.0},
            camera=camera,
            film={"width": 12, "height": 9},
        )
        return radiance(made)

    np.testing.assert_allclose(picture(scale), picture(1.0), rtol=1e-8, atol=1e-12)
