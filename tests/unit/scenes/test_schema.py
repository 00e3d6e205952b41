"""The JSON Schema for editors: shipped in step with the model, accepts what loads, rejects what is plainly wrong."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from equilux_scenes.limits import Limits
from equilux_scenes.loader import corpus_folder
from equilux_scenes.schema import json_schema, schema_file, schema_text
from equilux_scenes.yaml_tree import parse, plain

VALIDATOR = Draft202012Validator(json_schema())


def _as_json(text: str) -> Any:
    """The text as an editor's YAML reader sees it."""
    return json.loads(json.dumps(plain(parse(text, "t.yaml", Limits()).root)))


def _messages(text: str) -> list[str]:
    return [error.message for error in VALIDATOR.iter_errors(_as_json(text))]


def test_the_shipped_schema_is_in_step_with_the_model() -> None:
    assert schema_file().read_text(encoding="utf-8") == schema_text(), "run python -m equilux_scenes.schema"


def test_the_schema_is_a_valid_schema_of_its_dialect() -> None:
    Draft202012Validator.check_schema(json_schema())
    assert json_schema()["$schema"] == "https://json-schema.org/draft/2020-12/schema"


def test_every_key_of_every_part_is_described_or_says_it_all_by_its_name() -> None:
    obvious = {"kind", "projection", "camera", "film", "lights", "materials", "objects", "equilux", "name", "ambient", "normal",
               "axis", "degrees", "scale", "rotate", "adapter", "values", "attenuation"}  # fmt: skip
    schema = json_schema()
    parts = {"Scene": schema, **schema["$defs"]}
    silent = {
        f"{part}.{key}"
        for part, content in parts.items()
        for key, value in content["properties"].items()
        if "description" not in value and key not in obvious
    }
    assert silent == set()


def test_terms_of_other_models_say_so() -> None:
    material = json_schema()["$defs"]["Material"]["properties"]
    assert "Only in the model 'raytraced'" in material["reflection"]["description"]
    assert "Only in" not in material["diffuse"]["description"]


def test_a_valid_spec_and_the_whole_corpus_are_accepted(valid: str) -> None:
    assert _messages(valid) == []
    for path in sorted(corpus_folder().rglob("*.scene.yaml")):
        assert _messages(path.read_text(encoding="utf-8")) == [], path.name


REJECTED = {
    "unknown key": ("specular: 0.5", "specullar: 0.5"),
    "negative": ("radius: 0.5", "radius: -0.5"),
    "text": ("radius: 0.5", "radius: '0.5'"),
    "null": ("normals: smooth", "normals: ~"),
    "kind": ("kind: sphere", "kind: shpere"),
    "two numbers": ("eye: [0, 0, 3]", "eye: [0, 3]"),
    "four bands": ("[0.6, 0.6, 0.6]", "[0.6, 0.6, 0.6, 1]"),
    "fov": ("fov_y_deg: 30", "fov_y_deg: 180"),
    "version": ("equilux: 1", "equilux: 2"),
    "name": ("name: every-part", "name: Every Part"),
    "model": ("model: phong", "model: radiosity"),
    "missing": ("film: {width: 64, height: 48}\n", ""),
    "step of two": ("{scale: 2}", "{scale: 2, translate: [0, 0, 1]}"),
    "empty step": ("{scale: 2}", "{}"),
    "mesh of both": ("normals: smooth", "file: a.ply"),
    "no values": ("values: [1, 10, 100, 1000]", "values: []"),
    "fraction of a pixel": ("width: 64", "width: 64.5"),
    "face": ("faces: [[0, 1, 2]]", "faces: [[0, 1]]"),
}


@pytest.mark.parametrize("name", REJECTED)
def test_what_is_plainly_wrong_is_rejected(edited: Callable[..., str], name: str) -> None:
    assert _messages(edited(*REJECTED[name])) != []


LIGHTS = {
    "luminous_intensity: 5": True,
    "flux: [1, 2, 3]": True,
    "luminous_flux: 800, spectrum: {blackbody: 2700}": True,
    "spectrum: {table: [[400, 1], [700, 1]]}": True,
    "spectrum: {illuminant: D65, total: 1}": True,
    "intensity: 5, flux: 5": False,
    "intensity: 5, spectrum: {line_nm: 555, total: 1}": False,
    "flux: 5, luminous_flux: 5": False,
    "spectrum: {}": False,
    "spectrum: {blackbody: 2700, illuminant: D65}": False,
    "spectrum: {total: 1}": False,
    "spectrum: {table: [[400, 1]]}": False,
    "luminous_intensity: [5, 5, 5]": False,
    "flux: 5, illuminance: 5": False,
}


@pytest.mark.parametrize("strength", LIGHTS)
def test_the_schema_knows_what_a_light_is_given_by(edited: Callable[..., str], strength: str) -> None:
    assert (_messages(edited("intensity: 5,", f"{strength},")) == []) is LIGHTS[strength]
