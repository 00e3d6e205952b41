"""`equilux run --update-expectations`, as it is typed."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from equilux_scenes.loader import load_scene_file
from support.engine import write_scene

PATCH = Path("equilux-out/expectations.patch")
GONE = "expect:\n  # it used to be too bright\n  - {adapter: reference, cause: scaled}\n"
OPTION = "--update-expectations"


@pytest.fixture(autouse=True)
def at_a_desk(monkeypatch: pytest.MonkeyPatch):
    for name in ("CI", "GITHUB_ACTIONS"):
        monkeypatch.delenv(name, raising=False)


def test_what_is_gone_is_proposed_to_be_removed_and_nothing_is_written(tiny: Path, equilux):
    write_scene(tiny, rest=GONE)
    before = tiny.read_text()
    said = equilux("run", tiny, "--adapters", "reference", "--no-html", OPTION)
    assert said.code == 1
    assert "-  # it used to be too bright\n-  - {adapter: reference, cause: scaled}\n" in said.out
    assert "tiny.scene.yaml: remove reference: scaled: it is gone\n" in said.out
    assert PATCH.read_text() in said.out
    assert tiny.read_text() == before


def test_with_yes_it_is_written_and_the_next_run_passes(tiny: Path, equilux):
    write_scene(tiny, rest=GONE)
    said = equilux("run", tiny, "--adapters", "reference", "--no-html", OPTION, "--yes")
    assert "written: tiny.scene.yaml; run again to judge by it\n" in said.out
    assert "expect" not in tiny.read_text()
    again = equilux("run", tiny, "--adapters", "reference", "--no-html", OPTION, "--yes")
    assert again.code == 0
    assert "expectations: nothing to change\n" in again.out
    assert not PATCH.exists()


def test_a_proven_cause_is_pinned_and_the_next_run_passes(tiny: Path, equilux):
    pytest.importorskip("vtkmodules")
    sweep = "sweep:\n  exponent: {path: materials.clay.exponent, values: [0.1, 20]}\n"
    write_scene(tiny, specular=0.5, rest=sweep)
    first = equilux("run", tiny, "--adapters", "vtk", "--no-html", OPTION, "--yes")
    assert first.code == 1
    assert load_scene_file(tiny).scene.expect, first
    again = equilux("run", tiny, "--adapters", "vtk", "--no-html", OPTION)
    assert again.code == 0, again.out
    assert "expectations: nothing to change\n" in again.out


def test_json_stays_json(tiny: Path, equilux):
    write_scene(tiny, rest=GONE)
    said = equilux("run", tiny, "--adapters", "reference", "--no-html", OPTION, "--json")
    assert json.loads(said.out)["summary"]["exit_code"] == 1
    assert "+++ b/tiny.scene.yaml" in said.err


def test_what_is_unexplained_is_named_and_left_alone(tiny: Path, equilux):
    before = tiny.read_text()
    said = equilux("run", tiny, "--adapters", "nan", "--no-html", "--diagnosis-timeout", "0.1", OPTION, "--yes")
    assert "cannot be pinned: tiny: nan against oracle: 1 pixel without a radiance" in said.err
    assert "expectations: nothing that can be pinned\n" in said.out
    assert tiny.read_text() == before
    assert not PATCH.exists()


@pytest.mark.parametrize(("name", "value"), [("CI", "true"), ("CI", "1"), ("GITHUB_ACTIONS", "true")])
def test_in_ci_it_is_refused_before_anything_is_rendered(
    tiny: Path, equilux, monkeypatch: pytest.MonkeyPatch, name: str, value: str
):
    monkeypatch.setenv(name, value)
    said = equilux("run", tiny, OPTION, "--yes")
    assert (said.code, said.out) == (2, "")
    assert (
        said.err == f"{OPTION}: got {name}={value} in the environment, allowed only outside CI: run it where someone reads it\n"
    )
    assert not Path("equilux-out").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--yes",), "--yes: got without --update-expectations"),
        ((OPTION, "--plan"), "got with --plan"),
        ((OPTION, "--no-diagnose"), "got with --no-diagnose"),
    ],
)
def test_options_that_contradict_each_other_are_bad_usage(tiny: Path, equilux, arguments: tuple[str, ...], words: str):
    said = equilux("run", tiny, *arguments)
    assert (said.code, said.out, said.err.count("\n")) == (2, "", 1)
    assert words in said.err
