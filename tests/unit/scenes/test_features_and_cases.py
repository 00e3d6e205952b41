"""What a scene requires, what a case carries, and what its canonical form takes for the same picture."""

from __future__ import annotations

import json
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from equilux_scenes.causes import CAUSES, is_known
from equilux_scenes.features import FEATURES, RESOLVED_FEATURES, required_features
from equilux_scenes.loader import SceneFile

Load = Callable[..., Any]
Edited = Callable[..., str]

BARE = """\
equilux: 1
name: bare
model: phong
camera: {projection: orthographic, eye: [0, 0, 3], target: [0, 0, 0], height_m: 2}
film: {width: 4, height: 3}
materials: {m: {}, unused: {diffuse: 1, specular: 1, emission: 1}}
objects: [{kind: sphere, center: [0, 0, 0], radius: 1, material: m}]
"""
ALWAYS = {"model.phong", "camera.orthographic", "shape.sphere"}


def test_a_bare_scene_requires_nothing_beyond_its_model_camera_and_shape(load: Load) -> None:
    assert set(required_features(load(BARE).scene)) == ALWAYS


def test_a_full_scene_requires_each_term_that_its_model_has(load: Load, valid: str) -> None:
    missing = {"camera.orthographic", "attenuation.constant", "attenuation.linear", "normals.flat"}
    of_other_models = {"model.opengl", "model.raytraced", "model.reflection-equation", "light.sphere", "light.disc",
                       "light.rectangle", "light.environment", "light.ambient-colour", "light.diffuse-colour",
                       "light.specular-colour", "viewer.infinite", "brdf.phong-cosine", "occlusion", "reflection",
                       "transparency", "refraction", "shadow.attenuated", "shadow.ignored"}  # fmt: skip
    assert set(load(valid).cases[0].requires) == set(FEATURES) - missing - of_other_models


def _light(text: str) -> str:
    return BARE + f"lights: {{l: {text}}}\n"


ADDED = {
    "point": (_light("{kind: point, position: [0, 0, 5], intensity: 0}"), {"light.point", "attenuation.quadratic"}),
    "terms": (
        _light("{kind: point, position: [0, 0, 5], intensity: 1, attenuation: {constant: 1, linear: 2}}"),
        {"light.point", "attenuation.constant", "attenuation.linear"},
    ),
    "directional": (_light("{kind: directional, direction: [0, 0, -1], irradiance: 1}"), {"light.directional"}),
    "spot": (
        _light("{kind: spot, position: [0, 0, 5], direction: [0, 0, -1], intensity: 1, cone_half_angle_deg: 9}"),
        {"light.spot", "attenuation.quadratic"},
    ),
    "spot exponent": (
        _light("{kind: spot, position: [0, 0, 5], direction: [0, 0, -1], intensity: 1, cone_half_angle_deg: 9, exponent: .1}"),
        {"light.spot", "light.spot-exponent", "attenuation.quadratic"},
    ),
    "background": (BARE + "background: [0, 0, 0.1]\n", {"background"}),
    "ambient of the scene only": (BARE + "ambient: 1\n", set()),
    "ambient of the material only": (BARE.replace("m: {}", "m: {ambient: 1}"), set()),
    "ambient in other bands": (BARE.replace("m: {}", "m: {ambient: [1, 0, 0]}") + "ambient: [0, 1, 1]\n", set()),
    "ambient of both": (BARE.replace("m: {}", "m: {ambient: [0, 0, 1]}") + "ambient: 1\n", {"material.ambient"}),
    "diffuse": (BARE.replace("m: {}", "m: {diffuse: [0, 0, 1]}"), {"material.diffuse"}),
    "specular": (BARE.replace("m: {}", "m: {specular: 1}"), {"material.specular"}),
    "emission": (BARE.replace("m: {}", "m: {emission: 1}"), {"material.emission"}),
    "exponent only": (BARE.replace("m: {}", "m: {exponent: 5}"), set()),
    "transform": (BARE.replace("material: m}", "material: m, transform: [{scale: 2}]}"), {"transform"}),
    "empty transform": (BARE.replace("material: m}", "material: m, transform: []}"), set()),
}


@pytest.mark.parametrize("name", ADDED)
def test_a_term_adds_its_own_features_and_no_others(load: Load, name: str) -> None:
    text, added = ADDED[name]
    assert set(load(text).cases[0].requires) - ALWAYS == added


def test_features_of_a_case_follow_its_axes(load: Load) -> None:
    cases = load(BARE + "sweep: {d: {path: materials.m.diffuse, values: [0, 1]}}\n").cases
    assert ["material.diffuse" in case.requires for case in cases] == [False, True]


def test_every_feature_of_the_corpus_is_described(corpus: list[SceneFile]) -> None:
    for file in corpus:
        for case in file.cases:
            assert set(case.requires) <= set(FEATURES) | set(RESOLVED_FEATURES), case.name
            assert set(case.demands) == set(case.requires) & set(FEATURES), case.name
            assert list(case.requires) == sorted(case.requires)


# --- cases ------------------------------------------------------------------------------------------------------------


def test_a_case_survives_pickling(load: Load, valid: str) -> None:
    for case in load(valid).cases:
        again = pickle.loads(pickle.dumps(case))
        assert again.canonical() == case.canonical()
        assert again.name == case.name == case.directory_name
        assert again.requires == case.requires
        assert np.array_equal(again.meshes[6].vertex_normals, case.meshes[6].vertex_normals)


def test_the_typed_scene_is_one_that_pydantic_accepts_unchanged(load: Load, valid: str, corpus: list[SceneFile]) -> None:
    for scene in [load(valid).scene, *(case.scene for file in corpus for case in file.cases[:1])]:
        assert type(scene).model_validate(scene.model_dump()) == scene


SAME = {
    "name": ("name: every-part", "name: other"),
    "about": ("about: Every kind of part once.", "about: Something else."),
    "number": ("radius: 0.5", "radius: 5.0e-1"),
    "bands": ("background: 0.25", "background: [.25, 0.25, 2.5e-1]"),
    "default": ("emission: 0.01", "emission: 0.01, ior: 1"),
    "minus zero": ("target: [0, 0, 0]", "target: [-0.0, 0, 0]"),
    "light name": ("  sun:", "  moon:"),
    "unused material": ("materials:\n", "materials:\n  unused: {diffuse: 0.3}\n"),
    "transform": ("{scale: 2}", "{scale: [2, 2, 2]}"),
    "normals not unit": ("[[0, 0, 1], [0, 0, 2]", "[[0, 0, 9], [0, 0, 7]"),
    "expectation": ("cause: exponent-clamped", "cause: half-vector"),
}
OTHER = {
    "radius": ("radius: 0.5", "radius: 0.5000000000000001"),
    "film": ("width: 64", "width: 65"),
    "light": ("irradiance: 1", "irradiance: 1.1"),
    "background": ("background: 0.25", "background: [0.25, 0.25, 0.26]"),
    "material": ("emission: 0.01", "emission: 0.02"),
    "mesh": ("[1, 0, 0], [0, 1, 0]]\n", "[1, 0, 0], [0, 1, 0.5]]\n"),
    "normals": ("normals: smooth", "normals: flat"),
    "vertex normals": ("[0, 0, 2]", "[0, 1, 2]"),
    "transform": ("{scale: 2}", "{scale: 3}"),
}


@pytest.mark.parametrize("name", SAME)
def test_what_does_not_change_the_picture_does_not_change_the_canonical_form(
    load: Load, valid: str, edited: Edited, name: str
) -> None:
    assert load(edited(*SAME[name])).cases[0].canonical() == load(valid).cases[0].canonical()


@pytest.mark.parametrize("name", OTHER)
def test_what_may_change_the_picture_changes_the_canonical_form(load: Load, valid: str, edited: Edited, name: str) -> None:
    assert load(edited(*OTHER[name])).cases[0].canonical() != load(valid).cases[0].canonical()


def test_the_canonical_form_is_json_without_names(load: Load, valid: str) -> None:
    text = load(valid).cases[0].canonical().decode()
    assert set(json.loads(text)) == {
        "format", "model", "camera", "film", "ambient", "background", "recursion_limit", "transparent_shadows", "viewer",
        "lights", "objects",
    }  # fmt: skip
    for word in ("clay", "every-part", "Every kind", "expect", "sweep", '"key"'):
        assert word not in text


# --- causes -----------------------------------------------------------------------------------------------------------

FIXED = [
    "flipped-x",
    "flipped-y",
    "transposed",
    "shifted",
    "gamma-encoded",
    "clamped",
    "quantised",
    "bands-swapped",
    "scaled",
    "fov-other-axis",
    "mirrored-handedness",
    "faceted-normals",
    "smoothed-normals",
    "reversed-normals",
    "normal-side",
    "tessellated",
    "vertex-lighting",
    "diffuse-missing",
    "diffuse-two-sided",
    "half-vector",
    "exponent-clamped",
    "exponent-scaled",
    "specular-floored",
    "highlight-ungated",
    "highlight-cosine",
    "highlight-tinted",
    "highlight-missing",
    "transmitted-highlight-missing",
    "transparent-highlight-unweighted",
    "view-vector-from-eye",
    "view-vector-fixed",
    "light-missing",
    "attenuation-ignored",
    "attenuation-term-missing",
    "spot-ignored",
    "spot-cone-doubled",
    "spot-cone-halved",
    "spot-exponent-ignored",
    "spot-exponent-clamped",
    "spot-cone-ignored",
    "light-colours-ignored",
    "ambient-missing",
    "ambient-tinted",
    "emission-missing",
    "emission-tinted",
    "occlusion-ignored",
    "transparent-shadow-rule",
    "reflection-missing",
    "refraction-missing",
    "recursion-cut",
    "weight-cut",
    "index-inverted",
    "tir-weight",
    "nested-media",
    "transmission-uncounted",
    "shadow-bias",
    "transparency-weight-ignored",
    "background-missing",
    "unexplained",
]


def test_the_cause_ids_are_the_fixed_ones() -> None:
    assert list(CAUSES) == FIXED
    assert all(CAUSES.values())


def test_third_parties_prefix_their_own_causes() -> None:
    assert is_known("half-vector")
    assert is_known("blender:filmic-view")
    for cause in ("half_vector", "", ":x", "x:", "a:b:c", "A:b", "a: b", "half-vector\n", "x:y\n"):
        assert not is_known(cause), repr(cause)
