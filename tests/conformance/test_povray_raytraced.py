"""POV-Ray's ray tracing against an independent evaluation of the lighting model, less the one term it lacks: T·V."""

from __future__ import annotations

import copy
from collections.abc import Iterable
from typing import Any

import numpy as np
import pytest

from equilux.uncertainty import stated
from equilux_scenes.case import Case
from equilux_tracer import Tracer
from support import plain_raytraced
from support.povray import Run, bound, case_of_text, expressible, pixel_centres, run, run_all
from support.random_raytraced import random_raytraced
from support.random_scenes import case_of

PLAIN_TRUTH = 1e-9
"""Relative accuracy of the plain evaluation after a few bounces off small balls, in double precision."""
ONE_EXPOSURE = 1e-5
"""What the project promises of one exposure of radiances up to 1; half a step of the file is 7.6e-6."""
LEAST_DELTA_PX = 1e-6

GROUPS = {
    "all sorts": (range(8), {}),
    "five bounces": (range(6), {"recursion": (5, 5), "objects": (6, 8)}),
    "one bounce cuts most paths": (range(4), {"recursion": (1, 1), "objects": (6, 8)}),
    "cylinders": (range(4), {"shapes": ("cylinder", "sphere")}),
    "orthographic": (range(6), {"projections": ("orthographic",)}),
    "in the open": (range(4), {"plane": False, "recursion": (4, 5)}),
}


@pytest.fixture(autouse=True)
def without_transmitted_highlight(monkeypatch):
    monkeypatch.setattr(plain_raytraced, "TRANSMITTED_HIGHLIGHT", 0.0)


def truth_of(case: Case) -> np.ndarray:
    film = case.scene.film
    return plain_raytraced.radiance(case, pixel_centres(case))[0].reshape(film.height, film.width, 3)


def complaints(result: Run, allowed: np.ndarray | None = None) -> list[str]:
    """Every pixel off edges that is farther from the truth than allowed (None: its own budget), with both numbers."""
    truth = truth_of(result.case)
    error = np.abs(result.image - truth) - PLAIN_TRUTH * truth
    limit = bound(result.budget, truth) if allowed is None else allowed
    if allowed is None and (error > limit).any():
        # what indices in float32 and meshes do takes the reference to carry it along the paths
        limit = stated(result.budget, result.image.astype(np.float32), Tracer(result.case)).bound(truth)
    wrong = np.argwhere((error > limit).any(axis=2))
    if not len(wrong):
        return []
    edge = plain_raytraced.on_edge(result.case, wrong[:, ::-1] + 0.5, max(LEAST_DELTA_PX, result.budget.film_px))
    return [
        f"{result.case.name} at ({x}, {y}): povray {result.image[y, x]}, truth {truth[y, x]}, allowed {limit[y, x]}"
        for (y, x), excused in zip(wrong, edge, strict=True) if not excused
    ]


def random_cases(seeds: Iterable[int], **options: Any) -> list[Case]:
    return [case_of(expressible(random_raytraced(5000 + seed, **options))) for seed in seeds]


@pytest.mark.parametrize("group", GROUPS)
def test_random_scenes_agree_within_the_budget(group, tmp_path):
    seeds, options = GROUPS[group]
    problems = []
    for result in run_all(random_cases(seeds, **options), tmp_path):
        problems += complaints(result)
    assert not problems, "\n".join(problems[:10])


def test_one_exposure_is_good_to_half_a_step_of_its_file(tmp_path):
    dim = [case for case in random_cases(range(100, 116), film=(16, 12)) if truth_of(case).max() <= 1.0]
    assert len(dim) >= 4, f"only {len(dim)} scenes to test with"
    for result in run_all(dim, tmp_path, exposures=1):
        assert len(result.raw.files) == 1
        problems = complaints(result, np.full(result.image.shape, ONE_EXPOSURE))
        assert not problems, "\n".join(problems[:5])


def scaled(spec: dict[str, Any], factor: float) -> dict[str, Any]:
    """The same picture of a scene `factor` times as large."""
    result = copy.deepcopy(spec)
    camera = result["camera"]
    parts = [camera, *result["objects"], *(step for obj in result["objects"] for step in obj.get("transform", []))]
    lengths = ("eye", "target", "height_m", "center", "point", "min", "max", "corner", "edge_u", "edge_v", "base", "top")
    for part in parts:
        for key in (*lengths, "radius", "translate"):
            if key in part:
                part[key] = (np.array(part[key]) * factor).tolist()
    for light in result["lights"].values():
        if "position" in light:
            light["position"] = [factor * x for x in light["position"]]
            terms = light.pop("attenuation", {"constant": 0.0, "linear": 0.0, "quadratic": 1.0})
            powers = {"constant": 0, "linear": 1, "quadratic": 2}
            light["attenuation"] = {name: value / factor ** powers[name] for name, value in terms.items()}
    return result


@pytest.mark.parametrize("factor", [1e-9, 1e-4, 1e6])
def test_scenes_of_any_size_agree(factor, tmp_path):
    specs = [expressible(random_raytraced(5200 + seed, objects=(6, 8))) for seed in range(2)]
    problems = []
    for result in run_all([case_of(scaled(spec, factor)) for spec in specs], tmp_path):
        problems += complaints(result)
    assert not problems, "\n".join(problems[:5])


# --- rules that a random scene would rarely put to the test -----------------------------------------------------------

STAGE = """
equilux: 1
name: stage
model: raytraced
camera: {{projection: perspective, eye: [0.1, 0.4, 4], target: [0, 0, 0], fov_y_deg: 40}}
film: {{width: 32, height: 24}}
ambient: 0.2
background: [0.3, 0.2, 0.1]
recursion_limit: {limit}
lights:
  key: {{kind: point, position: [0.8, 1.4, 3], intensity: 5}}
  sun: {{kind: directional, direction: [-0.3, -1, -0.4], irradiance: [0.5, 1, 2]}}
materials:
  wall: {{diffuse: [0.7, 0.3, 0.1], specular: 0.2, exponent: 8, ambient: 0.4}}
  mirror: {{reflection: [0.9, 0.8, 0.7], emission: 0.01}}
  pane: {{transparency: 0.7, transmission: [0.9, 0.5, 0.8], diffuse: [0.2, 0, 0.4], emission: [0, 0.1, 0]}}
  glass: {{transparency: 0.9, transmission: 0.95, ior: 1.52, reflection: 0.5, specular: [0.5, 0.1, 0], exponent: 30}}
  dark: {{transparency: 0.5, transmission: 0, ior: 1.4, diffuse: 0.2}}
objects:
  - {{kind: plane, point: [0, -0.8, 0], normal: [0, 1, 0.02], material: wall}}
{objects}
"""
CUBE = """{kind: mesh, material: glass, normals: flat, vertices: [[-0.5, -0.5, -0.5], [0.5, -0.5, -0.5], [0.5, 0.5, -0.5],
    [-0.5, 0.5, -0.5], [-0.5, -0.5, 0.5], [0.5, -0.5, 0.5], [0.5, 0.5, 0.5], [-0.5, 0.5, 0.5]], faces: %s,
    transform: [{rotate: {axis: [1, 2, 0.5], degrees: 40}}%s]}"""
OUTWARD = [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], [0, 1, 5], [0, 5, 4], [2, 3, 7], [2, 7, 6], [1, 2, 6], [1, 6, 5],
           [3, 0, 4], [3, 4, 7]]
INWARD = [[a, c, b] for a, b, c in OUTWARD]
RULES = {
    "panes one behind the other, before a mirror": (3, [
        "{kind: rectangle, corner: [-1, -0.7, 0.5], edge_u: [1.7, 0, 0.1], edge_v: [0, 1.2, 0], material: pane}",
        "{kind: disc, center: [0.2, 0, 0], normal: [0.3, 0, 1], radius: 0.7, material: pane}",
        "{kind: sphere, center: [0.3, -0.2, -1.2], radius: 0.6, material: mirror}",
        "{kind: cylinder, base: [-0.8, -0.6, 0.9], top: [-0.8, 0.3, 0.8], radius: 0.2, capped: false, material: pane}",
    ]),
    "panes that a ray crosses out of turn": (6, [
        "{kind: disc, center: [0, 0, 0.5], normal: [0, 0, 1], radius: 0.8, material: pane}",
        "{kind: disc, center: [0, 0, 0.2], normal: [0.5, 0, 1], radius: 0.4, material: pane}",
        "{kind: sphere, center: [0, 0, -0.9], radius: 0.7, material: mirror}",
        "{kind: box, min: [-2, -0.5, 2], max: [-0.9, 1, 2.1], material: mirror}",
    ]),
    "the eye in a bubble behind a window": (2, [
        "{kind: sphere, center: [0.1, 0.4, 4], radius: 0.5, material: pane}",
        "{kind: plane, point: [0, 0, 2], normal: [0, 0.1, 1], material: pane}",
        "{kind: sphere, center: [0, 0, 0], radius: 0.7, material: pane}",
    ]),
    "the eye under water": (5, [
        "{kind: plane, point: [0, 0, 1], normal: [0, 0.2, -1], material: glass}",
        "{kind: sphere, center: [0, 0.1, -1], radius: 0.7, material: wall}",
    ]),
    "the eye in a glass ball": (4, ["{kind: sphere, center: [0.1, 0.3, 3.8], radius: 0.6, material: glass}"]),
    "a glass cube of triangles": (5, [CUBE % (OUTWARD, "")]),
    "a glass cube turned inside out": (5, [CUBE % (INWARD, "")]),
    "a glass cube in a looking glass": (5, [CUBE % (OUTWARD, ", {scale: [-1, 1, 1.2]}")]),
    "the eye in a glass cube of triangles": (4, [CUBE % (OUTWARD, ", {scale: 3}, {translate: [0, 0.3, 3.4]}")]),
    "nothing passes, and yet it reflects totally": (3, [
        "{kind: plane, point: [0, 0, 1], normal: [0, 0.5, -1], material: dark}",
        "{kind: sphere, center: [0, 1.1, 2.8], radius: 0.5, material: wall}",
    ]),
    "a ball on the floor": (3, ["{kind: sphere, center: [0, -0.3, 0], radius: 0.5, material: wall}"]),
    "a box on the floor": (3, ["{kind: box, min: [-0.5, -1, -0.5], max: [0.5, 0.2, 0.5], material: mirror}"]),
    "a brimming glass": (6, [
        "{kind: cylinder, base: [0, -0.7, 0], top: [0.1, 0.5, 0.1], radius: 0.5, material: glass}",
        "{kind: box, min: [0.8, -0.7, -0.6], max: [1.2, 0.4, 0.4], material: glass}",
    ]),
}


def stage(rule: str, shadows: str) -> Case:
    limit, objects = RULES[rule]
    text = STAGE.format(limit=limit, objects="\n".join(f"  - {obj}" for obj in objects))
    return case_of_text(text + f"transparent_shadows: {shadows}\n")


@pytest.mark.parametrize("shadows", ["attenuate", "ignore"])
def test_the_rules_of_the_model_hold(shadows, tmp_path):
    problems = []
    for rule, result in zip(RULES, run_all([stage(rule, shadows) for rule in RULES], tmp_path), strict=True):
        assert np.ptp(result.image) > 0, f"{rule}: the picture is constant"
        problems += [f"{rule}: {line}" for line in complaints(result)[:2]]
    assert not problems, "\n".join(problems)


def test_what_is_left_is_the_transmitted_highlight_and_nothing_else(tmp_path, monkeypatch):
    disc = "{kind: disc, center: [0, 0, 1], normal: [0.2, 0.3, 1], radius: 0.9, material: lens}"
    text = STAGE.format(limit=2, objects=f"  - {disc}")
    lamp = "key: {kind: point, position: [-0.1, 0.2, -1.5], intensity: 5}"
    text = text.replace("key: {kind: point, position: [0.8, 1.4, 3], intensity: 5}", lamp)
    lens = "lens: {transparency: 0.6, transmission: 0.9, diffuse: 0.1, specular: 0.8, exponent: 12}"
    result = run(case_of_text(text.replace("materials:\n", f"materials:\n  {lens}\n")), tmp_path)
    assert not complaints(result)
    monkeypatch.setattr(plain_raytraced, "TRANSMITTED_HIGHLIGHT", 1.0)
    assert len(complaints(result)) > 20, "the scene has no transmitted highlight: it proves nothing"
