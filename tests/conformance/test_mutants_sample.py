"""A fixed sample of the mutation suite (`make mutation` is the whole): faults are found and named, right pictures pass, broken
ones never.
"""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

import mutation
from equilux.compare import compare_pair
from equilux_scenes.causes import CAUSES
from mutation import faults, scenes
from mutation.broken import passed
from mutation.mutant import Mutant
from mutation.paired_faults import PAIRED_FAULTS
from mutation.renderer import picture
from mutation.scenes import stages
from mutation.single_faults import SINGLE_FAULTS
from mutation.suite import MUTANTS, unmutated_cases
from mutation.trial import Trial, rightly_named, staged, tried, visibility

ONE_PER_CAUSE = {mutant.causes[0]: mutant for mutant in reversed(SINGLE_FAULTS)}
"""The first mutant of each cause."""
NAMED = (
    "flipped-y", "bands-swapped: B G R", "scaled: 255/256", "normal-side: as stored", "vertex-lighting", "exponent-clamped: 64",
    "highlight-cosine", "light-missing: the second", "spot-cone-halved", "light-colours-ignored: ambient", "emission-tinted",
    "background-missing: black", "transmission-uncounted", "scaled: π + exponent-clamped: 64",
)  # fmt: skip
"""Some of every group that are quick to diagnose."""
UNMUTATED = 20


def first_trial(mutant: Mutant, *, name: bool = True) -> Trial:
    """On the first made-up scene where the mutant is visible, a local model's if it has one: they are quick."""
    for case in stages(mutant.models, mutant.variant):
        if not mutant.may_show(case):
            continue
        on, image = staged(case), picture(case, mutant.faults)
        visible = visibility(mutant, on, image)
        if visible:
            return tried(mutant, on, image, visible, name=name)
    raise AssertionError(f"{mutant.name} is visible nowhere")


def test_every_cause_has_a_mutant():
    assert set(ONE_PER_CAUSE) == set(CAUSES) - {"unexplained"}
    assert len(SINGLE_FAULTS) >= 30
    assert len(PAIRED_FAULTS) >= 20


@pytest.mark.parametrize("mutant", ONE_PER_CAUSE.values(), ids=lambda mutant: mutant.name)
def test_a_fault_is_found(mutant):
    trial = first_trial(mutant, name=False)
    assert trial.detected, f"{trial.case}: {trial.visible} pixels moved, and the verdict is not diverge"


@pytest.mark.parametrize("name", NAMED)
def test_a_fault_is_named(name):
    trial = first_trial(MUTANTS[name])
    assert trial.named, f"{trial.case}: injected {trial.causes}, found {trial.found}"


def test_unmutated_pictures_agree():
    cases = list(unmutated_cases())
    for case in cases[:: len(cases) // UNMUTATED]:
        on = staged(case)
        scored = compare_pair(on.side(on.right), on.truth, on.tracer).json
        assert scored["verdict"] == "agree", f"{case.name}: {scored['reason']}, worst {scored['worst']}"


@pytest.mark.parametrize(("case", "other"), [("clay-ball", "two-lights"), ("mirror-sphere", "glass-sphere")])
def test_broken_pictures_never_pass(case, other, tmp_path):
    tried_, wrong = passed(scenes.corpus()[case], scenes.corpus()[other], tmp_path)
    assert tried_ > 30
    assert not wrong, f"{case}: let through: {', '.join(wrong)}"


# --- the suite itself -------------------------------------------------------------------------------------------------


def test_mutants_know_nothing_of_the_rules_that_recognise_them():
    """Nor of the tracer's and the oracle's code: only the trial, which asks for a verdict, may."""
    asks = {"trial", "suite", "document", "rivals", "broken"}
    makers = [file for file in Path(next(iter(mutation.__path__))).glob("*.py") if file.stem not in asks]
    assert len(makers) >= 10
    for file in makers:
        tree = ast.parse(file.read_text(encoding="utf-8"))
        nodes = [node for node in ast.walk(tree) if isinstance(node, ast.Import | ast.ImportFrom)]
        imported = [alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names]
        imported += [node.module or "" for node in nodes if isinstance(node, ast.ImportFrom)]
        alien = [module for module in imported if module.split(".")[0] in ("equilux", "equilux_tracer", "equilux_oracle")]
        assert not alien, f"{file.name} imports {alien}"


def test_faults_go_together_unless_they_want_one_setting_in_two_ways():
    both = faults.together(faults.Faults(floor=0.5), faults.Faults(gated=False))
    assert (both.floor, both.gated) == (0.5, False)
    with pytest.raises(ValueError, match="floor"):
        faults.together(faults.Faults(floor=0.5), faults.Faults(floor=0.2))


@pytest.mark.parametrize(
    ("found", "right"),
    [
        ([("a", [])], False),
        ([("a", []), ("b", [])], True),
        ([("b", []), ("c", ["a"])], True),
        ([("c", ["a", "b"]), ("b", [])], True),
        ([("c", ["a", "b"]), ("d", [])], False),
        ([("a", []), ("b", []), ("unexplained", [])], False),
    ],
)
def test_a_name_is_right_only_if_causes_match_one_for_one(found, right):
    assert rightly_named(("a", "b"), [{"id": name, "alternatives": others} for name, others in found]) is right
