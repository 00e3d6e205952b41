"""A pair in words, from its records alone."""

from __future__ import annotations

from pathlib import Path

import pytest

from equilux.diagnose.diagnosis import Alternative, Found, Region
from equilux.explain import explain_pair, one_line
from equilux.explain.numbers import share
from equilux.readrun import read_run
from equilux.results import CaseRecord, ExpectationRecord, PairRecord, Standing
from support.trees import CLAMPED, Case, Render, brighter, truth, write_tree

LEFT = Found(
    id="unexplained", explained=0.25, residual_max_abs=0.2, side="vtk", terms={"specular": 0.91, "diffuse": 0.03},
    region=Region(pixels=1, x0=5, y0=4, x1=5, y1=4, words="on objects[0]"),
)  # fmt: skip


def pair_of(tmp_path: Path, case: Case, a: str = "vtk", b: str = "oracle") -> tuple[CaseRecord, PairRecord]:
    (record,) = read_run(write_tree(tmp_path / "run", [case], files=False)).results.cases
    return record, next(pair for pair in record.pairs if (pair.a, pair.b) == (a, b))


def told(tmp_path: Path, case: Case, a: str = "vtk", b: str = "oracle") -> str:
    return "\n".join(explain_pair(*pair_of(tmp_path, case, a, b)))


def test_a_cause_is_told_with_both_formulas_its_share_and_its_region(tmp_path: Path):
    text = told(tmp_path, Case(renders={"vtk": Render(brighter(), [CLAMPED])}))
    assert "1. vtk: exponent-clamped [128]: the highlight's exponent is cut off at 128" in text
    assert "model  K_spec (R·V)^p\n     vtk    K_spec (R·V)^min(p, max)" in text
    assert "explains 100 % of the diverging pixels" in text
    assert "4 pixels within (2, 2) to (3, 3), on objects[0] (sphere, clay)" in text


def test_the_parameters_recognised_name_is_said(tmp_path: Path):
    scaled = Found(id="scaled", parameter=3.141592653589793, recognised="π", side="vtk")
    assert "scaled [3.14159, which is π]" in told(tmp_path, Case(renders={"vtk": Render(brighter(), [scaled])}))


def test_both_numbers_at_the_worst_pixel_and_how_often_the_bound_fits_in_between(tmp_path: Path):
    text = told(tmp_path, Case(renders={"vtk": Render(brighter())}))
    assert "worst pixel: (2, 2)\n  vtk     0.6898601 0.6961538 0.7024476 W/(m²·sr)\n  oracle  0.4398601" in text
    assert "|E_n| = 2.3" in text


def test_an_expected_cause_is_told_apart_from_one_that_is_not(tmp_path: Path):
    pinned = ExpectationRecord(adapter="vtk", cause="exponent-clamped", when="exponent > 128", held=True)
    vtk = {"vtk": Render(brighter(), [CLAMPED])}
    known = told(tmp_path / "a", Case(renders=vtk, expect=[pinned], judged={"vtk": "diverge_expected"}))
    assert "the scene expects it (exponent-clamped when exponent > 128)" in known
    assert "next:" not in known
    new = told(tmp_path / "b", Case(renders=vtk))
    assert "the scene does not expect it" in new
    assert "- exponent-clamped: mend vtk so that it does K_spec (R·V)^p, or" in new
    assert "expect: - {adapter: vtk, cause: exponent-clamped}" in new


def test_an_expectation_of_a_cause_that_cannot_be_told_apart_is_enough(tmp_path: Path):
    either = CLAMPED.model_copy(update={"alternatives": (Alternative(id="exponent-scaled", parameter=0.128),)})
    pinned = ExpectationRecord(adapter="vtk", cause="exponent-scaled", held=True)
    text = told(tmp_path, Case(renders={"vtk": Render(brighter(), [either])}, expect=[pinned]))
    assert "this scene cannot tell it from exponent-scaled [0.128]" in text
    assert "the scene expects it (exponent-scaled)" in text


def test_what_is_unexplained_is_never_hidden(tmp_path: Path):
    text = told(tmp_path, Case(renders={"vtk": Render(brighter(), [CLAMPED, LEFT])}))
    assert "unexplained: 25.0 % of the diverging pixels of vtk" in text
    assert "correlates with: specular +0.91 (a hint, no proof)" in text
    assert "diffuse" not in text
    assert "--pixel 5,4" in text
    assert "--update-expectations" not in text


def test_a_suspected_translation_sends_the_reader_to_the_program(tmp_path: Path):
    flipped = Found(id="flipped-x", side="vtk", suspects="translation")
    assert "look at what vtk was given" in told(tmp_path, Case(renders={"vtk": Render(brighter(), [flipped])}))


def test_the_finding_is_told_three_ways(tmp_path: Path):
    standing = Standing(truth="diverge", dialect="agree", peers={"povray": "diverge"}, finding="model-difference")
    text = told(tmp_path, Case(renders={"vtk": Render(brighter(), [CLAMPED], standing)}))
    for words in ("the truth (oracle): diverges", "its declared dialect: agrees", "diverges from povray", "a model difference"):
        assert words in text


def test_a_pair_of_peers_is_told_by_what_each_does_against_the_truth(tmp_path: Path):
    renders = {"vtk": Render(brighter(), [CLAMPED]), "povray": Render(truth())}
    assert "1. vtk: exponent-clamped [128]" in told(tmp_path, Case(renders=renders), "vtk", "povray")


def test_a_vanished_divergence_says_what_to_remove(tmp_path: Path):
    pinned = ExpectationRecord(adapter="vtk", cause="exponent-clamped", held=False)
    text = told(tmp_path, Case(renders={"vtk": Render(truth())}, expect=[pinned], judged={"vtk": "improved"}))
    assert "they agree, exponent-clamped is not found" in text
    assert "remove the expectation of exponent-clamped from lights/clay-ball.scene.yaml" in text


def test_agreement_needs_no_next_step(tmp_path: Path):
    text = told(tmp_path, Case(renders={"vtk": Render(truth())}))
    assert "agree within their uncertainties" in text
    assert "why:" not in text
    assert "next:" not in text


def test_one_line_holds_verdict_size_place_and_cause(tmp_path: Path):
    line = one_line(*pair_of(tmp_path, Case(renders={"vtk": Render(brighter(), [CLAMPED])})))
    assert line == (
        "vtk against oracle: diverge, and the scene does not expect it: 4 of 48 pixels, worst 0.25 W/(m²·sr) at (2, 2): "
        "exponent-clamped [128] (100 %)"
    )


@pytest.mark.parametrize(
    ("part", "words"),
    [(0.0, "0 %"), (1.0, "100 %"), (0.9999, "99.99 %"), (0.9999999, "> 99.999 %"), (1e-9, "< 0.001 %"), (0.998, "99.8 %")],
)
def test_a_share_is_never_rounded_to_all_or_nothing(part: float, words: str):
    assert share(part) == words
