"""A run goes on when something fails, stops cleanly when it is told to, and keeps what is finished."""

from __future__ import annotations

import io
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest

from equilux.progress import Plain, Silent, suitable
from equilux.tree import read_json
from equilux_scenes.loader import load_scene_text
from support.engine import LABORATORIES, only_case, pair_of, run, scene, scene_text

SEVERAL = "sweep:\n  glow: {path: materials.clay.emission, values: [0, 0.1, 0.2, 0.3, 0.4, 0.5]}"


def test_a_failure_in_one_case_leaves_the_others_alone(tmp_path: Path):
    finished = run(tmp_path / "run", "dying-once", scenes=[scene(rest=SEVERAL)], jobs=1)
    assert [case.renders["dying-once"].status for case in finished.results.cases] == ["ok"] * 6
    assert sorted(case.renders["dying-once"].attempts for case in finished.results.cases) == [1, 1, 1, 1, 1, 2]


def test_a_worker_that_dies_while_idle_charges_no_case(tmp_path: Path):
    scenes = [scene("one"), scene("two", specular=0.5)]
    finished = run(tmp_path / "run", "dying-idle", "slow", scenes=scenes, jobs=1)
    assert [case.renders["dying-idle"].status for case in finished.results.cases] == ["ok", "ok"]
    assert [case.renders["dying-idle"].attempts for case in finished.results.cases] == [1, 1]


def test_results_say_how_lights_were_given_and_by_which_k_m(tmp_path: Path):
    found = load_scene_text(scene_text(rest="k_m: 684").replace("intensity: 7.5", "luminous_intensity: 5130"))
    said = only_case(run(tmp_path / "out", "good", scenes=[found])).photometry
    assert said is not None
    assert said.lights == {"key": "luminous_intensity 5130 cd"}
    assert (said.k_m, said.k_m_text) == (684, "684 lm/W, the lecture's, 0.146 % above the SI's 683.002")


def test_knobs_reach_the_adapter_and_are_recorded(tmp_path: Path):
    finished = run(tmp_path / "run", "good", settings=["good.level=2"])
    assert pair_of(only_case(finished), "good", "oracle").max_abs == 1.0
    assert (read_json(tmp_path / "run" / "cases" / "tiny" / "good" / "render.json") or {})["knobs"] == {"level": 2}


def test_an_adapter_whose_worker_cannot_load_it_fails_every_case_and_ends_the_run_soon(tmp_path: Path):
    from equilux import plan
    from equilux.registry import Registry
    from equilux.run import Options, execute
    from support.engine import entry

    here_only = entry("good")
    assert here_only.adapter is not None  # loaded here, before its workers are told to look elsewhere
    here_only.entry_point = type(here_only.entry_point)("good", "nowhere_to_be_found:ADAPTER", "equilux.adapters")
    selection = plan.select_adapters(Registry([here_only, entry("oracle")]), ["good"])
    knobs = dict.fromkeys(("good", "oracle"), here_only.adapter.Knobs())
    planned = plan.make_plan(scene(rest=SEVERAL).cases, selection, knobs)
    finished = execute(planned, Options(out=tmp_path / "run"))
    assert finished.exit_code == 3
    for case in finished.results.cases:
        assert case.renders["good"].status == "failed"
        assert "No module named 'nowhere_to_be_found'" in (case.renders["good"].reason or "")
        assert case.renders["oracle"].status == "ok"


class Recorder(Silent):
    def __init__(self) -> None:
        self.cases: list[str] = []
        self.notes: list[str] = []

    def case_done(self, line: str) -> None:
        self.cases.append(line)

    def note(self, line: str) -> None:
        self.notes.append(line)


def test_progress_tells_every_case_and_every_failure(tmp_path: Path):
    told = Recorder()
    run(tmp_path / "run", "good", "raising", progress=told)
    assert told.cases == ["tiny: good ok, oracle ok, raising failed; pairs: 1 agree"]
    assert told.notes == ["tiny: raising failed: the adapter raised ZeroDivisionError: the renderer divided by zero"]


def test_plain_progress_is_one_unwrapped_line_per_case(capsys: pytest.CaptureFixture[str]):
    plain = Plain(sys.stderr)
    plain.begin(4, 2)
    plain.case_done("a: " + "x" * 300)
    plain.case_done("b: y")
    assert capsys.readouterr().err == f"[1/2] a: {'x' * 300}\n[2/2] b: y\n"


class Screen(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_on_a_terminal_a_bar_moves_and_a_failure_is_a_line_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("TERM", "xterm")
    screen = Screen()
    assert isinstance(suitable(io.StringIO()), Plain)
    run(tmp_path / "run", "good", "raising", progress=suitable(screen))
    shown = screen.getvalue()
    assert "3/3" in shown
    assert "\x1b" in shown
    assert "tiny: raising failed: the adapter raised ZeroDivisionError: the renderer divided by zero\n" in shown


@pytest.mark.parametrize("cause", ["failure", "divergence"])
def test_fail_fast_stops_at_the_first_failure_or_unexpected_divergence(tmp_path: Path, cause: str):
    culprit = {"failure": "raising", "divergence": "bright"}[cause]
    scenes = [scene(f"s{number}", specular=number / 100) for number in range(40)]
    finished = run(tmp_path / "run", culprit, "slow", scenes=scenes, jobs=1, fail_fast=True)
    assert finished.exit_code == {"failure": 3, "divergence": 1}[cause]
    assert (finished.results.run.interrupted or "").startswith("--fail-fast: s")
    made = sum(len(case.renders) for case in finished.results.cases)
    assert made < 40 * 3, f"{made} renders of {40 * 3} were made all the same"


# --- signals ------------------------------------------------------------------------------------------------------------

SCRIPT = """
import sys
from pathlib import Path
from support.engine import run, scene
scenes = [scene(f"s{number}", specular=number / 100) for number in range(8)]
finished = run(Path(sys.argv[1]), "good", "slow", "hanging", scenes=scenes, jobs=2, timeout_s=60)
print(finished.exit_code)
sys.exit(finished.exit_code)
"""


def started(tmp_path: Path) -> subprocess.Popen[str]:
    """A long run in a process of its own, once something of it is finished."""
    path = os.pathsep.join([str(LABORATORIES.parent.parent), str(LABORATORIES)])
    process = subprocess.Popen(
        [sys.executable, "-c", SCRIPT, str(tmp_path / "run")],
        env=os.environ | {"PYTHONPATH": path}, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True,
    )  # fmt: skip
    deadline = time.monotonic() + 60
    while not all(list((tmp_path / "run").glob(f"cases/*/{adapter}/render.json")) for adapter in ("good", "slow")):
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < deadline, "nothing was finished within a minute"
        time.sleep(0.05)
    return process


def interrupted(tmp_path: Path, number: signal.Signals) -> tuple[subprocess.Popen[str], float, list[psutil.Process]]:
    """Interrupt a long run. Returns the ended process, how long it took to end, and every process it had."""
    process = started(tmp_path)
    members = psutil.Process(process.pid).children(recursive=True)
    began = time.monotonic()
    process.send_signal(number)
    process.wait(60)
    return process, time.monotonic() - began, members


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_ends_the_workers_and_keeps_what_is_finished(tmp_path: Path, number: signal.Signals):
    process, seconds, members = interrupted(tmp_path, number)
    assert (process.returncode, seconds < 15) == (130, True), (seconds, process.communicate())
    results = read_json(tmp_path / "run" / "results.json") or {}
    assert results["run"]["interrupted"] == number.name
    renders = [(case["case"], name, render) for case in results["cases"] for name, render in case["renders"].items()]
    finished = [(case, name) for case, name, render in renders if render["status"] == "ok"]
    assert {name for _, name in finished} >= {"good", "slow"}
    for case, name in finished:
        assert (tmp_path / "run" / "cases" / case / name / "image.exr").exists(), (case, name)
    assert not [case for case, name, _ in renders if name == "hanging"]
    gone, alive = psutil.wait_procs(members, timeout=5)
    assert (len(gone), alive) == (len(members), [])
    assert not list((tmp_path / "run").glob(".scratch*"))


def test_an_interrupted_tree_is_continued(tmp_path: Path):
    interrupted(tmp_path, signal.SIGINT)
    before = {path.parent.parent.name for path in (tmp_path / "run").glob("cases/*/good/render.json")}
    scenes = [scene(f"s{number}", specular=number / 100) for number in range(8)]
    again = run(tmp_path / "run", "good", "slow", "hanging", scenes=scenes, timeout_s=0.7, jobs=4)
    assert before
    assert {case.case for case in again.results.cases if case.renders["good"].reused} == before
    assert {case.renders["good"].status for case in again.results.cases} == {"ok"}


def test_a_killed_engine_leaves_no_process_behind(tmp_path: Path):
    process = started(tmp_path)
    members = psutil.Process(process.pid).children(recursive=True)
    process.kill()
    process.wait()
    _, alive = psutil.wait_procs(members, timeout=20)
    assert alive == [], [each.cmdline() for each in alive]


def test_results_survive_as_json_whatever_the_renders_hold(tmp_path: Path):
    run(tmp_path / "run", "nan", "infinite", "negative")
    text = (tmp_path / "run" / "results.json").read_text()
    json.loads(text, parse_constant=lambda name: pytest.fail(f"{name} is not JSON"))
