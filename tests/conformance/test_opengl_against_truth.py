"""OpenGL's radiance within its own budget of the truth; every term of the budget approached; every rule of its own seen."""

from __future__ import annotations

import dataclasses
import os
import subprocess
import sys
from itertools import pairwise

import numpy as np
import pytest

from equilux.budget import Bound
from equilux_adapters.opengl.kit.context import why_not
from equilux_oracle import radiance as oracle_radiance
from equilux_tracer import Tracer
from support.opengl import against, against_reference, as_opengl, run
from support.random_scenes import case_of, random_spec
from support.vtk import Run, allowed_by, case_of_text, corpus_case, term_of, verdict_line

BALL = """
equilux: 1
name: ball
model: opengl
camera: {projection: perspective, eye: [0, 0, 3], target: [0, 0, 0], up: [0, 1, 0], fov_y_deg: 30}
film: {width: 96, height: 72}
lights:
  key: {kind: point, position: [0, 2, 3], intensity: 7.5}
materials:
  clay: {diffuse: 0.6, specular: 0.5, exponent: 20}
objects:
  - {kind: sphere, center: [0, 0, 0], radius: 0.5, material: clay}
"""

CARD = """
equilux: 1
name: card
model: opengl
viewer: infinite
camera: {projection: perspective, eye: [0.3, 0.5, 3], target: [0, 0, 0], up: [0, 1, 0], fov_y_deg: 40}
film: {width: 96, height: 72}
lights: {sun: {kind: directional, direction: [0.5, -0.3, -1], irradiance: 1}}
materials: {card: {specular: 0.5, exponent: 128}}
objects: [{kind: rectangle, corner: [-1, -1, 0], edge_u: [2, 0, 0.3], edge_v: [0, 2, 0], material: card}]
"""

VIEWS = {
    "plain": {},
    "orthographic": {"fov_deg": None},
    "wide": {"fov_deg": (150.0, 150.0)},
    "narrow": {"fov_deg": (1.0, 1.0)},
    "far from the origin": {"offset": (1e6, -2e5, 3e6)},
    "cylinders": {"shapes": ("cylinder",)},
    "more than eight lights": {"lights": (9, 20)},
}


@pytest.mark.parametrize("view", VIEWS)
def test_random_scenes_agree_with_the_reference_within_the_budget(view, tmp_path):
    problems = []
    for seed in range(700, 706 if view == "plain" else 703):
        result = run(case_of(as_opengl(random_spec(seed, film=(72, 54), **VIEWS[view]), seed)), tmp_path)
        pair = against_reference(result)
        if pair.json["verdict"] != "agree":
            problems.append(verdict_line(result, pair))
    assert not problems, "\n".join(problems)


@pytest.mark.parametrize(
    ("scene", "name"),
    [
        ("opengl-half-vector", None), ("opengl-shininess", "opengl-shininess[shininess=128]"), ("opengl-light-ambient", None),
        ("opengl-light-shares", None), ("opengl-global-ambient", None), ("opengl-emission", None), ("opengl-box", None),
        ("opengl-attenuated-ambient", None), ("opengl-spot", "opengl-spot[cutoff=25]"), ("opengl-spot", "opengl-spot[cutoff=90]"),
        ("opengl-viewer", "opengl-viewer[viewer=#0]"), ("opengl-viewer", "opengl-viewer[viewer=#1]"),
        ("opengl-orthographic", None), ("opengl-two-sided", None), ("opengl-eleven-lights", None), ("opengl-plane", None),
        ("opengl-mesh-smooth", None), ("opengl-all-terms", None),
    ],
)  # fmt: skip
def test_corpus_scene_agrees_with_the_reference_and_the_oracle_within_the_budget(scene, name, tmp_path):
    result = run(corpus_case(scene, name), tmp_path)
    pair = against_reference(result)
    assert pair.json["verdict"] == "agree", verdict_line(result, pair)
    if scene != "opengl-mesh-smooth":  # which has no closed form
        pair = against(oracle_radiance(result.case), result, Tracer(result.case))
        assert pair.json["verdict"] == "agree", verdict_line(result, pair)


@pytest.mark.parametrize(
    "scene",
    [
        "mesh-from-obj", "mesh-given-normals", "mesh-transformed", "mesh-flat", "non-uniform-scale", "mirrored", "narrow-angle",
        "wide-angle", "inside-a-sphere", "light-inside", "grazing-light", "disc", "nearest-wins", "one-row",
        "coefficients-above-one", "ambient-only",
    ],
)  # fmt: skip
def test_a_phong_scene_of_the_corpus_read_as_a_fixed_function_one_agrees(scene, tmp_path):
    """All that is in the corpus of shapes, views and transforms, under the model that the API has."""
    case = corpus_case(scene)
    case = dataclasses.replace(case, scene=case.scene.model_copy(update={"model": "opengl", "expect": ()}))
    result = run(case, tmp_path)
    pair = against_reference(result)
    assert pair.json["verdict"] == "agree", verdict_line(result, pair)


def test_at_its_default_lighting_at_corners_departs_by_less_than_a_thousandth(tmp_path):
    """Of the ball's largest radiance, away from the terminator, where N·L = 0 crosses triangles."""
    result = run(case_of_text(BALL), tmp_path)
    truth = oracle_radiance(result.case)
    lit = truth[..., 0] > 0.05
    stated = np.asarray(term_of(result, "vertex lighting").abs)[lit].max() / truth.max()
    measured = np.abs(result.image - truth)[lit].max() / truth.max()
    assert measured <= stated <= 1e-3, f"measured {measured}, stated {stated}, allowed 1e-3"


def test_smaller_triangles_are_nearer_to_the_truth(tmp_path):
    text = CARD.replace("viewer: infinite", "viewer: local").replace("exponent: 128", "exponent: 40")
    case = case_of_text(text)
    truth = oracle_radiance(case)
    errors = [np.abs(run(case, tmp_path, triangle_px=px).image - truth)[15:60, 20:75].max() for px in (8, 4, 2, 1)]
    # the error goes with the square of the side: a factor of 4 each
    assert all(a > 2.5 * b for a, b in pairwise(errors)), f"errors at 8, 4, 2, 1 px: {errors}"


def test_a_coarse_picture_is_still_within_its_budget_and_visibly_lit_at_corners(tmp_path):
    """Of a box drawn with its own corners only, the highlight in the middle of its top is gone: that is what the term is for."""
    case = corpus_case("opengl-box")
    result = run(case, tmp_path, triangle_px=1000)
    truth = oracle_radiance(case)
    lost = np.abs(result.image - truth).max() / truth.max()
    assert lost > 0.2, f"lost {lost} of the largest radiance"
    pair = against_reference(result)
    assert pair.json["verdict"] == "agree", verdict_line(result, pair)


def rounding_of(result: Run) -> np.ndarray:
    """(h, w, 3): what the budget allows for arithmetic in single precision."""
    return np.asarray(term_of(result, "single precision").abs) + term_of(result, "arithmetic").rel * result.image


def test_more_lights_than_the_api_has_are_the_sum_of_their_passes(tmp_path):
    """Eleven equal lights give eleven times what one gives; emission and ambient are there once."""
    glowing = BALL.replace("diffuse: 0.6", "diffuse: 0.6, ambient: 0.5, emission: 0.25")
    one = glowing.replace("materials:", "ambient: 0.3\nmaterials:")
    key = "  key: {kind: point, position: [0, 2, 3], intensity: 7.5}\n"
    eleven = one.replace(key, "".join(key.replace("key", f"key{k}") for k in range(11))).replace("name: ball", "name: balls")
    single, several = run(case_of_text(one), tmp_path), run(case_of_text(eleven), tmp_path)
    seen = single.image[..., 0] > 0
    constant = 0.25 + 0.5 * 0.3
    expected = constant + 11 * (single.image.astype(float) - constant)
    # the corners are the same, so nothing but rounding differs: of one picture, and eleven times of the other
    allowed = 11 * rounding_of(single) + rounding_of(several)
    used = (np.abs(several.image - expected)[seen] / allowed[seen]).max()
    assert used <= 1, f"used {used} of what is allowed"


def test_egl_and_osmesa_give_the_same_bits(tmp_path):
    if reason := why_not("egl") or why_not("osmesa"):
        pytest.skip(reason)
    program = run(corpus_case("opengl-all-terms"), tmp_path).folder
    pictures = []
    for platform in ("egl", "osmesa"):
        subprocess.run(
            [sys.executable, "scene.py"], cwd=program, check=True, timeout=120, env=os.environ | {"PYOPENGL_PLATFORM": platform}
        )
        pictures.append(np.load(program / "image.npy"))
    assert np.array_equal(*pictures), f"differ by {np.abs(pictures[0] - pictures[1]).max()}"


def test_a_picture_is_neither_mirrored_nor_turned(tmp_path):
    result = run(corpus_case("opengl-all-terms"), tmp_path)
    truth = Tracer(result.case).render()["radiance"]
    right = np.abs(result.image - truth).mean()
    for name, wrong in {"flipped-x": truth[:, ::-1], "flipped-y": truth[::-1], "turned": truth[::-1, ::-1]}.items():
        assert np.abs(result.image - wrong).mean() > 20 * right, f"{name}: as near as the picture itself, {right}"


@pytest.mark.parametrize("projection", ["perspective, fov_y_deg: 40", "orthographic, height_m: 3"])
@pytest.mark.parametrize(("first", "second"), [("red", "green"), ("green", "red")])
def test_two_equal_surfaces_show_the_first_of_the_file(projection, first, second, tmp_path):
    case = case_of_text(f"""
equilux: 1
name: cards
model: opengl
camera: {{projection: {projection}, eye: [1.3, 0.8, 3], target: [0, 0, 0], up: [0, 1, 0]}}
film: {{width: 96, height: 72}}
lights: {{sun: {{kind: directional, direction: [0.2, -0.3, -1], irradiance: 1}}}}
materials: {{red: {{diffuse: [0.5, 0, 0]}}, green: {{diffuse: [0, 0.5, 0]}}}}
objects:
  - {{kind: rectangle, corner: [-0.9, -0.7, 0.1], edge_u: [1.3, 0, 0], edge_v: [0, 1.1, 0], material: {first}}}
  - {{kind: rectangle, corner: [-0.5, -0.9, 0.1], edge_u: [1.7, 0, 0], edge_v: [0, 1.3, 0], material: {second}}}
""")
    result = run(case, tmp_path)
    pair = against_reference(result)
    assert pair.json["verdict"] == "agree", verdict_line(result, pair)


# --- the budget is not loose ------------------------------------------------------------------------------------------


def approached(result: Run, name: str, where: object = np.s_[:]) -> float:
    """The largest share of what a term alone allows that the picture's error uses up, where the term allows anything."""
    tracer = Tracer(result.case)
    allowed = allowed_by(term_of(result, name), result, tracer)[where]
    error = np.abs(result.image - oracle_radiance(result.case))[where]
    return float(np.max(error / np.where(allowed > 0, allowed, np.inf)))


def test_the_term_vertex_lighting_is_approached_and_alone_explains_the_picture(tmp_path):
    """Among gates, cones and highlights, drawn coarsely: everywhere within the term but for what rounding may add."""
    result = run(corpus_case("opengl-all-terms"), tmp_path, triangle_px=3)
    error = np.abs(result.image - oracle_radiance(result.case))
    stated = np.asarray(term_of(result, "vertex lighting").abs)
    smooth = error > 1e-3
    share = (error / np.where(stated > 0, stated, np.inf))[smooth]
    assert np.median(share) >= 0.1, f"half of the pixels use less than {np.median(share)} of the term"
    assert isinstance(term_of(result, "vertex lighting"), Bound)


@pytest.mark.parametrize(
    ("term", "material"), [("single precision", "specular: 0.5, exponent: 128"), ("arithmetic", "diffuse: 0.5")]
)
def test_a_term_of_rounding_is_approached_within_a_factor_of_ten(term, material, tmp_path):
    result = run(case_of_text(CARD.replace("specular: 0.5, exponent: 128", material)), tmp_path)
    share = approached(result, term)
    assert share >= 0.1, f"used {share} of the term"


def test_the_term_set_back_is_approached_within_a_factor_of_ten(tmp_path):
    case = case_of_text("""
equilux: 1
name: cards-apart
model: opengl
camera: {projection: perspective, eye: [0, 0, 3], target: [0, 0, 0], up: [0, 1, 0], fov_y_deg: 40}
film: {width: 96, height: 72}
lights: {near: {kind: point, position: [0.3, 0.2, 0.05], intensity: 0.01}}
materials: {card: {diffuse: 0.5}, blank: {diffuse: 0.1}}
objects:
  - {kind: rectangle, corner: [-0.9, -0.7, 0], edge_u: [0.5, 0, 0], edge_v: [0, 1, 0], material: blank}
  - {kind: rectangle, corner: [-0.6, -0.7, 0], edge_u: [1.5, 0, 0], edge_v: [0, 1.4, 0], material: card}
  - {kind: sphere, center: [0, 0, -30], radius: 1, material: blank}
""")
    share = approached(run(case, tmp_path), "set back", np.s_[10:60, 40:80])
    assert share >= 0.1, f"used {share} of the term"


def test_the_term_silhouettes_is_approached_within_a_factor_of_ten(tmp_path):
    """Somewhere along a slanted edge a pixel is on the wrong side although the edge is more than a tenth of the term away."""
    result = run(case_of_text("""
equilux: 1
name: slanted
model: opengl
camera: {projection: perspective, eye: [0, 0, 3], target: [0, 0, 0], up: [0.42, 1, 0], fov_y_deg: 40}
film: {width: 400, height: 400}
materials: {card: {emission: 1}}
objects:
  - {kind: rectangle, corner: [-0.9, -0.85, 0], edge_u: [1.71, 0.01, 0], edge_v: [-0.01, 1.71, 0], material: card}
  - {kind: rectangle, corner: [-0.8, -0.75, 0.1], edge_u: [1.4, 0.2, 0], edge_v: [-0.2, 1.4, 0], material: card}
"""), tmp_path, triangle_px=100)
    tracer = Tracer(result.case)
    wrong = np.argwhere(np.abs(result.image - tracer.render()["radiance"]).max(axis=2) > 0.5)
    centres = wrong[:, ::-1] + 0.5
    away = 0.1 * term_of(result, "silhouettes").film_px
    alike = np.ones(len(centres), dtype=bool)
    here = tracer.evaluate(centres, ["object_id"])["object_id"] >= 0
    for angle in np.linspace(0, 2 * np.pi, 16, endpoint=False):
        there = tracer.evaluate(centres + away * np.array([np.cos(angle), np.sin(angle)]), ["object_id"])["object_id"] >= 0
        alike &= there == here
    assert alike.any(), f"{len(centres)} pixels on the wrong side, none farther from the edge than {away} pixel"


# --- what is the API's own is seen ------------------------------------------------------------------------------------


def test_a_phong_scene_gets_the_half_vector_and_is_otherwise_the_same(tmp_path):
    phong = corpus_case("phong-by-half-vector")
    result = run(phong, tmp_path)
    assert against_reference(result).json["verdict"] == "diverge"
    tracer = Tracer(dataclasses.replace(phong, scene=phong.scene.model_copy(update={"model": "opengl", "expect": ()})))
    pair = against(tracer.render()["radiance"], result, tracer)
    assert pair.json["verdict"] == "agree", verdict_line(result, pair)


def test_without_attenuation_an_exponent_of_zero_is_drawn_as_the_model_says(tmp_path):
    text, sun = BALL.replace("exponent: 20", "exponent: 0"), "{kind: directional, direction: [0, -2, -3], irradiance: 1}"
    sun = text.replace("{kind: point, position: [0, 2, 3], intensity: 7.5}", sun)
    result = run(case_of_text(sun), tmp_path)
    pair = against_reference(result)
    assert pair.json["verdict"] == "agree", verdict_line(result, pair)


def test_mesa_raises_the_cosine_to_itself_where_the_exponent_is_zero_and_the_light_attenuated(tmp_path):
    result = run(corpus_case("opengl-shininess-zero"), tmp_path)
    if "Mesa" not in result.raw.environment["opengl_version"]:
        pytest.skip(f"not Mesa but {result.raw.environment['opengl_version']}")
    parts = Tracer(result.case).render(["radiance", "diffuse", "specular", "object_id"])
    diffuse, specular = (parts[name][..., 0, 0] for name in ("diffuse", "specular"))
    lit = specular > 0
    cosine = diffuse[lit] / 0.3 / (specular[lit] / 0.5)
    expected = parts["radiance"][lit][:, 0] + specular[lit] * (cosine**cosine - 1)
    smooth = cosine > 0.2
    error = np.abs(result.image[lit][:, 0] - expected)[smooth].max()
    assert error <= 1e-3 * expected.max(), f"off by {error} of {expected.max()}"


RAYTRACED = """
equilux: 1
name: as-is
model: raytraced
camera: {projection: perspective, eye: [0, 1, 3], target: [0, 0, 0], up: [0, 1, 0], fov_y_deg: 35}
film: {width: 96, height: 72}
lights: {key: {kind: point, position: [-1, 2, 2], intensity: 5}}
materials:
  glass: {diffuse: 0.4, transmission: 0.8, transparency: 0.75, ior: 1.5}
  mirror: {diffuse: 0.3, reflection: 0.5}
objects:
  - {kind: sphere, center: [-0.3, 0, 0.3], radius: 0.3, material: glass}
  - {kind: rectangle, corner: [-1.5, -0.35, 1], edge_u: [3, 0, 0], edge_v: [0, 0, -3], material: mirror}
"""


def test_a_ray_traced_scene_is_drawn_by_its_local_terms(tmp_path):
    """1 − t of the glass's own, all of the mirror's own, nothing else: the picture of a local scene with these coefficients."""
    result = run(case_of_text(RAYTRACED), tmp_path)
    local = RAYTRACED.replace("raytraced", "opengl")
    local = local.replace("{diffuse: 0.4, transmission: 0.8, transparency: 0.75, ior: 1.5}", "{diffuse: 0.1}")
    tracer = Tracer(case_of_text(local.replace(", reflection: 0.5", "")))
    pair = against(tracer.render()["radiance"], result, tracer)
    assert pair.json["verdict"] == "agree", verdict_line(result, pair)
