"""`equilux explain`, as it is typed."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from support.trees import CLAMPED, Case, Render, brighter, rewrite, truth, write_tree


@pytest.fixture
def run(tmp_path: Path) -> Path:
    renders = {
        "vtk": Render(brighter(), [CLAMPED], sigma=1e-4),
        "povray": Render(truth()),
        "mitsuba": Render(None, status="crashed", reason="ended by signal 11"),
        "opengl": Render(truth()[:-1]),
    }
    cases = [Case(f"clay-ball[exponent={p}]", renders, {"exponent": p}) for p in (10, 1000)]
    return write_tree(tmp_path / "run", [*cases, Case("lamp", {"vtk": Render()})])


CASE = "clay-ball[exponent=1000]"


def test_it_tells_the_cause_and_the_budget_of_the_worst_pixel_term_by_term(run: Path, equilux):
    said = equilux("explain", run, CASE, "vtk", "oracle")
    assert (said.code, said.err) == (0, "")
    assert "vtk: exponent-clamped [128]" in said.out
    assert "difference 0.25, uncertainty of both B = 0.00067, E_n = 373" in said.out
    assert "vtk: noise (sampled): 6.69 standard deviations" in said.out
    assert "vtk: quantisation (bound): half a step of the output channel" in said.out


def test_either_order_of_the_adapters_will_do(run: Path, equilux):
    assert equilux("explain", run, CASE, "vtk", "oracle").out == equilux("explain", run, CASE, "oracle", "vtk").out


def test_wildcards_choose_one_case(run: Path, equilux):
    assert equilux("explain", run, "*=1000]", "vtk", "oracle").out.startswith(CASE)
    said = equilux("explain", run, "clay-ball*", "vtk", "oracle")
    assert (said.code, said.out) == (2, "")
    assert "matches 2 cases, allowed one" in said.err


def test_one_pixel_is_explained_with_its_class(run: Path, equilux):
    said = equilux("explain", run, CASE, "vtk", "oracle", "--pixel", "3,2")
    assert "(3, 2), diverge" in said.out
    assert "why:" not in said.out
    agrees = equilux("explain", run, CASE, "povray", "oracle", "--pixel", "0,0").out
    assert "(0, 0), agree" in agrees
    assert "E_n = 0" in agrees


@pytest.mark.parametrize("pixel", ["8,0", "0,6", "-1,0", "1", "a,b", "1.5,2"])
def test_a_pixel_that_is_none_is_bad_usage(run: Path, equilux, pixel: str):
    said = equilux("explain", run, CASE, "vtk", "oracle", f"--pixel={pixel}")
    assert (said.code, said.out, said.err.count("\n")) == (2, "", 1)
    assert pixel in said.err


def test_renders_that_brought_no_picture_are_told_too(run: Path, equilux):
    said = equilux("explain", run, CASE, "mitsuba", "vtk")
    assert said.code == 0
    assert "mitsuba brought no picture: crashed: ended by signal 11" in said.out
    assert equilux("explain", run, CASE, "mitsuba", "vtk", "--pixel", "0,0").code == 2


def test_pictures_of_different_size_are_told(run: Path, equilux):
    assert "the images differ in size" in equilux("explain", run, CASE, "opengl", "oracle").out


def test_json_holds_the_numbers_and_the_text(run: Path, equilux):
    told = json.loads(equilux("explain", run, CASE, "vtk", "oracle", "--json", "--pixel", "3,2").out)
    assert (told["schema"], told["verdict"], told["judged"]) == ("equilux/explain/1", "diverge", "diverge_unexpected")
    assert told["causes"][0]["id"] == "exponent-clamped"
    assert told["causes"][0]["expected_by"] is None
    assert [part["term"] for part in told["worst_pixel"]["parts"]] == ["noise", "quantisation", "quantisation"]
    assert (told["pixel"]["x"], told["pixel"]["class"]) == (3, "diverge")
    assert json.loads(equilux("explain", run, CASE, "mitsuba", "vtk", "--json").out)["verdict"] is None


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("nowhere", CASE, "vtk", "oracle"), "'nowhere': no such folder"),
        (("run/cases", CASE, "vtk", "oracle"), "did you mean 'run'?"),
        (("run", "clay-bal[exponent=1000]", "vtk", "oracle"), "did you mean 'clay-ball[exponent=1000]'?"),
        (("run", "clay-ball", "vtk", "oracle"), "is a scene of 2 cases"),
        (("run", CASE, "vkt", "oracle"), "A: got 'vkt', allowed an adapter of"),
        (("run", CASE, "vtk", "vtk"), "got 'vtk' twice"),
        (("run", CASE, "vtk"), "requires an argument"),
    ],
)
def test_wrong_arguments_are_told_on_one_line(run: Path, equilux, arguments: tuple[str, ...], words: str):
    said = equilux("explain", *arguments)
    assert (said.code, said.out, said.err.count("\n")) == (2, "", 1)
    assert words in said.err


def test_results_alone_suffice(tmp_path: Path, equilux):
    run = write_tree(tmp_path / "alone", [Case(renders={"vtk": Render(brighter(), [CLAMPED])})], files=False)
    said = equilux("explain", run, "clay-ball", "vtk", "oracle")
    assert said.code == 0
    assert "|E_n| = " in said.out


def test_damaged_pictures_are_left_out_and_an_unfinished_run_is_refused(run: Path, equilux):
    (run / "cases" / CASE / "vtk" / "image.npy").write_bytes(b"no picture")
    assert "|E_n| = " in equilux("explain", run, CASE, "vtk", "oracle").out
    assert equilux("explain", run, CASE, "vtk", "oracle", "--pixel", "0,0").code == 2
    (run / "results.json").unlink()
    assert "interrupted" in equilux("explain", run, CASE, "vtk", "oracle").err


def test_keys_of_a_later_version_are_left_out_and_said(run: Path, equilux):
    rewrite(run, lambda content: content["cases"][0].update(colour="blue"))
    said = equilux("explain", run, CASE, "vtk", "oracle")
    assert said.code == 0
    assert "left out: cases.*.colour" in said.err
