"""Mitsuba's radiance within its own noise and bounds of the truth; every term of the budget approached; the noise as stated."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from equilux.adapter import Unsupported
from equilux.budget import Budget, Sampled
from equilux.uncertainty import stated
from equilux_oracle import radiance as oracle_radiance
from equilux_oracle import supports
from equilux_scenes.case import Case
from equilux_tracer import Tracer
from support.mitsuba import (
    Run,
    against,
    against_local,
    case_of_text,
    corpus_cases,
    random_emitters,
    run,
    standardised,
    term_of,
    verdict_line,
    without_ambient,
)
from support.random_scenes import Spec, case_of, random_spec

CONTACT = """
equilux: 1
name: contact
model: reflection-equation
camera: {projection: perspective, eye: [0.4, 1.8, 4], target: [0.9994, 0, 1.002], up: [0, 1, 0], fov_y_deg: 0.1}
film: {width: 40, height: 30}
lights:
  panel: {kind: rectangle, corner: [1, 2, -0.5], edge_u: [0.5, 0, 0], edge_v: [0, 0, 0.7], radiance: [10, 20, 30]}
materials:
  floor: {diffuse: 0.3, brdf: lambert}
objects:
  - {kind: plane, point: [0, 0, 0], normal: [0, 1, 0], material: floor}
  - {kind: sphere, center: [0.5, 0.2, 0.3], radius: 0.2, material: floor}
  - {kind: disc, center: [1, 0.005, 0.8], normal: [0, 1, 0], radius: 0.2, material: floor}
"""
"""A sheet five millimetres above the floor, its shadow's border from near: its penumbra is 2 mm wide, rays start 0.2 mm off."""


@cache
def corpus() -> dict[str, Case]:
    """By name, on films of half the width and height: each pixel is judged alike, and a report renders them whole."""
    return {
        case.name: on_half_the_film(case) for family in ("reflection-equation", "photometry") for case in corpus_cases(family)
    }


def on_half_the_film(case: Case) -> Case:
    film = case.scene.film.model_copy(update={"width": case.scene.film.width // 2, "height": case.scene.film.height // 2})
    return replace(case, scene=case.scene.model_copy(update={"film": film}))


def truth_of(case: Case, tracer: Tracer) -> np.ndarray:
    has_closed_form = not supports(case)  # `supports` names what has none
    return np.asarray(oracle_radiance(case) if has_closed_form else tracer.render()["radiance"])


@pytest.mark.parametrize(
    "name",
    [
        "furnace[k_diff=0.3183098861837907]", "furnace-phong[brdf=#0,exponent=10]", "furnace-phong-sideways[brdf=#1]",
        "disc-emitter", "rectangle-emitter", "sphere-emitter-over-plane", "emitter-at-the-horizon", "emitter-black-behind",
        "emitters-seen", "coloured-emitters", "delta-lights-on-lambert", "sky-over-a-ball", "soft-shadow", "three-emitters",
        "highlight-of-an-emitter[exponent=30]", "phong-classic-vs-cosine[brdf=#1]", "shrinking-emitter[lamp=#2]",
    ],
)  # fmt: skip
def test_corpus_scene_agrees_with_the_truth_within_its_noise(name, tmp_path):
    case = corpus()[name]
    result, tracer = run(case, tmp_path, samples=16), Tracer(case)
    pair = against(truth_of(case, tracer), result, tracer)
    assert pair.json["verdict"] == "agree", verdict_line(result, pair)


VIEWS = {"plain": {}, "orthographic": {"fov_deg": None}, "wide": {"fov_deg": (140.0, 140.0)}}


@pytest.mark.parametrize("view", VIEWS)
def test_random_scenes_under_delta_lights_agree_within_float32(view, tmp_path):
    """One object that cannot be in its own light, so that the local reference is the truth."""
    problems = []
    for seed in range(20, 28 if view == "plain" else 24):
        spec = random_spec(seed, objects=(1, 1), shapes=("sphere", "plane", "box", "disc", "rectangle"), **VIEWS[view])
        result = run(case_of(without_ambient(spec)), tmp_path)
        assert not any(isinstance(term, Sampled) for term in result.budget.terms)
        pair = against_local(result)
        if pair.json["verdict"] != "agree":
            problems.append(verdict_line(result, pair))
    assert not problems, "\n".join(problems)


def test_random_scenes_under_emitters_agree_and_their_residuals_scatter_as_stated(tmp_path):
    problems, residuals = [], []
    for seed in range(40, 46):
        case = case_of(random_emitters(seed, film=(36, 27), fov_deg=None if seed % 4 == 0 else (20.0, 90.0)))
        result, tracer = run(case, tmp_path, samples=16), Tracer(case)
        truth = tracer.render()["radiance"]
        pair = against(truth, result, tracer)
        residuals.append(standardised(result, truth))
        if pair.json["verdict"] != "agree":
            problems.append(verdict_line(result, pair))
    assert not problems, "\n".join(problems)
    found = np.concatenate(residuals)
    # Student's t of ν = 31: variance ν/(ν − 2), kurtosis 3 + 6/(ν − 4); four standard deviations of mean and variance
    count, expected = len(found), 31 / 29
    assert count > 500
    allowed = 4 * expected * np.sqrt((2 + 6 / 27) / count)
    assert abs(found.var() - expected) < allowed, f"variance {found.var()} of {count} residuals, expected {expected} ± {allowed}"
    allowed = 4 * np.sqrt(expected / count)
    assert abs(found.mean()) < allowed, f"mean {found.mean()} of {count} residuals, expected 0 ± {allowed}"


def world(metre: float) -> Spec:
    """Every kind of length there is, in a scene whose metres are `metre` long; it looks the same whatever that is."""

    def at(*lengths: float) -> list[float]:
        return [metre * length for length in lengths]

    def clay(kind: str, **shape: object) -> Spec:
        return {"kind": kind, "material": "clay"} | shape

    stretch = [[1, 0, 0, 0.8 * metre], [0, 0.5, 0, 0.3 * metre], [0, 0, 1, 0.2 * metre], [0, 0, 0, 1]]
    per_metre, edges = 1 / metre, {"edge_u": at(0.5, 0, 0), "edge_v": at(0, 0, 0.4)}
    return {
        "equilux": 1,
        "name": "world",
        "model": "reflection-equation",
        "camera": {"projection": "perspective", "eye": at(1, 2, 4), "target": at(0, 0, 0), "fov_y_deg": 35},
        "film": {"width": 12, "height": 9},
        "lights": {
            "ball": {"kind": "sphere", "center": at(-1, 2, 1), "radius": 0.3 * metre, "radiance": 4},
            "disc": {"kind": "disc", "center": at(1, 2, 1), "normal": [-1, -2, -1], "radius": 0.3 * metre, "radiance": 3},
            "panel": {"kind": "rectangle", "corner": at(0, 2, -1), **edges, "radiance": 5},
            "point": {"kind": "point", "position": at(2, 2, 0), "intensity": 3 * metre**2},
            "bulb": {"kind": "point", "position": at(0, 2, 2), "intensity": 1, "attenuation": {"linear": per_metre}},
            "spot": {
                "kind": "spot", "position": at(-2, 2, 0), "direction": [2, -2, 0], "intensity": 3, "cone_half_angle_deg": 40,
                "exponent": 2, "attenuation": {"constant": 1, "linear": per_metre, "quadratic": per_metre**2},
            },
        },
        "materials": {"clay": {"diffuse": 0.3, "specular": 0.2, "exponent": 9}},
        "objects": [
            clay("plane", point=at(0, -0.5, 0), normal=[0, 1, 0]),
            clay("sphere", center=at(0, 0, 0), radius=0.3 * metre, transform=[{"translate": at(-0.7, 0, 0.2)}]),
            clay("sphere", center=at(0, 0, 0), radius=0.3 * metre, transform=[{"matrix": stretch}]),
            clay("box", min=at(-0.2, -0.5, -0.2), max=at(0.2, -0.1, 0.2)),
            clay("disc", center=at(-0.3, -0.2, 1), normal=[0.3, 1, 0.2], radius=0.2 * metre),
            clay("rectangle", corner=at(0.4, -0.3, 0.6), edge_u=at(0, 0, 0.4), edge_v=at(0.4, 0, 0)),
            clay("cylinder", base=at(0.1, -0.1, 0), top=at(0.1, 0.3, 0), radius=0.1 * metre),
            clay("mesh", vertices=[at(-0.3, -0.4, 0.5), at(0.1, -0.4, 0.5), at(-0.1, 0.1, 0.4)], faces=[[0, 1, 2]]),
        ],
    }  # fmt: skip


@pytest.mark.parametrize("metre", [1e-9, 1e-6, 1e6, 1e9])
def test_a_world_of_any_size_agrees_with_the_truth(metre, tmp_path):
    case = case_of_text(json.dumps(world(metre)))
    result, tracer = run(case, tmp_path, samples=12), Tracer(case)
    pair = against(tracer.render()["radiance"], result, tracer)
    assert pair.json["verdict"] == "agree", verdict_line(result, pair)
    assert pair.json["edge"] < 0.5 * result.image[..., 0].size, verdict_line(result, pair)


EDGE_ON = """
equilux: 1
name: edge-on
model: reflection-equation
camera: {{projection: perspective, eye: [0, {height}, 3], target: [0, 0, 0], up: [0, 1, 0], fov_y_deg: 30}}
film: {{width: 16, height: 12}}
lights:
  k: {{kind: sphere, center: [0, 2, 1], radius: 0.5, radiance: 5}}
materials:
  a: {{diffuse: 0.3, specular: 0.2, exponent: 20}}
objects:
  - {{kind: sphere, center: [0, 0, 0], radius: 0.5, material: a}}
  - {{kind: plane, point: [0, 0, 3], normal: {normal}, material: a}}
"""


@pytest.mark.parametrize("normal", [[0, 1, 0], [0.3, 0.7, 0.2], [1, 2, -3]])
def test_a_plane_in_which_the_eye_lies_is_not_seen(normal, tmp_path):
    case = case_of_text(EDGE_ON.format(height=0, normal=normal))
    result, tracer = run(case, tmp_path, samples=9), Tracer(case)
    pair = against(tracer.render()["radiance"], result, tracer)
    assert pair.json["verdict"] == "agree", verdict_line(result, pair)
    assert pair.json["edge"] <= 0.25 * result.image[..., 0].size, verdict_line(result, pair)


@pytest.mark.parametrize("height", [1e-3, -1e-5])
def test_a_plane_near_the_eye_is_seen(height, tmp_path):
    case = case_of_text(EDGE_ON.format(height=height, normal=[0, 1, 0]))
    result, tracer = run(case, tmp_path, samples=9), Tracer(case)
    pair = against(tracer.render()["radiance"], result, tracer)
    assert pair.json["verdict"] == "agree", verdict_line(result, pair)
    assert pair.json["edge"] <= 0.25 * result.image[..., 0].size, verdict_line(result, pair)


def test_a_plane_nearer_to_the_eye_than_single_precision_can_tell_is_refused(tmp_path):
    with pytest.raises(Unsupported, match="on which side") as caught:
        run(case_of_text(EDGE_ON.format(height=-1e-7, normal=[0, 1, 0])), tmp_path)
    assert caught.value.missing_features == ["shape.plane"]


def test_a_picture_is_neither_mirrored_nor_turned(tmp_path):
    case = corpus()["three-emitters"]
    result, truth = run(case, tmp_path, samples=9), truth_of(case, Tracer(case))
    right = np.abs(result.image - truth).mean()
    for name, wrong in {"flipped-x": truth[:, ::-1], "flipped-y": truth[::-1], "turned": truth[::-1, ::-1]}.items():
        assert np.abs(result.image - wrong).mean() > 20 * right, f"{name}: as near as the picture itself, {right}"


def test_four_times_the_repeats_give_a_smaller_error_and_say_so(tmp_path):
    case = corpus()["soft-shadow"]
    few, many = (run(case, tmp_path / str(repeats), samples=4, repeats=repeats) for repeats in (16, 64))
    ratio = np.median(term_of(few, "sampling").sigma) / np.median(term_of(many, "sampling").sigma)
    assert 1.8 < ratio < 2.2, f"σ falls by {ratio}, expected 2"


MESHES = """
equilux: 1
name: mesh-{normals}
model: reflection-equation
camera: {{projection: perspective, eye: [1, 2, 3], target: [0, 0, 0], up: [0, 1, 0], fov_y_deg: 40}}
film: {{width: 40, height: 30}}
lights:
  panel: {{kind: rectangle, corner: [-1, 3, -1], edge_u: [2, 0, 0], edge_v: [0, 0, 2], radiance: [3, 2, 1]}}
  key: {{kind: point, position: [2, 1, 2], intensity: 3}}
materials:
  clay: {{diffuse: 0.2, specular: 0.3, exponent: 12}}
objects:
  - kind: mesh
    vertices: [[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1], [0, 0.4, 0]]
    faces: [[0, 4, 1], [1, 4, 2], [2, 4, 3], [3, 4, 0]]
    normals: {normals}
    material: clay
    transform: [{{scale: [1, 1.2, 0.8]}}, {{rotate: {{axis: [0, 1, 0], degrees: 25}}}}]
"""


@pytest.mark.parametrize("normals", ["flat", "smooth"])
def test_meshes_are_shaded_flat_and_smooth(normals, tmp_path):
    case = case_of_text(MESHES.format(normals=normals))
    result, tracer = run(case, tmp_path, samples=16), Tracer(case)
    pair = against(tracer.render()["radiance"], result, tracer)
    assert pair.json["verdict"] == "agree", verdict_line(result, pair)


# --- the budget is not loose ------------------------------------------------------------------------------------------


def approached(result: Run, name: str, truth: np.ndarray) -> float:
    """The largest share of what a term alone allows that the picture's error uses up, where the term allows anything."""
    allowed = stated(Budget((term_of(result, name),)), result.image).bound(result.image)
    error = np.abs(result.image - truth)
    return float(np.max(error / np.maximum(allowed, 1e-300), where=allowed > 0, initial=0.0))


def test_the_arithmetic_term_is_approached(tmp_path):
    shares = []
    for seed in (3, 9, 11, 12):
        shapes = ("sphere", "box", "rectangle")
        spec = random_spec(seed, objects=(1, 1), shapes=shapes, exponents=(1.0, 8.0), lights=(1, 1), film=(40, 30))
        result = run(case_of(without_ambient(spec)), tmp_path)
        pair = against_local(result)
        assert pair.json["verdict"] == "agree", verdict_line(result, pair)
        shares.append(float(pair.json["en_max"]))
    assert 0.1 < max(shares) <= 1, f"largest E_n {shares}, expected above 0.1 somewhere"


def test_the_density_term_is_approached_by_a_small_sphere(tmp_path):
    case = corpus()["shrinking-emitter[lamp=#2]"]
    result = run(case, tmp_path, samples=16)
    share = approached(result, "density", truth_of(case, Tracer(case)))
    assert share > 0.1, f"the picture's error is {share} of what the term allows, expected above 0.1"


def test_the_ray_offset_term_is_approached_where_a_sheet_is_near_the_floor(tmp_path):
    case = case_of_text(CONTACT)
    result, tracer = run(case, tmp_path), Tracer(case)
    truth = tracer.render()["radiance"]
    pair = against(truth, result, tracer)
    assert pair.json["verdict"] == "agree", verdict_line(result, pair)
    noise = 6 * np.asarray(term_of(result, "sampling").sigma)
    term = np.asarray(term_of(result, "ray offset").abs)
    beyond = np.abs(result.image - truth) - noise
    share = float(np.max(beyond / np.maximum(term, 1e-300), where=(term > 0) & (beyond > 0), initial=0.0))
    assert share > 0.1, f"beyond noise, the error is {share} of what the term allows, expected above 0.1"
    assert np.median(term) == 0, "where nothing is near, the term must vanish"
