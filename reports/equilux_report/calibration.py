"""Calibration of the stated uncertainties over a run: the histogram of |E_n| of each adapter against the truth."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

from equilux_report import numerals
from equilux_report.facts import mapping, number, numbers
from equilux_report.tree import CaseRecord, Pair, Run

DECADES = (-6.25, 6.25)
PER_DECADE = 4
"""1 is an edge; the first column collects what is smaller still, zeros included, the last what is larger, ∞ included."""


@dataclass(frozen=True)
class Bin:
    """One column: bands of pixels whose |E_n| lies in [10^low, 10^high), from pairs that agree and from pairs that diverge."""

    low: float
    high: float
    agreeing: int
    diverging: int


@dataclass(frozen=True)
class Calibration:
    """How one adapter's stated uncertainty compares with what was found."""

    adapter: str
    pairs: int
    bins: tuple[Bin, ...]
    largest_agreeing: float | None
    """Largest |E_n| among the pairs that agree: how closely the budget is approached."""

    @property
    def total(self) -> int:
        return sum(bin.agreeing + bin.diverging for bin in self.bins)

    @property
    def beyond(self) -> int:
        """Counts with |E_n| > 1."""
        return sum(bin.agreeing + bin.diverging for bin in self.bins if bin.low >= 0)

    @property
    def peak(self) -> int:
        return max((bin.agreeing + bin.diverging for bin in self.bins), default=0)

    @property
    def verdict(self) -> str:
        """What the histogram says of the budget."""
        largest = self.largest_agreeing
        if largest is None:
            return "No pair agrees, so nothing is learnt of the budget."
        if largest == 0:
            return "Agreeing pairs show no difference at all."
        reach = f"Agreeing pairs reach {numerals.magnitude(largest)}: the budget is held"
        if largest >= 0.1:
            return f"{reach} and approached within a factor of ten. Well calibrated."
        return f"{reach} with room to spare, {numerals.magnitude(1 / largest, 2)} times what is needed."


def histogram(pair: Pair) -> tuple[list[float], list[int]]:
    """Edges and counts of a pair's |E_n|, or empty lists if the pair has none that line up."""
    facts = mapping(pair.facts, "en_histogram")
    edges, counts = numbers(facts, "edges"), numbers(facts, "counts")
    fits = len(edges) == len(counts) + 1 and all(low < high for low, high in pairwise(edges)) and edges[0] >= 0
    return (edges, [int(value) for value in counts]) if fits else ([], [])


def rebin(pairs: Iterable[Pair]) -> tuple[Bin, ...]:
    """Pairs' histograms on common log bins: a column goes where its geometric centre lies; the ends collect what lies beyond."""
    total = round((DECADES[1] - DECADES[0]) * PER_DECADE)
    agreeing, diverging = [0] * total, [0] * total
    for pair in pairs:
        edges, counts = histogram(pair)
        target = diverging if pair.verdict == "diverge" else agreeing
        for low, high, count in zip(edges, edges[1:], counts, strict=False):
            centre = (math.log10(low) + math.log10(high)) / 2 if low > 0 else DECADES[0]
            target[min(max(math.floor((centre - DECADES[0]) * PER_DECADE), 0), total - 1)] += count
    return tuple(
        Bin(DECADES[0] + index / PER_DECADE, DECADES[0] + (index + 1) / PER_DECADE, agreeing[index], diverging[index])
        for index in range(total)
    )


def calibrations(run: Run) -> list[Calibration]:
    """One per adapter that was held against a truth."""
    found = []
    for adapter in run.adapters:
        pairs = [
            pair for pair in (_against_truth(case, adapter) for case in run.cases) if pair is not None and histogram(pair)[0]
        ]
        if pairs:
            largest = [value for pair in pairs if pair.verdict == "agree" and (value := number(pair.facts, "en_max")) is not None]
            found.append(Calibration(adapter, len(pairs), rebin(pairs), max(largest, default=None)))
    return found


def _against_truth(case: CaseRecord, adapter: str) -> Pair | None:
    return case.against_truth(adapter) if adapter != case.truth else None
