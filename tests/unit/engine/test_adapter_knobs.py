"""What every installed adapter declares of its knobs: range, direction, and steps worth trying."""

from __future__ import annotations

import itertools
from typing import Any

import pytest

from equilux.registry import Registry

ADAPTERS = {name: entry.adapter for name, entry in Registry.discover().entries.items() if entry.distribution == "equilux"}
SETTINGS = [
    (name, knob) for name, adapter in ADAPTERS.items() if adapter is not None for knob in adapter.Knobs.model_fields
]  # fmt: skip
HOW_FAST_ONLY = {"threads"}
"""Knobs that leave the picture as it is: nothing to sweep."""


def declared(adapter: str, knob: str) -> dict[str, Any]:
    extra = ADAPTERS[adapter].Knobs.model_fields[knob].json_schema_extra  # type: ignore[union-attr]
    assert isinstance(extra, dict), f"{adapter}.{knob} declares nothing of its trade"
    return extra


def default(adapter: str, knob: str) -> Any:
    return ADAPTERS[adapter].Knobs.model_fields[knob].default  # type: ignore[union-attr]


@pytest.mark.parametrize(("adapter", "knob"), SETTINGS)
def test_a_knob_says_which_way_is_faster_and_what_it_is(adapter: str, knob: str):
    faster = declared(adapter, knob)["faster"]
    assert faster in ("smaller", "larger") or (isinstance(faster, list) and faster), f"{adapter}.{knob}: faster is {faster!r}"
    schema = ADAPTERS[adapter].Knobs.model_json_schema()["properties"][knob]  # type: ignore[union-attr]
    assert schema["description"]
    parts = schema.get("anyOf", [schema])
    assert all(
        {"enum", "const"} & set(part) or ({"minimum", "exclusiveMinimum"} & set(part) and "maximum" in part) for part in parts
    ), f"{adapter}.{knob} has no range: {schema}"


@pytest.mark.parametrize(("adapter", "knob"), [(name, knob) for name, knob in SETTINGS if knob not in HOW_FAST_ONLY])
def test_a_knob_has_steps_within_its_range_fastest_first_with_its_default(adapter: str, knob: str):
    extra, model = declared(adapter, knob), ADAPTERS[adapter].Knobs  # type: ignore[union-attr]
    steps = extra["steps"]
    assert len(steps) >= 2
    assert default(adapter, knob) in steps, f"{adapter}.{knob}: default {default(adapter, knob)} is not among {steps}"
    for step in steps:
        taken = getattr(model.model_validate({knob: step}), knob)
        as_text = getattr(model.model_validate({knob: str(step)}), knob)
        assert (taken, as_text) == (step, step), f"{adapter}.{knob}: {step} becomes {taken}, as text {as_text}"
    if isinstance(extra["faster"], list):
        assert steps == [value for value in extra["faster"] if value in steps]
        return
    numbers = [step for step in steps if not isinstance(step, str)]
    sign = 1 if extra["faster"] == "smaller" else -1
    assert all(sign * a < sign * b for a, b in itertools.pairwise(numbers)), f"{adapter}.{knob}: {steps} is not fastest first"
    # a word stands for what the scene itself asks for: the most accurate
    assert steps[: len(numbers)] == numbers


def test_the_sampled_uncertainty_of_every_step_of_mitsubas_repeats_can_be_judged_by():
    from equilux.uncertainty import MINIMUM_REPEATS

    assert min(declared("mitsuba", "repeats")["steps"]) >= MINIMUM_REPEATS
