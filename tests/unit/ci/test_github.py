"""What GitHub is told: annotations at the right lines, properly escaped, and the job summary; and nobody else."""

from __future__ import annotations

import io
import re
from dataclasses import replace
from pathlib import Path

from equilux.ci import RunView, announce, write_files
from equilux.ci.annotations import _command, commands
from equilux.ci.summary import GITHUB_BYTES, job_summary

COMMAND = re.compile(r"::error (?P<properties>[^:]*)::(?P<message>.*)")


def told(view: RunView, workspace: Path | None = None) -> list[tuple[dict[str, str], str]]:
    found = []
    for line in commands(view, str(workspace) if workspace else None):
        match = COMMAND.fullmatch(line)
        assert match, line
        found.append((dict(each.split("=", 1) for each in match["properties"].split(",")), match["message"]))
    return found


def test_what_is_unexpected_is_marked_at_the_scene_and_what_is_gone_at_its_expectation(view: RunView, tmp_path: Path):
    marks = [(each.get("file"), each.get("line"), each.get("col"), each["title"]) for each, _ in told(view, tmp_path)]
    spec = "specs/clay.scene.yaml"
    assert marks == [
        (None, None, None, "equilux%3A fault of the engine"),
        (spec, "2", "7", "clay%3A vtk diverges unexpectedly"),
        (spec, "16", "5", "clay%3A povray no longer diverges by scaled"),
        (spec, "2", "7", "clay%3A mitsuba crashed"),
    ]


def test_an_annotation_names_the_cause_and_what_differs(view: RunView):
    message = told(view)[1][1]
    assert "exponent-clamped [128]" in message
    assert "the highlight's exponent is cut off at 128" in message
    assert "12 of 48 pixels" in message


def test_pairs_whose_side_is_told_against_the_truth_are_not_told_again(view: RunView):
    assert "povray against" not in "".join(commands(view))
    assert "vtk against reference" not in "".join(commands(view))


def test_a_spec_outside_the_checkout_has_no_line_to_mark(view: RunView, tmp_path: Path):
    assert all("file" not in properties for properties, _ in told(view, tmp_path / "elsewhere"))


def test_what_a_command_may_not_hold_is_escaped():
    written = _command({"file": "a,b:c.yaml", "title": "50 %\n"}, "100 %: a,b\r\nsecond::error ::line")
    assert written == "::error file=a%2Cb%3Ac.yaml,title=50 %25%0A::100 %25: a,b%0D%0Asecond::error ::line"


def test_nothing_is_told_outside_github(view: RunView):
    stream = io.StringIO()
    announce(view, {"GITHUB_ACTIONS": "false"}, stream)
    announce(view, {}, stream)
    assert stream.getvalue() == ""


def test_on_github_annotations_go_to_the_stream_and_the_summary_to_its_file(view: RunView, tmp_path: Path):
    stream, target = io.StringIO(), tmp_path / "step.md"
    target.write_text("before\n")
    announce(view, {"GITHUB_ACTIONS": "true", "GITHUB_WORKSPACE": str(tmp_path), "GITHUB_STEP_SUMMARY": str(target)}, stream)
    assert stream.getvalue().splitlines() == commands(view, str(tmp_path))
    assert target.read_text().startswith("before\n## equilux: ")


def test_a_summary_that_cannot_be_written_is_said(view: RunView, tmp_path: Path):
    stream = io.StringIO()
    announce(view, {"GITHUB_STEP_SUMMARY": str(tmp_path / "nowhere" / "step.md")}, stream)
    assert stream.getvalue().startswith("the job summary cannot be written: ")


def test_a_summary_too_long_for_github_is_cut_at_a_line(view: RunView):
    many = replace(view, errors=("x" * 50_000,) * 50)
    text = job_summary(
        many,
    )
    assert len(text.encode()) < GITHUB_BYTES
    assert text.endswith("… the rest is in summary.md of the results\n")


def test_both_files_lie_in_the_results_tree(view: RunView):
    write_files(view)
    assert (view.tree / "junit.xml").read_bytes().startswith(b"<?xml ")
    assert (view.tree / "summary.md").read_text().startswith("## equilux: 3 unexpected divergences, 1 expected divergence gone")
