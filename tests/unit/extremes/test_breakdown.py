"""The breakdown point is the first broken value outward; what is inside again behind it is a bump."""

from __future__ import annotations

from equilux.extremes.breakdown import Outcome, breakdown, outward

CODES: dict[str, Outcome] = {
    "+": "inside", "o": "blind", "x": "outside", "f": "failed", "r": "refused", "m": "missing", "?": "unjudged",
}  # fmt: skip


def found(text: str, benign: int = 0, direction: str = "up"):
    outcomes = [CODES[letter] for letter in text]
    return breakdown(outcomes, outward(len(outcomes), benign)[direction])


def test_the_first_broken_value_outward_is_the_breakdown():
    result = found("+++xx")
    assert (result.first, result.last_good, result.bumps) == (3, 2, ())


def test_downward_goes_the_other_way():
    result = found("xx+++", benign=4, direction="down")
    assert (result.first, result.last_good) == (1, 2)


def test_a_missing_picture_is_a_breakdown():
    assert found("++f").first == 2


def test_values_that_are_inside_again_are_bumps():
    result = found("++x++xx+")
    assert result.first == 2
    assert result.bumps == (3, 4), "what holds behind the last broken value is no bump between two"


def test_what_holds_has_no_breakdown():
    result = found("++++")
    assert (result.first, result.last_good, result.bumps, result.blind, result.refused) == (None, 3, (), None, None)


def test_giving_up_with_a_word_is_no_breakdown():
    result = found("++orr")
    assert (result.first, result.last_good, result.blind, result.refused) == (None, 1, 2, 3)


def test_giving_up_behind_the_breakdown_is_not_told():
    result = found("+xor")
    assert (result.first, result.blind, result.refused) == (1, None, None)


def test_what_breaks_at_the_benign_value_was_never_good():
    result = found("xx")
    assert (result.first, result.last_good) == (0, None)


def test_unjudged_and_missing_break_nothing():
    assert found("?m?").first is None


def test_a_direction_that_goes_nowhere_is_left_out():
    assert list(outward(3, 0)) == ["up"]
    assert list(outward(3, 2)) == ["down"]
    assert outward(3, 1) == {"down": [1, 0], "up": [1, 2]}
