"""A dialect's page lists what is declared, each rule with its evidence, and nothing that changes from run to run."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest

from equilux import uncertainty
from equilux.adapter import Bound, Budget, Geometric
from equilux.cli import run_command
from equilux.diagnose.catalogue import all_rules
from equilux.diagnose.diagnosis import Diagnosis, Found
from equilux.diagnosing import save
from equilux.dialect import Declared, declared_dialect
from equilux.dialects.evidence import Evidence, gathered, with_fits
from equilux.dialects.page import page
from equilux.dialects.refit import budget_of
from equilux.readrun import ReadRun
from equilux.registry import Registry
from equilux.results import CaseRecord, Finding, RenderRecord, Results, RunRecord, Standing, summarise
from equilux_tracer.causes import Rule

DIALECT = (
    Declared("exponent-clamped", 128.0, quirk="Q5"),
    Declared("half-vector", models=("opengl",)),
    Declared("shadow-bias"),
    Declared("refraction-missing", reading="not bent", unless=("light.spot",)),
    Declared("mine:blur"),
)
PAGES = Path(__file__).parents[3] / "docs" / "dialects"


def case(name: str, finding: Finding | None) -> CaseRecord:
    standing = None if finding is None else Standing(finding=finding)
    renders = {"vtk": RenderRecord(status="ok", standing=standing)}
    return CaseRecord(case=name, scene=name, model="phong", width=4, height=3, requires=[], renders=renders, pairs=[])


def run(folder: Path, cases: Iterable[CaseRecord], diagnoses: dict[str, Diagnosis]) -> ReadRun:
    of_run = RunRecord(equilux="1.2.3", adapters={"vtk": "9.7"}, command=[], started="today", ended="today", seconds=1)
    records = list(cases)
    for name, diagnosis in diagnoses.items():
        (folder / "cases" / name / "vtk").mkdir(parents=True)
        save(diagnosis, folder / "cases" / name / "vtk")
    return ReadRun(folder, Results(run=of_run, cases=records, summary=summarise(records, 0)), {})


def diagnosis(*causes: Found) -> Diagnosis:
    return Diagnosis(adapter="vtk", diverging=9, explained=1.0, causes=causes)


@pytest.fixture
def evidence(tmp_path: Path) -> Evidence:
    clamped = Found(id="exponent-clamped", parameter=128.0, explained=1.0, residual_max_abs=1.25e-4, declared=True)
    scaled = Found(id="scaled", parameter=0.5, explained=0.25, recognised="1/2")
    left = Found(id="unexplained", explained=0.125, words="1 of 8 pixels")
    cases = [case("b", "model-difference"), case("a", "implementation-bug"), case("c", "as-modelled"), case("uncompared", None)]
    made = run(tmp_path, cases, {"b": diagnosis(clamped), "a": diagnosis(clamped, scaled, left)})
    return gathered(made, "vtk", "VTK", DIALECT)


def headings(text: str) -> list[str]:
    return re.findall(r"^## `(.+)`$", text, re.MULTILINE)


def test_the_page_lists_exactly_the_declared_rules_in_their_order(evidence: Evidence):
    assert headings(page(evidence, all_rules())) == [declared.cause for declared in DIALECT]


def test_a_rule_comes_with_its_formula_its_parameter_and_the_cases_it_was_proven_on(evidence: Evidence):
    text = page(evidence, all_rules())
    model, instead = all_rules()["exponent-clamped"].formula
    assert f"| the model | {model} |\n| VTK | {instead} |\n| max | 128 |\n" in text
    assert "| `a` (with others) | 128 | 100 % | 0.000125 |\n| `b` | 128 | 100 % | 0.000125 |\n" in text
    assert "Fact Q5 of the adapter's `QUIRKS.md`." in text


def test_models_and_features_that_limit_a_rule_and_its_reading_are_said(evidence: Evidence):
    text = page(evidence, all_rules())
    assert "In scenes of model `opengl`." in text
    assert "Not in scenes with `light.spot`." in text
    assert all_rules()["refraction-missing"].readings["not bent"] in text
    assert "| length | depends on the scene |" in text


def test_what_was_declared_and_not_seen_and_what_was_found_and_not_declared_is_said(evidence: Evidence):
    text = page(evidence, all_rules())
    assert text.count("Declared, and seen on no case of this run.") == 4
    assert "## Found and not declared\n\n| case | cause | explained |\n| --- | --- | --- |\n| `a` | scaled [0.5" in text
    assert "## What no rule accounts for" in text
    assert "| `a` | 12.5 % | 1 of 8 pixels |" in text
    assert "No rule can be applied for this cause." in text


def test_the_head_says_which_run_and_how_its_cases_stand(evidence: Evidence):
    text = page(evidence, all_rules())
    assert text.startswith("# What VTK's Phong is\n")
    assert "equilux 1.2.3 with VTK 9.7" in text
    assert "of 3 cases 1 agree with the truth, 1 depart from it exactly as declared here and 1 depart" in text
    assert "Of the 18 pixels that diverge from it, 100 % carry a proven cause." in text


def test_the_page_holds_no_date_and_no_folder(evidence: Evidence, tmp_path: Path):
    text = page(evidence, all_rules())
    assert "today" not in text
    assert str(tmp_path) not in text


def test_the_command_writes_a_page_for_each_adapter_of_the_run_that_declares_a_dialect(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    made = run(tmp_path / "run", [case("a", "as-modelled")], {"a": diagnosis()})
    (tmp_path / "run" / "results.json").write_text(made.results.model_dump_json(by_alias=True))
    (tmp_path / "run" / "run.json").write_text('{"schema": "equilux/run/1"}')
    assert run_command(["dialects", str(tmp_path / "run"), "--out", str(tmp_path / "pages")]) == 0
    assert [path.name for path in (tmp_path / "pages").iterdir()] == ["vtk.md"]
    assert capsys.readouterr().out == f"{tmp_path / 'pages' / 'vtk.md'}\n"


@pytest.mark.parametrize("name", ["povray", "vtk", "opengl", "mitsuba"])
def test_the_published_page_lists_exactly_what_the_adapter_declares(name: str):
    declared = declared_dialect(Registry.discover().entries[name].adapter)
    assert headings((PAGES / f"{name}.md").read_text()) == [rule.cause for rule in declared], "run: equilux dialects RUN"


def test_a_number_is_found_anew_where_the_rule_is_the_only_cause(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    clamped = Found(id="exponent-clamped", parameter=128.0, explained=1.0, declared=True)
    made = run(
        tmp_path,
        [case("alone", "model-difference"), case("both", "model-difference")],
        {"alone": diagnosis(clamped), "both": diagnosis(clamped, Found(id="half-vector", declared=True))},
    )
    asked: list[tuple[str, str]] = []

    def refitted(_: ReadRun, record: CaseRecord, adapter: str, rule: Rule) -> Found:
        asked.append((record.case, rule.id))
        return Found(id=rule.id, parameter=128.03)

    monkeypatch.setattr("equilux.dialects.refit.refitted", refitted)
    evidence = gathered(made, "vtk", "VTK", DIALECT)
    with_fits(evidence, made, all_rules())
    assert asked == [("alone", "exponent-clamped")]
    text = page(evidence, all_rules())
    assert "| case | parameter | fitted | explained |" in text
    assert "| `alone` | 128 | 128.03 | 100 % |" in text
    assert "| `both` (with others) | 128 |  | 100 % |" in text


def test_a_budget_is_read_back_from_what_render_json_says_of_it():
    image = np.full((2, 2, 3), 0.5, np.float32)
    budget = Budget(
        (
            Bound("b", "why", abs=1e-3, rel=1e-4),
            Geometric("g", "why", normal={1: 0.5}, position_m=0.25, film_px=0.1),
            Bound("storage", "why", rel=2.0**-24),
        )
    )
    terms = uncertainty.stated(budget, image).to_json()["terms"]
    assert budget_of(terms) == budget
    assert budget_of(uncertainty.stated(Budget((Bound("map", "why", abs=image),)), image).to_json()["terms"]) is None
