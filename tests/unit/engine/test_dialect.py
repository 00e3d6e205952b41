"""What adapters declare, and which of it concerns a case."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from equilux.diagnose.catalogue import all_rules
from equilux.dialect import Declared, complaints_about, declared_dialect, dialect_on, told
from equilux.registry import Registry
from support.engine import scene

OURS = [entry for entry in Registry.discover().entries.values() if declared_dialect(entry.adapter)]


def on(dialect: list[Declared], **scene_options: Any) -> list[str]:
    (case,) = scene(**scene_options).cases
    return [str(applied) for applied in dialect_on(case, dialect, all_rules())]


def test_what_an_adapter_lacks_is_declared_by_that_unless_its_dialect_says_more():
    adapter = SimpleNamespace(
        dialect=(Declared("half-vector", quirk="Q1", models=("opengl",)),),
        lack_causes={
            "model.opengl": "half-vector",
            "model.raytraced": "occlusion-ignored",
            "material.specular": "highlight-missing",
        },
    )
    assert declared_dialect(adapter) == (
        Declared("half-vector", quirk="Q1", models=("opengl",)),
        Declared("occlusion-ignored", models=("raytraced",)),
        Declared("highlight-missing"),
    )
    assert declared_dialect(SimpleNamespace()) == declared_dialect(None) == ()


def test_a_rule_concerns_a_case_of_its_model_whose_picture_it_may_change():
    shiny = [Declared("exponent-clamped", 128.0), Declared("highlight-missing"), Declared("reflection-missing")]
    assert on(shiny, specular=0.5) == ["exponent-clamped[128]", "highlight-missing"]
    assert on(shiny) == []
    assert on([Declared("highlight-missing", models=("opengl",))], specular=0.5) == []
    assert on([Declared("highlight-missing", unless=("light.point",))], specular=0.5) == []
    assert on([Declared("nobodys:cause")], specular=0.5) == []


def test_a_parameter_that_depends_on_the_scene_stays_open():
    assert on([Declared("exponent-clamped")], specular=0.5) == ["exponent-clamped"]


def test_a_reading_that_the_cause_does_not_have_is_an_error_that_says_which_it_has():
    with pytest.raises(ValueError, match="dialect: highlight-missing has no reading 'at night', allowed ''"):
        on([Declared("highlight-missing", reading="at night")], specular=0.5)


@pytest.mark.parametrize(
    ("dialect", "said"),
    [
        ((Declared("exponent-clamped", 128),), []),
        (({"cause": "exponent-clamped"},), ["dialect holds a dict, expected Declared"]),
        ((Declared("exponent-clampt"),), ["dialect: no cause has the id 'exponent-clampt'"]),
        ("exponent-clamped", ["dialect is a str, expected a sequence of equilux.dialect.Declared"]),
        (None, ["dialect is a NoneType, expected a sequence of equilux.dialect.Declared"]),
    ],
)
def test_an_adapter_whose_dialect_is_none_is_told_so(dialect: Any, said: list[str]):
    assert complaints_about(dialect) == said


@pytest.mark.parametrize("entry", OURS, ids=lambda entry: entry.name)
def test_every_rule_that_our_adapters_declare_can_be_applied_in_the_reading_they_name(entry: Any):
    rules = all_rules()
    for declared in declared_dialect(entry.adapter):
        assert declared.cause in rules, declared.cause
        assert declared.reading in rules[declared.cause].readings, declared


def test_the_laboratories_with_rules_of_their_own_declare_them():
    assert {entry.name for entry in OURS} >= {"povray", "vtk", "opengl", "mitsuba"}


def test_a_dialect_is_told_in_words_to_readers_that_have_no_rules():
    limit, missing = told([Declared("exponent-clamped", 128.0, quirk="Q5"), Declared("acme:sparkle")], all_rules())
    assert (limit["parameter"], limit["quirk"]) == (128.0, "Q5")
    assert limit["formula"] == list(all_rules()["exponent-clamped"].formula)
    assert limit["words"] == all_rules()["exponent-clamped"].summary
    assert (missing["cause"], missing["words"], missing["formula"]) == ("acme:sparkle", "", None)


def test_the_reading_that_is_declared_is_the_formula_that_is_told():
    rule = all_rules()["refraction-missing"]
    reading = next(reading for reading in rule.readings if reading)
    (entry,) = told([Declared("refraction-missing", reading=reading)], all_rules())
    assert entry["formula"] == [rule.formula[0], rule.readings[reading]]
