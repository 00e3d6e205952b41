"""Which objects share a surface, and which of them gives way."""

from __future__ import annotations

from equilux_adapters._triangles.coincident import set_backs
from support.random_scenes import case_of, random_spec


def steps(*objects: dict[str, object]) -> list[int]:
    spec = random_spec(1)
    spec["objects"] = [{"material": "m0", **obj} for obj in objects]
    return set_backs(case_of(spec))


def card(x: float, z: float = 0.0, **more: object) -> dict[str, object]:
    return {"kind": "rectangle", "corner": [x, 0, z], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0], **more}


FLOOR = {"kind": "plane", "point": [5, 0, 7], "normal": [0, -2, 0]}
CRATE = {"kind": "box", "min": [0, 0, 0], "max": [1, 1, 1]}


def test_objects_apart_stay_where_they_are():
    assert steps(card(0), card(0, z=0.1), CRATE | {"min": [0, 0, 0.2]}) == [0, 0, 0]


def test_later_objects_in_one_surface_go_farther_back():
    assert steps(card(0), card(0.5), card(0.7)) == [0, 1, 2]


def test_tiles_side_by_side_do_not_give_way():
    assert steps(card(0), card(1), card(2), card(3)) == [0, 0, 0, 0]


def test_an_infinite_plane_stays_and_what_lies_in_it_comes_forward():
    assert steps(CRATE, FLOOR, {"kind": "disc", "center": [0, 0, 0], "normal": [0, 1, 0], "radius": 1}) == [-1, 0, 1]


def test_a_transform_may_bring_surfaces_together():
    assert steps(card(0), card(0, z=-2, transform=[{"translate": [0, 0, 2]}])) == [0, 1]


def test_equal_spheres_and_coaxial_cylinders_share_their_surface():
    ball = {"kind": "sphere", "center": [0, 0, 0], "radius": 1}
    pipe = {"kind": "cylinder", "radius": 0.5, "capped": False}
    assert steps(ball, dict(ball), ball | {"radius": 1.1}) == [0, 1, 0]
    assert steps(pipe | {"base": [0, 0, 0], "top": [0, 1, 0]}, pipe | {"base": [0, 2, 0], "top": [0, 0.5, 0]}) == [0, 1]
