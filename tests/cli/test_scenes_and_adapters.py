"""`equilux scenes …` and `equilux adapters list`, as they are typed."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from equilux_scenes.loader import load_scene_text
from support.engine import LABORATORIES, write_scene

SWEEP = "sweep:\n  exponent: {path: materials.clay.exponent, values: [1, 10]}"


def test_the_corpus_is_listed_with_what_each_scene_is_about(equilux):
    said = equilux("scenes", "list")
    assert said.code == 0
    (line,) = [line for line in said.out.splitlines() if line.startswith("clay-ball ")]
    assert len(line.split()) > 4
    listed = json.loads(equilux("scenes", "list", "--json").out)
    assert len(listed) >= 36
    assert {"scene", "file", "model", "about", "cases", "requires"} == set(listed[0])
    assert len(said.out.splitlines()) == len(listed) + 1


def test_a_scene_is_shown_with_every_default_filled_in_and_what_it_requires(tiny: Path, equilux):
    write_scene(tiny, specular=0.5, rest=SWEEP)
    said = equilux("scenes", "show", tiny)
    assert said.code == 0
    again = load_scene_text(said.out)  # what is shown is a spec of the same scene
    assert again.scene == load_scene_text(tiny.read_text()).scene
    assert "ambient: [0.0, 0.0, 0.0]" in said.out
    assert "# requires: attenuation.quadratic, camera.perspective, light.point, material.diffuse, material.specular, " in said.out
    assert "# case: tiny[exponent=10]\n" in said.out
    shown = json.loads(equilux("scenes", "show", tiny, "--json").out)
    assert shown["scene"]["lights"]["key"]["attenuation"]["quadratic"] == 1
    assert shown["cases"] == ["tiny[exponent=1]", "tiny[exponent=10]"]


UNITS = """\
equilux: 1
name: lamp
model: phong
camera: {projection: orthographic, eye: [0, 0, 3], target: [0, 0, 0], height_m: 2}
film: {width: 4, height: 3}
k_m: 684
lights: {k: {kind: point, position: [0, 0, 5], luminous_intensity: 684}}
materials: {m: {diffuse: 1}}
objects: [{kind: sphere, center: [0, 0, 0], radius: 1, material: m}]
sweep: {i: {path: lights.k.luminous_intensity, values: [684, 1368]}}
"""


def test_a_light_in_units_is_shown_as_written_and_in_bands(tmp_path: Path, equilux):
    spec = tmp_path / "lamp.scene.yaml"
    spec.write_text(UNITS)
    said = equilux("scenes", "show", spec).out
    assert "# light k: intensity [1, 1, 1] W/sr from luminous_intensity 684 cd\n" in said
    assert "# k_m: 684 lm/W, the lecture's, 0.146 % above the SI's 683.002\n" in said
    assert [case.canonical() for case in load_scene_text(said).cases] == [
        case.canonical() for case in load_scene_text(UNITS).cases
    ]
    shown = json.loads(equilux("scenes", "show", spec, "--json").out)
    assert shown["bands"] == {"k": {"intensity": [1, 1, 1]}}
    _, two = json.loads(equilux("scenes", "expand", spec, "--json").out)
    assert two["resolved"]["lights"]["k"]["intensity"] == [2, 2, 2]
    assert two["written"] == {"k": "luminous_intensity 1368 cd"}


def test_a_corpus_scene_is_shown_by_name(equilux):
    assert equilux("scenes", "show", "clay-ball").out.startswith("equilux: 1\nname: clay-ball\n")


def test_cases_are_expanded(tiny: Path, equilux):
    write_scene(tiny, rest=SWEEP)
    assert equilux("scenes", "expand", tiny).out == "tiny[exponent=1]\ntiny[exponent=10]\n"
    one, ten = json.loads(equilux("scenes", "expand", tiny, "--json").out)
    assert (one["axes"], ten["axes"]) == ({"exponent": 1}, {"exponent": 10})
    assert ten["resolved"]["materials"]["clay"]["exponent"] == 10


def test_valid_scenes_are_called_valid(tiny: Path, equilux):
    write_scene(tiny, rest=SWEEP)
    assert equilux("scenes", "validate", tiny).out == "valid: 1 scenes, 2 cases\n"
    said = equilux("scenes", "validate", "--json")
    assert (said.code, json.loads(said.out)) == (0, [])


def test_the_schema_of_specs_is_printed(equilux):
    schema = json.loads(equilux("scenes", "schema").out)
    assert "camera" in json.dumps(schema["properties"])


def test_installed_adapters_are_listed_with_version_and_what_they_support(equilux):
    said = equilux("adapters", "list")
    assert said.code == 0
    rows = {line.split()[0]: line for line in said.out.splitlines() if not line.startswith(" ")}
    assert "found" in next(line for line in said.out.splitlines() if line.startswith("good "))
    assert "missing" in next(line for line in said.out.splitlines() if line.startswith("absent "))
    assert "  lacks material.specular" in said.out
    assert "  --set good.level=1  the picture is brighter by level − 1" in said.out
    assert {"reference", "oracle", "povray", "vtk"} <= set(rows)


def test_the_list_of_adapters_as_json_says_all_there_is(equilux):
    listed = {adapter["name"]: adapter for adapter in json.loads(equilux("adapters", "list", "--json").out)}
    good, absent = listed["good"], listed["absent"]
    assert (good["version"], good["found"], good["error"], good["api_version"]) == ("fake 1.0", True, None, 1)
    assert good["distribution"] == "fake-laboratories 1.0"
    assert good["capabilities"]["light.point"] == {"level": "exact", "note": ""}
    assert good["knobs"]["level"]["maximum"] == 9
    assert good["lack_causes"] == {"material.specular": "highlight-missing"}
    assert (absent["found"], absent["detail"]) == (False, "no such program: fake-renderer")


def test_what_cannot_be_loaded_is_listed_with_its_error(equilux, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.syspath_prepend(LABORATORIES.parent / "broken_laboratories")
    said = equilux("adapters", "list")
    assert said.code == 0
    assert "outdated: broken_laboratories:OUTDATED is not an adapter: api_version is 99, this equilux speaks 1" in said.out
    listed = {adapter["name"]: adapter for adapter in json.loads(equilux("adapters", "list", "--json").out)}
    assert "missing lack_causes" in listed["incomplete"]["error"]
    assert listed["good"]["error"] is None
