"""Editing `expect:` in a spec's text: nothing else changes, comments stay."""

from __future__ import annotations

import difflib
from functools import lru_cache

import pytest

from equilux.pinning.edit import CannotEdit, Changes, Pin, edited
from equilux_scenes.loader import load_scene_text
from equilux_scenes.model import Scene
from support.engine import scene_text

SWEEP = "sweep:\n  exponent: {path: materials.clay.exponent, values: [1, 10, 100, 1000]}\n"
HALF = Pin("vtk", "half-vector", None, "VTK draws (N·H)^p.")
CLAMP = Pin("vtk", "exponent-clamped", "exponent > 128")
LISTED = (
    scene_text(rest=SWEEP)
    + """\
expect:
  # The reason of the first.
  - {adapter: vtk, cause: exponent-clamped, when: exponent > 128}  # beside it
  # Two reasons share
  # this comment.
  - {adapter: povray, cause: normal-side}
  - {adapter: povray, cause: half-vector, when: "exponent > 1"}
# The end.
"""
)
BLOCKS = (
    scene_text(rest=SWEEP)
    + """\
expect:
- adapter: vtk   # here
  cause: exponent-clamped
  when: exponent > 128  # why
- cause: normal-side
  adapter: povray
"""
)
FLOW = scene_text(rest=SWEEP).replace(
    "sweep:", "expect: [{adapter: vtk, cause: half-vector}, {adapter: povray, cause: normal-side}]\nsweep:"
)
FLOW_LINES = (
    scene_text(rest=SWEEP)
    + """\
expect: [
  {adapter: vtk, cause: exponent-clamped},  # one
  # two
  {adapter: povray, when: exponent < 10, cause: normal-side}   # three
]
"""
)
JSON = (
    '{"equilux": 1, "name": "tiny", "model": "phong", "film": {"width": 8, "height": 6}, "camera": {"projection": "perspective", '
    '"eye": [0, 0, 3], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y_deg": 30}, "materials": {"clay": {"diffuse": 0.6}}, '
    '"objects": [{"kind": "sphere", "center": [0, 0, 0], "radius": 0.5, "material": "clay"}]}\n'
)  # fmt: skip
STYLES = {
    "listed": LISTED,
    "blocks": BLOCKS,
    "flow": FLOW,
    "flow lines": FLOW_LINES,
    "none": scene_text(rest=SWEEP),
    "json": JSON,
}


@lru_cache
def scene_of(text: str) -> Scene:
    return load_scene_text(text).scene


def expected(text: str) -> list[tuple[str, str, str | None]]:
    return [(item.adapter, item.cause, item.when) for item in scene_of(text).expect]


def apart(text: str, new: str) -> list[str]:
    """Lines removed and added."""
    lines = difflib.unified_diff(text.splitlines(), new.splitlines(), n=0, lineterm="")
    return [line for line in lines if line[0] in "+-" and line[:3] not in ("+++", "---")]


def without_expect(text: str) -> object:
    return scene_of(text).model_copy(update={"expect": ()})


@pytest.mark.parametrize("style", STYLES)
def test_an_added_pin_is_the_last_expectation_and_all_that_changed(style: str):
    text = STYLES[style]
    new = edited(text, Changes(added=(HALF,)))
    assert expected(new) == [*expected(text), ("vtk", "half-vector", None)]
    assert without_expect(new) == without_expect(text)
    if style != "json":
        assert any(
            line == f"+{' ' * 2}# VTK draws (N·H)^p." or line.strip("+ ") == "# VTK draws (N·H)^p." for line in apart(text, new)
        )


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize(("ending", "mark"), [("\r\n", "\ufeff"), ("", "")])
def test_line_ends_and_byte_order_mark_stay(style: str, ending: str, mark: str):
    text = mark + STYLES[style].replace("\n", ending or "\n")
    text = text if ending else text.rstrip("\n")
    new = edited(text, Changes(added=(HALF, Pin("vtk", "mesa:odd"))))
    assert expected(new)[-2:] == [("vtk", "half-vector", None), ("vtk", "mesa:odd", None)]
    assert new.startswith(mark + text[len(mark) : 20])
    assert ("\r\n" in new) == (ending == "\r\n")
    assert "\n" not in new.replace("\r\n", "") or ending != "\r\n"
    assert new.endswith(("\n", "\r\n")) == bool(ending)


@pytest.mark.parametrize("style", ["listed", "blocks", "flow", "flow lines"])
@pytest.mark.parametrize("position", [0, 1])
@pytest.mark.parametrize("when", ["exponent == 10", None])
def test_a_when_is_written_changed_and_taken_away(style: str, position: int, when: str | None):
    text = STYLES[style]
    new = edited(text, Changes(whens={position: when}))
    before = expected(text)
    assert expected(new) == [(a, c, when if index == position else w) for index, (a, c, w) in enumerate(before)]
    assert without_expect(new) == without_expect(text)
    assert len(new.splitlines()) - len(text.splitlines()) in (-1, 0, 1)


@pytest.mark.parametrize("style", ["listed", "blocks", "flow", "flow lines"])
def test_any_of_them_can_be_removed(style: str):
    text = STYLES[style]
    count = len(expected(text))
    for removed in ((0,), (1,), (count - 1,), tuple(range(count))):
        new = edited(text, Changes(removed=tuple(set(removed))))
        assert expected(new) == [item for index, item in enumerate(expected(text)) if index not in removed]
        assert without_expect(new) == without_expect(text)


def test_the_comment_of_a_removed_expectation_goes_with_it():
    assert apart(LISTED, edited(LISTED, Changes(removed=(0,)))) == [
        "-  # The reason of the first.", "-  - {adapter: vtk, cause: exponent-clamped, when: exponent > 128}  # beside it",
    ]  # fmt: skip


def test_a_comment_that_the_next_one_may_rely_on_stays():
    assert apart(LISTED, edited(LISTED, Changes(removed=(1,)))) == ["-  - {adapter: povray, cause: normal-side}"]


def test_the_last_expectation_takes_the_key_with_it():
    new = edited(LISTED, Changes(removed=(0, 1, 2)))
    assert "expect" not in new
    assert new.endswith("# The end.\n")


def test_all_at_once():
    new = edited(LISTED, Changes(added=(CLAMP,), whens={1: "exponent < 5"}, removed=(0, 2)))
    assert expected(new) == [("povray", "normal-side", "exponent < 5"), ("vtk", "exponent-clamped", "exponent > 128")]


def test_a_document_end_stays_the_end():
    new = edited(scene_text() + "...\n", Changes(added=(HALF,)))
    assert new.endswith("- {adapter: vtk, cause: half-vector}\n...\n")


def test_a_commented_out_object_stays_with_the_objects():
    new = edited(scene_text().rstrip("\n") + "\n  # - {kind: box}\n", Changes(added=(HALF,)))
    assert "  # - {kind: box}\nexpect:\n" in new


def test_hostile_words_stay_inside_their_comment():
    new = edited(scene_text(), Changes(added=(Pin("vtk", "half-vector", None, "a\nexpect: []\n" + "x" * 500),)))
    assert expected(new) == [("vtk", "half-vector", None)]
    assert max(map(len, new.splitlines())) <= 130


def test_aliases_are_refused():
    text = scene_text() + "expect:\n  - &first {adapter: vtk, cause: half-vector}\n"
    with pytest.raises(CannotEdit, match="alias or an anchor"):
        edited(text, Changes(whens={0: "exponent > 1"}))
