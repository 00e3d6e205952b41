"""`equilux diff`, as it is typed."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from support.engine import write_scene
from support.trees import CLAMPED, Case, Render, brighter, truth, write_tree


def run(root: Path, parameter: float = 128.0, **more: object) -> Path:
    cause = CLAMPED.model_copy(update={"parameter": parameter})
    cases = [Case(f"clay-ball[exponent={p}]", {"vtk": Render(brighter(), [cause])}, {"exponent": p}) for p in (300, 1000)]
    return write_tree(root, [*cases, Case("lamp", {"vtk": Render(truth())})], **more)


def test_nothing_that_changed_is_exit_code_0(tmp_path: Path, equilux):
    said = equilux("diff", run(tmp_path / "a"), run(tmp_path / "b"))
    assert (said.code, said.err) == (0, "")
    assert said.out.endswith("nothing that matters changed on the 3 cases of both\n")


def test_a_cause_with_another_parameter_is_exit_code_1_and_one_sentence(tmp_path: Path, equilux):
    said = equilux("diff", run(tmp_path / "a"), run(tmp_path / "b", 256.0, adapters={"oracle": "0.1.0", "vtk": "9.5.0"}))
    assert said.code == 1
    assert "  vtk: 9.4.0 → 9.5.0\n" in said.out
    assert "  vtk: exponent-clamped 128 → 256 on 2 cases: clay-ball[exponent=300], clay-ball[exponent=1000]\n" in said.out


def test_another_version_that_renders_the_same_is_told_and_exit_code_0(tmp_path: Path, equilux):
    said = equilux("diff", run(tmp_path / "a"), run(tmp_path / "b", adapters={"oracle": "0.1.0", "vtk": "9.5.0"}))
    assert said.code == 0
    assert "vtk: 9.4.0 → 9.5.0" in said.out


def test_json_lists_every_change_by_itself(tmp_path: Path, equilux):
    said = equilux("diff", run(tmp_path / "a"), run(tmp_path / "b", 256.0), "--json")
    told = json.loads(said.out)
    assert (said.code, told["schema"], told["matters"]) == (1, "equilux/diff/1", True)
    assert [(change["case"], change["before"], change["after"]) for change in told["changes"] if change["kind"] == "cause"] == [
        ("clay-ball[exponent=300]", 128.0, 256.0), ("clay-ball[exponent=1000]", 128.0, 256.0),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("a",), "requires an argument"),
        (("a", "nowhere"), "'nowhere': no such folder"),
        (("a", "a/cases"), "did you mean 'a'?"),
        (("a/results.json", "a"), "is a file, expected the folder"),
    ],
)
def test_wrong_arguments_are_told_on_one_line(tmp_path: Path, equilux, arguments: tuple[str, ...], words: str):
    run(Path("a"))
    said = equilux("diff", *arguments)
    assert (said.code, said.out, said.err.count("\n")) == (2, "", 1)
    assert words in said.err


def test_two_real_runs_with_another_knob_are_told_apart(tiny: Path, equilux):
    write_scene(tiny, rest="expect:\n  - {adapter: good, cause: 'fakes:ramp'}")
    for out, level in (("a", 1), ("b", 2)):
        equilux("run", tiny, "--adapters", "good", "--no-html", "--no-diagnose", "--out", out, "--set", f"good.level={level}")
    said = equilux("diff", "a", "b")
    assert said.code == 1
    assert "  good: knob level: 1 → 2\n" in said.out
    assert "  good: the picture changed beyond its stated uncertainty on tiny: |ΔL| at most 1 W/(m²·sr)" in said.out
