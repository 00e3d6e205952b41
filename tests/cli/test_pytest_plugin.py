"""`pytest scene_specs`: the same verdicts as `equilux run`, told so that a renderer's developer knows what to fix."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

import pytest

from equilux.cli import run_command
from equilux.pytest_plugin import SUFFIX
from equilux.registry import Registry
from support.engine import LABORATORIES, registry, write_scene

pytest_plugins = ["pytester"]

CONFTEST = """
import json, os

def pytest_runtest_logreport(report):
    if "PYTEST_XDIST_WORKER" not in os.environ and (report.when == "call" or report.outcome != "passed"):
        with open(os.environ["OUTCOMES"], "a") as file:
            file.write(json.dumps([report.nodeid, report.outcome, str(report.longrepr), dict(report.user_properties)]) + "\\n")
"""
RAMP = "fakes:ramp"
ADAPTERS = "good,matte,raising,absent"
"""The fakes paint a ramp, which the real truths do not."""


@dataclass(frozen=True)
class Session:
    """A pytest session. items: by node id, (outcome, its text, its properties)."""

    code: int
    out: str
    items: dict[str, tuple[str, str, dict[str, str]]]


ONLY_WHAT_IS_NEEDED = ("-p", "no:hypothesispytest", "-p", "no:regressions", "-p", "no:playwright", "-p", "no:timeout")
"""Other people's plugins, which only take time here."""


def environment(folder: Path, **more: str) -> dict[str, str]:
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("PYTEST_", "GITHUB_"))}
    return kept | {"EQUILUX_CACHE": str(folder / ".cache"), "PYTHONPATH": str(LABORATORIES), "COLUMNS": "240"} | more


def session(folder: Path, *arguments: str, **more: str) -> Session:
    """pytest in a process of its own, in the folder."""
    (folder / "conftest.py").write_text(CONFTEST)
    outcomes = folder / "outcomes.jsonl"
    outcomes.unlink(missing_ok=True)
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", *ONLY_WHAT_IS_NEEDED, *arguments]
    done = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, env=environment(folder, OUTCOMES=str(outcomes), **more), timeout=240
    )
    lines = outcomes.read_text().splitlines() if outcomes.exists() else []
    items = {
        nodeid.partition("@")[0]: (outcome, text, properties) for nodeid, outcome, text, properties in map(json.loads, lines)
    }
    return Session(done.returncode, done.stdout + done.stderr, items)


@pytest.fixture(scope="module")
def specs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with `specs/`: what diverges as expected, unexpectedly, and no more; what is not supported; a sweep."""
    folder = tmp_path_factory.mktemp("session")
    good = f"{{adapter: good, cause: '{RAMP}'"
    write_scene(folder / "specs/pinned.scene.yaml", "pinned", rest=f"expect:\n  - {good}}}")
    sweep = "sweep:\n  exponent: {path: materials.clay.exponent, values: [1, 10]}\n"
    write_scene(
        folder / "specs/more/swept.scene.yaml", "swept", specular=0.5, rest=f"{sweep}expect:\n  - {good}, when: exponent > 5}}"
    )
    write_scene(folder / "specs/gone.scene.yaml", "gone", rest="expect:\n  - {adapter: reference, cause: scaled}")
    return folder


@pytest.fixture(scope="module")
def judged(specs: Path) -> dict:
    """results.json of `equilux run` on the same specs."""
    command = [
        sys.executable,
        "-m",
        "equilux",
        "run",
        "specs",
        "--adapters",
        ADAPTERS,
        "--no-html",
        "--no-diagnose",
        "--out",
        "run",
    ]
    done = subprocess.run(command, cwd=specs, capture_output=True, text=True, env=environment(specs), timeout=240)
    assert done.returncode == 3, done.stderr  # "raising" raises
    return json.loads((specs / "run/results.json").read_text())


@pytest.fixture(scope="module")
def serial(specs: Path, judged: dict) -> Session:
    return session(
        specs,
        "specs",
        "--equilux-adapters",
        ADAPTERS,
        "--equilux-no-diagnose",
        "--equilux-out",
        "serial",
        "--junitxml=pytest.xml",
    )


@pytest.fixture(scope="module")
def parallel(specs: Path, judged: dict) -> Session:
    """Items of one scene in several processes, and nothing remembered from before."""
    (specs / "state").mkdir()
    return session(
        specs, "specs", "--equilux-adapters", ADAPTERS, "--equilux-no-diagnose", "--equilux-out", "parallel", "-n", "2", "--dist",
        "load", "--equilux-no-reuse", EQUILUX_FAKE_STATE=str(specs / "state"),
    )  # fmt: skip


FAILS = {"agree": "passed", "diverge_expected": "passed", "diverge_unexpected": "failed", "improved": "failed",
         "not_comparable": "skipped"}  # fmt: skip


@pytest.mark.parametrize("how", ["serial", "parallel"])
def test_every_pair_has_an_item_with_the_verdict_of_equilux_run(judged: dict, how: str, request: pytest.FixtureRequest):
    made: Session = request.getfixturevalue(how)
    expected = {
        (case["case"], f"{pair['a']}--{pair['b']}"): (FAILS[pair["judged"]], pair["judged"])
        for case in judged["cases"]
        for pair in case["pairs"]
    }
    got = {
        tuple(nodeid.split("::")[1:]): (outcome, properties["equilux.result"])
        for nodeid, (outcome, _, properties) in made.items.items()
        if not {"raising", "absent"} & set(nodeid.split("::")[-1].split("--"))
        and not (nodeid.split("::")[1].startswith("swept") and "matte" in nodeid)
    }
    assert got == expected, made.out
    assert {judgement for _, judgement in got.values()} == {"agree", "diverge_expected", "diverge_unexpected", "improved"}
    assert made.code == 1


@pytest.mark.parametrize("how", ["serial", "parallel"])
def test_a_renderer_that_fails_fails_its_items_and_one_that_lacks_a_feature_is_skipped(how: str, request: pytest.FixtureRequest):
    made: Session = request.getfixturevalue(how)
    outcome, text, _ = made.items["specs/pinned.scene.yaml::pinned::raising--oracle"]
    assert outcome == "failed"
    assert "pinned: raising failed: the adapter raised ZeroDivisionError: the renderer divided by zero" in text
    outcome, text, _ = made.items["specs/pinned.scene.yaml::pinned::absent--oracle"]
    assert (outcome, "pinned: absent missing: no such program: fake-renderer" in text) == ("failed", True), text
    lacking = {nodeid: outcome for nodeid, (outcome, _, _) in made.items.items() if "swept" in nodeid and "matte" in nodeid}
    assert lacking == {f"specs/more/swept.scene.yaml::swept[exponent={p}]::matte--oracle": "skipped" for p in (1, 10)}
    assert "matte unsupported: cannot express material.specular" in made.items[min(lacking)][1]


def test_parallel_and_serial_sessions_have_the_same_items_and_texts(serial: Session, parallel: Session):
    def comparable(made: Session, out: str) -> dict[str, tuple[str, str]]:
        return {nodeid: (outcome, text.replace(out, "OUT")) for nodeid, (outcome, text, _) in made.items.items()}

    assert comparable(serial, "serial") == comparable(parallel, "parallel")


@pytest.mark.parametrize("how", ["serial", "parallel"])
def test_the_session_leaves_the_results_tree_of_equilux_run(
    judged: dict, specs: Path, how: str, request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch
):
    request.getfixturevalue(how)
    results = json.loads((specs / how / "results.json").read_text())
    standing = {(case["case"], pair["a"], pair["b"]): pair["judged"] for case in results["cases"] for pair in case["pairs"]}
    assert standing == {
        (case["case"], pair["a"], pair["b"]): pair["judged"] for case in judged["cases"] for pair in case["pairs"]
    }
    assert results["summary"]["exit_code"] == judged["summary"]["exit_code"] == 3
    assert {path.name for path in (specs / how).iterdir()} == {"run.json", "results.json", "junit.xml", "summary.md", "cases"}
    monkeypatch.chdir(specs)
    assert run_command(["explain", how, "pinned", "good", "oracle"]) == 0


def test_several_processes_render_a_scene_once(parallel: Session, specs: Path):
    assert (specs / "state/good.renders").read_text() == "x" * 4  # four cases


def test_a_failure_alone_says_what_to_fix_and_where_to_look(serial: Session):
    outcome, text, _ = serial.items["specs/more/swept.scene.yaml::swept[exponent=1]::good--oracle"]
    assert outcome == "failed"
    for words in (
        "swept[exponent=1]: good against oracle", "worst pixel: (", "uncertainty of both B = ", "E_n = ",
        "specs/more/swept.scene.yaml:2", "program given to good: serial/cases/swept[exponent=1]/good/program/scene.txt",
        "equilux explain serial 'swept[exponent=1]' good oracle", "equilux report serial",
    ):  # fmt: skip
        assert words in text, text
    assert "Traceback" not in text
    assert "pytest_plugin" not in text
    outcome, text, _ = serial.items["specs/gone.scene.yaml::gone::reference--oracle"]
    assert (outcome, "gone.scene.yaml:14:5: reference: scaled no longer holds: remove it" in text) == ("failed", True), text


def test_the_summary_line_of_a_failure_says_what_is_wrong(serial: Session):
    line = "FAILED specs/gone.scene.yaml::gone::reference--oracle - gone: reference agrees"
    assert line in serial.out


def test_an_expected_divergence_passes_and_its_cause_is_a_property(serial: Session, specs: Path):
    outcome, _, properties = serial.items["specs/pinned.scene.yaml::pinned::good--oracle"]
    assert (outcome, properties["equilux.expected_cause"]) == ("passed", f"good: {RAMP}")
    found = {(each.get("name"), each.get("value")) for each in ET.parse(specs / "pytest.xml").iter("property")}
    assert ("equilux.expected_cause", f"good: {RAMP}") in found


# --- one small session each -------------------------------------------------------------------------------------------


def test_an_item_can_be_run_again_by_its_name_and_its_failure_names_the_cause(tmp_path: Path):
    """A real renderer with a real departure; what the chosen items do not need is not rendered."""
    sweep = "sweep:\n  exponent: {path: materials.clay.exponent, values: [1, 300]}"
    ball = write_scene(tmp_path / "specs/ball.scene.yaml", "ball", specular=0.5, rest=sweep)
    ball.write_text(ball.read_text().replace("{width: 8, height: 6}", "{width: 32, height: 24}"))  # the highlight is small
    write_scene(tmp_path / "specs/plain.scene.yaml", "plain")
    chosen = ["specs/ball.scene.yaml::ball[exponent=300]::vtk--oracle", "specs/plain.scene.yaml::plain::reference--oracle"]
    made = session(tmp_path, *chosen, "--equilux-adapters", "vtk,good")
    assert {nodeid: outcome for nodeid, (outcome, _, _) in made.items.items()} == {chosen[0]: "failed", chosen[1]: "passed"}
    text = made.items[chosen[0]][1]
    for words in ("exponent-clamped [128]", "K_spec max(0, R·V)^p", "E_n = ", "ball[exponent=300]/vtk/program/"):
        assert words in text, text
    results = json.loads((tmp_path / "equilux-out/results.json").read_text())
    rendered = {case["case"]: sorted(case["renders"]) for case in results["cases"]}
    assert rendered == {"ball[exponent=300]": ["oracle", "reference", "vtk"], "plain": ["oracle", "reference"]}


def test_a_session_without_scenes_loads_nothing_of_equilux(tmp_path: Path):
    (tmp_path / "test_light.py").write_text(
        "import sys\ndef test_nothing_is_loaded():\n"
        "    assert not {'numpy', 'pydantic', 'cyclopts', 'equilux.plan', 'equilux_scenes'} & set(sys.modules)\n"
    )
    made = session(tmp_path)
    assert [outcome for outcome, _, _ in made.items.values()] == ["passed"], made.out


@pytest.fixture
def here(pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> pytest.Pytester:
    """Sessions in this process, which see few adapters; one scene in `specs/`."""
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")  # other people's plugins only take time here
    monkeypatch.setattr(Registry, "discover", classmethod(lambda cls: registry("good", "absent", "matte", "reference")))
    write_scene(pytester.path / "specs/plain.scene.yaml", "plain")
    return pytester


def listed(here: pytest.Pytester, *arguments: str) -> tuple[int, list[str], str]:
    """Exit code, node ids and output of a session that only collects."""
    alone = ("-p", "no:cacheprovider", "-p", "xdist", "-p", "equilux.pytest_plugin")
    made = here.runpytest_inprocess("--collect-only", "-q", *alone, *arguments)
    text = made.stdout.str() + made.stderr.str()
    return int(made.ret), [line for line in made.outlines if f"{SUFFIX}::" in line], text


def test_without_names_every_adapter_found_takes_part(here: pytest.Pytester):
    code, items, _ = listed(here, "specs")
    pairs = ["absent--oracle", "good--matte", "good--oracle", "good--reference", "matte--oracle", "matte--reference"]
    assert (code, [item.rpartition("::")[2] for item in items]) == (0, ["absent--oracle", "good--oracle", "good--reference",
            "matte--good", "matte--oracle", "matte--reference", "reference--oracle"]), pairs  # fmt: skip


def test_items_of_a_scene_are_one_group_of_xdist(here: pytest.Pytester):
    (here.path / "conftest.py").write_text(
        "def pytest_collection_modifyitems(items):\n    print({item.get_closest_marker('xdist_group').args for item in items})\n"
    )
    assert "{('plain',)}" in listed(here, "specs", "-s", "--strict-markers")[2]


def test_every_error_of_every_spec_is_shown_without_a_traceback(here: pytest.Pytester):
    write_scene(here.path / "specs/wrong.scene.yaml", "wrong", specular=-1, rest="backgruond: 1")
    write_scene(here.path / "specs/zz.scene.yaml", "plain")
    code, _, text = listed(here, "specs", "--equilux-adapters", "good")
    assert code == pytest.ExitCode.INTERRUPTED, text
    for words in (
        "specs/wrong.scene.yaml:10:", "specs/wrong.scene.yaml:13:1: ", "did you mean 'background'?",
        "specs/zz.scene.yaml:2:7: name of the scene: got 'plain'",
    ):  # fmt: skip
        assert words in text, text
    assert "Traceback" not in text


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--equilux-adapters", "gud"], "--equilux-adapters: unknown adapter 'gud'"),
        (["--equilux-adapters", "good", "--equilux-set", "good.levle=1"], "--equilux-set: unknown knob 'good.levle'"),
        (["--equilux-adapters", "good", "--equilux-timeout", "soon"], "--equilux-timeout: got soon, expected a number of"),
        (["--equilux-adapters", "good", "--equilux-out", "specs"], "--equilux-out: 'specs' holds 'plain.scene.yaml'"),
    ],
)
def test_bad_usage_is_said_once(here: pytest.Pytester, arguments: list[str], says: str):
    write_scene(here.path / "specs/second.scene.yaml", "second")
    got, items, text = listed(here, "specs", *arguments)
    assert (got, items) == (2, []), text
    assert text.count(says) == 1, text


def test_a_filter_leaves_the_cases_that_match(here: pytest.Pytester):
    write_scene(here.path / "specs/second.scene.yaml", "second")
    _, items, text = listed(here, "specs", "--equilux-case-filter", "sec*", "--equilux-adapters", "good")
    assert {item.split("::")[1] for item in items} == {"second"}
    assert "3/6 tests collected (3 deselected)" in text


def test_a_filter_that_matches_nothing_is_bad_usage(here: pytest.Pytester):
    code, _, text = listed(here, "specs", "--equilux-case-filter", "nothing", "--equilux-adapters", "good")
    assert (code, "--equilux-case-filter: 'nothing' matches none of the 1 cases" in text) == (4, True), text


@pytest.mark.parametrize(
    ("arguments", "found"),
    [
        ([], []),
        (["tests"], []),
        (["."], ["plain", "fixture"]),
        (["specs"], ["plain"]),
        (["tests/fixture.scene.yaml"], ["fixture"]),
        (["--equilux-adapters", "good"], ["fixture"]),
        (["-o", "equilux_collect=always"], ["fixture"]),
        (["specs", "-o", "equilux_collect=never"], []),
    ],
)
def test_scenes_are_collected_where_they_were_asked_for_and_nowhere_else(
    here: pytest.Pytester, arguments: list[str], found: list[str]
):
    """A fixture below testpaths is somebody's test material, unless it is named or adapters are given."""
    write_scene(here.path / "tests/fixture.scene.yaml", "fixture")
    (here.path / "pytest.ini").write_text("[pytest]\ntestpaths = tests\n")
    _, items, text = listed(here, *arguments)
    assert sorted({item.split("::")[1] for item in items}) == sorted(found), text
