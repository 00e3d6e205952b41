"""`equilux tradeoff`, as it is typed, and what `equilux run` makes of it."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import pytest

import equilux.tradeoff
from equilux.tradeoff.record import Presets, Tradeoff, json_schema
from support.engine import write_scene

SCHEMA_FILE = Path(equilux.tradeoff.__file__).with_name("tradeoff.schema.json")


@pytest.fixture
def lit(elsewhere: Path) -> Path:
    return write_scene(elsewhere / "tiny.scene.yaml", specular=0.5)


def measured(folder: str = "equilux-tradeoff") -> Tradeoff:
    return Tradeoff.model_validate_json((Path(folder) / "tradeoff.json").read_bytes())


def test_the_published_schema_is_that_of_the_code():
    expected = json.dumps(json_schema(), indent=1, ensure_ascii=False) + "\n"
    hint = "run: python -m equilux.tradeoff.record > harness/equilux/tradeoff/tradeoff.schema.json"
    assert SCHEMA_FILE.read_text() == expected, hint


def test_a_knob_that_trades_is_measured_and_its_fronts_answers_and_presets_follow(lit: Path, equilux):
    command = ("tradeoff", lit, "--adapter", "tunable", "--repeats", 3, "--no-features", "--presets", "p.json", "--page", "p.md")
    said = equilux(*command)
    assert said.code == 0, said
    found = measured()
    jsonschema.Draft202012Validator(json.loads(SCHEMA_FILE.read_text())).validate(json.loads(found.model_dump_json(by_alias=True)))
    (case,) = found.cases
    assert (case.case, case.truth) == ("tiny", "oracle")
    by_quality = {setting.knobs["quality"]: setting for setting in case.renderers["tunable"].settings}
    assert list(by_quality) == [2, 1, 3]
    for quality, setting in by_quality.items():
        assert setting.accuracy == pytest.approx(10.0**-quality, rel=1e-9)
        assert setting.times is not None
        assert setting.times.wall["total"].samples == 3
        assert set(setting.times.cpu) == {"translate", "render", "read", "total"}
        assert setting.times.cpu["total"].median > 0
        assert setting.pictures == 1
    assert by_quality[3].front
    assert found.start_up["tunable"].small_picture_wall.median > 0
    preset = Presets.model_validate_json(Path("p.json").read_bytes()).adapters["tunable"]
    assert preset.presets["fast"].knobs["quality"] in (2, 3)
    assert preset.presets["balanced"].rule.startswith("none reaches 0.0001")
    assert [rung.knobs["quality"] for rung in preset.ladder][-1] == 3
    assert "| tunable | `fast` |" in Path("p.md").read_text()
    assert "results: equilux-tradeoff/tradeoff.json" in said.out
    assert Path("equilux-tradeoff/report/tradeoff.html").is_file()
    assert sorted(path.name for path in Path("equilux-tradeoff").glob("*.svg")) == ["tiny-cpu.svg", "tiny-wall.svg"]
    assert equilux(*command).code == 0, "an earlier measurement's folder is taken again"


def test_what_is_asked_is_answered_and_the_exit_code_says_whether_anything_meets_it(lit: Path, equilux):
    command = ("tradeoff", lit, "--adapter", "tunable", "--repeats", 3, "--no-features", "--no-html")
    said = equilux(*command, "--error", "2e-2")
    assert said.code == 0
    assert "tunable: error ≤ 0.02: tunable, " in said.out
    said = equilux(*command, "--error", "1e-9", "--time", "60")
    assert said.code == 1
    assert "tunable: error ≤ 1e-09: no setting" in said.out
    assert "tunable: within 60 s: tunable, quality 3" in said.out


def test_a_renderer_that_fails_is_told_and_so_is_one_that_is_not_there(lit: Path, equilux):
    command = ("tradeoff", lit, "--repeats", 3, "--no-features", "--no-html", "--json")
    said = equilux(*command, "--adapter", "raising,tunable")
    assert said.code == 3
    trades = json.loads(said.out)["cases"][0]["renderers"]
    assert (trades["raising"]["status"], trades["tunable"]["status"]) == ("failed", "measured")
    assert "divided by zero" in trades["raising"]["reason"]
    said = equilux(*command, "--adapter", "absent,matte")
    assert said.code == 4
    trades = json.loads(said.out)["cases"][0]["renderers"]
    assert {name: trade["status"] for name, trade in trades.items()} == {"absent": "missing", "matte": "unsupported"}


def test_pictures_that_are_no_numbers_have_no_accuracy_and_are_counted_by_kind(lit: Path, equilux):
    equilux("tradeoff", lit, "--adapter", "nan", "--repeats", 3, "--no-features", "--no-html")
    (setting,) = measured().cases[0].renderers["nan"].settings
    assert setting.error is not None
    assert (setting.accuracy, setting.error.not_numbers) == (None, {"nan": 1})


def test_run_takes_the_accuracy_that_is_asked_and_the_summary_says_who_claims_it(lit: Path, equilux):
    said = equilux("run", lit, "--adapters", "tunable", "--accuracy", "5e-2", "--no-html", "--no-diagnose")
    assert "accuracy 0.05: tunable claims it on 1 of 1 picture; 1 of 1 hold against the truth" in said.out, said
    render = json.loads(Path("equilux-out/results.json").read_text())["cases"][0]["renders"]["tunable"]
    assert render["accuracy"]["met"] is True
    assert render["cpu_seconds"]["render"] >= 0
    assert equilux("run", lit, "--adapters", "tunable", "--preset", "fast", "--no-html", "--no-diagnose").code == 0
