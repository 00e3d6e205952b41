"""What changed between two runs: each thing by itself, then in words."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from equilux.difference.changes import Change
from equilux.difference.compare import compare_runs
from equilux.difference.pictures import compare_pictures
from equilux.difference.words import grouped, tell
from equilux.readrun import read_run
from equilux.results import ExpectationRecord, Standing
from support.trees import CLAMPED, Case, Render, brighter, truth, write_tree


def changes(tmp_path: Path, a: list[Case], b: list[Case], **of_b: object) -> list[Change]:
    before = read_run(write_tree(tmp_path / "a", a, files=False))
    after = read_run(write_tree(tmp_path / "b", b, files=False, **of_b))
    return compare_runs(before.results, after.results, before.manifest, after.manifest)


def whats(tmp_path: Path, a: Case, b: Case, **of_b: object) -> list[tuple[str, bool]]:
    return [(change.what, change.matters) for change in changes(tmp_path, [a], [b], **of_b)]


def vtk(*args: object, **more: object) -> dict[str, Render]:
    return {"vtk": Render(*args, **more)}  # type: ignore[arg-type]


def clamped(at: float, **more: object) -> Render:
    return Render(brighter(), [CLAMPED.model_copy(update={"parameter": at, **more})])


def test_the_same_run_twice_has_no_changes(tmp_path: Path):
    case = Case(renders=vtk(brighter(), [CLAMPED]))
    assert changes(tmp_path, [case], [case]) == []


def test_versions_machine_knobs_and_command_are_told_and_do_not_matter(tmp_path: Path):
    case = Case(renders=vtk())
    found = whats(
        tmp_path, case, case, equilux="0.2.0", adapters={"oracle": "0.1.0", "vtk": "9.5.0"}, command=["equilux", "run", "x"],
        machine={"cores": 4},
    )  # fmt: skip
    assert found == [
        ("equilux: 0.1.0 → 0.2.0", False), ("vtk: 9.4.0 → 9.5.0", False), ("machine: cores: 2 → 4", False),
        ("command: equilux run → equilux run x", False),
    ]  # fmt: skip


def test_a_knob_and_a_scene_that_changed_are_told(tmp_path: Path):
    case = Case(renders=vtk())
    write_tree(tmp_path / "a", [case], adapters={}, identity={"cases": {"clay-ball": "1"}})
    write_tree(tmp_path / "b", [case], adapters={}, identity={"cases": {"clay-ball": "2"}})
    a, b = (read_run(tmp_path / name) for name in "ab")
    found = compare_runs(
        a.results, b.results, a.manifest | {"adapters": {"vtk": {"knobs": {"samples": 1}}}},
        b.manifest | {"adapters": {"vtk": {"knobs": {"samples": 4}}}},
    )  # fmt: skip
    assert [(change.what, change.matters) for change in found] == [
        ("vtk: knob samples: 1 → 4", False), ("the scene itself changed", True),
    ]  # fmt: skip


def test_cases_and_adapters_of_one_run_alone_matter(tmp_path: Path):
    found = changes(tmp_path, [Case("old", vtk()), Case("both", vtk())], [Case("new"), Case("both")])
    assert {(change.what, change.case) for change in found if change.matters} == {
        ("only in A", "old"), ("only in B", "new"), ("vtk took part in A alone", None),
    }  # fmt: skip


def test_a_status_that_changed_says_why(tmp_path: Path):
    crash = Render(None, status="crashed", reason="signal 11")
    (found,) = changes(tmp_path, [Case(renders=vtk())], [Case(renders={"vtk": crash})])
    assert (found.what, found.detail) == ("vtk: ok → crashed", "signal 11")
    (back,) = changes(tmp_path / "back", [Case(renders={"vtk": crash})], [Case(renders=vtk())])
    assert (back.what, back.detail) == ("vtk: crashed → ok", "it was: signal 11")


def test_a_judgement_that_changed_says_how_much_diverges_now(tmp_path: Path):
    found = changes(tmp_path, [Case(renders=vtk())], [Case(renders=vtk(brighter()))])
    assert found[0].what == "vtk against oracle: agree → diverge unexpectedly"
    assert found[0].detail == "4 of 48 pixels, at most 0.25"


@pytest.mark.parametrize(
    ("before", "after", "what"),
    [
        (clamped(128.0), clamped(256.0), "vtk: exponent-clamped 128 → 256"),
        (Render(brighter()), clamped(128.0), "vtk: exponent-clamped [128] appeared"),
        (clamped(128.0), Render(brighter()), "vtk: exponent-clamped [128] vanished"),
        (clamped(128.0), clamped(128.0, reading="of the half vector"),
         "vtk: exponent-clamped [128] → exponent-clamped [128] (of the half vector)"),
    ],
)  # fmt: skip
def test_causes_appear_vanish_and_change_their_parameter(tmp_path: Path, before: Render, after: Render, what: str):
    assert whats(tmp_path, Case(renders={"vtk": before}), Case(renders={"vtk": after})) == [(what, True)]


def test_a_fitted_parameter_that_moved_by_less_than_a_thousandth_is_the_same(tmp_path: Path):
    assert whats(tmp_path, Case(renders={"vtk": clamped(128.0)}), Case(renders={"vtk": clamped(128.1)})) == []


def test_a_finding_that_changed_matters(tmp_path: Path):
    one = Render(brighter(), [CLAMPED], Standing(truth="diverge", dialect="agree", finding="model-difference"))
    other = Render(brighter(), [CLAMPED], Standing(truth="diverge", dialect="diverge", finding="implementation-bug"))
    assert whats(tmp_path, Case(renders={"vtk": one}), Case(renders={"vtk": other})) == [
        ("vtk: model-difference → implementation-bug", True),
    ]  # fmt: skip


def test_expectations_that_appear_and_vanish_are_told(tmp_path: Path):
    old = ExpectationRecord(adapter="vtk", cause="half-vector")
    new = ExpectationRecord(adapter="vtk", cause="exponent-clamped", when="exponent > 128")
    renders = vtk(brighter(), [CLAMPED])
    assert {what for what, _ in whats(tmp_path, Case(renders=renders, expect=[old]), Case(renders=renders, expect=[new]))} == {
        "vtk: half-vector is no longer expected", "vtk: exponent-clamped when exponent > 128 is now expected",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("before", "after", "what"),
    [
        ({"abs": 1e-6}, {"abs": 1.9e-6}, None),
        ({"abs": 1e-6}, {"abs": 2.1e-6}, ("vtk: the stated uncertainty (abs) is markedly larger", True)),
        ({"seconds": 0.1}, {"seconds": 0.5}, None),
        ({"seconds": 2.0}, {"seconds": 3.0}, None),
        ({"seconds": 2.0}, {"seconds": 0.9}, ("vtk: rendering is markedly faster", False)),
    ],
)
def test_uncertainty_and_time_change_markedly_beyond_a_factor_of_two(
    tmp_path: Path, before: dict, after: dict, what: tuple | None
):
    found = whats(tmp_path, Case(renders=vtk(**before)), Case(renders=vtk(**after)))
    assert found == ([what] if what else [])


# --- pictures ---------------------------------------------------------------------------------------------------------


def pictures(tmp_path: Path, before: np.ndarray, after: np.ndarray) -> list[Change]:
    a = write_tree(tmp_path / "a", [Case(renders=vtk(before))])
    b = write_tree(tmp_path / "b", [Case(renders=vtk(after))])
    return list(compare_pictures(read_run(a), read_run(b)))


def test_equal_pictures_have_not_changed(tmp_path: Path):
    assert pictures(tmp_path, truth(), truth()) == []


def test_a_change_is_measured_in_units_of_what_both_claim_to_know(tmp_path: Path):
    (beyond,) = pictures(tmp_path / "beyond", truth(), brighter())
    assert (beyond.what, beyond.matters) == ("vtk: the picture changed beyond its stated uncertainty", True)
    assert beyond.detail.startswith("|ΔL| at most 0.25 W/(m²·sr), 1.1")
    assert beyond.detail.endswith("e+05 × the uncertainty of both at (2, 2)")
    (within,) = pictures(tmp_path / "within", truth(), truth() + 1e-7)
    assert (within.what, within.matters) == ("vtk: the picture changed within its stated uncertainty", False)


def test_values_that_are_no_numbers_and_other_sizes_are_told(tmp_path: Path):
    spoiled = truth()
    spoiled[1, 2, 0] = np.nan
    (found,) = pictures(tmp_path / "nan", truth(), spoiled)
    assert (found.what, found.detail, found.matters) == (
        "vtk: the picture changed, it holds values that are no numbers", "at (2, 1)", True,
    )  # fmt: skip
    assert pictures(tmp_path / "same", spoiled, spoiled) == []
    (size,) = pictures(tmp_path / "size", truth(), truth()[:-1])
    assert "their sizes differ: 8×6 and 8×5 pixels" in size.detail


# --- words ------------------------------------------------------------------------------------------------------------


def test_the_same_change_on_many_cases_is_one_sentence(tmp_path: Path):
    names = [f"clay-ball[exponent={p}]" for p in range(5)]
    a, b = ([Case(name, {"vtk": clamped(at)}) for name in names] for at in (128.0, 256.0))
    runs = [read_run(write_tree(tmp_path / name, cases, files=False)).results for name, cases in (("a", a), ("b", b))]
    text = tell(runs[0], runs[1], compare_runs(*runs))
    assert "  vtk: exponent-clamped 128 → 256 on all 5 cases: clay-ball[exponent=0], clay-ball[exponent=1], " \
           "clay-ball[exponent=2] and 2 more" in text  # fmt: skip


def test_what_matters_most_comes_first_and_what_got_worse_before_what_got_better():
    found = grouped([
        Change("time", "slower", False), Change("uncertainty", "larger"), Change("judgement", "better", after="agree"),
        Change("judgement", "worse", after="diverge_unexpected"), Change("status", "crashed", after="crashed"),
    ])  # fmt: skip
    assert [group.first.what for group in found] == ["crashed", "worse", "better", "larger", "slower"]
