"""Causes, findings and expectations as the report arranges them, and dialects from a results tree alone."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import pytest

from equilux_report import build, numerals
from equilux_report.causes import Cause, causes_of
from equilux_report.dialects import dialects
from equilux_report.links import Links
from equilux_report.overview import Overview, overview
from equilux_report.standing import expectations_of, standing_of
from equilux_report.tree import CaseRecord, Pair, Run, read_run
from equilux_report.why import why_of


@pytest.fixture(scope="module")
def run(diagnosed: Path) -> Run:
    return read_run(diagnosed)


@pytest.fixture(scope="module")
def view(run: Run) -> Overview:
    return overview(run, Links(single_file=False), lambda *_: None)


def case(run: Run, name: str) -> CaseRecord:
    return next(case for case in run.cases if case.name == name)


def causes(run: Run, name: str, adapter: str) -> tuple[Cause, ...]:
    pair = case(run, name).against_truth(adapter)
    assert pair is not None
    return causes_of(case(run, name), pair)


def test_a_cause_is_told_with_its_parameter_and_the_name_of_it(run: Run) -> None:
    (scaled,) = causes(run, "bright", "povray")
    assert (scaled.name, scaled.recognised) == ("scaled [3.14159]", "π")
    assert scaled.alternatives == ("intensity-scaled [3.14159]", "diffuse-scaled [3.14]")
    (clamped,) = causes(run, "clamped[exponent=300]", "vtk")
    assert (clamped.name, clamped.recognised) == ("exponent-clamped [128]", ""), "128 is no name of 128"


def test_a_sentence_does_not_repeat_the_formula(run: Run) -> None:
    swapped, _ = causes(run, "swapped", "vtk")
    assert swapped.sentence == "Bands are in another order."


def test_an_expectation_of_an_alternative_covers_the_cause(run: Run) -> None:
    bright = case(run, "bright")
    pinned = CaseRecord(bright.name, {"expect": [{"adapter": "povray", "cause": "diffuse-scaled", "when": "p > 1"}]}, {}, ())
    pair = bright.against_truth("povray")
    assert pair is not None
    assert [cause.expected for cause in causes_of(pinned, pair)] == ["diffuse-scaled when p > 1"]
    assert [cause.expected for cause in causes_of(bright, pair)] == [""]


def test_a_remainder_keeps_the_terms_that_say_something_strongest_first(run: Run) -> None:
    left = causes(run, "swapped", "vtk")[-1]
    assert left.is_unexplained
    assert left.terms == (("diffuse key", 0.83), ("specular key", -0.41))


@pytest.mark.parametrize(
    "facts",
    [
        {"id": "scaled", "formula": ["one"], "region": {"x0": 1}, "terms": [], "alternatives": [7], "explained": "all"},
        {"id": "scaled", "parameter": {"a": 1}, "formula": None, "region": [], "terms": {"a": None}, "alternatives": None},
    ],
)
def test_damaged_causes_are_read_as_far_as_they_go(facts: dict[str, Any]) -> None:
    pair = Pair("ball", "vtk", "oracle", None, {"verdict": "diverge", "causes": [facts, {}, 3, {"id": 5}]})
    (cause,) = causes_of(CaseRecord("ball", {}, {}, ()), pair)
    assert (cause.name, cause.formula, cause.region, cause.terms, cause.side) == ("scaled", None, None, (), "vtk")


def test_a_pair_of_peers_says_which_side_departs(run: Run) -> None:
    why = why_of(case(run, "bright"), case(run, "bright").pair("vtk", "povray"))
    assert why is not None
    assert {side.adapter: ([cause.id for cause in side.causes], side.agrees) for side in why.sides} == {
        "vtk": ([], True),
        "povray": (["scaled"], False),
    }


def test_the_overview_groups_by_cause_and_renderer_unexpected_ones_first(view: Overview) -> None:
    told = [(group.expected, group.cause, group.parameter, group.adapter, len(group.cells)) for group in view.causes]
    assert sorted(told[:2]) == [(False, "unexplained", "", "povray", 1), (False, "unexplained", "", "vtk", 1)]
    assert sorted(told[2:4]) == [(False, "bands-permuted", "BGR", "vtk", 1), (False, "scaled", "3.14159 = π", "povray", 1)]
    assert sorted(told[4:]) == [(True, "exponent-clamped", "128", "vtk", 2), (True, "half-vector", "", "vtk", 1)]


def test_findings_are_counted_by_renderer_and_shares_by_pixel(view: Overview, run: Run) -> None:
    stands = {stand.adapter: stand for stand in view.stands}
    assert stands["povray"].findings == {"as-modelled": 5, "implementation-bug": 1, "unexplained": 1}
    assert stands["vtk"].findings == {"as-modelled": 3, "model-difference": 3, "translation-bug": 1}
    pairs = {name: case(run, name).against_truth("povray") for name in ("bright", "riddle")}
    pixels = {name: pair.facts["diverge"] for name, pair in pairs.items() if pair is not None}
    proven = pixels["bright"] / sum(pixels.values())
    assert stands["povray"].share == pytest.approx(proven), f"share {stands['povray'].share}, by hand {proven}"


def test_expectations_say_which_no_longer_hold(view: Overview, run: Run) -> None:
    gone = [(item.case, item.cause) for item in view.expectations if item.state == "gone"]
    assert gone == [("gone", "spot-cone-ignored"), ("half-gone", "spot-cone-ignored")]
    assert [item.state for item in expectations_of(case(run, "half-gone"))] == ["held", "gone"]
    assert "2 expectations no longer hold" in view.headline[1]


def test_results_that_do_not_say_what_held_are_judged_by_their_pairs(tree: Path) -> None:
    states = {item.case: item.state for case in read_run(tree).cases for item in expectations_of(case)}
    assert states == {"clay-ball[exponent=1000]": "held", "spot-cone": "gone"}


def test_results_without_a_diagnosis_name_the_pins_and_prove_nothing(tree: Path) -> None:
    view = overview(read_run(tree), Links(single_file=False), lambda *_: None)
    assert not view.findings
    told = {(group.expected, group.cause, group.adapter) for group in view.causes}
    assert (True, "exponent-clamped", "vtk") in told
    assert (False, "not diagnosed", "povray") in told
    assert not any(group.is_proven for group in view.causes)
    assert all(stand.share is None for stand in view.stands)


def test_many_values_of_a_parameter_become_a_range(view: Overview) -> None:
    group = next(group for group in view.causes if group.cause == "scaled")
    group.parameters.update(["10", "0.5", "2"])
    try:
        assert group.parameter == "0.5 to 10"
    finally:
        for value in ("10", "0.5", "2"):
            del group.parameters[value]


def test_standings_are_read_as_told(run: Run) -> None:
    standing = standing_of(case(run, "swapped").renders["vtk"])
    assert standing is not None
    assert (standing.truth, standing.dialect, standing.diverges_from, standing.label) == (
        "diverge", "diverge", ("povray",), "translation bug",
    )  # fmt: skip
    assert standing_of(case(run, "swapped").renders["oracle"]) is None


def test_a_dialect_has_its_evidence_and_what_was_not_seen(run: Run) -> None:
    found = {dialect.adapter: dialect for dialect in dialects(run, Links(single_file=False), lambda *_: None)}
    vtk = found["vtk"]
    assert (vtk.title, vtk.cases) == ("VTK", 7)
    assert {rule.cause: [seen.case for seen in rule.seen] for rule in vtk.rules} == {
        "exponent-clamped": ["clamped[exponent=300]", "clamped[exponent=600]"],
        "half-vector": ["half-gone"],
        "occlusion-ignored": [],
    }
    assert [(seen.case, seen.cause.id, seen.alone) for seen in vtk.beyond] == [("swapped", "bands-permuted", False)]
    assert [seen.case for seen in vtk.unexplained] == ["swapped"]
    assert vtk.rules[2].where == "not in scenes with shape.mesh; fact Q11 of the adapter's QUIRKS.md"
    assert [seen.cause.id for seen in found["povray"].beyond] == ["scaled"]


def test_a_manifest_without_dialects_still_shows_what_was_declared(diagnosed: Path, tmp_path: Path) -> None:
    copy = Path(shutil.copytree(diagnosed, tmp_path / "run"))
    (copy / "run.json").write_text("{}")
    vtk = next(item for item in dialects(read_run(copy), Links(single_file=False), lambda *_: None) if item.adapter == "vtk")
    assert [(rule.cause, rule.parameter) for rule in vtk.rules] == [("exponent-clamped", "128"), ("half-vector", "")]


def test_an_interrupted_run_takes_causes_from_the_diagnoses(diagnosed: Path, tmp_path: Path) -> None:
    copy = Path(shutil.copytree(diagnosed, tmp_path / "run"))
    (copy / "results.json").unlink()
    diagnosis = {"adapter": "povray", "diverging": 1, "explained": 0.5, "causes": [{"id": "scaled", "explained": 0.5}]}
    (copy / "cases" / "bright" / "povray" / "diagnosis.json").write_text(json.dumps(diagnosis))
    assert [cause.id for cause in causes(read_run(copy), "bright", "povray")] == ["scaled"]
    build(copy)


@pytest.mark.parametrize("single", [False, True])
def test_words_of_a_diagnosis_are_escaped_everywhere(diagnosed: Path, tmp_path: Path, single: bool) -> None:
    build(diagnosed, out=tmp_path / "report", single_file=single)
    pages = list((tmp_path / "report").rglob("*.html"))
    assert any("What VTK's Phong is" in page.read_text(encoding="utf-8") for page in pages)
    for page in pages:
        assert "<script>window.hacked" not in page.read_text(encoding="utf-8"), page.name


@pytest.mark.parametrize(
    ("part", "text"),
    [(0, "0 %"), (1.0, "100 %"), (0.5090605, "50.9 %"), (0.9999, "99.99 %"), (0.0004, "0.04 %"), (1e-7, "<0.001 %"),
     (1 - 1e-7, ">99.999 %"), (None, "–")],
)  # fmt: skip
def test_shares_are_0_and_100_only_where_they_are(part: float | None, text: str) -> None:
    assert numerals.share(part).replace("\u202f", " ") == text


@pytest.mark.parametrize(
    ("value", "text"), [(None, ""), (128.0, "128"), (3.14159265, "3.14159"), ([0.5, 2], "0.5, 2"), ("BGR", "BGR"), (True, "true")]
)
def test_parameters_are_written_as_they_are_read(value: object, text: str) -> None:
    assert numerals.parameter(value) == text


def test_every_link_of_a_diagnosed_report_leads_to_a_file(diagnosed: Path, tmp_path: Path) -> None:
    index = build(diagnosed, out=tmp_path / "report")
    for page in [index, index.parent / "dialects.html", *(index.parent / "cases").glob("*.html")]:
        for target in re.findall(r'(?:href|src)="([^"#]+)', page.read_text(encoding="utf-8")):
            assert (page.parent / unquote(target)).is_file(), f"{page.name} links to {target}"
