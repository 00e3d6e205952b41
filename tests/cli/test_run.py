"""`equilux run`, as it is typed."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import jsonschema
import pytest

from equilux.results import json_schema
from support.engine import LABORATORIES, write_scene

PINNED = "expect:\n  - {adapter: good, cause: 'fakes:ramp'}"
"""The fake laboratories paint a ramp; against the real truths that diverges."""

BARE = ("--no-html", "--no-diagnose")
"""Where neither the report nor causes are the point."""


def results(folder: str = "equilux-out") -> dict:
    return json.loads((Path(folder) / "results.json").read_text())


@pytest.mark.parametrize(
    ("adapters", "specular", "rest", "code"),
    [
        ("reference,oracle", 0, "", 0),
        ("good", 0, PINNED, 0),
        ("good", 0, "", 1),
        ("reference", 0, "expect:\n  - {adapter: reference, cause: scaled}", 1),
        ("raising", 0, "", 3),
        ("absent", 0, "", 3),
        ("good,segfaulting", 0, PINNED, 3),
        ("matte", 0.5, "", 4),
        ("nan", 0, "expect:\n  - {adapter: nan, cause: 'fakes:ramp'}", 1),
    ],
)
def test_the_exit_code_says_how_it_went(tiny: Path, equilux, adapters: str, specular: float, rest: str, code: int):
    write_scene(tiny, specular=specular, rest=rest)
    said = equilux("run", tiny, "--adapters", adapters, *BARE)
    assert said.code == code, said
    assert results()["summary"]["exit_code"] == code


def test_a_divergence_that_nobody_pinned_is_shown_with_its_numbers(tiny: Path, equilux):
    said = equilux("run", tiny, "--adapters", "good", *BARE)
    assert "tiny: good diverges from oracle: 48 of 48 pixels, largest difference" in said.out
    assert "results: equilux-out/results.json" in said.out


def test_a_pinned_divergence_that_is_gone_says_what_to_remove(tiny: Path, equilux):
    write_scene(tiny, rest="expect:\n  - {adapter: reference, cause: scaled}")
    said = equilux("run", tiny, "--adapters", "reference", *BARE)
    assert "tiny: reference agrees with oracle, but the scene expects it to diverge (scaled): remove the expectation" in said.out


def test_the_truths_that_were_not_named_are_added_and_stderr_says_so(tiny: Path, equilux):
    said = equilux("run", tiny, "--adapters", "good", *BARE)
    assert said.err.startswith("added oracle and reference: there is always a truth to judge against\n")
    assert set(results()["cases"][0]["renders"]) == {"good", "oracle", "reference"}


def test_without_names_every_installed_adapter_takes_part_and_a_missing_one_is_no_failure(tiny: Path, equilux):
    said = equilux("run", tiny, "--plan", "--json")
    plan = {render["adapter"]: render["action"] for render in json.loads(said.out)}
    assert {"good": "run", "absent": "missing", "reference": "run", "oracle": "run"}.items() <= plan.items()
    assert (said.code, said.err) == (0, "")


def test_a_plan_renders_nothing_and_touches_nothing(tiny: Path, equilux, elsewhere: Path):
    write_scene(tiny, specular=0.5)
    said = equilux("run", tiny, "--adapters", "matte,absent", "--plan")
    assert said.code == 0
    lines = [line.split(None, 3) for line in said.out.splitlines()]
    assert ["tiny", "matte", "unsupported", "cannot express material.specular"] in lines
    assert ["tiny", "absent", "missing", "no such program: fake-renderer"] in lines
    assert "1 case, 2 of 4 renders would run" in said.out
    assert [path.name for path in elsewhere.iterdir()] == ["tiny.scene.yaml"]


def test_as_is_renders_what_lacks_a_feature(tiny: Path, equilux):
    write_scene(tiny, specular=0.5)
    assert equilux("run", tiny, "--adapters", "matte", *BARE, "--as-is").code == 1
    assert results()["cases"][0]["renders"]["matte"]["status"] == "ok"


def test_json_on_stdout_is_results_json_and_nothing_else(tiny: Path, equilux):
    said = equilux("run", tiny, "--adapters", "good,nan", *BARE, "--json")
    printed = json.loads(said.out)
    assert printed == results()
    jsonschema.Draft202012Validator(json_schema()).validate(printed)


def test_progress_off_a_terminal_is_plain_lines_on_stderr(tiny: Path, equilux):
    said = equilux("run", tiny, "--adapters", "good,raising", *BARE)
    assert "tiny: raising failed: the adapter raised ZeroDivisionError: the renderer divided by zero\n" in said.err
    assert "[1/1] tiny: good ok, oracle ok, raising failed, reference ok; pairs: 1 agree, 2 diverge unexpectedly\n" in said.err
    assert "\x1b" not in said.err + said.out


def test_a_sweep_is_filtered_by_case_and_knobs_are_set(tiny: Path, equilux):
    write_scene(tiny, specular=0.5, rest="sweep:\n  exponent: {path: materials.clay.exponent, values: [1, 10, 100]}")
    wanted = ("--case-filter", "*=10*", "--set", "level=2", "--out", "some/where")
    equilux("run", tiny, "--adapters", "good", *wanted, *BARE)
    assert [case["case"] for case in results("some/where")["cases"]] == ["tiny[exponent=10]", "tiny[exponent=100]"]
    record = json.loads(Path("some/where/cases/tiny[exponent=10]/good/render.json").read_text())
    assert record["knobs"] == {"level": 2}


def test_the_second_run_is_made_of_reused_renders_and_no_reuse_makes_them_anew(tiny: Path, equilux):
    equilux("run", tiny, "--adapters", "good", *BARE)
    again = equilux("run", tiny, "--adapters", "good", *BARE)
    assert "(3 ok, 3 reused)" in again.out
    anew = equilux("run", tiny, "--adapters", "good", *BARE, "--no-reuse")
    assert "(3 ok)" in anew.out
    assert Path(".cache/renders").is_dir()


def test_the_report_is_built_and_its_path_printed(tiny: Path, equilux):
    said = equilux("run", tiny, "--adapters", "good")
    assert "report: equilux-out/report/index.html\n" in said.out
    assert Path("equilux-out/report/index.html").is_file()
    Path("equilux-out/report/index.html").unlink()
    rebuilt = equilux("report", "equilux-out")
    assert (rebuilt.code, rebuilt.out) == (0, "equilux-out/report/index.html\n")
    assert Path("equilux-out/report/index.html").is_file()


def test_a_report_that_would_overwrite_or_show_nothing_is_bad_usage(tiny: Path, equilux, elsewhere: Path):
    equilux("run", tiny, "--adapters", "reference", *BARE)
    (elsewhere / "full").mkdir()
    (elsewhere / "full" / "photo.jpg").write_text("mine")
    for arguments in (["--out", "full"], ["--case-filter", "nothing"]):
        said = equilux("report", "equilux-out", *arguments)
        assert (said.code, said.out, said.err.count("\n")) == (2, "", 1), said
    assert [path.name for path in (elsewhere / "full").iterdir()] == ["photo.jpg"]


def test_an_adapter_that_cannot_be_loaded_fails_when_it_is_run(tiny: Path, equilux, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.syspath_prepend(LABORATORIES.parent / "broken_laboratories")
    said = equilux("run", tiny, "--adapters", "outdated", *BARE)
    assert said.code == 3
    render = results()["cases"][0]["renders"]["outdated"]
    assert (render["status"], "api_version is 99" in render["reason"]) == ("failed", True)


def test_a_worker_survives_a_stray_module_in_the_working_folder(tiny: Path, elsewhere: Path):
    (elsewhere / "numpy.py").write_text("raise SystemExit('stray')\n")
    (elsewhere / "json.py").write_text("raise SystemExit('stray')\n")
    command = [sys.executable, "-P", "-m", "equilux", "run", str(tiny), "--adapters", "good", *BARE]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 1, done.stderr


def test_a_limit_on_time_is_kept(tiny: Path, equilux):
    said = equilux("run", tiny, "--adapters", "hanging", "--timeout", "0.3", *BARE)
    assert said.code == 3
    assert results()["cases"][0]["renders"]["hanging"]["status"] == "timeout"
