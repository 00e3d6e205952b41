"""Sweeps: the product of the axes, the names of the cases, and where wrong values are reported."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

Edited = Callable[..., str]
Only = Callable[..., str]
AXIS = "exponent: {path: materials.clay.exponent, values: [1, 10, 100, 1000]}"
WHEN = '  - {adapter: vtk, cause: exponent-clamped, when: "exponent > 128"}  # VTK clamps it\n'


@pytest.fixture
def swept(edited: Edited) -> Callable[[str], str]:
    """The valid spec with another sweep and no expectation."""
    return lambda axes: edited(AXIS, axes, "expect:\n" + WHEN, "")


def test_a_scene_without_a_sweep_is_one_case_of_its_name(load: Callable[..., Any], edited: Edited) -> None:
    file = load(edited("sweep:\n  " + AXIS, "sweep: {}", "expect:\n" + WHEN, ""))
    assert [case.name for case in file.cases] == ["every-part"]
    assert dict(file.cases[0].axes) == {}


def test_cases_are_the_product_in_file_order(load: Callable[..., Any], swept: Callable[[str], str]) -> None:
    file = load(swept("b: {path: objects.0.radius, values: [1, 2]}\n  a: {path: lights.lamp.exponent, values: [3, 4]}"))
    assert [case.name for case in file.cases] == [f"every-part[b={b},a={a}]" for b in (1, 2) for a in (3, 4)]
    assert [(case.scene.objects[0].radius, case.scene.lights["lamp"].exponent) for case in file.cases] == [
        (1, 3), (1, 4), (2, 3), (2, 4),
    ]  # fmt: skip
    assert file.cases[1].axes == {"b": 1, "a": 4}
    assert all(case.scene.sweep == {} for case in file.cases)
    assert list(file.scene.sweep) == ["b", "a"]


NAMES = {
    "10.0": "10",
    "1e1": "10",
    "0.1": "0.1",
    ".5": "0.5",
    "1e-5": "1e-05",
    "1e22": "1e+22",
    "100000": "100000",
    "-0.0": "0",
    "0x10": "16",
}


@pytest.mark.parametrize("written", NAMES)
def test_numbers_in_names_are_the_shortest_that_read_back(
    load: Callable[..., Any], swept: Callable[[str], str], written: str
) -> None:
    file = load(swept(f"a: {{path: ambient, values: [{written}]}}"))
    assert file.cases[0].name == f"every-part[a={NAMES[written]}]"
    assert float(NAMES[written]) == file.cases[0].scene.ambient[0]


def test_values_that_are_no_numbers_are_named_by_their_index(load: Callable[..., Any], swept: Callable[[str], str]) -> None:
    file = load(
        swept("on: {path: objects.5.capped, values: [true, false]}\n  up: {path: camera.up, values: [[0, 1, 0], [1, 0, 0]]}")
    )
    assert [case.name for case in file.cases] == [f"every-part[on=#{a},up=#{b}]" for a in (0, 1) for b in (0, 1)]
    assert file.cases[3].scene.camera.up == (1, 0, 0)
    assert file.cases[3].scene.objects[5].capped is False
    assert file.cases[3].axes == {"on": False, "up": (1, 0, 0)}


PATHS = {
    "materials.clay.exponent": lambda scene: scene.materials["clay"].exponent,
    "objects.0.radius": lambda scene: scene.objects[0].radius,
    "objects.1.point.1": lambda scene: scene.objects[1].point[1],
    "lights.key.position.1": lambda scene: scene.lights["key"].position[1],
    "lights.key.intensity.2": lambda scene: scene.lights["key"].intensity[2],
    "lights.key.attenuation.linear": lambda scene: scene.lights["key"].attenuation.linear,
    "objects.6.vertices.1.0": lambda scene: scene.objects[6].vertices[1][0],
    "objects.6.transform.1.rotate.degrees": lambda scene: scene.objects[6].transform[1].rotate.degrees,
    "film.width": lambda scene: scene.film.width,
    "camera.fov_y_deg": lambda scene: scene.camera.fov_y_deg,
}


@pytest.mark.parametrize("path", PATHS)
def test_a_path_leads_through_keys_and_list_positions(load: Callable[..., Any], swept: Callable[[str], str], path: str) -> None:
    file = load(swept(f"a: {{path: {path}, values: [5, 7]}}"))
    assert [PATHS[path](case.scene) for case in file.cases] == [5, 7]
    assert len({case.canonical() for case in file.cases}) == 2


def test_a_field_left_at_its_default_can_be_swept(load: Callable[..., Any], edited: Edited) -> None:
    text = edited(AXIS, "a: {path: materials.clay.exponent, values: [2, 3]}", "exponent: 20, ", "", "expect:\n" + WHEN, "")
    assert [case.scene.materials["clay"].exponent for case in load(text).cases] == [2, 3]


def test_cases_share_the_meshes_that_the_sweep_does_not_touch(load: Callable[..., Any], valid: str) -> None:
    cases = load(valid).cases
    assert len({id(case.meshes[6]) for case in cases}) == 1
    assert len({id(case.scene.objects[6]) for case in cases}) == 1


PATHLESS = {
    "materials.clya.exponent": "one of clay after 'materials', not 'clya' (did you mean 'clay'?)",
    "objects.7.radius": "a position 0 to 6 after 'objects', not '7'",
    "objects.-1.radius": "a position 0 to 6 after 'objects', not '-1'",
    "objects.first": "a position 0 to 6 after 'objects', not 'first'",
    "camera.eye.x": "a position 0 to 2 after 'camera.eye', not 'x'",
    "camera.fov_y_deg.0": "nothing after 'camera.fov_y_deg', which is 30",
    "name": "a path to something that determines the picture ('name' does not)",
    "sweep.a.values": "a path to something that determines the picture ('sweep' does not)",
    "lights.sun.ambient.0": "the path of a value that is written out ('ambient' of light 'sun' is not)",
    "lights.lamp.attenuation.linear": "the path of a value that is written out ('attenuation' of light 'lamp' is not)",
}


@pytest.mark.parametrize("path", PATHLESS)
def test_a_path_that_leads_nowhere_says_where_it_ends(only_error: Only, swept: Callable[[str], str], path: str) -> None:
    message = only_error(swept(f"a: {{path: «{path}, values: [5, 7]}}"))
    assert message == f"path of a sweep axis: got '{path}', allowed {PATHLESS[path]}"


def test_a_value_that_makes_a_case_invalid_is_reported_at_its_place(only_error: Only, swept: Callable[[str], str]) -> None:
    message = only_error(swept("a: {path: objects.0.radius, values: [1, «-2, 3]}"))
    assert message == "radius of object 0 (sphere): got -2, allowed a number > 0"


def test_an_error_inside_a_value_stands_inside_it(only_error: Only, swept: Callable[[str], str]) -> None:
    message = only_error(swept("a: {path: camera.up, values: [[0, 1, 0], [0, «.nan, 0]]}"))
    assert message == "up[1] of camera: got .nan, allowed a finite number"


def test_an_error_that_a_value_brings_about_elsewhere_moves_to_the_value(only_error: Only, swept: Callable[[str], str]) -> None:
    axes = "b: {path: objects.0.radius, values: [1, 2]}\n  a: {path: camera.eye.2, values: [3, «0]}"
    message = only_error(swept(axes))
    assert message == "target of camera: got [0, 0, 0], allowed another point than the eye (in case 'every-part[b=1,a=0]')"


def test_an_error_of_a_combination_names_the_case(errors_of: Callable[..., Any], swept: Callable[[str], str]) -> None:
    text = swept("lo: {path: objects.2.min.0, values: [-5, 5]}\n  hi: {path: objects.2.max.0, values: [4, 6]}")
    errors = errors_of(text)
    assert [error.message for error in errors] == [
        "max[0] of object 2 (box): got 4, allowed a number > 5, which is min[0] (in case 'every-part[lo=5,hi=4]')"
    ]
    assert text.splitlines()[errors[0].line - 1][errors[0].column - 1 :].startswith("4, 6]")


def test_a_value_that_no_case_combines_with_the_written_one_is_fine(
    load: Callable[..., Any], swept: Callable[[str], str]
) -> None:
    axes = "lo: {path: objects.2.min.0, values: [10]}\n  hi: {path: objects.2.max.0, values: [11]}"
    assert [case.scene.objects[2].max[0] for case in load(swept(axes)).cases] == [11]


def test_errors_of_the_spec_and_of_the_sweep_are_reported_together(
    errors_of: Callable[..., Any], swept: Callable[[str], str]
) -> None:
    text = swept("a: {path: objects.0.radius, values: [1, -2]}").replace("fov_y_deg: 30", "fov_y_deg: 190")
    assert [error.message.split(":")[0] for error in errors_of(text)] == ["fov_y_deg of camera", "radius of object 0 (sphere)"]


REFUSED = {
    "same value twice": ("a: {path: ambient, values: [1, «1.0]}", "value of sweep axis 'a': got 1.0, allowed each value once"),
    "same path twice": (
        "a: {path: ambient, values: [1]}\n  b: {path: «ambient, values: [2]}",
        "path of a sweep axis: got 'ambient', allowed a value that axis 'a' does not sweep",
    ),
    "name of an axis": ("«a b: {path: ambient, values: [1]}", "name of sweep axis: got 'a b', allowed a letter"),
    "name and": ("«and: {path: ambient, values: [1]}", "name of sweep axis: got 'and', allowed a letter"),
    "name with a slash": ("«../x: {path: ambient, values: [1]}", "name of sweep axis: got '../x', allowed a letter"),
    "values not a list": (
        "a: {path: ambient, values: «7}",
        "values of sweep axis 'a': got 7, allowed a list of at least one value",
    ),
    "no values": ("a: «{path: ambient}", "missing key 'values' in sweep axis 'a', allowed a list of at least one value"),
    "no path": ("a: «{values: [1]}", "missing key 'path' in sweep axis 'a', allowed text"),
    "null": ("a: {path: ambient, values: [«~]}", "ambient of the scene: got nothing, allowed one number ≥ 0 or three"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_sweep_that_makes_no_sense_is_refused(only_error: Only, swept: Callable[[str], str], name: str) -> None:
    axes, message = REFUSED[name]
    assert only_error(swept(axes)).startswith(message)


def test_overlapping_paths_are_refused(errors_of: Callable[..., Any], swept: Callable[[str], str]) -> None:
    messages = [
        error.message for error in errors_of(swept("a: {path: camera, values: [{}]}\n  b: {path: camera.eye, values: [2]}"))
    ]
    assert "path of a sweep axis: got 'camera.eye', allowed a value that axis 'a' does not sweep" in messages


def test_a_case_name_that_no_file_system_takes_is_refused(only_error: Only, swept: Callable[[str], str]) -> None:
    axes = "\n  ".join(f"{letter * 40}: {{path: objects.6.vertices.0.{i}, values: [1]}}" for i, letter in enumerate("abc"))
    axes += "\n  " + "\n  ".join(
        f"{letter * 40}: {{path: objects.6.vertices.1.{i}, values: [1]}}" for i, letter in enumerate("def")
    )
    assert "bytes ('every-part[aaaa" in only_error(swept(axes).replace("sweep:", "«sweep:"))
