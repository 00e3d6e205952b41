"""Causes of a divergence as the results tell them, arranged for reading. What is proven and what stays unexplained come alike."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from equilux_report import numerals
from equilux_report.facts import Facts, count, items, mapping, number, objects, text
from equilux_report.tree import CaseRecord, Pair

UNEXPLAINED = "unexplained"
STRONG = 0.1
"""Correlations below this are not worth a line."""
SHOWN_TERMS = 5


@dataclass(frozen=True)
class Region:
    """Where pixels lie: how many, the box around them (inclusive), and what is seen there."""

    pixels: int
    x0: int
    y0: int
    x1: int
    y1: int
    words: str

    @property
    def box(self) -> str:
        """As the viewer's state has it."""
        return f"{self.x0},{self.y0},{self.x1},{self.y1}"

    @property
    def place(self) -> str:
        """ "312 pixels within (40, 20) to (60, 33)"."""
        corner, other = f"({self.x0}, {self.y0})", f"({self.x1}, {self.y1})"
        return f"{numerals.plural(self.pixels, 'pixel')} " + (corner if corner == other else f"within {corner} to {other}")


@dataclass(frozen=True)
class Cause:
    """One cause that was found, or what no cause accounts for.

    side: the adapter that departs. parameter, recognised: "3.14159", "π". expected: the expectation that names it, as the scene
    has it; "" where none does. alternatives: causes that the scene cannot tell from it. terms: what a remainder goes with.
    """

    id: str
    side: str
    parameter: str
    recognised: str
    reading: str
    words: str
    formula: tuple[str, str] | None
    explained: float | None
    residual: float | None
    suspects: str
    declared: bool
    expected: str
    region: Region | None
    alternatives: tuple[str, ...]
    terms: tuple[tuple[str, float], ...]

    @property
    def is_unexplained(self) -> bool:
        return self.id == UNEXPLAINED

    @property
    def name(self) -> str:
        """ "exponent-clamped [128]"."""
        return _named(self.id, self.parameter)

    @property
    def sentence(self) -> str:
        """What the renderer does, as a sentence; what the formula says too is not said twice."""
        said = self.words.removesuffix(f" ({self.formula[1]})") if self.formula else self.words
        return said[:1].upper() + said[1:] + "." if said else ""


def causes_of(case: CaseRecord, pair: Pair) -> tuple[Cause, ...]:
    """What was found of a pair, most explaining first, what stays unexplained last."""
    return tuple(_cause(case, pair, facts) for facts in objects(pair.facts, "causes") if text(facts, "id"))


def _cause(case: CaseRecord, pair: Pair, facts: Facts) -> Cause:
    formula = [part for part in items(facts, "formula") if isinstance(part, str)]
    side = text(facts, "side") or pair.a
    others = objects(facts, "alternatives")
    return Cause(
        id=text(facts, "id"),
        side=side,
        parameter=numerals.parameter(facts.get("parameter")),
        recognised=_recognised(facts),
        reading=text(facts, "reading"),
        words=text(facts, "words"),
        formula=(formula[0], formula[1]) if len(formula) == 2 else None,
        explained=number(facts, "explained"),
        residual=number(facts, "residual_max_abs"),
        suspects=text(facts, "suspects"),
        declared=facts.get("declared") is True,
        expected=_expected(case, side, {text(facts, "id"), *(text(other, "id") for other in others)}),
        region=_region(mapping(facts, "region")),
        alternatives=tuple(_named(text(other, "id"), numerals.parameter(other.get("parameter"))) for other in others),
        terms=_terms(mapping(facts, "terms")),
    )


def _named(id_: str, parameter: str) -> str:
    return f"{id_} [{parameter}]" if parameter else id_


def _recognised(facts: Facts) -> str:
    """The parameter's name, where it says more than its digits."""
    name = text(facts, "recognised")
    return "" if name == numerals.parameter(facts.get("parameter")) else name


def _expected(case: CaseRecord, adapter: str, names: set[str]) -> str:
    for item in objects(case.facts, "expect"):
        if text(item, "adapter") == adapter and text(item, "cause") in names:
            when = text(item, "when")
            return text(item, "cause") + (f" when {when}" if when else "")
    return ""


def _region(facts: Facts) -> Region | None:
    corners = [number(facts, key) for key in ("x0", "y0", "x1", "y1")]
    if None in corners:
        return None
    x0, y0, x1, y1 = (int(corner or 0) for corner in corners)
    return Region(count(facts, "pixels"), x0, y0, x1, y1, text(facts, "words"))


def _terms(facts: Mapping[str, Any]) -> tuple[tuple[str, float], ...]:
    found = [(name, value) for name in facts if (value := number(facts, name)) is not None and abs(value) >= STRONG]
    return tuple(sorted(found, key=lambda term: -abs(term[1]))[:SHOWN_TERMS])
