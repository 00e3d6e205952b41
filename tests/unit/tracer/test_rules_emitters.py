"""Changed rules of model reflection-equation: of the integrals over emitters, and of the lights beside them."""

from __future__ import annotations

import numpy as np
import pytest

from equilux_tracer import Tracer
from equilux_tracer.shading_rules import MODEL_RULES, ShadingRules
from support import plain_phong
from support.random_emitter_scenes import random_emitter_spec
from support.random_scenes import case_of

TOLERANCE = 3e-6
"""Of the brightest pixel: three times the tracer's error target."""

FLOOR = {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "m"}
LID = {"kind": "rectangle", "corner": [-1, -1, 1], "edge_u": [2, 0, 0], "edge_v": [0, 2, 0], "material": "black"}
LAMP = {"kind": "sphere", "center": [0.3, 0.2, 2.0], "radius": 0.5, "radiance": [3.0, 2.0, 1.0]}
BELOW = {**LAMP, "center": [0.3, 0.2, -2.0]}
POINT = {"kind": "point", "position": [0.5, -0.5, 1.5], "intensity": 2.0}
GLOSSY = {"diffuse": 0.2, "specular": 0.3, "exponent": 6, "brdf": "phong-classic"}


def case_with(lights, camera=None, objects=(FLOOR,), material=GLOSSY):
    perspective = {"projection": "perspective", "eye": [0, -6, 2.5], "target": [0, 0, 0], "up": [0, 0, 1], "fov_y_deg": 20}
    return case_of(
        {
            "equilux": 1,
            "name": "some",
            "model": "reflection-equation",
            "camera": {key: value for key, value in {**perspective, **(camera or {})}.items() if value is not None},
            "film": {"width": 6, "height": 4},
            "lights": {f"l{k}": light for k, light in enumerate(lights)},
            "materials": {"m": material, "black": {}},
            "objects": list(objects),
        }
    )


def seen(*objects, lights, material=GLOSSY, rules=MODEL_RULES, channel="radiance", camera=None):
    """A channel of the film, 0 where anything but the first object is seen."""
    case = case_with(lights, camera or {"eye": [0, -6, 0.8]}, objects, material)
    out = Tracer(case, rules=rules).render([channel, "object_id"])
    floor = out["object_id"] == 0
    assert floor.any()
    return np.where(floor.reshape(floor.shape + (1,) * (out[channel].ndim - 2)), out[channel], 0)


def close(got, expected):
    np.testing.assert_allclose(got, expected, rtol=0, atol=TOLERANCE * np.abs(expected).max())


def differ(a, b):
    assert np.abs(a - b).max() > 100 * TOLERANCE * max(a.max(), b.max())


@pytest.mark.parametrize("seed", range(2))
def test_kernels_that_know_rules_show_the_model_where_no_rule_applies(seed):
    case = case_of(random_emitter_spec(seed))
    inert = ShadingRules(total_reflection="none")
    names = ["radiance", "diffuse", "specular", "emission", "object_id", "quadrature"]
    expected, got = Tracer(case).render(names), Tracer(case, rules=inert).render(names)
    for name in names:
        np.testing.assert_allclose(got[name], expected[name], rtol=1e-9, atol=1e-12, err_msg=name)  # R rounded otherwise


@pytest.mark.parametrize("light", [LAMP, POINT], ids=["emitter", "point"])
def test_without_occlusion_nothing_stands_in_between(light):
    lid = {**LID, "corner": [-1, -1, 1.2]}
    open_floor, shaded = seen(FLOOR, lights=[light]), seen(FLOOR, lid, lights=[light])
    unblocked = seen(FLOOR, lid, lights=[light], rules=ShadingRules(occlusion=False))
    differ(open_floor, shaded)
    close(unblocked, open_floor)


def test_reversed_normals_are_lit_from_below():
    reversed_n = ShadingRules(normals_reversed=True)
    differ(seen(FLOOR, lights=[LAMP]), seen(FLOOR, lights=[LAMP], rules=reversed_n))
    assert seen(FLOOR, lights=[LAMP], rules=reversed_n).max() == 0
    # as much as a floor that is seen from below gets from an emitter on the viewer's side
    mirrored = seen(FLOOR, lights=[LAMP], rules=MODEL_RULES, channel="diffuse")
    close(seen(FLOOR, lights=[BELOW], rules=reversed_n, channel="diffuse"), mirrored)


@pytest.mark.parametrize("light", [BELOW, {**POINT, "position": [0.5, -0.5, -1.5]}], ids=["emitter", "point"])
def test_two_sided_diffuse_light_comes_from_below_too(light):
    up = {key: [v[0], v[1], -v[2]] if key in ("center", "position") else v for key, v in light.items()}
    both = ShadingRules(diffuse_two_sided=True)
    assert seen(FLOOR, lights=[light]).max() == 0
    expected = seen(FLOOR, lights=[up], channel="diffuse")
    close(seen(FLOOR, lights=[light], channel="diffuse", rules=both), expected)
    close(seen(FLOOR, lights=[up], channel="diffuse", rules=both), expected)


@pytest.mark.parametrize("light", [LAMP, POINT], ids=["emitter", "point"])
def test_the_highlight_s_cosine_is_that_of_brdf_phong_cosine(light):
    cosine = {**GLOSSY, "brdf": "phong-cosine"}
    rules = ShadingRules(highlight_cosine=True)
    expected = seen(FLOOR, lights=[light], material=cosine)
    differ(expected, seen(FLOOR, lights=[light]))
    close(seen(FLOOR, lights=[light], rules=rules), expected)
    close(seen(FLOOR, lights=[light], material=cosine, rules=rules), expected)


def test_ungated_highlights_of_what_is_below_the_horizon():
    # grazing light on both sides of the floor: without a gate, both halves of the emitter count, about one R
    half_sunk = {**LAMP, "center": [0.0, 5.0, 0.0], "radius": 1.0}
    ungated = seen(FLOOR, lights=[half_sunk], channel="specular", rules=ShadingRules(highlight_ungated=True))
    two_sided = seen(FLOOR, lights=[half_sunk], channel="specular", rules=ShadingRules(highlight_two_sided=True))
    gated = seen(FLOOR, lights=[half_sunk], channel="specular")
    close(two_sided, ungated)
    assert (ungated >= gated).all()
    differ(ungated, gated)
    # seen edge-on R lies in the floor's plane, to 2e-4, and both halves are alike
    edge_on = {"eye": [0, -6, 1e-6], "target": [0, 0, -1e-3], "fov_y_deg": 1e-3}
    both = seen(FLOOR, lights=[half_sunk], channel="specular", rules=ShadingRules(highlight_ungated=True), camera=edge_on)
    one = seen(FLOOR, lights=[half_sunk], channel="specular", camera=edge_on)
    np.testing.assert_allclose(both, 2 * one, rtol=6 * 2e-4)  # times the exponent


@pytest.mark.parametrize("light", [LAMP, POINT], ids=["emitter", "point"])
def test_v_of_the_highlight(light):
    # a parallel view and one in perspective from the same eye, of the same points
    perspective = case_with([light])
    parallel = case_with([light], {"projection": "orthographic", "height_m": 2.0, "fov_y_deg": None})
    out = Tracer(parallel).render(["position", "specular"])
    points, of_parallel = out["position"].reshape(-1, 3), out["specular"].reshape(-1, 1, 3)
    film_xy = plain_phong.film_positions_of(perspective, points)
    of_perspective = Tracer(perspective).evaluate(film_xy, ["specular"])["specular"]
    differ(of_perspective, of_parallel)
    from_eye = Tracer(parallel, rules=ShadingRules(viewer="from-eye")).render(["specular"])["specular"].reshape(-1, 1, 3)
    close(from_eye, of_perspective)
    close(Tracer(perspective, rules=ShadingRules(viewer="fixed")).evaluate(film_xy, ["specular"])["specular"], of_parallel)
