"""Mirrors: what they show, how often, and what the recursion limit leaves of it."""

from __future__ import annotations

import numpy as np
import pytest

from equilux_tracer import Tracer
from support.one_ray import channels, close, plane, radiance, sphere, sun
from support.random_scenes import case_of, random_spec

MIRROR = {"reflection": 1.0}


@pytest.mark.parametrize("seed", range(4))
def test_a_plane_mirror_shows_the_scene_as_its_mirror_image_would_see_it(seed):
    spec = random_spec(seed, shapes=("sphere", "box", "disc", "cylinder"), exponents=(1.0, 50.0), film=(32, 24), transforms=False)
    for light in spec["lights"].values():  # on the far side of the scene, so that the mirror at x = −3 hides none
        if light["kind"] == "directional":
            light["direction"][0] = -abs(light["direction"][0])
        else:
            light["position"][0] = abs(light["position"][0])
    view = {"projection": "perspective", "up": [0, 1, 0], "fov_y_deg": 70}
    mirror = {"kind": "rectangle", "corner": [-3, -20, -20], "edge_u": [0, 40, 0], "edge_v": [0, 0, 40], "material": "mirror"}
    looking_into_it = {
        **spec,
        "model": "raytraced",
        "camera": {**view, "eye": [-2.0, 0.3, 0.2], "target": [-4.0, 0.1, 0.0]},
        "materials": {**spec["materials"], "mirror": MIRROR},
        "objects": [mirror, *spec["objects"]],
    }
    from_behind_it = {
        **spec,
        "model": "raytraced",
        "camera": {**view, "eye": [-4.0, 0.3, 0.2], "target": [-2.0, 0.1, 0.0]},
    }
    reflected = Tracer(case_of(looking_into_it)).render(["reflected"])["reflected"]
    direct = Tracer(case_of(from_behind_it)).render(["radiance"])["radiance"][:, ::-1]
    assert np.ptp(direct) > 0.01
    # both pictures are good to 1e-13 of lights of about 10
    np.testing.assert_allclose(reflected, direct, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("limit", [0, 1, 2, 7, 30])
@pytest.mark.parametrize("k", [0.5, 0.9])
def test_two_parallel_mirrors_are_a_geometric_series_cut_off_by_the_limit(limit, k):
    mirror = {"emission": 0.3, "reflection": k}
    got = radiance(
        plane([0, 0, 1], [0, 0, -1], "m"), plane([0, 0, -1], [0, 0, 1], "m"), materials={"m": mirror}, eye=[0, 0, 0],
        target=[0.2, 0.1, 1], recursion_limit=limit,
    )  # fmt: skip
    close(got, 0.3 * (1 - k ** (limit + 1)) / (1 - k))


def test_what_the_limit_cuts_off_is_the_tail_of_the_series():
    mirror, k = {"emission": 0.3, "reflection": 0.8}, 0.8
    mirrors = plane([0, 0, 1], [0, 0, -1], "m"), plane([0, 0, -1], [0, 0, 1], "m")
    view = {"materials": {"m": mirror}, "eye": [0, 0, 0], "target": [0.2, 0.1, 1]}
    short, long = (radiance(*mirrors, recursion_limit=limit, **view) for limit in (5, 60))
    tail = 0.3 * (k**6 - k**61) / (1 - k)
    assert abs((long - short) - tail) < 1e-14, f"cut off {long - short}, expected {tail}"


def test_a_thousand_reflections_need_no_stack():
    mirror = {"emission": 0.25, "reflection": 1.0}
    mirrors = plane([0, 0, 1], [0, 0, -1], "m"), plane([0, 0, -1], [0, 0, 1], "m")
    got = radiance(*mirrors, materials={"m": mirror}, eye=[0, 0, 0], target=[0.2, 0.1, 1], recursion_limit=1000)
    close(got, 0.25 * 1001)


def test_however_little_a_reflection_counts_it_is_followed():
    faint, lamp = {"reflection": 1e-30}, {"emission": 7.0}
    got = radiance(
        plane([0, 0, 0], [0, 1, 0], "faint"), plane([0, 5, 0], [0, 1, 0], "lamp"), materials={"faint": faint, "lamp": lamp},
        eye=[0, 1, 1], target=[0, 0, 0],
    )  # fmt: skip
    close(got, 7e-30)


def test_the_background_is_seen_at_the_last_allowed_depth_and_nothing_is_beyond():
    floor = plane([0, 0, 0], [0, 1, 0], "m")
    view = {"materials": {"m": {"reflection": 0.5, "emission": 0.1}}, "eye": [0, 1, 1], "target": [0, 0, 0], "background": 0.8}
    close(radiance(floor, recursion_limit=1, **view), 0.1 + 0.5 * 0.8)
    close(radiance(floor, recursion_limit=0, **view), 0.1)


@pytest.mark.parametrize("distance", [3.0, 30.0])
def test_a_mirror_ball_shows_what_lies_in_the_mirrored_direction(distance):
    # Which way the mirrored ray goes is told by the highlight of a sun on a wall: it depends on the direction alone.
    offset = 0.6
    eye, target = [offset, 0, distance], [offset, 0, 0]
    normal = np.array([offset, 0, np.sqrt(1 - offset**2)])
    onward = 2 * normal[2] * normal - np.array([0, 0, 1])  # mirrored (0, 0, 1), to the right
    wall = {"specular": 1.0, "exponent": 3.0}
    got = radiance(
        sphere([0, 0, 0], 1, "mirror"), plane([2, 0, 0], [-1, 0, 0], "wall"),
        materials={"mirror": {"reflection": 0.7}, "wall": wall}, eye=eye, target=target, lights=[sun([1, 0.2, 0.1])],
    )  # fmt: skip
    to_light = -np.array([1, 0.2, 0.1]) / np.linalg.norm([1, 0.2, 0.1])
    n = np.array([-1.0, 0, 0])
    lobe = (2 * (n @ to_light) * n - to_light) @ -onward
    expected = 0.7 * max(lobe, 0) ** 3
    assert expected > 0.01
    close(got, expected, 1e-12)


def test_terms_of_the_first_surface_and_what_it_mirrors_sum_up_to_radiance():
    surface = {"diffuse": 0.2, "specular": 0.3, "exponent": 4, "emission": 0.1, "ambient": 0.5, "reflection": 0.25}
    found = channels(
        plane([0, 0, 0], [0, 1, 0], "m"), plane([0, 5, 0], [0, 1, 0], "lamp"),
        materials={"m": surface, "lamp": {"emission": 2.0}},
        eye=[0, 1, 1], target=[0, 0, 0], ambient=0.4, lights=[sun([0.1, -1, -0.9])],
    )  # fmt: skip
    terms = {name: found[name].sum(axis=0) if name in ("diffuse", "specular") else found[name] for name in
             ("emission", "ambient", "diffuse", "specular", "reflected", "transmitted")}  # fmt: skip
    # the lamp's plane is opaque and above the sun's way in: only the mirrored part and emission and ambient are left
    assert terms["reflected"][0] == 0.5, terms["reflected"]
    assert terms["transmitted"][0] == 0, terms["transmitted"]
    assert terms["diffuse"][0] == 0, terms["diffuse"]
    close(float(found["radiance"][0]), 0.1 + 0.5 * 0.4 + 0.5)
    close(float(sum(t[0] for t in terms.values())), float(found["radiance"][0]))
