"""Fronts hold what nobody beats; answers are points of them."""

from __future__ import annotations

import pytest

from equilux.tradeoff.answers import answers, cheapest, most_accurate
from equilux.tradeoff.front import front, points_of
from equilux.tradeoff.words import exit_code, told
from support.made_up_trade import case, failed, measurement, setting

QUICK = [setting("coarse", 0.1, 1e-2), setting("fine", 0.3, 1e-4), setting("wasteful", 0.4, 1e-3)]
SLOW = [setting("only", 0.2, 1e-5, cpu=2.0)]


def test_a_setting_that_is_slower_and_less_accurate_is_not_on_the_front():
    assert [point.setting.label for point in front(points_of(case(quick=QUICK), "wall"))] == ["coarse", "fine"]


def test_of_equal_settings_one_is_on_the_front():
    same = [setting("a", 0.1, 1e-2), setting("b", 0.1, 1e-2), setting("slower", 0.2, 1e-2)]
    assert [point.setting.label for point in front(points_of(case(quick=same), "wall"))] == ["a"]


def test_the_front_of_all_is_marked_apart_from_that_of_each_renderer():
    found = case(quick=QUICK, slow=SLOW)
    marked = {s.label: (s.front, s.front_of_all) for trade in found.renderers.values() for s in trade.settings}
    assert marked == {"coarse": (True, True), "fine": (True, False), "wasteful": (False, False), "only": (True, True)}


def test_cpu_and_wall_time_have_fronts_of_their_own():
    points = points_of(case(quick=QUICK, slow=SLOW), "cpu")
    assert [point.setting.label for point in front(points)] == ["coarse", "fine", "only"]


def test_what_failed_or_has_no_accuracy_is_on_no_front():
    assert points_of(case(quick=[failed("broken"), setting("blind", 0.1, None)]), "wall") == []


@pytest.mark.parametrize(("error", "label"), [(1e-2, "coarse"), (9e-3, "fine"), (1e-4, "fine"), (1e-5, None)])
def test_the_cheapest_setting_that_is_accurate_enough(error: float, label: str | None):
    point = cheapest(points_of(case(quick=QUICK), "wall"), error)
    assert (point.setting.label if point else None) == label


@pytest.mark.parametrize(("seconds", "label"), [(0.05, None), (0.1, "coarse"), (0.29, "coarse"), (5.0, "fine")])
def test_the_most_accurate_setting_that_is_fast_enough(seconds: float, label: str | None):
    point = most_accurate(points_of(case(quick=QUICK), "wall"), seconds)
    assert (point.setting.label if point else None) == label


def test_every_renderer_answers_and_all_together():
    found = answers([case(quick=QUICK, slow=SLOW)], "wall", errors=[1e-3], times=[0.15])
    told_by = {(answer.renderer, answer.question): (answer.found, answer.label) for answer in found}
    assert told_by == {
        ("quick", "error"): ("quick", "fine"), ("slow", "error"): ("slow", "only"), ("any", "error"): ("slow", "only"),
        ("quick", "time"): ("quick", "coarse"), ("slow", "time"): (None, None), ("any", "time"): ("quick", "coarse"),
    }  # fmt: skip


def test_the_exit_code_says_whether_what_was_asked_is_met():
    found = measurement(case(quick=QUICK))
    assert exit_code(found, asked=False) == 0
    found.answers = answers(found.cases, "wall", errors=[1e-6])
    assert (exit_code(found, asked=True), exit_code(found, asked=False)) == (1, 0)
    assert exit_code(measurement(case(quick=[*QUICK, failed("broken")])), asked=False) == 3
    assert exit_code(measurement(case()), asked=False) == 4


def test_the_printed_table_names_failures_with_their_reason():
    assert "ended by SIGSEGV" in told(measurement(case(quick=[*QUICK, failed("broken")])), asked=False)
