"""Each render that diverges from the truth is diagnosed once, beside rendering; what agrees costs nothing; a fault is noted."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np
import pytest

from equilux import diagnosing
from equilux.adapter import Bound, Budget, Geometric
from equilux.compare import RenderedImage
from equilux.diagnose.diagnosis import Diagnosis, Found
from equilux.tree import read_json
from equilux.uncertainty import Uncertainty
from support.engine import only_case, pair_of, run, scene

SCALED = "expect:\n  - {adapter: bright, cause: scaled}"


class Search:
    """Stands for the search for causes: tells what it was asked, and finds what it is told to."""

    def __init__(self, *causes: str, seconds: float = 0.01) -> None:
        self.asked: list[dict[str, Any]] = []
        self.causes = causes
        self.seconds = seconds
        self.fault: Exception | None = None

    def __call__(self, case: Any, side: RenderedImage, truth: RenderedImage, scored: Any, **rest: Any) -> Diagnosis:
        self.asked.append({"case": case, "side": side, "truth": truth, "scored": scored, **rest})
        if self.fault is not None:
            raise self.fault
        found = tuple(Found(id=cause, explained=1.0) for cause in self.causes)
        diverging = int((scored.planes["class"] == 1).sum())
        return Diagnosis(adapter=side.adapter, diverging=diverging, explained=1.0, causes=found, seconds=self.seconds)


@pytest.fixture
def search(monkeypatch: pytest.MonkeyPatch) -> Search:
    stand_in = Search("scaled")
    monkeypatch.setattr("equilux.diagnose.search.diagnose", stand_in)
    return stand_in


def test_what_diverges_is_diagnosed_and_what_agrees_is_not(tmp_path: Path, search: Search):
    finished = run(tmp_path / "run", "bright", "good", "reference", scenes=[scene(rest=SCALED)], diagnose=True)
    assert (finished.exit_code, finished.errors) == (0, ())
    (asked,) = search.asked
    assert (asked["side"].adapter, asked["truth"].adapter, asked["expected"]) == ("bright", "oracle", ("scaled",))
    assert asked["scored"].planes["class"].dtype == np.uint8
    case = only_case(finished)
    assert case.expect[0].held is True
    assert case.renders["bright"].standing is not None
    assert case.renders["bright"].standing.finding == "implementation-bug"
    assert case.renders["bright"].standing.peers == {"good": "diverge"}
    assert case.renders["good"].standing is not None
    assert case.renders["good"].standing.finding == "as-modelled"
    assert case.renders["oracle"].standing is None
    written = read_json(tmp_path / "run" / "cases" / "tiny" / "bright" / "diagnosis.json")
    assert Diagnosis.model_validate(written).diverging == 48
    assert not (tmp_path / "run" / "cases" / "tiny" / "good" / "diagnosis.json").exists()


class Accounts:
    """Stands for what renders show under their causes: tells whom it was given, and explains every pair alike."""

    given: ClassVar[list[tuple[str, bool]]] = []

    def __init__(self, case: Any, truth: RenderedImage, rules: Any) -> None:
        assert truth.adapter == "oracle"

    def add(self, side: RenderedImage, scored: Any, diagnosis: Diagnosis | None, *, restate: Any = None) -> None:
        assert (scored.json["a"], scored.json["b"]) == (side.adapter, "oracle")
        self.given.append((side.adapter, diagnosis is not None))

    def explain(self, a: str, b: str, classes: np.ndarray) -> SimpleNamespace:
        return SimpleNamespace(explained=0.75, causes=(Found(id="scaled", side="bright"), Found(id="unexplained")))


def test_pairs_with_either_truth_say_what_was_found(tmp_path: Path, search: Search):
    case = only_case(run(tmp_path / "run", "bright", "good", "reference", diagnose=True))
    for truth in ("oracle", "reference"):
        pair = pair_of(case, "bright", truth)
        assert ([(found.id, found.side) for found in pair.causes], pair.explained) == ([("scaled", "bright")], 1.0), truth
    assert pair_of(case, "good", "oracle").causes == []


def test_pairs_of_peers_say_what_was_found_of_both_and_remember_it(
    tmp_path: Path, search: Search, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr("equilux.diagnose.peers.Accounts", Accounts)
    monkeypatch.setattr(Accounts, "given", [])
    for name in ("one", "two"):
        finished = run(tmp_path / name, "bright", "good", "talkative", store=tmp_path / "store", diagnose=True)
        assert finished.errors == ()
        for peer in ("good", "talkative"):
            pair = pair_of(only_case(finished), "bright", peer)
            assert ([found.id for found in pair.causes], pair.explained) == (["scaled", "unexplained"], 0.75)
    assert Accounts.given == [("bright", True), ("good", False), ("talkative", False)]
    assert pair_of(only_case(finished), "good", "talkative").causes == []


def test_another_cause_than_the_expected_one_is_unexpected(tmp_path: Path, search: Search):
    search.causes = ("gamma-encoded",)
    finished = run(tmp_path / "run", "bright", scenes=[scene(rest=SCALED)], diagnose=True)
    assert finished.exit_code == 1
    assert pair_of(only_case(finished), "bright", "oracle").judged == "diverge_unexpected"
    assert only_case(finished).expect[0].held is False


def test_a_fault_of_the_diagnosis_is_noted_and_the_run_goes_on(tmp_path: Path, search: Search):
    search.fault = RuntimeError("no such luck")
    finished = run(tmp_path / "run", "bright", diagnose=True)
    assert finished.errors == ("tiny: diagnosing bright failed: RuntimeError: no such luck",)
    assert finished.exit_code == 3
    assert pair_of(only_case(finished), "bright", "oracle").verdict == "diverge"
    assert not (tmp_path / "run" / "cases" / "tiny" / "bright" / "diagnosis.json").exists()


def test_a_diagnosis_is_taken_from_the_store_as_long_as_nothing_it_rests_on_has_changed(tmp_path: Path, search: Search):
    store = tmp_path / "store"
    run(tmp_path / "one", "bright", store=store, diagnose=True)
    again = run(tmp_path / "two", "bright", store=store, diagnose=True)
    assert len(search.asked) == 1
    assert pair_of(only_case(again), "bright", "oracle").explained == 1.0
    assert (tmp_path / "two" / "cases" / "tiny" / "bright" / "diagnosis.json").exists()
    run(tmp_path / "three", "bright", store=store, diagnose=True, scenes=[scene(rest=SCALED)])
    assert len(search.asked) == 2  # something else is expected
    run(tmp_path / "four", "bright", store=store, diagnose=True, settings=["bright.level=2"])
    assert len(search.asked) == 3  # another picture


def test_a_continued_tree_keeps_its_diagnoses(tmp_path: Path, search: Search):
    for _ in range(2):
        finished = run(tmp_path / "run", "bright", store=tmp_path / "store", diagnose=True)
    assert len(search.asked) == 1
    assert pair_of(only_case(finished), "bright", "oracle").explained == 1.0


@pytest.mark.parametrize(("causes", "times_asked"), [(("scaled", "unexplained"), 2), (("scaled",), 1)])
def test_a_diagnosis_that_ran_out_of_time_is_remembered_only_where_it_left_nothing(
    tmp_path: Path, search: Search, causes: tuple[str, ...], times_asked: int
):
    search.seconds, search.causes = diagnosing.TIME_LIMIT_S, causes
    for name in ("one", "two"):
        run(tmp_path / name, "bright", store=tmp_path / "store", diagnose=True)
    assert len(search.asked) == times_asked


def test_without_diagnosis_nothing_is_looked_for_and_run_json_says_so(tmp_path: Path, search: Search):
    run(tmp_path / "run", "bright", diagnose=True)
    finished = run(tmp_path / "run", "bright", scenes=[scene(rest=SCALED)])
    assert len(search.asked) == 1
    assert (read_json(tmp_path / "run" / "run.json") or {})["options"]["diagnose"] is False
    assert not (tmp_path / "run" / "cases" / "tiny" / "bright" / "diagnosis.json").exists()
    standing = only_case(finished).renders["bright"].standing
    assert standing is not None
    assert (standing.finding, standing.reason) == ("unexplained", "it was not diagnosed")


def test_a_picture_of_another_size_and_one_without_a_radiance_are_not_diagnosed(tmp_path: Path, search: Search):
    run(tmp_path / "run", "truncated", "nan", diagnose=True)
    assert search.asked == []


def test_an_uncertainty_of_geometry_is_stated_anew_under_other_rules():
    class Tracer:
        def sensitivity(self, normal: Any, position_m: Any) -> np.ndarray:
            return np.full((2, 2, 3), 100 * float(np.max(normal)))

    image = np.ones((2, 2, 3))
    side = RenderedImage("vtk", image, Uncertainty())
    flat = Budget((Bound("b", "r", abs=0.5),))
    curved = Budget((*flat.terms, Geometric("facets", "r", normal=0.01)))
    assert diagnosing.restating(side, None) is None
    assert diagnosing.restating(side, flat) is None
    restated = diagnosing.restating(side, curved)
    assert restated is not None
    assert restated(Tracer()).bound(image).max() == pytest.approx(1.5)  # 0.5 stated, 100 × 0.01 by the facets
