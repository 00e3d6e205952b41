"""Changed rules of the local models, each against its formula in NumPy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from equilux_tracer import Tracer, TracerError
from equilux_tracer.channels import CHANNELS
from equilux_tracer.shading_rules import MODEL_RULES, ShadingRules
from support import plain_phong, plain_rules
from support.plain_rules import blinn, phong, powered
from support.random_raytraced import random_raytraced
from support.random_scenes import case_of, random_spec

INERT = {
    "phong": ShadingRules(total_reflection="none"),
    "opengl": ShadingRules(total_reflection="none"),
    "raytraced": ShadingRules(opaque_behind=True),
}
"""Rules that are not the model's, and change nothing in that model: they select the kernels that know rules."""

PLAIN_ERROR = 1e-11
"""Relative to the brightest pixel: plain_phong's own precision (its docstring), with exponents up to 60."""


def spec_of(model, seed, fov_deg=(30.0, 60.0)):
    if model == "raytraced":
        return random_raytraced(seed)
    return {**random_spec(seed, exponents=(0.5, 60.0), fov_deg=fov_deg), "model": model}


@pytest.mark.parametrize("model", INERT)
@pytest.mark.parametrize("seed", range(3))
def test_kernels_that_know_rules_show_the_model_where_no_rule_applies(model, seed):
    case = case_of(spec_of(model, seed))
    names = [name for name in CHANNELS if name not in ("rounding", "signature")]
    expected, got = Tracer(case).render(names), Tracer(case, rules=INERT[model]).render(names)
    for name in names:
        np.testing.assert_allclose(got[name], expected[name], rtol=1e-13, atol=1e-15, err_msg=name)  # other order of sums


@pytest.mark.parametrize("model", INERT)
def test_the_bound_of_rounding_is_no_smaller_than_the_model_s(model):
    case = case_of(spec_of(model, 1))
    expected, got = (Tracer(case, rules=rules).render(["rounding"])["rounding"] for rules in (MODEL_RULES, INERT[model]))
    assert (got >= expected * (1 - 1e-12)).all()


def test_an_unknown_name_of_a_rule_is_refused_with_what_is_allowed():
    with pytest.raises(TracerError, match="viewer: got sideways, allowed model, from-eye, fixed"):
        Tracer(case_of(spec_of("phong", 1)), rules=ShadingRules(viewer="sideways"))


def flipped(c, nh):
    return np.where(c < 0, -nh, nh)


FORMULAS = [
    ("phong", {"half_vector": True}, blinn),
    ("opengl", {"half_vector": True}, phong),
    ("phong", {"diffuse_two_sided": True}, lambda c, rv, nh, p: (np.abs(c), phong(c, rv, nh, p)[1])),
    ("opengl", {"diffuse_two_sided": True}, lambda c, rv, nh, p: (np.abs(c), blinn(c, rv, nh, p)[1])),
    ("phong", {"highlight_two_sided": True}, lambda c, rv, nh, p: (np.maximum(0, c), powered(rv, p))),
    ("opengl", {"highlight_two_sided": True}, lambda c, rv, nh, p: (np.maximum(0, c), powered(flipped(c, nh), p))),
    ("phong", {"highlight_ungated": True}, lambda c, rv, nh, p: (np.maximum(0, c), powered(rv, p))),
    ("opengl", {"highlight_ungated": True}, lambda c, rv, nh, p: (np.maximum(0, c), powered(nh, p))),
    ("phong", {"highlight_cosine": True}, lambda c, rv, nh, p: (np.maximum(0, c), np.maximum(0, c) * powered(rv, p))),
    (
        "phong",
        {"highlight_cosine": True, "highlight_ungated": True},
        lambda c, rv, nh, p: (np.maximum(0, c), np.abs(c) * powered(rv, p)),
    ),
    ("opengl", {"highlight_cosine": True}, lambda c, rv, nh, p: (np.maximum(0, c), np.maximum(0, c) * powered(nh, p))),
    ("phong", {"specular_floor": 0.3}, lambda c, rv, nh, p: (np.maximum(0, c), (c > 0) * np.maximum(0.3, rv) ** p)),
    ("opengl", {"specular_floor": 0.3}, lambda c, rv, nh, p: (np.maximum(0, c), (c > 0) * np.maximum(0.3, nh) ** p)),
]


@pytest.mark.parametrize(("model", "fields", "formula"), FORMULAS, ids=lambda value: value if isinstance(value, str) else None)
def test_a_changed_formula(model, fields, formula):
    changes = [check(case_of(spec_of(model, seed)), ShadingRules(**fields), formula) for seed in range(3)]
    assert max(changes) > 1e-4, f"none of the scenes shows the rule: changes {changes}"


@pytest.mark.parametrize("model", ["phong", "opengl"])
@pytest.mark.parametrize("fov_deg", [(30.0, 60.0), None], ids=["perspective", "orthographic"])
@pytest.mark.parametrize("viewer", ["from-eye", "fixed"])
def test_v_of_the_highlight(model, fov_deg, viewer):
    case = case_of(spec_of(model, 1, fov_deg))
    usual = "fixed" if fov_deg is None and model == "phong" else "from-eye"

    def to_viewer(point, _ray):
        camera = case.scene.camera
        towards = np.array(camera.eye) - (point if viewer == "from-eye" else np.array(camera.target))
        return np.broadcast_to(towards, point.shape)

    change = check(case, ShadingRules(viewer=viewer), phong if model == "phong" else blinn, to_viewer)
    assert (change > 1e-4) == (viewer != usual), f"change {change}"


def test_reversed_normals_light_the_other_side():
    case = case_of(spec_of("phong", 2))
    check(case, ShadingRules(normals_reversed=True), phong, sign=-1)


def check(case, rules, formula, to_viewer=None, sign=1):
    """The rules' channels against the formula's. Returns the largest change that they make, of the brightest pixel."""
    film = case.scene.film
    x, y = np.meshgrid(np.arange(film.width) + 0.5, np.arange(film.height) + 0.5)
    film_xy = np.stack([x.ravel(), y.ravel()], axis=1)
    seen = Tracer(case).evaluate(film_xy, ["object_id", "position", "normal"])
    hit = seen["object_id"] >= 0
    _, direction = plain_phong.rays(case, film_xy)
    point = seen["position"][hit]
    v = -direction[hit] if to_viewer is None else to_viewer(point, direction[hit])
    if case.scene.model == "opengl" and to_viewer is None:
        v = np.array(case.scene.camera.eye) - point
    v = v / np.linalg.norm(v, axis=1, keepdims=True)
    expected = plain_rules.terms(case, formula, seen["object_id"][hit], point, sign * seen["normal"][hit], v)
    got = Tracer(case, rules=rules).evaluate(film_xy, list(expected))
    unchanged = Tracer(case).evaluate(film_xy)["radiance"]
    for name, value in expected.items():
        np.testing.assert_allclose(got[name][hit], value, rtol=0, atol=PLAIN_ERROR * value.max(), err_msg=name)
    return np.abs(got["radiance"] - unchanged).max() / unchanged.max()


# --- which side N is on -------------------------------------------------------------------------------------------------

BALL = {"kind": "sphere", "center": [0, 0, 0], "radius": 1.0}
MATT = {"diffuse": 0.5}


def in_a_ball(make_case, light, **rules):
    camera = {"projection": "perspective", "eye": [0, 0, 0.5], "target": [0, 0, -1], "up": [0, 1, 0], "fov_y_deg": 20}
    lights = [{"kind": "point", "position": light, "intensity": 1}]
    case = make_case(BALL, lights=lights, material=MATT, camera=camera, film={"width": 1, "height": 1})
    return Tracer(case, rules=ShadingRules(**rules)).render()["radiance"][0, 0, 0]


def test_a_normal_as_given_is_lit_from_outside_wherever_the_eye_is(make_case):
    inside, outside = (0, 0, 0), (0, 0, -3)
    assert in_a_ball(make_case, inside) == 0.5
    assert in_a_ball(make_case, outside) == 0
    assert in_a_ball(make_case, inside, normal_side="as-given") == 0
    assert in_a_ball(make_case, outside, normal_side="as-given") == 0.5 / 4
    assert in_a_ball(make_case, inside, normal_side="as-given", normals_reversed=True) == 0.5


# --- the path signature, and numbers that no spec has ---------------------------------------------------------------------


def gate_signatures(make_case, **rules):
    """On a ball lit along −y, at two film positions on either side of N·L = 0."""
    sun = {"kind": "directional", "direction": [0, -1, 0], "irradiance": 1}
    case = make_case({**BALL, "radius": 3.0}, lights=[sun], material={"diffuse": 0.5, "specular": 0.5, "exponent": 5})
    return Tracer(case, rules=ShadingRules(**rules)).evaluate([[4.0, 3.9], [4.0, 4.1]], ["signature"])["signature"]


def test_without_a_gate_the_signature_knows_none(make_case):
    gated, ungated = gate_signatures(make_case, half_vector=True), gate_signatures(make_case, highlight_ungated=True)
    assert gated[0] != gated[1]
    assert ungated[0] == ungated[1]


@pytest.mark.parametrize("model", ["phong", "opengl", "raytraced"])
@pytest.mark.parametrize("rules", [MODEL_RULES, replace(MODEL_RULES, vertex_lighting=True)], ids=["model", "ruled"])
def test_a_cone_of_180_degrees_holds_everything(make_case, model, rules):
    point = {"kind": "point", "position": [0, 1, 2], "intensity": 5}
    spot = {**point, "kind": "spot", "direction": [0, 0, 1], "cone_half_angle_deg": 90}
    floor = {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}
    lit = make_case(floor, lights=[point], material=MATT, model=model)
    case = make_case(floor, lights=[spot], material=MATT, model=model)
    wide = case.scene.lights["l0"].model_copy(update={"cone_half_angle_deg": 180.0})
    case = replace(case, scene=case.scene.model_copy(update={"lights": {"l0": wide}}))
    got, expected = (Tracer(which, rules=rules).render()["radiance"] for which in (case, lit))
    np.testing.assert_array_equal(got, expected)
    assert expected.min() > 0
