"""Hundreds of malformed specs, made by changing a valid one everywhere.

Each is answered with a located error, never with a traceback.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from equilux_scenes.errors import SpecErrors
from equilux_scenes.limits import Limits
from equilux_scenes.loader import SceneFile, load_scene_file, load_scene_text
from equilux_scenes.yaml_tree import ListNode, MapNode, Node, Place, ScalarNode, parse

Load = Callable[..., SceneFile]


def _nodes(node: Node) -> Iterator[Node]:
    yield node
    if isinstance(node, ListNode):
        for item in node.items:
            yield from _nodes(item)
    if isinstance(node, MapNode):
        for value in node.entries.values():
            yield from _nodes(value)


def _keys(node: Node) -> Iterator[tuple[Place, Node]]:
    """Every key with its value."""
    for part in _nodes(node):
        if isinstance(part, MapNode):
            yield from ((part.keys[key], value) for key, value in part.entries.items())


def _root(text: str) -> Node:
    return parse(text, "t", Limits()).root


def _inline(node: Node) -> bool:
    """Whether a node can be replaced by a span of text: anything but a block collection."""
    return isinstance(node, ScalarNode) or node.place.start < node.place.end


def _replaced(text: str, place: Place, by: str) -> str:
    return text[: place.start] + by + text[place.end :]


def _flow(valid: str) -> str:
    """The valid spec without its block collections, so that every value is one span of text."""
    start, end = valid.index("  key:\n"), valid.index("  sun:")
    light = valid[start:end].replace("\n    ", ", ").replace("key:, ", "key: {").rstrip() + "}\n"
    valid = valid[:start] + light + valid[end:]
    start, end = valid.index("  - kind: mesh"), valid.index("sweep:")
    mesh = "  - {" + valid[start:end].strip().removeprefix("- ").replace("\n    ", ", ") + "}\n"
    return valid[:start] + mesh + valid[end:]


def _places(text: str) -> set[tuple[int, int]] | None:
    """Where the errors of a text are; None when it loads."""
    try:
        load_scene_text(text, "t.yaml")
        return None
    except SpecErrors as failed:
        errors = failed.errors
    assert errors
    for error in errors:
        assert len(str(error).splitlines()) == 1, error
        assert 1 <= error.line <= len(re.split("\r\n|\r|\n", text)), error
        assert error.column >= 1, error
    return {(error.line, error.column) for error in errors}


def test_the_flow_form_is_the_same_scene(load: Load, valid: str) -> None:
    assert load(_flow(valid)).scene == load(valid).scene


NEVER = ["~", ".nan", "!!python/object/apply:os.system [x]", "-.inf", "{nested: {deeper: [1]}}"]


def test_a_value_that_fits_nowhere_is_reported_at_its_place_wherever_it_stands(valid: str) -> None:
    text = _flow(valid)
    scalars = [node for node in _nodes(_root(text)) if isinstance(node, ScalarNode)]
    assert len(scalars) > 130
    for number, node in enumerate(scalars):
        value = NEVER[number % len(NEVER)]
        places = _places(_replaced(text, node.place, value))
        assert places is not None, f"{value} accepted at {node.place}"
        assert (node.place.line, node.place.column) in places, f"{value} at {node.place}, reported at {places}"


def test_a_misspelt_key_is_reported_at_its_place_wherever_it_stands(valid: str) -> None:
    text = _flow(valid)
    named = {"lights", "materials", "sweep"}  # what is inside these has names of its own
    tried = 0
    for place, _ in _keys(_root(text)):
        key = text[place.start : place.end]
        places = _places(_replaced(text, place, key + "_"))
        if key in ("key", "sun", "lamp"):
            assert places is None
            continue
        assert places is not None, f"{key}_ accepted"
        if key not in ("clay", "exponent", *named):  # these are missed elsewhere too, or instead
            assert (place.line, place.column) in places, f"{key}_ at {place}, reported at {places}"
        tried += 1
    assert tried > 80, tried


def test_a_repeated_key_is_reported_at_the_second_wherever_it_stands(valid: str) -> None:
    text = _flow(valid)
    tried = 0
    for place, value in _keys(_root(text)):
        if place.line == value.place.line and _inline(value) and "{" in text.splitlines()[place.line - 1][: place.column]:
            entry = text[place.start : value.place.end]
            places = _places(_replaced(text, Place(0, 0, place.start, value.place.end), f"{entry}, {entry}"))
            second = (place.line, place.column + len(entry) + 2)
            assert places is not None, f"{entry} accepted twice"
            assert second in places, f"{entry} at {place}, reported at {places}"
            tried += 1
    assert tried > 70, tried


def test_a_key_left_out_is_an_error_or_has_a_default(valid: str) -> None:
    text = _flow(valid)
    optional = set()
    for place, value in _keys(_root(text)):
        if "{" not in text.splitlines()[place.line - 1][: place.column]:
            continue
        end = value.place.end
        end += 2 if text[end : end + 2] == ", " else 0
        if _places(_replaced(text, Place(0, 0, place.start, end), "")) is None:
            optional.add(text[place.start : place.end])
    assert optional == {
        "up", "attenuation", "constant", "linear", "exponent", "diffuse", "specular", "ambient", "emission", "capped", "normals",
        "vertex_normals", "transform", "when",
    }  # fmt: skip


OTHERS = [
    "-1", "0", "1e308", "5e-324", "true", "'text'", "[]", "{}", "[1, [2]]", "[0, 0, 0]",
    "*x", "&x", "[", "}", '"', ": ", "- 1", "#", "\t",
]  # fmt: skip


def test_any_other_value_loads_or_is_answered_with_located_errors(valid: str) -> None:
    text = _flow(valid)
    nodes = [node for node in _nodes(_root(text)) if _inline(node)]
    answers = [_places(_replaced(text, node.place, OTHERS[number % len(OTHERS)])) for number, node in enumerate(nodes)]
    malformed = sum(answer is not None for answer in answers)
    assert malformed > 100, f"{malformed} of {len(answers)}"


def test_a_spec_cut_off_anywhere_loads_or_is_answered_with_located_errors(valid: str) -> None:
    answers = [_places(valid[:length]) for length in range(0, len(valid), 40)]
    assert sum(answer is not None for answer in answers) > 35


@settings(max_examples=150, deadline=None, derandomize=True)
@given(st.text(max_size=60))
def test_any_text_is_answered_with_located_errors(text: str) -> None:
    assert _places(text) is not None


YAML_BITS = st.sampled_from(
    ["a", "1", ".", "~", "- ", ": ", "? ", "{", "}", "[", "]", ",", "&a ", "*a", "!t ", "|", ">", "'", '"', "\\", "#",
     "%YAML 1.2", "---",
     "...", "\n", "\n  ", "\t", "<<", "=", "\x85", "\u2028", "\ufeff", "é"]
)  # fmt: skip


@settings(max_examples=300, deadline=None, derandomize=True)
@given(st.lists(YAML_BITS, max_size=25).map("".join))
def test_any_sequence_of_yaml_tokens_is_answered_with_located_errors(text: str) -> None:
    assert _places(text) is not None


@settings(max_examples=150, deadline=None, derandomize=True)
@given(st.data())
def test_a_valid_spec_with_something_spliced_in_loads_or_is_answered(valid: str, data: st.DataObject) -> None:
    start = data.draw(st.integers(0, len(valid)))
    end = data.draw(st.integers(start, min(start + 30, len(valid))))
    _places(valid[:start] + "".join(data.draw(st.lists(YAML_BITS, max_size=4))) + valid[end:])


@settings(max_examples=100, deadline=None, derandomize=True)
@given(content=st.binary(max_size=60))
def test_any_bytes_in_a_file_are_answered_with_located_errors(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    path = tmp_path_factory.mktemp("bytes") / "a.scene.yaml"
    path.write_bytes(content)
    with pytest.raises(SpecErrors) as caught:
        load_scene_file(path)
    assert all(str(error).startswith(f"{path}:") for error in caught.value.errors)


# --- every other model, and lights in units ---------------------------------------------------------------------------

_HEAD = """\
equilux: 1
name: other
model: {model}
camera: {{projection: perspective, eye: [0, 0, 3], target: [0, 0, 0], up: [0, 1, 0], fov_y_deg: 30}}
film: {{width: 64, height: 48}}
"""
OTHER_MODELS = {
    "raytraced": _HEAD.format(model="raytraced")
    + """\
recursion_limit: 3
transparent_shadows: ignore
lights: {key: {kind: point, position: [0, 2, 3], luminous_flux: 800, spectrum: {blackbody: 2700}}}
materials:
  glass: {reflection: 0.1, transmission: [0.9, 0.9, 1], transparency: 0.9, ior: 1.5}
objects:
  - {kind: sphere, center: [0, 0, 0], radius: 0.5, material: glass}
  - {kind: mesh, vertices: [[0, 0, 9], [1, 0, 9], [0, 1, 9], [0, 0, 8]], faces: [[0, 1, 2], [0, 3, 1], [1, 3, 2], [0, 2, 3]],
     material: glass}
""",
    "opengl": _HEAD.format(model="opengl")
    + """\
viewer: infinite
k_m: 684
lights:
  key: {kind: spot, position: [0, 2, 3], direction: [0, -1, 0], flux: [1, 2, 3], cone_half_angle_deg: 20, exponent: 4,
        ambient: 0.1, diffuse: [1, 1, 2], specular: 0.5}
  sun: {kind: directional, direction: [0, -1, 0], illuminance: 1e5, spectrum: {illuminant: D65}}
materials: {clay: {diffuse: 0.1, specular: 0.2, exponent: 128}}
objects: [{kind: box, min: [-1, -1, -1], max: [1, 1, 1], material: clay}]
""",
    "reflection-equation": _HEAD.format(model="reflection-equation")
    + """\
bands: {intervals_nm: [[600, 700], [500, 600], [400, 500]]}
lights:
  sky: {kind: environment, spectrum: {line_nm: 520, total: 2}}
  ball: {kind: sphere, center: [0, 5, 0], radius: 1, luminance: 200}
  lid: {kind: disc, center: [0, 7, 0], normal: [0, -1, 0], radius: 1, spectrum: {table: [[400, 0.1], [500, 0], [700, 1]]}}
  panel: {kind: rectangle, corner: [0, 9, 0], edge_u: [1, 0, 0], edge_v: [0, 0, 1], flux: 8, spectrum: {blackbody: 900}}
materials: {matt: {diffuse: 0.1, brdf: lambert}, shiny: {specular: 0.1, brdf: phong-cosine, exponent: 9}}
objects: [{kind: disc, center: [0, 0, 0], normal: [0, 1, 0], radius: 1, material: shiny}]
""",
}


@pytest.mark.parametrize("model", OTHER_MODELS)
def test_what_is_wrong_in_any_model_is_reported_at_its_place(model: str) -> None:
    text = OTHER_MODELS[model]
    assert _places(text) is None
    for number, node in enumerate(node for node in _nodes(_root(text)) if isinstance(node, ScalarNode)):
        value = NEVER[number % len(NEVER)]
        places = _places(_replaced(text, node.place, value))
        assert places is not None, f"{value} accepted at {node.place}"
        assert (node.place.line, node.place.column) in places, f"{value} at {node.place}, reported at {places}"


@pytest.mark.parametrize("model", OTHER_MODELS)
def test_any_change_in_any_model_loads_or_is_answered_with_located_errors(model: str) -> None:
    text = OTHER_MODELS[model]
    malformed = 0
    for number, node in enumerate(node for node in _nodes(_root(text)) if _inline(node)):
        for other in (OTHERS[number % len(OTHERS)], OTHERS[(7 * number + 3) % len(OTHERS)]):
            malformed += _places(_replaced(text, node.place, other)) is not None
    for place, value in _keys(_root(text)):
        if "{" in text.splitlines()[place.line - 1][: place.column]:
            end = value.place.end
            end += 2 if text[end : end + 2] == ", " else 0
            malformed += _places(_replaced(text, Place(0, 0, place.start, end), "")) is not None
    assert malformed > 60, malformed
