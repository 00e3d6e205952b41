"""A pair and a render in one line each: what all outputs for a CI share. More is said by `equilux.explain`."""

from __future__ import annotations

from collections.abc import Sequence

from equilux.explain.causes import UNEXPLAINED, name_of
from equilux.explain.numbers import share
from equilux.explain.sentences import one_line
from equilux.judge import FAILED
from equilux.results import CaseRecord, ExpectationRecord, PairRecord
from equilux.trust import TRUTHS

UNEXPECTED = ("diverge_unexpected", "improved")
"""Judgements that fail a run."""


def pair_headline(case: CaseRecord, pair: PairRecord) -> str:
    """How the pair stands and why; its case left out."""
    if pair.judged == "improved":
        pins = ", ".join(dict.fromkeys(used.cause for used in gone(case, pair)))
        if pair.verdict == "agree":
            return f"{pair.a} agrees with {pair.b}, but the scene expects it to diverge ({pins}): remove the expectation"
        found = causes_in_words(pair) or "no cause was proven"
        return f"{pair.a} diverges from {pair.b}, but not by {pins}, as the scene expects: remove the expectation ({found})"
    line = one_line(case, pair)
    return f"{line}: {words}" if (words := _only_words(pair)) else line


def causes_in_words(pair: PairRecord) -> str:
    """`exponent-clamped [128]: the highlight's exponent is cut off at 128`, all causes of a pair; empty where none was found."""
    said = [f"{name_of(found)}: {found.words}" if found.words else name_of(found) for found in pair.causes]
    return "; ".join(said)


def _only_words(pair: PairRecord) -> str:
    """For where the names are there already."""
    if pair.verdict != "diverge":
        return ""
    return "; ".join(found.words for found in pair.causes if found.words and found.id != UNEXPLAINED)


def render_headline(case: CaseRecord, adapter: str) -> str:
    """What became of a render that brought no picture; its case left out."""
    render = case.renders[adapter]
    lacks = f"lacks {', '.join(render.missing_features)}" if render.missing_features else "no reason given"
    return f"{adapter} {render.status}: {render.reason or lacks}"


def gone(case: CaseRecord, pair: PairRecord) -> list[ExpectationRecord]:
    """The expectations that an `improved` pair speaks of: those known not to hold; where none is known, all of its sides."""
    pinned = [used for used in case.expect if used.adapter in (pair.a, pair.b)]
    return [used for used in pinned if used.held is False] or pinned


def speaks_for_itself(case: CaseRecord, pair: PairRecord) -> bool:
    """Whether a wrong pair is news: not where a side of it is told to be wrong already by its pair with a better truth."""
    known: set[str] = set()
    for truth in TRUTHS:
        if pair.b == truth:
            return pair.a not in known
        known |= {other.a for other in case.pairs if other.judged in UNEXPECTED and other.b == truth}
    return not {pair.a, pair.b} & known


def failed_renders(cases: Sequence[CaseRecord], named: frozenset[str]) -> list[tuple[CaseRecord, str]]:
    """The renders that end a run with exit code 3."""
    return [
        (case, name)
        for case in cases
        for name, render in case.renders.items()
        if render.status in FAILED or (render.status == "missing" and name in named)
    ]


def share_of(part: int, whole: int) -> str:
    return share(part / whole) if whole else "0 %"
