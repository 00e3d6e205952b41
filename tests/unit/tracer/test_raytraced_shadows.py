"""Shadows: what stands between a point and a light, and by how much it weakens it."""

from __future__ import annotations

import numpy as np
import pytest

from equilux_scenes.mesh import TriangleMesh
from support.one_ray import box, channels, close, lamp, plane, radiance, sphere, sun

MATT = {"diffuse": 0.5}
PANE = {"transparency": 0.5, "transmission": [0.8, 0.4, 0.0], "ior": 1.7}
FLOOR = plane([0, 0, 0], [0, 0, 1], "matt")
VIEW = {"eye": [3, 0, 1], "target": [0, 0, 0]}


def floor_under(*objects, rule="attenuate", light=None):
    """What the floor shows at the origin, below whatever stands on it, lit from straight above."""
    materials, lights = {"matt": MATT, "pane": PANE}, [light or sun([0, 0, -1])]
    return channels(FLOOR, *objects, materials=materials, lights=lights, transparent_shadows=rule, **VIEW)["radiance"].tolist()


OPAQUE = sphere([0, 0, 3], 0.5, "matt")
CLEAR = sphere([0, 0, 3], 0.5, "pane")


def test_an_opaque_object_on_the_way_leaves_nothing():
    assert floor_under() == [0.5, 0.5, 0.5]
    assert floor_under(OPAQUE) == [0, 0, 0]


def test_every_crossing_of_a_transparent_object_multiplies_by_its_weight():
    got = floor_under(CLEAR)
    for band, k in zip(got, (0.8, 0.4, 0.0), strict=True):
        close(band, 0.5 * (0.5 * k) ** 2)
    one = floor_under({"kind": "disc", "center": [0, 0, 3], "normal": [0, 0, 1], "radius": 1, "material": "pane"})
    close(one[0], 0.5 * 0.4)


@pytest.mark.parametrize("turn", [0.0, 45.0, 33.0])
def test_through_an_edge_that_triangles_share_there_is_one_crossing(turn):
    # the shadow ray from the origin meets the diagonal of the pane, and with turn 0 a vertex of four
    corners = np.array([[-1, -1, 3], [1, -1, 3], [1, 1, 3], [-1, 1, 3], [0, 0, 3]], dtype=float)
    two, four = np.array([[0, 1, 2], [0, 2, 3]]), np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    pane = {"kind": "mesh", "vertices": [[0, 0, 0]] * 3, "faces": [[0, 1, 2]], "material": "pane"}
    pane["transform"] = [{"rotate": {"axis": [0, 0, 1], "degrees": turn}}]
    for faces in (two, four):
        meshes = {1: TriangleMesh(corners, faces, None)}
        found = channels(FLOOR, pane, materials={"matt": MATT, "pane": PANE}, lights=[sun([0, 0, -1])], meshes=meshes, **VIEW)
        close(float(found["radiance"][0]), 0.5 * 0.4)


def test_ignored_transparent_objects_cast_no_shadow_and_opaque_ones_do():
    assert floor_under(CLEAR, rule="ignore") == [0.5, 0.5, 0.5]
    assert floor_under(CLEAR, sphere([0, 0, 5], 0.5, "matt"), rule="ignore") == [0, 0, 0]


def test_only_what_is_strictly_between_point_and_light_counts():
    at_light = {"kind": "disc", "center": [0, 0, 2], "normal": [0, 0, 1], "radius": 1, "material": "matt"}
    assert floor_under(at_light, light=lamp([0, 0, 2], 4.0)) == [0.5, 0.5, 0.5]
    assert floor_under(at_light, light=lamp([0, 0, 2.0000001], 4.0)) == [0, 0, 0]
    assert floor_under(sphere([0, 0, 9], 1, "matt"), light=lamp([0, 0, 2], 4.0)) == [0.5, 0.5, 0.5]
    assert floor_under(sphere([0, 0, -9], 1, "matt"), light=sun([0, 0, -1])) == [0.5, 0.5, 0.5]


def test_a_directional_light_is_at_infinity():
    assert floor_under(sphere([0, 0, 1e9], 10, "matt")) == [0, 0, 0]


@pytest.mark.parametrize(("left", "shaded"), [(0.99, True), (1.01, False)])
def test_shadows_are_sharp_to_the_last_digits(left, shaded):
    # light from (1, 0, 1) passes x = z = 1, the upper edge of the box
    got = floor_under(box([left, -1, 0.7], [1.5, 1, 1.0], "matt"), light=sun([-1, 0, -1]))
    assert (got == [0, 0, 0]) == shaded, got


def test_shadow_rays_are_not_bent():
    # oblique light through a thick pane above an opaque shade: only straight on does it pass the shade's edge
    pane = box([-9, -9, 2], [9, 9, 4], "pane")
    for left, shaded in ((0.99, True), (1.01, False)):
        got = floor_under(pane, box([left, -1, 0.7], [1.5, 1, 1.0], "matt"), light=sun([-1, 0, -1]))
        expected = 0.0 if shaded else 0.5 * 0.5**0.5 * 0.4**2
        assert abs(got[0] - expected) < 1e-14, f"got {got[0]}, expected {expected} with the shade from x = {left}"


@pytest.mark.parametrize("opening", ["attenuate", "ignore"])
def test_an_object_shades_itself(opening):
    # inside an opaque ball no light from outside arrives, whichever way N points
    ball = sphere([0, 0, 0], 1, "m")
    view = {"eye": [0, 0, 0.5], "target": [0, 0, -1], "transparent_shadows": opening}
    assert radiance(ball, materials={"m": MATT}, lights=[sun([0, 0, -1])], **view) == 0
    close(radiance(ball, materials={"m": MATT}, lights=[lamp([0, 0, 0.5])], **view), 0.5 / 1.5**2)
    glass = {"diffuse": 0.5, "transparency": 0.25, "transmission": 0.8, "ior": 1.5}
    through = 0.25 * 0.8 if opening == "attenuate" else 1.0
    close(radiance(ball, materials={"m": glass}, lights=[sun([0, 0, -1])], recursion_limit=0, **view), 0.75 * 0.5 * through)


def test_a_light_behind_a_glass_ball_shines_through_its_far_side():
    glass = {"diffuse": 0.5, "transparency": 0.25, "transmission": 0.8, "ior": 1.0}
    view = {"eye": [0, 0, 4], "target": [0, 0, 0], "recursion_limit": 0}
    got = channels(sphere([0, 0, 0], 1, "m"), materials={"m": glass}, lights=[sun([0, 0, 1])], **view)
    close(float(got["diffuse"][0, 0]), 0.25 * 0.5 * (0.25 * 0.8))


def test_of_coincident_surfaces_only_the_first_is_there():
    # a glass box on an opaque floor: its bottom is the floor
    stacked = box([-1, -1, 0], [1, 1, 1], "pane")
    seen = {"materials": {"matt": MATT, "pane": {**PANE, "ior": 1.0}}, "eye": [0.3, 0.1, 3], "target": [0.2, 0.1, 0]}
    lights = [sun([0, 0, -1])]
    floor_first = channels(FLOOR, stacked, lights=lights, **seen)
    close(float(floor_first["radiance"][0]), 0.4 * (0.5 * 0.4))  # in through the top; light too
    box_first = channels(stacked, FLOOR, lights=lights, background=0.7, **seen)
    close(float(box_first["radiance"][0]), 0.4 * 0.4 * 0.7)  # the floor is not there: below is the background


def test_only_the_side_that_counts_is_asked_for_light():
    # opaque: lights behind do not count; t = 1: those in front do not
    for t, direction, lit in ((0.0, [0, 0, -1], True), (0.0, [0, 0, 1], False), (1.0, [0, 0, -1], False), (1.0, [0, 0, 1], True)):
        got = radiance(FLOOR, materials={"matt": {**MATT, "transparency": t}}, lights=[sun(direction)], recursion_limit=0, **VIEW)
        assert got == (0.5 if lit else 0.0), f"{got} at t = {t}, light along {direction}"
