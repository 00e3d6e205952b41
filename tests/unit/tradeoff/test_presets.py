"""Presets and ladders follow from the numbers by rules that say what they are."""

from __future__ import annotations

import pytest

from equilux.complaint import BadUsage
from equilux.knobs import resolve
from equilux.registry import Registry
from equilux.tradeoff import presets
from equilux.tradeoff.record import AdapterPresets, Presets, Rung
from support.engine import entry
from support.made_up_trade import case, measurement, setting

FACETS = (16, 64, 256, 1024)


def swept(*numbers: tuple[float, float]) -> list:
    """One renderer's settings, by seconds and accuracy."""
    last = len(numbers) - 1
    return [
        setting(f"facets {n}", seconds, accuracy, knobs={"facets": n}, most_accurate_knobs=i == last)
        for i, (n, (seconds, accuracy)) in enumerate(zip(FACETS, numbers, strict=False))
    ]


BALL = swept((0.1, 5e-2), (0.2, 5e-3), (0.4, 5e-5), (0.8, 4.9e-5))
TUBE = swept((0.1, 9e-3), (0.2, 2e-2), (0.4, 9e-5), (0.8, 1e-6))


def derived(*cases) -> AdapterPresets:
    return presets.derive(measurement(*cases)).adapters["quick"]


def facets(found: AdapterPresets) -> dict[str, int]:
    return {name: preset.knobs["facets"] for name, preset in found.presets.items()}


def test_the_presets_of_one_case_are_the_cheapest_that_meet_their_errors():
    assert facets(derived(case(quick=BALL))) == {"fast": 64, "balanced": 256, "exact": 256}


def test_a_preset_holds_on_every_case_that_was_measured():
    found = derived(case("ball", quick=BALL), case("tube", quick=TUBE))
    assert facets(found) == {"fast": 256, "balanced": 256, "exact": 1024}
    assert found.presets["fast"].accuracy == 9e-5
    assert found.presets["fast"].cases == {"ball": (5e-5, 0.4), "tube": (9e-5, 0.4)}


def test_where_no_setting_is_as_accurate_as_a_preset_asks_the_most_accurate_stands_for_it_and_says_so():
    found = derived(case(quick=swept((0.1, 0.3), (0.2, 0.1))))
    assert facets(found) == {"fast": 64, "balanced": 64, "exact": 64}
    assert found.presets["fast"].rule == "none reaches 0.01: the most accurate"


def test_of_settings_that_take_equally_long_the_default_one_is_taken_and_else_the_most_accurate():
    """Seconds here are medians of intervals that reach a tenth to both sides."""
    numbers = [setting(f"facets {n}", seconds, accuracy, knobs={"facets": n}, within=0.1)
               for n, seconds, accuracy in ((16, 1.0, 9e-3), (64, 1.1, 8e-3), (256, 1.15, 2e-3), (1024, 1.5, 1e-6))]
    assert facets(derived(case(quick=numbers)))["fast"] == 256
    numbers[1] = numbers[1].model_copy(update={"default": True})
    assert facets(derived(case(quick=numbers)))["fast"] == 64


def test_a_knob_that_did_nothing_on_the_measured_cases_is_not_turned():
    """A recursion depth where no mirror was measured, however fast it came out."""
    numbers = [setting("default", 1.0, 1e-3, knobs={"facets": 64}, default=True),
               setting("depth 0", 0.5, 1e-3, knobs={"facets": 0}),
               setting("facets 16", 0.8, 9e-3, knobs={"facets": 16}),
               setting("facets 1024", 2.0, 1e-3, knobs={"facets": 1024}, most_accurate_knobs=True)]  # fmt: skip
    found = derived(case(quick=numbers))
    assert facets(found) == {"fast": 16, "balanced": 64, "exact": 64}
    assert [rung.knobs["facets"] for rung in found.ladder] == [16, 64, 1024]


def test_a_renderer_with_nothing_to_set_has_no_preset():
    assert presets.derive(measurement(case(quick=[setting("default", 0.1, 1e-3)]))).adapters == {}


def test_a_ladder_leaves_out_what_claims_nothing_new_and_ends_with_every_knob_at_its_most_accurate():
    rungs = [rung.knobs["facets"] for rung in derived(case(quick=BALL)).ladder]
    assert rungs == [16, 64, 256, 1024]
    wasteful = swept((0.1, 1e-2), (0.2, 9e-3), (0.4, 1e-4), (0.8, 1e-4))
    assert [rung.knobs["facets"] for rung in derived(case(quick=wasteful)).ladder] == [16, 256, 1024]


def made(*qualities: int, adapter: str = "tunable") -> Presets:
    ladder = [Rung(knobs={"quality": n}, label=f"quality {n}", seconds=n, claimed={}) for n in qualities]
    return Presets(adapters={adapter: AdapterPresets(version="1", ladder=ladder)})


def test_what_the_user_has_set_no_rung_changes(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(presets, "shipped", lambda: made(1, 2, 3))
    base = {"quality": 2, "colour": "plain"}
    assert [rung["quality"] for rung in presets.ladder_of(entry("tunable"), {}, base)] == [1, 2, 3]
    assert presets.ladder_of(entry("tunable"), {"quality": 2}, base) == [base]


def test_an_adapter_that_was_never_measured_has_one_rung(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(presets, "shipped", lambda: made(1, 2, 3))
    assert presets.ladder_of(entry("good"), {}, {"level": 1}) == [{"level": 1}]


def test_a_measurement_that_does_not_fit_the_knobs_is_told_with_what_to_do(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(presets, "shipped", lambda: made(77))
    with pytest.raises(BadUsage, match=r"does not fit the knobs of tunable \(quality: .*\); measure anew: equilux tradeoff"):
        presets.ladder_of(entry("tunable"), {}, {})


def test_the_shipped_presets_fit_the_knobs_of_the_adapters_that_are_installed():
    entries = list(Registry.discover().entries.values())
    for name in presets.NAMES:
        resolve(presets.preset_settings(name, entries), entries)
    for each in entries:
        if each.adapter is not None:
            base = each.adapter.Knobs().model_dump(mode="json")
            for rung in presets.ladder_of(each, {}, base):
                each.adapter.Knobs.model_validate(rung)
