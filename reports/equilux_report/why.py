"""Why a pair diverges, as the page of its case shows it: causes, what stays unexplained, and which side departs."""

from __future__ import annotations

from dataclasses import dataclass

from equilux_report import words
from equilux_report.causes import Cause, causes_of
from equilux_report.facts import number
from equilux_report.standing import Standing, standing_of
from equilux_report.tree import TRUTHS, CaseRecord, Pair


@dataclass(frozen=True)
class Side:
    """What one side of a pair does. agrees: with the truth."""

    adapter: str
    causes: tuple[Cause, ...]
    agrees: bool


@dataclass(frozen=True)
class Why:
    """One pair that diverges. explained: share of its diverging pixels that its causes account for, None where none were sought.
    standing: of the render, where the pair is one with the truth. sides: of a pair of peers."""

    pair: Pair
    is_against_truth: bool
    label: str
    causes: tuple[Cause, ...]
    left: Cause | None
    explained: float | None
    standing: Standing | None
    sides: tuple[Side, ...]

    @property
    def names(self) -> str:
        """ "exponent-clamped [128] and unexplained"."""
        return words.listed([cause.name for cause in (*self.causes, *([self.left] if self.left else []))])


def whys(case: CaseRecord, pairs: list[Pair]) -> tuple[Why, ...]:
    """Of every pair that diverges, those with the truth first, as the pairs come."""
    return tuple(_why(case, pair) for pair in pairs if pair.verdict == "diverge")


def why_of(case: CaseRecord, pair: Pair | None) -> Why | None:
    """None for a pair that does not diverge."""
    return _why(case, pair) if pair is not None and pair.verdict == "diverge" else None


def _why(case: CaseRecord, pair: Pair) -> Why:
    found = causes_of(case, pair)
    with_truth = case.truth in (pair.a, pair.b)
    return Why(
        pair,
        with_truth,
        words.JUDGED.get(pair.judged, pair.judged),
        tuple(cause for cause in found if not cause.is_unexplained),
        next((cause for cause in found if cause.is_unexplained), None),
        number(pair.facts, "explained"),
        standing_of(case.renders[pair.a]) if with_truth and pair.a in case.renders else None,
        () if with_truth else tuple(_side(case, name, found) for name in (pair.a, pair.b)),
    )


def _side(case: CaseRecord, name: str, found: tuple[Cause, ...]) -> Side:
    against = case.against_truth(name)
    agrees = name in TRUTHS or (against is not None and against.verdict == "agree")
    return Side(name, tuple(cause for cause in found if cause.side == name and not cause.is_unexplained), agrees)
