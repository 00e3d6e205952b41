"""Limits: their options, and each of them met."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from equilux_scenes.limits import Limits
from equilux_scenes.loader import SpecErrors, load_scene_file

Edited = Callable[..., str]
Only = Callable[..., str]


def test_options_raise_limits_by_name() -> None:
    assert Limits.from_options(["cases=10", "pixels=7"]) == Limits(cases=10, pixels=7)


WRONG = {
    "case=10": "--limit case=10: unknown limit 'case', allowed file_bytes, nesting,",
    "cases": "--limit cases: got '', allowed an integer from 1 to",
    "cases=0": "--limit cases=0: got '0', allowed an integer from 1 to",
    "cases=-1": "--limit cases=-1: got '-1', allowed",
    "cases=1e3": "--limit cases=1e3: got '1e3', allowed",
    "cases=²": "--limit cases=²: got '²', allowed",
    "nesting=201": "--limit nesting=201: got '201', allowed an integer from 1 to 200 (as in nesting=100)",
    "cases=" + 5000 * "9": "--limit cases=999",
}


@pytest.mark.parametrize("option", WRONG)
def test_a_wrong_option_says_what_is_allowed(option: str) -> None:
    with pytest.raises(ValueError) as caught:
        Limits.from_options([option])
    assert str(caught.value).startswith(WRONG[option]), str(caught.value)


MET = {
    "pixels": ("film: {", "film: «{", 3071, "pixels of film, got 3072, allowed at most 3071"),
    "objects": (
        "objects:\n  - {kind: sphere",
        "objects:\n  «- {kind: sphere",
        6,
        "objects of the scene, got 7, allowed at most 6",
    ),
    "lights": ("  key:\n", "  «key:\n", 2, "lights of the scene, got 3, allowed at most 2"),
    "cases": ("sweep:", "«sweep:", 3, "cases of the sweep, got 4, allowed at most 3"),
}


@pytest.mark.parametrize("name", MET)
def test_a_limit_of_the_scene_names_itself(only_error: Only, edited: Edited, name: str) -> None:
    old, new, limit, words = MET[name]
    message = only_error(edited(old, new), **{name: limit})
    assert message == f"{words} (limit '{name}': raise it with --limit {name}={limit + 1})"


def test_exactly_the_limit_is_allowed(load: Callable[..., Any], valid: str) -> None:
    load(valid, pixels=3072, objects=7, lights=3, materials=1, cases=4, file_bytes=len(valid))


def test_the_file_size_is_bounded_before_it_is_read(tmp_path: Path, valid: str) -> None:
    path = tmp_path / "big.scene.yaml"
    with path.open("wb") as file:
        file.truncate(1 << 40)  # a sparse file: no terabyte on the disk
    with pytest.raises(SpecErrors) as caught:
        load_scene_file(path)
    assert str(caught.value) == (
        f"{path}:1:1: bytes of the file, got 1099511627776, allowed at most 4194304 "
        "(limit 'file_bytes': raise it with --limit file_bytes=1099511627776)"
    )


def test_errors_beyond_their_limit_are_counted(errors_of: Callable[..., Any], valid: str) -> None:
    text = valid.replace("materials:\n", "materials:\n" + "".join(f"  m{i}: {{exponent: -1}}\n" for i in range(20)))
    errors = errors_of(text, errors=5)
    assert len(errors) == 6
    assert errors[-1].message == "15 more errors (limit 'errors': raise it with --limit errors=20)"
