"""`run --accuracy`: the cheapest setting that claims what is asked of this very picture, and what is claimed holds."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from equilux.accuracy import Ladders, kept
from equilux.cli.summary import summary
from equilux.knobs import resolve
from equilux.plan import Selection, make_plan
from equilux.results import AccuracyRecord
from equilux.reuse import Store
from equilux.run import Finished, Options, execute
from equilux.tree import read_json
from support.engine import entry, only_case, planned, scene

QUALITIES = (1, 2, 3)
BASE = {"quality": 2, "colour": "plain"}


def run(out: Path, error: float, qualities: tuple[int, ...] = QUALITIES, store: Path | None = None, **more: Any) -> Finished:
    rungs = {"tunable": [BASE | {"quality": n} for n in qualities]}
    entries = (entry("tunable"), entry("oracle", "equilux_adapters.oracle:ADAPTER"))
    plan = make_plan(scene(specular=0.5).cases, Selection(entries), resolve([], entries))
    plan = replace(plan, ladders=Ladders(error, rungs))
    options = Options(out, jobs=2, diagnose=False, store=Store(store) if store else None, reuse=store is not None, **more)
    return execute(plan, options)


def said(finished: Finished) -> AccuracyRecord:
    found = only_case(finished).renders["tunable"].accuracy
    assert found is not None
    return found


@pytest.mark.parametrize(("error", "quality", "tried"), [(0.2, 1, 1), (0.05, 2, 2), (2e-3, 3, 3)])
def test_the_cheapest_setting_whose_claim_meets_what_is_asked_is_taken(tmp_path: Path, error: float, quality: int, tried: int):
    finished = run(tmp_path / "out", error)
    accuracy = said(finished)
    assert (accuracy.met, accuracy.knobs["quality"], accuracy.tried) == (True, quality, tried)
    # claimed: 10^-quality of the largest radiance, over what that may be at least
    true = 10.0**-quality
    assert accuracy.claimed == pytest.approx(true * (1 + true) / ((1 + true) * (1 - true)), rel=1e-9)


def test_what_was_taken_is_what_lies_in_the_tree(tmp_path: Path):
    run(tmp_path / "out", 0.05)
    record = read_json(tmp_path / "out/cases/tiny/tunable/render.json") or {}
    assert record["knobs"]["quality"] == 2
    assert record["accuracy"]["asked"] == 0.05
    assert (tmp_path / "out/cases/tiny/tunable/program/scene.txt").read_text() == "quality 2\n"
    assert (read_json(tmp_path / "out/run.json") or {})["options"]["accuracy"] == 0.05


def test_every_claim_that_is_made_holds_against_the_truth(tmp_path: Path):
    for error in (0.2, 0.05, 2e-3):
        (claim,) = kept(run(tmp_path / f"{error}", error).results.cases)
        assert claim.error is not None
        assert claim.error <= claim.asked
        assert claim.holds is True


def test_where_no_setting_is_enough_the_most_accurate_is_delivered_and_does_not_claim_it(tmp_path: Path):
    finished = run(tmp_path / "out", 1e-6)
    accuracy = said(finished)
    assert (accuracy.met, accuracy.knobs["quality"], accuracy.reason) == (
        False, 3, "its most accurate setting claims no better",
    )  # fmt: skip
    assert only_case(finished).renders["tunable"].status == "ok"
    assert "accuracy 1e-06: tunable claims it on 0 of 1 picture" in summary(finished.results)
    assert "not on tiny: it claims 0.001; its most accurate setting claims no better" in summary(finished.results)


def test_a_setting_that_fails_leaves_the_one_before_it_and_says_why(tmp_path: Path):
    finished = run(tmp_path / "out", 1e-6, (1, 2, 4))
    accuracy = said(finished)
    assert (accuracy.met, accuracy.knobs["quality"]) == (False, 2)
    assert accuracy.reason == "its next setting failed: no such quality on this machine"
    assert only_case(finished).renders["tunable"].status == "ok"


def test_a_first_setting_that_fails_is_a_failure(tmp_path: Path):
    assert only_case(run(tmp_path / "out", 1e-6, (4, 4))).renders["tunable"].status == "failed"


def test_settings_that_were_tried_before_are_not_rendered_again(tmp_path: Path):
    first = run(tmp_path / "one", 2e-3, store=tmp_path / "store")
    again = run(tmp_path / "two", 2e-3, store=tmp_path / "store")
    assert said(first) == said(again)
    assert only_case(again).renders["tunable"].reused
    less = run(tmp_path / "three", 0.05, store=tmp_path / "store")
    assert only_case(less).renders["tunable"].reused
    assert said(less).knobs["quality"] == 2


def test_a_continued_tree_keeps_its_claims(tmp_path: Path):
    first = run(tmp_path / "out", 0.05, store=tmp_path / "store")
    again = run(tmp_path / "out", 0.05, store=tmp_path / "store")
    assert said(first) == said(again)


def test_the_truth_keeps_its_own_knobs(tmp_path: Path):
    plan = planned(["tunable"], [scene()])
    rungs = {"oracle": [{"level": 0}, {"level": 1}], "tunable": [BASE]}
    finished = execute(replace(plan, ladders=Ladders(0.5, rungs)), Options(tmp_path / "out", jobs=2, diagnose=False, reuse=False))
    assert only_case(finished).renders["oracle"].accuracy is None
    record = read_json(tmp_path / "out/cases/tiny/oracle/render.json") or {}
    assert record["knobs"] == {"level": 1}
