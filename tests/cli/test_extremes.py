"""`equilux extremes`: axes, arguments, and what is written."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from equilux.extremes import record
from equilux.extremes.axes import AXES, BY_NAME
from support.engine import LABORATORIES

Command = Callable[..., Any]


def test_the_axes_are_listed(equilux: Command):
    said = equilux("extremes", "--list")
    assert said.code == 0
    assert [line.split()[0] for line in said.out.splitlines()[1:]] == [axis.name for axis in AXES]


def test_the_axes_are_listed_for_machines(equilux: Command):
    listed = json.loads(equilux("extremes", "gap-depth", "--list", "--json").out)
    assert [axis["name"] for axis in listed] == ["gap-depth"]
    assert listed[0]["values"][-1] == listed[0]["benign"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("scael",), ("unknown axis 'scael'", "did you mean 'scale'?")),
        (("scale", "--adapters", "goood"), ("goood",)),
        (("scale", "--timeout", "0"), ("--timeout", "above 0")),
        (("scale", "--jobs", "0"), ("--jobs", "at least 1")),
        (("scale", "--adapters", "good", "--set", "good.levell=2"), ("unknown knob 'good.levell'", "level")),
        (("scale", "--diagnosis-timeout", "nan"), ("--diagnosis-timeout",)),
    ],
)
def test_wrong_arguments_are_told_and_nothing_is_written(
    arguments: tuple[str, ...], words: tuple[str, ...], equilux: Command, tmp_path: Path
):
    said = equilux("extremes", *arguments)
    assert said.code == 2
    assert "Traceback" not in said.err
    for word in words:
        assert word in said.err
    assert not (tmp_path / "equilux-extremes").exists()


def test_all_unknown_axes_are_told_at_once(equilux: Command):
    said = equilux("extremes", "scal", "fovv")
    assert [line.split("'")[1] for line in said.err.splitlines()] == ["scal", "fovv"]


def test_a_folder_with_something_else_is_refused(equilux: Command, tmp_path: Path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "letter.txt").write_text("dear")
    said = equilux("extremes", "recursion", "--adapters", "good", "--out", "mine")
    assert (said.code, (tmp_path / "mine" / "letter.txt").read_text()) == (2, "dear")


@dataclass(frozen=True)
class Pushed:
    root: Path
    content: dict[str, Any]
    out: str

    def curve(self, adapter: str) -> dict[str, Any]:
        return next(curve for curve in self.content["axes"][0]["curves"] if curve["adapter"] == adapter)


@pytest.fixture(scope="module")
def pushed(tmp_path_factory: pytest.TempPathFactory) -> Pushed:
    """One push of one axis, as a user's shell starts it."""
    folder = tmp_path_factory.mktemp("push")
    command = [sys.executable, "-m", "equilux", "extremes", "critical-angle", "--adapters", "good,nan,absent,segfaulting"]
    environment = os.environ | {"PYTHONPATH": str(LABORATORIES), "EQUILUX_CACHE": str(folder / ".cache")}
    done = subprocess.run(
        [*command, "--no-diagnose"], cwd=folder, env=environment, capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr
    root = folder / "equilux-extremes"
    return Pushed(root, json.loads((root / "extremes.json").read_text()), done.stdout)


def test_what_is_found_is_written_as_documented(pushed: Pushed):
    jsonschema.validate(pushed.content, record.json_schema())
    (axis,) = pushed.content["axes"]
    assert [point["value"] for point in axis["curves"][0]["points"]] == list(BY_NAME["critical-angle"].values)
    assert pushed.curve("good")["turns"][0]["breakdown"] == 10, "a ramp is no glass"
    assert pushed.curve("good")["turns"][0]["last_good"] is None
    assert pushed.curve("reference")["turns"][0]["breakdown"] is None
    assert {point["truth"] for point in pushed.curve("reference")["points"]} == {"oracle"}
    assert "critical-angle" in pushed.out


def test_not_a_number_is_counted_by_kind(pushed: Pushed):
    point = pushed.curve("nan")["points"][0]
    assert point["invalid"] == {"nan": 1}
    assert point["symptom"]["kind"] == "nan"
    assert point["error"] is not None, "the error is that of the pixels that are numbers"


def test_a_missing_renderer_breaks_nothing(pushed: Pushed):
    curve = pushed.curve("absent")
    assert {point["outcome"] for point in curve["points"]} == {"missing"}
    assert curve["turns"][0]["breakdown"] is None


def test_a_crash_is_a_breakdown_and_no_failure_of_the_command(pushed: Pushed):
    curve = pushed.curve("segfaulting")
    assert curve["points"][0]["outcome"] == "failed"
    assert curve["turns"][0]["breakdown"] == 10
    assert "crash" in curve["turns"][0]["what"]


def test_the_scenes_that_were_rendered_can_be_run(pushed: Pushed, equilux: Command):
    folder = pushed.root / "extremes"
    assert equilux("scenes", "validate", folder).code == 0
    assert {path.name for path in folder.iterdir()} >= {"critical-angle-10.scene.yaml", "critical-angle-1e-10.scene.yaml"}


def test_the_page_holds_every_axis_and_renderer(pushed: Pushed):
    page = (pushed.root / "report" / "extremes.html").read_text()
    assert 'id="critical-angle"' in page
    for adapter in ("good", "nan", "segfaulting"):
        assert adapter in page
    assert page.count("<svg class=\"push\"") >= 3
