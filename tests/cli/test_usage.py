"""Bad usage is answered with exit code 2 and one clear line: what, got, allowed, and the nearest known thing."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from equilux.cli import run_command
from support.engine import LABORATORIES, write_scene

BAD = [
    (["rnu"], ['Unknown command "rnu"', 'Did you mean "run"?', "equilux --help"]),
    (["run", "--jbos", "3"], ["Unknown option: --jbos", "Did you mean --jobs?", "equilux run --help"]),
    (["run", "--jobs"], ["--jobs requires an argument"]),
    (["run", "--jobs", "many"], ["--jobs", '"many"', "int"]),
    (["run", "--jobs", "0"], ["--jobs: got 0, expected an integer of at least 1"]),
    (["run", "--jobs", "1", "--jobs", "2"], ["--jobs specified multiple times"]),
    (["run", "--timeout", "0"], ["--timeout: got 0, expected a number of seconds above 0"]),
    (["run", "--timeout", "nan"], ["--timeout: got nan"]),
    (["run", "--memory", "-1"], ["--memory: got -1, expected a number of MiB above 0"]),
    (["run", "--adapters", "povary"], ["unknown adapter 'povary'", "reference", "did you mean 'povray'?"]),
    (["run", "--adapters", "good,,slow"], ["--adapters: got 'good,,slow', expected names separated by single commas"]),
    (["run", "--set", "level"], ["--set: got 'level', expected [ADAPTER.]KNOB=VALUE"]),
    (["run", "--adapters", "good", "--set", "good.levle=1"], ["unknown knob 'good.levle'", "did you mean 'level'?"]),
    (["run", "--adapters", "good", "--set", "gud.level=1"], ["'gud' of 'gud.level=1' is not among the adapters of this run"]),
    (["run", "--adapters", "good", "--set", "level=99"], ["good.level", '"99"', "less than or equal to 9"]),
    (["run", "--case-filter", "nothing"], ["--case-filter: 'nothing' matches none of the", "'*' and '?' are wild"]),
    (["run", "--limit", "pixel=1"], ["unknown limit 'pixel'", "did you mean 'pixels'?"]),
    (["run", "nowhere"], ["no such file or folder: 'nowhere'"]),
    (["run", "empty"], ["empty:1:1: folder without scenes, allowed a folder with files named *.scene.yaml"]),
    (["run", "--out", "full"], ["--out: 'full' holds 'photo.jpg' and is no results tree"]),
    (["run", "--plan", "--out", "full"], ["--out: 'full' holds 'photo.jpg' and is no results tree"]),
    (["run", "--out", "full/photo.jpg"], ["--out: 'full/photo.jpg' is a file, expected a folder"]),
    (["report"], ["report", "RUN"]),
    (["report", "full"], ["'full' is no results tree"]),
    (["report", "nowhere"], ["'nowhere' is no results tree"]),
    (["scenes", "shwo"], ['Unknown command "shwo"', 'Did you mean "show"?']),
    (["scenes", "show", "clay-bal"], ["'clay-bal' is neither a file nor a scene of the corpus", "did you mean 'clay-ball'?"]),
    (["scenes", "show", "full"], ["'full' is a folder; give one scene"]),
    (["scenes", "validate", "nowhere"], ["no such file or folder: 'nowhere'"]),
    (["adapters", "lits"], ['Unknown command "lits"', 'Did you mean "list"?']),
    (["adapters", "list", "all"], ["all"]),
    (["score", "nowhere", "image.exr"], ["no such file or folder: 'nowhere'"]),
    (["explain", "run", "case", "a", "b"], ["'run': no such folder"]),
    (["diff", "full", "full"], ["'full' is no results tree"]),
    (["run", "--accuracy", "0"], ["--accuracy: got 0, expected a number of largest radiances above 0"]),
    (["run", "--accuracy", "1e-3", "--preset", "fast"], ["--accuracy and --preset: got both, allowed one of them"]),
    (["run", "--preset", "fats"], ["--preset: got 'fats', allowed fast, balanced, exact"]),
    (["tradeoff", "--repeats", "2"], ["--repeats: got 2, expected an integer of at least 3"]),
    (["tradeoff", "--error", "-1"], ["--error: got -1, expected a number of largest radiances above 0"]),
    (["tradeoff", "--time", "nan"], ["--time: got nan, expected a number of seconds above 0"]),
    (["tradeoff", "--grid", "0"], ["--grid: got 0, expected an integer of at least 1"]),
    (["tradeoff", "--clock", "sun"], ["--clock", '"sun"', "wall"]),
    (["tradeoff", "--adapter", "povary"], ["--adapter: unknown adapter 'povary'", "did you mean 'povray'?"]),
    (["tradeoff", "--adapter", "oracle"], ["--adapter: the oracle is what errors are measured against"]),
    (["tradeoff", "nowhere"], ["no such file or folder: 'nowhere'"]),
    (["tradeoff", "--out", "full"], ["--out: 'full' holds 'photo.jpg' and is no measurement of 'equilux tradeoff'"]),
    (["tradeoff", "--out", "full/photo.jpg"], ["--out: 'full/photo.jpg' is a file, expected a folder"]),
    (["explian"], ['Unknown command "explian"', 'Did you mean "explain"?']),
]


@pytest.mark.parametrize(("arguments", "says"), BAD, ids=[" ".join(arguments) for arguments, _ in BAD])
def test_bad_usage_is_one_line_on_stderr_and_exit_code_2(
    elsewhere: Path, capfd: pytest.CaptureFixture[str], arguments: list[str], says: list[str]
):
    (elsewhere / "empty").mkdir()
    (elsewhere / "full").mkdir()
    (elsewhere / "full" / "photo.jpg").write_text("mine")
    code = run_command(arguments)
    out, err = capfd.readouterr()
    assert (code, out) == (2, ""), (code, out, err)
    assert err.count("\n") == 1, err
    assert "\x1b" not in err
    for text in says:
        assert text in err, f"{err!r} does not say {text!r}"
    assert sorted(path.name for path in elsewhere.iterdir()) == ["empty", "full"]


def test_every_error_of_every_file_is_reported_at_once_with_its_place_and_nothing_is_rendered(elsewhere: Path, equilux):
    good = elsewhere / "scenes" / "good.scene.yaml"
    good.parent.mkdir()
    write_scene(good, "fine")
    write_scene(good.with_name("a.scene.yaml"), "wrong-a", rest="backgruond: 1")
    write_scene(good.with_name("b.scene.yaml"), "wrong-b", specular=-1)
    said = equilux("run", "scenes", "--adapters", "good")
    lines = said.err.splitlines()
    assert (said.code, said.out, len(lines)) == (2, "", 2), said
    assert lines[0].startswith("scenes/a.scene.yaml:13:1: ")
    assert "did you mean 'background'?" in lines[0]
    assert lines[1].startswith("scenes/b.scene.yaml:10:")
    assert not (elsewhere / "equilux-out").exists()


def test_the_errors_of_a_spec_are_printed_as_a_list_with_json(elsewhere: Path, equilux):
    write_scene(elsewhere / "a.scene.yaml", "wrong", rest="backgruond: 1")
    for command in (["run"], ["scenes", "validate"], ["scenes", "list"]):
        said = equilux(*command, "a.scene.yaml", "--json")
        (error,) = json.loads(said.out)
        assert said.code == 2
        assert (error["file"], error["line"], error["column"]) == ("a.scene.yaml", 13, 1)
        assert said.err.startswith("a.scene.yaml:13:1: ")


def test_two_distributions_with_one_adapter_name_end_every_command_that_needs_adapters(
    tiny: Path, equilux, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.syspath_prepend(LABORATORIES.parent / "rival_laboratories")
    for command in (["adapters", "list"], ["run", tiny]):
        said = equilux(*command)
        assert (said.code, said.out) == (2, "")
        assert "two distributions register the adapter 'good': " in said.err


HELP = [[], ["--help"], ["run", "--help"], ["scenes"], ["adapters", "--help"], ["score", "--help"]]


@pytest.mark.parametrize("arguments", HELP)
def test_help_is_printed_to_stdout_and_is_no_error(equilux, arguments: list[str]):
    said = equilux(*arguments)
    assert (said.code, said.err) == (0, "")
    assert said.out.startswith("Usage: equilux")


def test_the_version_is_printed(equilux):
    import importlib.metadata

    assert equilux("--version").out == importlib.metadata.version("equilux") + "\n"


HEAVY = """
import sys
from equilux.cli import run_command
run_command(["run", "--help"])
heavy = {"numpy", "pydantic", "OpenImageIO", "psutil", "vtk", "equilux_tracer", "ruamel"} & set(sys.modules)
sys.exit(str(heavy) if heavy else 0)
"""


def test_help_needs_none_of_the_heavy_packages():
    done = subprocess.run([sys.executable, "-c", HEAVY], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_python_m_equilux_is_equilux(shell):
    said = shell("run", "--jbos", "3")
    assert (said.code, said.out, said.err.count("\n")) == (2, "", 1)
