"""POV-Ray's radiance against an independent evaluation of the lighting model: random scenes, views, meshes, conventions."""

from __future__ import annotations

import numpy as np
import pytest

from equilux_scenes.model import INVERSE_SQUARE
from equilux_tracer import Tracer
from support import plain_phong
from support.edges import LEAST_DELTA_PX, on_edge
from support.povray import Run, bound, case_of_text, expressible, pixel_centres, run, run_all
from support.random_scenes import case_of, random_spec

SHAPES = ("sphere", "box", "disc", "rectangle", "plane")
PROMISE_ABS, PROMISE_REL = 1.2e-5, 1e-4
"""What the project promises of POV-Ray at any pixel off edges: |ΔL| ≤ PROMISE_ABS + PROMISE_REL L."""
ONE_EXPOSURE = 1e-5
"""What it promises of a single exposure where radiance is at most 1: half a step of 1/65535 is 7.6e-6."""
PLAIN_TRUTH = 1e-10
"""Relative accuracy of the plain evaluation, in double precision (its own docstring)."""


def truth_of(case) -> np.ndarray:
    """(h, w, 3), from the plain evaluation."""
    film = case.scene.film
    return plain_phong.radiance(case, pixel_centres(case))[0].reshape(film.height, film.width, 3)


def complaints(result: Run, allowed: np.ndarray, truth: np.ndarray) -> list[str]:
    """Every pixel off edges that is farther from the truth than allowed, with both numbers."""
    wrong = ~(np.abs(result.image - truth) <= allowed + PLAIN_TRUTH * truth).all(axis=2)
    found = np.argwhere(wrong)
    if not len(found):
        return []
    positions = found[:, ::-1] + 0.5
    edge = on_edge(Tracer(result.case), positions, max(LEAST_DELTA_PX, result.budget.film_px))
    return [
        f"{result.case.name} at ({x}, {y}): povray {result.image[y, x]}, truth {truth[y, x]}, allowed {allowed[y, x]}"
        for (y, x), excused in zip(found, edge, strict=True) if not excused
    ]


VIEWS = {
    "plain": {},
    "orthographic": {"fov_deg": None},
    "wide": {"fov_deg": (150.0, 150.0)},
    "narrow": {"fov_deg": (1.0, 1.0)},
    "far from the origin": {"offset": (1e6, -2e5, 3e6)},
    "cylinders": {"shapes": ("cylinder",)},
    "any exponent": {"exponents": (0.1, 1000.0), "lights": (1, 8)},
}


@pytest.mark.parametrize("view", VIEWS)
def test_random_scenes_agree_within_the_promise_and_within_the_budget(view, tmp_path):
    seeds = range(8 if view == "plain" else 4)
    cases = [case_of(expressible(random_spec(900 + seed, **{"shapes": SHAPES, **VIEWS[view]}))) for seed in seeds]
    problems = []
    for result in run_all(cases, tmp_path):
        truth = truth_of(result.case)
        problems += complaints(result, PROMISE_ABS + PROMISE_REL * truth, truth)
        problems += complaints(result, bound(result.budget, truth), truth)
    assert not problems, "\n".join(problems[:10])


def test_one_exposure_of_a_radiance_below_one_is_good_to_1e5(tmp_path):
    cases = [case_of(expressible(random_spec(950 + seed, shapes=SHAPES, exponents=(0.1, 200.0)))) for seed in range(6)]
    dim = [c for c in cases if truth_of(c).max() <= 1.0]
    assert len(dim) >= 2, "no scenes to test with"
    for result in run_all(dim, tmp_path, exposures=1):
        truth = truth_of(result.case)
        assert len(result.raw.files) == 1
        problems = complaints(result, np.full(truth.shape, ONE_EXPOSURE), truth)
        assert not problems, "\n".join(problems[:5])


# --- conventions ------------------------------------------------------------------------------------------------------

THREE_BALLS = """
equilux: 1
name: three-balls
model: phong
camera: {{{camera}}}
film: {{width: 48, height: 32}}
materials:
  red: {{emission: [1, 0, 0]}}
  green: {{emission: [0, 1, 0]}}
  blue: {{emission: [0, 0, 1]}}
objects:   # right of the target, above it, and towards the viewer's lower left
  - {{kind: sphere, center: [1, 0, 0], radius: 0.2, material: red}}
  - {{kind: sphere, center: [0, 0.6, 0], radius: 0.2, material: green}}
  - {{kind: sphere, center: [-0.8, -0.4, 0.3], radius: 0.2, material: blue}}
"""
CAMERAS = {
    "perspective": "projection: perspective, eye: [0, 0, 4], target: [0, 0, 0], fov_y_deg: 30",
    "orthographic": "projection: orthographic, eye: [0, 0, 4], target: [0, 0, 0], height_m: 2",
}


@pytest.mark.parametrize("projection", CAMERAS)
def test_right_is_right_up_is_up_and_row_zero_is_the_top(projection, tmp_path):
    image = run(case_of_text(THREE_BALLS.format(camera=CAMERAS[projection])), tmp_path).image
    middle = {band: np.argwhere(image[..., k] > 0.5).mean(axis=0) for k, band in enumerate(("red", "green", "blue"))}
    assert middle["red"][1] > 36, f"x = +1 is drawn in column {middle['red'][1]} of 48"
    assert abs(middle["red"][0] - 15.5) < 0.6, f"y = 0 is drawn in row {middle['red'][0]} of 32"
    assert middle["green"][0] < 10, f"y = +0.6 is drawn in row {middle['green'][0]} of 32"
    assert abs(middle["green"][1] - 23.5) < 0.6, f"x = 0 is drawn in column {middle['green'][1]} of 48"
    assert middle["blue"][0] > 18, f"y = −0.4 is drawn in row {middle['blue'][0]} of 32"
    assert middle["blue"][1] < 16, f"x = −0.8 is drawn in column {middle['blue'][1]} of 48"


def test_a_tilted_asymmetric_view_is_neither_mirrored_nor_turned(tmp_path):
    camera = "projection: perspective, eye: [3, 1.5, -2], target: [0.1, 0, 0], up: [0.4, 1, 0.2], fov_y_deg: 40"
    case = case_of_text(THREE_BALLS.format(camera=camera))
    result = run(case, tmp_path)
    truth = truth_of(case)
    assert not complaints(result, bound(result.budget, truth), truth)
    for name, other in {"mirrored": truth[:, ::-1], "upside down": truth[::-1], "turned": truth[::-1, ::-1]}.items():
        assert np.abs(result.image - other).max() > 0.5, f"the picture agrees with the truth {name}: the scene proves nothing"


# --- rules of the model that a shadowing, one-sided, albedo-minded renderer could break ------------------------------

STAGE = """
equilux: 1
name: stage
model: phong
camera: {{projection: perspective, eye: [0, 0.5, 4], target: [0, 0, 0], fov_y_deg: 40}}
film: {{width: 32, height: 24}}
lights:
  key: {{{light}}}
materials:
  wall: {{diffuse: [1.7, 0.3, 0], specular: [0, 0.9, 0.2], exponent: {exponent}}}
objects:
{objects}
"""
LIGHT = "kind: point, position: [0, 0.4, 2], intensity: 3"
RULES = {
    "a blocker casts no shadow, and the highlight stays": (LIGHT, 5, [
        "{kind: disc, center: [0, 0, -1], normal: [0, 0, 1], radius: 2, material: wall}",
        "{kind: disc, center: [0, 0.3, 1], normal: [0, 0, 1], radius: 0.3, material: wall}",
    ]),
    "both faces of a surface are lit alike": (LIGHT, 5, [
        "{kind: plane, point: [0, 0, 0], normal: [0.3, 0, -1], material: wall}",
    ]),
    "a light inside a ball lights its inside only": ("kind: point, position: [0, 0, 0.2], intensity: 1", 2, [
        "{kind: sphere, center: [0, 0, 0], radius: 5, material: wall}",
        "{kind: sphere, center: [0, 0, 0], radius: 0.5, material: wall}",
    ]),
    "exponent 0 is a step": (LIGHT, 0, ["{kind: sphere, center: [0, 0, 0], radius: 1, material: wall}"]),
    "exponent 0.1 shines widely": (LIGHT, 0.1, ["{kind: sphere, center: [0, 0, 0], radius: 1, material: wall}"]),
    "exponent 1000 shines narrowly": (LIGHT, 1000, ["{kind: sphere, center: [0, 0, 0], radius: 1, material: wall}"]),
    "a cone of 90° is a half-space": (
        "kind: spot, position: [0, 0, 0.6], direction: [0, -1, -0.2], intensity: 1, cone_half_angle_deg: 90, exponent: 0.5", 5,
        ["{kind: plane, point: [0, 0, 0], normal: [0, 0, 1], material: wall}"]),
    "a cone's exponent may exceed 128": (
        "kind: spot, position: [0, 0, 2], direction: [0, 0, -1], intensity: 9, cone_half_angle_deg: 30, exponent: 777.7", 5,
        ["{kind: plane, point: [0, 0, 0], normal: [0, 0, 1], material: wall}"]),
    "a cone may be one degree wide": (
        "kind: spot, position: [0, 0, 2], direction: [0.1, 0, -1], intensity: 9, cone_half_angle_deg: 5, exponent: 0", 5,
        ["{kind: plane, point: [0, 0, 0], normal: [0, 0, 1], material: wall}"]),
    "of coincident surfaces the first wins": (LIGHT, 5, [
        "{kind: rectangle, corner: [-1, -1, 0], edge_u: [1.3, 0, 0], edge_v: [0, 1.2, 0], material: wall}",
        "{kind: rectangle, corner: [-1, -1, 0], edge_u: [2.6, 0, 0], edge_v: [0, 1.9, 0], material: other}",
    ]),
    "a stretched, turned, mirrored box": (LIGHT, 5, [
        "{kind: box, min: [-0.5, -0.4, -0.3], max: [0.5, 0.6, 0.7], material: wall,"
        " transform: [{scale: [-1.5, 0.7, 1]}, {rotate: {axis: [1, 2, 3], degrees: 50}}, {translate: [0.1, -0.2, 0.3]}]}",
    ]),
}


def stage(rule: str):
    light, exponent, objects = RULES[rule]
    text = STAGE.format(light=light, exponent=exponent, objects="\n".join(f"  - {obj}" for obj in objects))
    return case_of_text(text.replace("materials:", "materials:\n  other: {diffuse: [0.1, 0.2, 0.9]}"))


def test_the_rules_of_the_model_hold(tmp_path):
    problems = []
    for rule, result in zip(RULES, run_all([stage(rule) for rule in RULES], tmp_path), strict=True):
        truth = truth_of(result.case)
        assert np.ptp(truth) > 0, f"{rule}: the truth is constant"
        problems += [f"{rule}: {line}" for line in complaints(result, bound(result.budget, truth), truth)[:2]]
    assert not problems, "\n".join(problems)


def test_the_default_light_falls_off_with_the_square():
    assert (INVERSE_SQUARE.constant, INVERSE_SQUARE.linear, INVERSE_SQUARE.quadratic) == (0.0, 0.0, 1.0)
