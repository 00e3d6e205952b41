"""The page about causes says what the rules say, and there is a rule for every cause."""

from __future__ import annotations

import inspect
from pathlib import Path

import pytest

from equilux_scenes.causes import CAUSES
from equilux_tracer.causes import RULES, geometry, highlight, image, light, transport
from equilux_tracer.causes.table import TITLES, page

PAGE = Path(__file__).parents[3] / "docs" / "causes.md"
GROUPS = {"image": image, "geometry": geometry, "highlight": highlight, "light": light, "transport": transport}


def test_the_page_is_in_step_with_the_rules():
    assert PAGE.read_text(encoding="utf-8") == page(), "out of step: python -m equilux_tracer.causes.table > docs/causes.md"


def test_every_cause_but_unexplained_has_exactly_one_rule_in_the_order_of_the_ids():
    ids = [rule.id for group in GROUPS.values() for rule in group.RULES]
    assert ids == [cause for cause in CAUSES if cause != "unexplained"]


@pytest.mark.parametrize("rule", RULES.values(), ids=RULES)
def test_a_rule_documents_itself(rule):
    assert inspect.getdoc(type(rule)) != inspect.getdoc(type(rule).__mro__[1]), "no docstring of its own"
    assert all(rule.formula)
    assert rule.formula[0] != rule.formula[1]
    assert next(iter(rule.readings)) == ""
    if len(rule.readings) > 1:
        assert all(rule.readings.values())
    assert rule.group in TITLES
    assert rule in GROUPS[rule.group].RULES
