"""What a scene should expect after a run, and the patch that says so."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from equilux.complaint import BadUsage
from equilux.diagnose.diagnosis import Alternative, Found
from equilux.pinning.propose import Proposal, propose, write
from equilux.readrun import read_run
from equilux.results import ExpectationRecord
from equilux_scenes.loader import load_scene_file
from support.engine import write_scene
from support.trees import CLAMPED, Case, Render, brighter, rewrite, truth, write_tree

SWEEP = "sweep:\n  exponent: {path: materials.clay.exponent, values: [1, 10, 100, 1000]}\n"
VALUES = (1, 10, 100, 1000)
LEFT = Found(id="unexplained", explained=0.25, side="vtk")
FLIPPED = Found(id="flipped-x", side="vtk", alternatives=(Alternative(id="mirrored-handedness"),))
MIRRORED = Found(id="mirrored-handedness", side="vtk")


def swept(diverging: dict[int, list[Found]], ran: tuple[int, ...] = VALUES, **more: Any) -> list[Case]:
    """One case per exponent; vtk diverges in some of them, by these causes."""
    renders = {p: Render(brighter() if p in diverging else truth(), diverging.get(p, ())) for p in ran}
    return [Case(f"tiny[exponent={p}]", {"vtk": render}, {"exponent": p}, **more) for p, render in renders.items()]


def proposal(tmp_path: Path, cases: list[Case], expect: str = "", sweep: str = SWEEP) -> Proposal:
    spec = write_scene(tmp_path / "tiny.scene.yaml", specular=0.5, rest=sweep + expect)
    return propose(read_run(write_tree(tmp_path / "run", cases, files=False)).results, [spec])


def expected(found: Proposal) -> list[tuple[str, str, str | None]]:
    """What the spec expects once the proposal is written."""
    write(found.edits)
    scene = load_scene_file(found.edits[0].path).scene
    return [(item.adapter, item.cause, item.when) for item in scene.expect]


def held(adapter: str, cause: str, when: str | None, holds: bool | None) -> list[ExpectationRecord]:
    return [ExpectationRecord(adapter=adapter, cause=cause, when=when, held=holds)]


def test_a_proven_cause_is_pinned_on_the_cases_that_diverge_with_its_reason(tmp_path: Path):
    found = proposal(tmp_path, swept({1000: [CLAMPED]}))
    assert "+  # The highlight's exponent is cut off at 128 (found by a run, explains 100 %)" in found.patch()
    assert found.impossible == ()
    assert expected(found) == [("vtk", "exponent-clamped", "exponent > 128")]


def test_where_all_cases_diverge_there_is_no_when(tmp_path: Path):
    assert expected(proposal(tmp_path, swept({value: [CLAMPED] for value in VALUES}))) == [("vtk", "exponent-clamped", None)]


def test_several_causes_are_pinned_each_where_it_was_proven(tmp_path: Path):
    floored = Found(id="specular-floored", parameter=1e-5, side="vtk")
    found = proposal(tmp_path, swept({1: [floored], 1000: [CLAMPED, floored]}))
    assert set(expected(found)) == {
        ("vtk", "specular-floored", "exponent < 10 or exponent > 100"), ("vtk", "exponent-clamped", "exponent > 128"),
    }  # fmt: skip


def test_cases_that_were_not_run_are_neither_pinned_nor_unpinned(tmp_path: Path):
    pinned = "expect:\n  - {adapter: vtk, cause: half-vector, when: exponent < 50}\n"
    cases = swept({1000: [CLAMPED]}, ran=(10, 1000))
    cases[0].expect, cases[0].judged = held("vtk", "half-vector", "exponent < 50", False), {"vtk": "improved"}
    assert expected(proposal(tmp_path, cases, pinned)) == [
        ("vtk", "half-vector", "exponent < 10"), ("vtk", "exponent-clamped", "exponent > 128"),
    ]  # fmt: skip


def test_what_is_gone_everywhere_is_removed(tmp_path: Path):
    pinned = "expect:\n  - {adapter: vtk, cause: half-vector}\n"
    cases = swept({}, expect=held("vtk", "half-vector", None, False), judged={"vtk": "improved"})
    found = proposal(tmp_path, cases, pinned)
    assert expected(found) == []
    assert "expect" not in found.edits[0].after


def test_an_expectation_that_held_nowhere_else_is_widened_to_new_cases(tmp_path: Path):
    pinned = "expect:\n  - {adapter: vtk, cause: exponent-clamped, when: exponent > 500}\n"
    cases = swept({100: [CLAMPED], 1000: [CLAMPED]})
    cases[3].expect, cases[3].judged = held("vtk", "exponent-clamped", "exponent > 500", True), {"vtk": "diverge_expected"}
    assert expected(proposal(tmp_path, cases, pinned)) == [("vtk", "exponent-clamped", "exponent > 10")]


def test_an_expectation_of_what_the_scene_cannot_tell_apart_is_not_doubled(tmp_path: Path):
    pinned = "expect:\n  - {adapter: vtk, cause: mirrored-handedness}\n  - {adapter: vtk, cause: half-vector}\n"
    expect = [*held("vtk", "mirrored-handedness", None, True), *held("vtk", "half-vector", None, False)]
    found = proposal(tmp_path, [Case("tiny", {"vtk": Render(brighter(), [FLIPPED])}, expect=expect)], pinned, sweep="")
    assert expected(found) == [("vtk", "mirrored-handedness", None)]


def test_of_causes_that_cannot_be_told_apart_the_one_that_serves_all_cases_is_pinned(tmp_path: Path):
    found = proposal(tmp_path, swept({1: [FLIPPED], 10: [MIRRORED], 100: [FLIPPED], 1000: [FLIPPED]}))
    assert expected(found) == [("vtk", "mirrored-handedness", None)]


@pytest.mark.parametrize(
    ("causes", "words"),
    [
        ([], "the divergence is unexplained"),
        ([CLAMPED, LEFT], "25.0 % of the diverging pixels is unexplained (exponent-clamped [128] is proven)"),
    ],
)
def test_what_is_unexplained_is_never_pinned(tmp_path: Path, causes: list[Found], words: str):
    found = proposal(tmp_path, swept({1000: causes}))
    assert found.edits == ()
    (why,) = found.impossible
    assert why.startswith("tiny[exponent=1000]: vtk against oracle: ")
    assert words in why


def test_pixels_that_are_no_radiance_are_never_pinned(tmp_path: Path):
    image = brighter()
    image[0, 0] = float("nan")
    found = proposal(tmp_path, [Case("tiny", {"vtk": Render(image, [CLAMPED], status="invalid")})], sweep="")
    assert found.edits == ()
    assert "1 pixel without a radiance: no cause stands for that" in found.impossible[0]


def test_a_truth_is_never_pinned(tmp_path: Path):
    found = proposal(tmp_path, [Case("tiny", {"reference": Render(brighter(), [CLAMPED])})], sweep="")
    assert found.edits == ()
    assert "two truths disagree" in found.impossible[0]


def test_peers_that_differ_while_both_agree_with_the_truth_cannot_be_pinned(tmp_path: Path):
    spec = write_scene(tmp_path / "tiny.scene.yaml")
    run = write_tree(tmp_path / "run", [Case("tiny", {"vtk": Render(), "povray": Render()})], files=False)

    def diverging(content: dict) -> None:
        peers = next(pair for pair in content["cases"][0]["pairs"] if pair["b"] == "povray")
        peers.update(verdict="diverge", judged="diverge_unexpected", diverge=1)

    rewrite(run, diverging)
    found = propose(read_run(run).results, [spec])
    assert found.edits == ()
    assert found.impossible == (
        "tiny: vtk against povray: neither diverges from the truth by a cause, so there is nothing to pin",
    )


def test_cases_that_differ_in_no_number_are_told_apart_by_hand(tmp_path: Path):
    sweep = "sweep:\n  tint: {path: materials.clay.diffuse, values: [[1, 0, 0], [0, 1, 0]]}\n"
    cases = [
        Case(f"tiny[tint=#{index}]", {"vtk": Render(image, [CLAMPED])}, {"tint": [index, 1 - index, 0]})
        for index, image in enumerate((brighter(), truth()))
    ]
    found = proposal(tmp_path, cases, sweep=sweep)
    assert found.edits == ()
    assert "no `when` selects these cases alone" in found.impossible[0]


def test_the_patch_is_one_that_patch_applies(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    found = proposal(tmp_path, swept({1000: [CLAMPED]}))
    spec = tmp_path / "tiny.scene.yaml"
    spec.write_text(spec.read_text().rstrip("\n"))  # a last line without its end
    found = propose(read_run(tmp_path / "run").results, [spec])
    program = shutil.which("patch") or pytest.skip("no patch program")
    subprocess.run([program, "-p1"], input=found.patch(), text=True, check=True, cwd=found.base)
    assert spec.read_bytes().decode() == found.edits[0].after


def test_a_spec_that_was_changed_since_it_was_run_is_left_alone(tmp_path: Path):
    found = proposal(tmp_path, swept({1000: [CLAMPED]}), sweep=SWEEP.replace("1000", "2000"))
    assert (found.edits, len(found.impossible)) == ((), 1)
    assert "changed since it was run (it has no case tiny[exponent=1000])" in found.impossible[0]


def test_a_spec_that_changes_between_proposal_and_writing_is_not_overwritten(tmp_path: Path):
    found = proposal(tmp_path, swept({1000: [CLAMPED]}))
    path = found.edits[0].path
    path.write_text(path.read_text() + "# a thought\n")
    with pytest.raises(BadUsage, match="changed meanwhile; nothing was written"):
        write(found.edits)
    assert path.read_text().endswith("# a thought\n")


def test_a_specs_mode_stays_as_it_was(tmp_path: Path):
    found = proposal(tmp_path, swept({1000: [CLAMPED]}))
    found.edits[0].path.chmod(0o600)
    write(found.edits)
    assert found.edits[0].path.stat().st_mode & 0o777 == 0o600


def test_specs_of_installed_packages_are_only_proposed(tmp_path: Path):
    found = proposal(tmp_path / "site-packages", swept({1000: [CLAMPED]}))
    assert found.edits[0].fixed == "it belongs to an installed package"
