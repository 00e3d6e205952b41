"""Model `opengl`: by hand, against fifty digits, and against a plain evaluation."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest
from mpmath import mp, mpf

import equilux_oracle
from equilux_oracle.precise import evaluate_at
from support import plain_raytraced
from support.random_scenes import case_of, random_spec

TRACERS_BOUND = 1e-12
SHARE = 0.1
ROUNDING = 1e-14
"""Some forty roundings of 1.1e-16 on values of order one."""

FLOOR = {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}
SUN = {"kind": "directional", "direction": [0, 0, -1], "irradiance": [3, 2, 1]}
FROM_ABOVE = {"projection": "perspective", "eye": [0, 0, 3], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y_deg": 90}


def opengl(seed, *, exponents=(0.1, 128.0), **options):
    """A random scene whose lights have colours of their own."""
    rng = random.Random(f"opengl {seed}")
    spec = {**random_spec(seed, exponents=exponents, **options), "model": "opengl", "viewer": ("local", "infinite")[seed % 2]}
    for light in spec["lights"].values():
        light.update({term: [rng.uniform(0, 1) for _ in range(3)] for term in ("ambient", "diffuse", "specular")})
    return spec


GROUPS = {
    "plain": {},
    "a million metres from the origin": {"offset": (1e6, -1e6, 1e6)},
    "narrow": {"fov_deg": (1.0, 1.0)},
    "orthographic": {"fov_deg": None},
    "soft highlights": {"exponents": (0.1, 0.9)},
    "sharp highlights": {"exponents": (100.0, 128.0)},
}


@pytest.mark.parametrize("group", GROUPS)
def test_the_oracle_agrees_with_fifty_digits(group):
    of_scale, of_bound, hits = 0.0, 0.0, 0
    for seed in range(8):
        case, rng = case_of(opengl(seed, **GROUPS[group])), random.Random(seed)
        positions = [(rng.uniform(0, case.scene.film.width), rng.uniform(0, case.scene.film.height)) for _ in range(6)]
        found = equilux_oracle.examine(case, positions)
        for k, (x, y) in enumerate(positions):
            true = evaluate_at(case, x, y)
            assert found.object_id[k] == (-1 if true.seen is None else true.seen.index), f"{case.name} at ({x}, {y})"
            if true.scale is None:
                continue
            hits += 1
            with mp.workdps(50):
                for band in range(3):
                    error, bound = abs(mpf(found.radiance[k, band]) - true.radiance[band]), found.bound[k, band]
                    assert error <= bound, f"{case.name} at ({x}, {y}): off by {mp.nstr(error, 3)}, bound {bound}"
                    if error > 0:
                        of_scale = max(of_scale, float(error / (true.scale[band] * TRACERS_BOUND)))
                        of_bound = max(of_bound, float(error / bound))
                    assert abs(mpf(found.scale[k, band]) - true.scale[band]) <= TRACERS_BOUND * true.scale[band]
    print(f"\n{group}: worst error ÷ (1e-12 scale) {of_scale:.2g}, ÷ own bound {of_bound:.2g}, over {hits} positions")
    assert hits >= 12
    assert of_scale <= SHARE, f"{group}: error is {of_scale} of 1e-12 of the scale, allowed {SHARE}"


def test_the_oracle_agrees_with_a_plain_evaluation_off_edges():
    worst = 0.0
    for seed in range(50, 80):
        case = case_of(opengl(seed, fov_deg=None if seed % 3 == 0 else (20.0, 90.0)))
        positions = equilux_oracle.pixel_centers(case.scene.film)
        plain, _ = plain_raytraced.radiance(case, positions)
        found = equilux_oracle.evaluate(case, positions)
        off = np.max(np.abs(plain - found) / (1 + np.abs(found)), axis=1)
        doubtful = np.flatnonzero(off > 1e-9)
        on_edge = plain_raytraced.on_edge(case, positions[doubtful], 1e-5) if len(doubtful) else np.zeros(0, dtype=bool)
        for k in doubtful[~on_edge]:
            pytest.fail(f"{case.name} at {positions[k]}: oracle {found[k].tolist()}, plain evaluation {plain[k].tolist()}")
        worst = max(worst, float(np.max(off[off <= 1e-9])))
    print(f"\nworst {worst:.2g} of 1 + L")


def at_middle(case):
    return equilux_oracle.evaluate(case, [[4, 4]])[0]


def assert_bands(got, true, where=""):
    assert np.allclose(got, true, rtol=ROUNDING, atol=0), f"oracle {got.tolist()}, by hand {list(true)} {where}"


def test_all_terms_of_the_formula_add_up(make_case):
    # N = L = V = H: e + a a_global + E (a a_i + d d_i + s s_i).
    light = {**SUN, "ambient": [0.5, 0.25, 1], "diffuse": [1, 0.5, 0.25], "specular": [0.5, 1, 2]}
    material = {"emission": 0.125, "ambient": [0.5, 1, 0.25], "diffuse": [0.25, 0.5, 1], "specular": 0.5, "exponent": 7}
    case = make_case(FLOOR, material, light, model="opengl", ambient=[0.5, 0.25, 1], camera=FROM_ABOVE)
    expected = [
        0.125 + a * g + e * (a * la + d * ld + 0.5 * ls)
        for a, g, e, la, d, ld, ls in zip(
            (0.5, 1, 0.25), (0.5, 0.25, 1), (3, 2, 1), (0.5, 0.25, 1), (0.25, 0.5, 1), (1, 0.5, 0.25), (0.5, 1, 2), strict=True
        )
    ]
    assert_bands(at_middle(case), expected)


def test_by_default_a_light_has_no_ambient_share_and_full_diffuse_and_specular_ones(make_case):
    material = {"ambient": 1, "diffuse": 0.5, "specular": 0.25, "exponent": 3}
    assert_bands(at_middle(make_case(FLOOR, material, SUN, model="opengl", camera=FROM_ABOVE)), [2.25, 1.5, 0.75])


def test_the_ambient_share_reaches_what_the_light_does_not(make_case):
    below = {"kind": "point", "position": [0, 0, -2], "intensity": 4, "ambient": 0.5}
    case = make_case(
        FLOOR, {"ambient": 0.5, "diffuse": 1, "specular": 1, "exponent": 0}, below, model="opengl", camera=FROM_ABOVE
    )
    assert_bands(at_middle(case), [0.25] * 3, "E = 4/2² = 1 weakens the ambient share; no highlight where N·L < 0")


def test_the_cone_of_a_spot_cuts_its_ambient_share_too(make_case):
    spot = {
        "kind": "spot",
        "position": [3, 0, 1],
        "direction": [0, 0, -1],
        "intensity": 4,
        "ambient": 1,
        "cone_half_angle_deg": 20,
    }
    case = make_case(FLOOR, {"ambient": 1, "diffuse": 1}, spot, model="opengl", camera=FROM_ABOVE)
    assert at_middle(case).tolist() == [0, 0, 0]


def test_the_highlight_is_about_the_half_vector(make_case):
    # L at 60° from N = V: H at 30°, (N·H)^4 = (√3/2)^4 = 9/16.
    light = {"kind": "directional", "direction": [-math.sqrt(3), 0, -1], "irradiance": 1}
    case = make_case(FLOOR, {"specular": 1, "exponent": 4}, light, model="opengl", camera=FROM_ABOVE)
    assert_bands(at_middle(case), [9 / 16] * 3)


@pytest.mark.parametrize("projection", ["perspective", "orthographic"])
def test_a_local_viewer_looks_from_the_eye_and_an_infinite_one_along_the_view(make_case, projection):
    # At (3, 0, 0) below an eye at (0, 0, 3): V is 45° off N, or N itself; L = N, so H is 22.5° off N, or N itself.
    camera = FROM_ABOVE if projection == "perspective" else {**FROM_ABOVE, "projection": "orthographic", "height_m": 6}
    camera = {key: value for key, value in camera.items() if projection == "perspective" or key != "fov_y_deg"}
    material = {"specular": 1, "exponent": 8}
    for viewer, cosine in (("local", math.cos(math.radians(22.5))), ("infinite", 1.0)):
        case = make_case(FLOOR, material, SUN, model="opengl", camera=camera, viewer=viewer)
        got = equilux_oracle.evaluate(case, [[8, 4]])[0]
        assert_bands(got, np.array([3, 2, 1]) * cosine**8, f"{projection}, viewer {viewer}")


def test_the_side_of_the_normal_is_the_facets_whatever_the_viewer(make_case):
    # A parallel view from above of a wall that leans so that the eye point is behind it: the ray still meets its upper face.
    wall = {"kind": "plane", "point": [3, 0, 0], "normal": [1, 0, 0.2]}
    view = {"projection": "orthographic", "eye": [0, 0, 3], "target": [0, 0, 0], "up": [0, 1, 0], "height_m": 8}
    lamp = {"kind": "directional", "direction": [-1, 0, -0.2], "irradiance": 1}
    case = make_case(wall, {"diffuse": 1}, lamp, model="opengl", camera=view)
    assert_bands(equilux_oracle.evaluate(case, [[7.2, 4]])[0], [1, 1, 1], "lit along its normal")


def test_nothing_occludes(make_case):
    roof = {"kind": "rectangle", "corner": [-1, -1, 4], "edge_u": [2, 0, 0], "edge_v": [0, 2, 0], "material": "m"}
    case = make_case(FLOOR, {"diffuse": 1}, SUN, model="opengl", objects=[{**FLOOR, "material": "m"}, roof], camera=FROM_ABOVE)
    assert_bands(at_middle(case), [3, 2, 1])
