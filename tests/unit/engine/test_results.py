"""results.json and run.json say what is documented, and nothing that JSON cannot say."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import pytest

import equilux
from equilux.results import Results, json_schema, summarise
from equilux.tree import read_json
from support.engine import only_case, run, scene

SCHEMA_FILE = Path(equilux.__file__).with_name("results.schema.json")


def test_the_published_schema_is_that_of_the_code():
    expected = json.dumps(json_schema(), indent=1, ensure_ascii=False) + "\n"
    assert SCHEMA_FILE.read_text() == expected, "run: python -m equilux.results > harness/equilux/results.schema.json"


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    from support.engine import LABORATORIES

    folder = tmp_path_factory.mktemp("results")
    rest = (
        "sweep:\n  glow: {path: materials.clay.emission, values: [0, 0.5]}\n"
        'expect:\n  - {adapter: bright, cause: scaled, when: "glow > 0.1"}'
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(LABORATORIES)
        names = ("good", "bright", "nan", "absent", "matte", "reference")
        finished = run(folder / "run", *names, scenes=[scene(specular=0.5, rest=rest)])
    assert finished.errors == ()
    return folder / "run"


def test_what_is_written_is_valid_under_the_published_schema(tree: Path):
    results = read_json(tree / "results.json")
    jsonschema.Draft202012Validator(json.loads(SCHEMA_FILE.read_text())).validate(results)
    assert Results.model_validate(results).schema_ == "equilux/results/1"


def test_the_contracts_fields_are_there_by_name(tree: Path):
    results = read_json(tree / "results.json") or {}
    case = results["cases"][1]
    assert (case["case"], case["scene"], case["model"]) == ("tiny[glow=0.5]", "tiny", "phong")
    assert {"light.point", "material.emission"} <= set(case["requires"])
    render = case["renders"]["good"]
    assert {"start", "render", "read"} <= set(render["seconds"])
    assert render["uncertainty"]["rel"] == 2.0**-24
    assert case["renders"]["matte"]["missing_features"] == ["material.specular"]
    (pair,) = [pair for pair in case["pairs"] if (pair["a"], pair["b"]) == ("bright", "oracle")]
    counts = ["a", "b", "verdict", "expected", "pixels", "agree", "diverge", "edge", "invalid"]
    statistics = ["max_abs", "max_rel", "rms", "bias", "p50", "p95", "p99", "edge_max_abs"]
    assert {*counts, *statistics, "flip", "worst", "explained", "causes"} <= set(pair)
    assert (pair["pixels"], pair["explained"], pair["causes"], pair["flip"]) == (48, None, [], None)
    assert set(pair["worst"]) == {"x", "y", "a", "b"}


def test_the_more_trusted_side_is_b(tree: Path):
    pairs = {(pair["a"], pair["b"]) for pair in (read_json(tree / "results.json") or {})["cases"][0]["pairs"]}
    assert pairs == {
        ("reference", "oracle"), ("bright", "oracle"), ("good", "oracle"), ("nan", "oracle"), ("bright", "reference"),
        ("good", "reference"), ("nan", "reference"), ("good", "bright"), ("nan", "bright"), ("nan", "good"),
    }  # fmt: skip


def test_the_summary_counts_what_the_cases_hold(tree: Path):
    results = Results.model_validate(read_json(tree / "results.json"))
    assert results.summary == summarise(results.cases, results.summary.exit_code)
    assert results.summary.renders.model_dump() == {
        "ok": 8, "unsupported": 2, "missing": 2, "timeout": 0, "crashed": 0, "failed": 0, "invalid": 2,
    }  # fmt: skip
    assert sum(results.summary.pairs.model_dump().values()) == 20
    assert results.summary.expectations_used == 1
    # bright against good, nan, oracle, reference in the case where it is expected; nan's pixel is never expected
    assert results.summary.pairs.diverge_expected == 3


def test_expectations_are_named_with_the_case_they_apply_to(tree: Path):
    cold, glowing = Results.model_validate(read_json(tree / "results.json")).cases
    (used,) = glowing.expect
    assert used.model_dump() == {"adapter": "bright", "cause": "scaled", "when": "glow > 0.1", "held": True}
    assert cold.expect == []


def test_the_manifest_says_what_it_was_made_with_and_names_no_folder_of_this_machine(tree: Path):
    manifest = read_json(tree / "run.json") or {}
    assert manifest["schema"] == "equilux/run/1"
    assert manifest["adapters"]["good"]["version"] == "fake 1.0"
    assert manifest["adapters"]["good"]["knobs"] == {"level": 1}
    assert manifest["adapters"]["absent"]["detail"] == "no such program: fake-renderer"
    assert manifest["clock"]["seconds"] > 0
    assert manifest["libraries"]["numpy"]
    assert manifest["machine"]["cores"] >= 1
    assert str(tree.parent) not in json.dumps(manifest)


def test_every_render_has_a_record_even_one_that_never_ran(tree: Path):
    for adapter, status in {"good": "ok", "absent": "missing", "matte": "unsupported", "nan": "invalid"}.items():
        record = read_json(tree / "cases" / "tiny[glow=0]" / adapter / "render.json") or {}
        assert (record["schema"], record["status"], record["adapter"]) == ("equilux/render/1", status, adapter)


def test_the_program_is_kept_as_it_was_given(tree: Path):
    folder = tree / "cases" / "tiny[glow=0]" / "good"
    record = read_json(folder / "render.json") or {}
    assert record["program"]["files"] == ["lib/colours.txt", "scene.txt"]
    assert record["program"]["entry"] == "scene.txt"
    assert (folder / "program" / "scene.txt").read_text() == "ramp 8 6 1\n"


def test_a_scene_without_a_file_has_none(tree: Path):
    assert Results.model_validate(read_json(tree / "results.json")).cases[0].scene_file is None


def test_nothing_to_render_scores_nothing(tmp_path: Path):
    finished = run(tmp_path / "run", "matte", scenes=[scene(specular=0.5)])
    assert finished.exit_code == 4
    assert only_case(finished).renders["matte"].status == "unsupported"
