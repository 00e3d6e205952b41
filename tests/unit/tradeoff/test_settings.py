"""Which settings are measured: all combinations where they are few, else every knob alone and all together; none in silence."""

from __future__ import annotations

from pydantic import Field

from equilux.adapter import Knobs
from equilux.knobs import steps_of
from equilux.registry import Registry
from equilux.tradeoff.settings import sweep_of


class Two(Knobs):
    facets: int = Field(default=64, ge=8, json_schema_extra={"faster": "smaller", "steps": [16, 64, 256]})
    target: float = Field(default=1e-3, json_schema_extra={"faster": "larger", "steps": [1e-1, 1e-3]})
    threads: int = Field(default=0, json_schema_extra={"faster": "larger"})


class Nothing(Knobs):
    threads: int = 0


def labels(**given: int) -> list[str]:
    return [setting.label for setting in sweep_of(Two, **given).settings]


def test_knobs_without_steps_are_not_swept():
    assert steps_of(Two) == {"facets": [16, 64, 256], "target": [0.1, 0.001]}
    assert sweep_of(Nothing).settings[0].knobs == {}
    assert sweep_of(Nothing).combinations == 1


def test_few_combinations_are_all_measured_the_default_first():
    sweep = sweep_of(Two)
    assert (sweep.kind, sweep.combinations, len(sweep.settings)) == ("grid", 6, 6)
    assert sweep.settings[0].is_default


def test_many_are_measured_knob_by_knob_and_all_together_and_the_sweep_says_so():
    sweep = sweep_of(Two, grid_limit=5)
    assert (sweep.kind, sweep.combinations) == ("through the default", 6)
    assert labels(grid_limit=5) == ["default", "facets 16", "facets 256", "target 0.1", "facets 16, target 0.1"]


def test_the_setting_with_every_knob_at_its_last_step_is_known():
    (last,) = [setting for setting in sweep_of(Two, grid_limit=5).settings if setting.most_accurate_knobs]
    assert last.label == "facets 256"


def test_no_setting_is_measured_twice():
    found = labels(grid_limit=5)
    assert len(found) == len(set(found))


def test_every_installed_adapter_has_a_sweep_through_its_own_default():
    for entry in Registry.discover().entries.values():
        if entry.adapter is not None:
            sweep = sweep_of(entry.adapter.Knobs)
            assert sum(setting.is_default for setting in sweep.settings) == 1, entry.name
