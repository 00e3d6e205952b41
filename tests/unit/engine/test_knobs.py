"""`--set [ADAPTER.]KNOB=VALUE` reaches the adapters it means, or says what is wrong."""

from __future__ import annotations

import pytest

from equilux.complaint import BadUsage
from equilux.knobs import resolve
from support.engine import entry


def levels(*settings: str) -> dict[str, int]:
    return {name: knobs.level for name, knobs in resolve(settings, [entry("good"), entry("slow")]).items()}  # type: ignore[attr-defined]


def test_without_settings_every_knob_has_its_default():
    assert levels() == {"good": 1, "slow": 1}


def test_a_knob_without_a_name_is_set_for_every_adapter_that_has_it():
    assert levels("level=3") == {"good": 3, "slow": 3}


def test_a_knob_with_a_name_is_set_for_that_adapter_alone_and_the_last_setting_wins():
    assert levels("level=3", "slow.level=5", "slow.level=6") == {"good": 3, "slow": 6}


@pytest.mark.parametrize(
    ("setting", "says"),
    [
        ("level", "got 'level', expected [ADAPTER.]KNOB=VALUE"),
        ("=3", "got '=3', expected [ADAPTER.]KNOB=VALUE"),
        ("levle=3", "unknown knob 'levle'; known are good.level, slow.level (did you mean 'level'?)"),
        ("good.levle=3", "unknown knob 'good.levle'; known are good.level (did you mean 'level'?)"),
        ("goood.level=3", "'goood' of 'goood.level=3' is not among the adapters of this run (good, slow) (did you mean 'good'?)"),
        ("good.level=ten", 'good.level: got "ten"; input should be a valid integer'),
        ("good.level=10", 'good.level: got "10"; input should be less than or equal to 9'),
        ("good.level=", 'good.level: got ""; input should be a valid integer'),
    ],
)
def test_a_setting_that_cannot_be_is_one_line_with_what_got_and_allowed(setting: str, says: str):
    with pytest.raises(BadUsage) as problem:
        levels(setting)
    assert len(problem.value.lines) == 1
    assert says in problem.value.lines[0]


def test_all_wrong_settings_are_reported_at_once():
    with pytest.raises(BadUsage) as problem:
        levels("a=1", "b=2", "good.level=x")
    assert len(problem.value.lines) == 3
