"""YAML 1.2 as the spec reads it: what a scalar is, what is refused, and what bounds hold while reading."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any

import pytest

from equilux_scenes.errors import SpecErrors
from equilux_scenes.limits import Limits
from equilux_scenes.loader import load_scene_text
from equilux_scenes.yaml_scalars import resolve
from equilux_scenes.yaml_tree import parse, plain

Edited = Callable[..., str]
Only = Callable[..., str]


def _plain(text: str, **limits: int) -> Any:
    tree = parse(text, "t.yaml", Limits(**limits))
    assert tree.errors == ()
    return plain(tree.root)


def _stopped(text: str, **limits: int) -> str:
    with pytest.raises(SpecErrors) as caught:
        parse(text, "t.yaml", Limits(**limits))
    assert len(caught.value.errors) == 1
    return str(caught.value.errors[0])


NUMBERS = {
    "7.5": 7.5, "1e2": 100.0, ".5": 0.5, "5.": 5.0, "-.5": -0.5, "+3": 3, "1E-3": 0.001, "007": 7, "0x1F": 31, "0o17": 15,
    "-0": 0,
    "1e400": math.inf, "-.inf": -math.inf, ".INF": math.inf, "123456789012345678901234567890": 1.2345678901234568e29,
}  # fmt: skip
TEXTS = [
    "no",
    "yes",
    "on",
    "off",
    "y",
    "1_000",
    "1:30",
    "0b1",
    "1e",
    "e2",
    ".",
    "--1",
    "1.2.3",
    "0x",
    "2001-01-01",
    "nan",
    "inf",
    "1,5",
    "١",
]


@pytest.mark.parametrize("text", NUMBERS)
def test_a_number_of_yaml_1_2_is_a_number(text: str) -> None:
    assert resolve(text) == NUMBERS[text]
    assert _plain(f"a: {text}") == {"a": NUMBERS[text]}


@pytest.mark.parametrize("text", TEXTS)
def test_what_only_yaml_1_1_or_python_takes_for_more_is_text(text: str) -> None:
    assert resolve(text) == text


def test_nan_true_and_null_are_read_as_such() -> None:
    assert math.isnan(float(resolve(".nan") or 0))
    assert _plain("[true, FALSE, null, ~, Null]") == (True, False, None, None, None)


def test_quotes_make_text_of_anything() -> None:
    assert _plain("['1', \"2\", 'true', '']") == ("1", "2", "true", "")


def test_windows_line_ends_a_byte_order_mark_and_comments_do_not_matter(load: Callable[..., Any], valid: str) -> None:
    unix, windows = load(valid), load("\ufeff" + valid.replace("\n", "\r\n"))
    assert unix.scene == windows.scene
    assert [case.canonical() for case in unix.cases] == [case.canonical() for case in windows.cases]


def test_columns_count_characters_after_a_byte_order_mark_and_windows_line_ends(only_error: Only, valid: str) -> None:
    text = "\ufeff" + valid.replace("about: Every kind", "about: «[Größe →]").replace(" of part once.", "")
    assert only_error(text.removeprefix("\ufeff")) == "about of the scene: got ['Größe →'], allowed text"
    windows = text.replace("\n", "\r\n").replace("«", "")
    with pytest.raises(SpecErrors) as caught:
        load_scene_text(windows)
    assert [(error.line, error.column) for error in caught.value.errors] == [(3, 8)]


BROKEN = {
    "empty": ("", "t.yaml:1:1: empty file, allowed a scene spec (it begins with 'equilux: 1')"),
    "only comments": ("# nothing\n\n", "t.yaml:1:1: empty file, allowed a scene spec (it begins with 'equilux: 1')"),
    "two documents": ("a: 1\n---\nb: 2\n", "t.yaml:2:1: second YAML document, allowed one scene per file"),
    "unclosed list": ("a: [1, 2\nb: 3\n", "t.yaml:2:2: not YAML: "),
    "tab as indentation": ("a:\n\t- 1\n", "t.yaml:2:1: not YAML: "),
    "undefined alias": ("a: 1\nb: *x\n", "t.yaml:2:4: alias '*x' to an anchor that is not defined before it"),
    "alias inside itself": ("a: &x\n  b: [*x]\n", "t.yaml:2:7: alias '*x' inside the value that it names, allowed no recursion"),
    "NUL": ("a: 1\nb: \0\n", "t.yaml:2:4: character U+0000, allowed printable text (is this a YAML file?)"),
    "escape character": ("a: \x1b[0m\n", "t.yaml:1:4: character U+001B, allowed printable text (is this a YAML file?)"),
    "lone surrogate": ("a: \ud800\n", "t.yaml:1:4: character U+D800, allowed printable text (is this a YAML file?)"),
    "impossible escape": ('a: "\\UFFFFFFFF"\n', "t.yaml:1:"),
    "unknown directive version": ("%YAML 9.9.9\n---\na: 1\n", "t.yaml:1:"),
    "endless tag": ("a: " + "!" * 1_000_000, "t.yaml:1:4: YAML tag '!!!!"),
    "unknown tag handle": ("a: !e!x 1\n", "t.yaml:1:4: not YAML: "),
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_text_is_answered_with_its_place(name: str) -> None:
    text, expected = BROKEN[name]
    assert _stopped(text).startswith(expected), _stopped(text)


def test_a_yaml_1_1_document_is_refused() -> None:
    tree = parse("%YAML 1.1\n---\na: no\n", "t.yaml", Limits())
    assert [str(error) for error in tree.errors] == ["t.yaml:2:1: YAML version, got 1.1, allowed 1.2"]


SOFT = {
    "tag": ("a: !x 1", "t.yaml:1:4: YAML tag '!x', allowed no tags (values are typed by the spec)"),
    "non-specific tag": ("a: ! 1", "t.yaml:1:4: YAML tag '!', allowed no tags (values are typed by the spec)"),
    "duplicate key": ("a: 1\nb: 2\na: 3", "t.yaml:3:1: duplicate key 'a', first given at 1:1"),
    "merge key": (
        "a: &x {b: 1}\nc:\n  <<: *x",
        "t.yaml:3:3: merge key '<<', allowed plain keys only (YAML 1.2 has no merge keys; repeat the values)",
    ),
    "number as key": ("1: 2", "t.yaml:1:1: key, got 1, allowed text (write it in quotes)"),
    "true as key": ("true: 2", "t.yaml:1:1: key, got true, allowed text (write it in quotes)"),
    "null as key": ("~: 2", "t.yaml:1:1: key, got ~, allowed text (write it in quotes)"),
    "list as key": ("? [a]\n: 2", "t.yaml:1:3: key, got a collection, allowed text"),
}


@pytest.mark.parametrize("name", SOFT)
def test_what_is_refused_does_not_keep_the_rest_from_being_read(name: str) -> None:
    text, expected = SOFT[name]
    tree = parse(text, "t.yaml", Limits())
    assert [str(error) for error in tree.errors] == [expected]


def test_an_alias_repeats_a_value_and_errors_stand_where_it_is_used(
    only_error: Only, edited: Edited, load: Callable[..., Any]
) -> None:
    file = load(edited("position: [0, 2, 3]", "position: &here [0, 2, 3]", "position: [0, 2, 0]", "position: *here"))
    assert file.scene.lights["lamp"].position == file.scene.lights["key"].position
    text = edited("about: Every kind of part once.", "about: &words Every kind", "irradiance: 1", "irradiance: «*words")
    assert only_error(text) == "irradiance of light 'sun': got 'Every kind', allowed one number ≥ 0 or three"


def test_a_billion_laughs_are_stopped_by_the_limit_of_nodes() -> None:
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"] + [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]" for i in range(1, 12)]
    started = time.perf_counter()
    message = _stopped("\n".join(lines))
    assert "limit 'nodes': raise it with --limit nodes=" in message, message
    assert time.perf_counter() - started < 5


LIMITS = {
    "nesting": (
        "a: " + "[" * 100 + "]" * 100,
        32,
        "t.yaml:1:35: lists and mappings nested in each other, got 33, allowed at most 32",
    ),
    "aliases": ("a: &x 1\nb: [*x, *x, *x]", 2, "t.yaml:2:13: aliases in the file, got 3, allowed at most 2"),
    "nodes": ("[a, b, c, d]", 4, "t.yaml:1:11: values in the file, aliases expanded, got 5, allowed at most 4"),
}


@pytest.mark.parametrize("name", LIMITS)
def test_a_limit_names_itself_and_how_to_raise_it(name: str) -> None:
    text, limit, expected = LIMITS[name]
    got = limit + 1
    assert _stopped(text, **{name: limit}) == f"{expected} (limit '{name}': raise it with --limit {name}={got})"
    parse(text, "t.yaml", Limits(**{name: 200}))


@pytest.mark.parametrize("opening", ["[", "{a: ", "- ", "? ", "{? "])
def test_a_hundred_thousand_levels_are_refused_at_once(opening: str) -> None:
    started = time.perf_counter()
    assert "limit 'nesting'" in _stopped(opening * 100_000)
    assert time.perf_counter() - started < 5
