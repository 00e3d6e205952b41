"""Handedness, and the side that normals are taken on, against scenes that are written so and formulas by hand."""

from __future__ import annotations

import numpy as np
import pytest

from support.cause_scenes import ROOF, SPEC, lopsided
from support.faulty import assert_same, picture, tried, with_cause

CASE = lopsided()
FLAT_ROOF = lopsided(objects=[ROOF])


def mirrored(vector, axis):
    return [-value if "xyz"[k] == axis else value for k, value in enumerate(vector)]


def mirrored_objects(axis):
    return [{**obj, "center": mirrored(obj["center"], axis)} for obj in SPEC["objects"]]


def mirrored_lights(axis):
    return {"key": {**SPEC["lights"]["key"], "position": mirrored(SPEC["lights"]["key"]["position"], axis)}}


def test_a_left_handed_world_is_a_mirrored_picture():
    assert_same(with_cause(CASE, "mirrored-handedness"), picture(CASE)[:, ::-1])


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_parts_of_the_scene_may_be_mirrored(axis):
    objects, lights = mirrored_objects(axis), mirrored_lights(axis)
    for reading, changes in [(axis, {"objects": objects, "lights": lights}), (f"objects {axis}", {"objects": objects}),
                             (f"lights {axis}", {"lights": lights})]:  # fmt: skip
        assert_same(with_cause(CASE, "mirrored-handedness", None, reading), picture(lopsided(**changes)), relative=1e-9)


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_mirroring_the_camera_is_mirroring_the_world_and_the_picture(axis):
    of_world = with_cause(CASE, "mirrored-handedness", None, axis)
    assert_same(with_cause(CASE, "mirrored-handedness", None, f"camera {axis}"), of_world[:, ::-1], relative=1e-9)


def test_every_kind_of_light_is_mirrored():
    spot = {"kind": "spot", "position": [0.3, 2, 1], "direction": [0.1, -1, -0.3], "intensity": 9, "cone_half_angle_deg": 40}
    sun = {"kind": "directional", "direction": [1, -1, -0.5], "irradiance": 2}
    turned = [{**spot, "position": [0.3, 2, -1], "direction": [0.1, -1, 0.3]}, {**sun, "direction": [1, -1, 0.5]}]
    case = lopsided(lights={"a": spot, "b": sun})
    expected = lopsided(lights=dict(zip("ab", turned, strict=True)))
    assert_same(with_cause(case, "mirrored-handedness", None, "lights z"), picture(expected), relative=1e-9)


def test_rotations_that_turn_the_other_way_have_the_other_angle():
    def roof(degrees):
        return lopsided(objects=[{**ROOF, "transform": [{"rotate": {"axis": [0.2, 1, 0], "degrees": degrees}}]}])

    assert_same(with_cause(roof(25), "mirrored-handedness", None, "rotations"), picture(roof(-25)), relative=1e-9)
    assert "rotations" not in [reading for _, reading in tried(CASE, "mirrored-handedness")]


def test_what_mirroring_leaves_in_place_is_not_tried():
    ball = {"kind": "sphere", "center": [0, 0, 0], "radius": 0.5, "material": "clay"}
    camera = {**SPEC["camera"], "eye": [0, 0, 3]}
    light = {"key": {"kind": "point", "position": [0, 2, 3], "intensity": 7}}
    readings = [reading for _, reading in tried(lopsided(objects=[ball], camera=camera, lights=light), "mirrored-handedness")]
    assert not any("x" in reading for reading in readings), readings
    assert "z" in readings


def test_reversed_normals_leave_what_is_lit_in_front_dark():
    # the light is beside the camera: all that is seen faces it, and nothing that faces away is seen
    lights = {"key": {"kind": "point", "position": [0.4, 0.6, 3], "intensity": 14}}
    case = lopsided(lights=lights, ambient=0)
    shown = with_cause(case, "reversed-normals")
    hit = picture(case).max(axis=2) > 0.11
    assert hit.any()
    assert not shown[hit].any(), f"largest {shown[hit].max()}"


def test_a_reversed_normal_is_lit_by_what_is_behind():
    floor = {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "clay"}
    front, back = ({"a": {"kind": "directional", "direction": [0.2, 0.1, z], "irradiance": 3}} for z in (-1, 1))
    # the diffuse term about −N of light from behind is that about N of light from in front; highlights lie elsewhere
    dull = {"clay": {**SPEC["materials"]["clay"], "specular": 0}}
    case = lopsided(objects=[floor], lights=back, materials=dull)
    expected = lopsided(objects=[floor], lights=front, materials=dull)
    assert_same(with_cause(case, "reversed-normals"), picture(expected))


def test_a_plane_seen_from_behind_is_lit_on_its_own_side():
    def seen(normal, z):
        floor = {"kind": "plane", "point": [0, 0, 0], "normal": normal, "material": "clay"}
        return lopsided(objects=[floor], lights={"a": {"kind": "directional", "direction": [0.2, 0.1, z], "irradiance": 3}},
                        materials={"clay": {**SPEC["materials"]["clay"], "specular": 0}})  # fmt: skip

    away = seen([0, 0, -1], 1)
    assert tried(away, "normal-side") == [(None, "")]
    assert_same(with_cause(away, "normal-side"), picture(seen([0, 0, 1], -1)))
    assert tried(seen([0, 0, 1], 1), "normal-side") == []


def test_vertex_lighting_is_linear_between_the_values_at_the_corners():
    camera = {"projection": "orthographic", "eye": [0, 0, 3], "target": [0, 0, 0], "up": [0, 1, 0], "height_m": 1.6}
    case = lopsided(objects=[ROOF], camera=camera)
    shown = with_cause(case, "vertex-lighting")
    # pixels of one face: the upper one's row of equal steps has no second difference
    row = shown[4, 8:16]
    inside = np.abs(np.diff(row, 2, axis=0)).max(axis=1)
    assert inside.min() < 1e-12, f"second differences {inside}"
    assert np.abs(np.diff(picture(case)[4, 8:16], 2, axis=0)).max(axis=1).min() > 1e-6


def test_a_rectangle_is_lit_at_its_corners():
    sheet = {"kind": "rectangle", "corner": [-0.7, -0.6, 0.1], "edge_u": [1.4, 0, 0], "edge_v": [0, 1.2, 0], "material": "clay"}
    mesh = {
        "kind": "mesh", "material": "clay", "faces": [[0, 1, 2], [0, 2, 3]],
        "vertices": [[-0.7, -0.6, 0.1], [0.7, -0.6, 0.1], [0.7, 0.6, 0.1], [-0.7, 0.6, 0.1]],
    }  # fmt: skip
    expected = with_cause(lopsided(objects=[mesh]), "vertex-lighting")
    assert_same(with_cause(lopsided(objects=[sheet]), "vertex-lighting", None, "corners"), expected, relative=1e-9)
    readings = [reading for _, reading in tried(lopsided(objects=[sheet]), "vertex-lighting")]
    assert readings == ["corners", "corners, other diagonals"]
