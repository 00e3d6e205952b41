"""The causes of a whole run: which renderer departs by what, in how many cases, and how much of it all is proven."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from equilux_report.causes import UNEXPLAINED, Cause
from equilux_report.facts import count, number
from equilux_report.standing import Expectation, expectations_of, standing_of
from equilux_report.tree import CaseRecord, Run

if TYPE_CHECKING:
    from equilux_report.overview import Cell

NOT_DIAGNOSED = "not diagnosed"
PARAMETERS = 3
"""As many different values of a parameter are listed; of more the range is told."""


@dataclass
class CauseGroup:
    """The divergences of one renderer by one cause. expected: the scenes expect them."""

    cause: str
    adapter: str
    expected: bool
    declared: bool = False
    is_proven: bool = False
    parameters: Counter[str] = field(default_factory=Counter)
    recognised: dict[str, str] = field(default_factory=dict)
    pixels: float = 0.0
    """That diverge by it."""
    cells: list[tuple[CaseRecord, Cell]] = field(default_factory=list)

    @property
    def worst(self) -> tuple[CaseRecord, Cell]:
        return max(self.cells, key=lambda item: item[1].en or 0)

    @property
    def parameter(self) -> str:
        """ "128"; "128, 64"; of many values the range."""
        values = [value for value in self.parameters if value]
        if len(values) <= PARAMETERS:
            return ", ".join(value + (f" = {self.recognised[value]}" if value in self.recognised else "") for value in values)
        try:
            in_order = sorted(values, key=float)
        except ValueError:
            return f"{len(values)} values"
        return f"{in_order[0]} to {in_order[-1]}"

    @property
    def gravity(self) -> tuple[bool, bool, float]:
        """Unexpected first, among them what nobody can explain, then by size."""
        return (self.expected, self.is_proven and not self.expected, -(self.worst[1].en or 0))


@dataclass
class Stand:
    """How one renderer stands over the run. diverging: pixels that diverge from the truth; proven: of those with a cause."""

    adapter: str
    findings: Counter[str] = field(default_factory=Counter)
    diverging: int = 0
    proven: float = 0.0
    sought: bool = False
    """Whether causes were looked for at all."""

    @property
    def share(self) -> float | None:
        return self.proven / self.diverging if self.diverging and self.sought else None


def cause_groups(cells: Iterable[tuple[CaseRecord, Cell]]) -> tuple[CauseGroup, ...]:
    """Every divergence from the truth by cause and renderer."""
    found: dict[tuple[bool, str, str], CauseGroup] = {}
    for case, cell in cells:
        if cell.judged not in ("diverge_expected", "diverge_unexpected", "improved") or not cell.why:
            continue
        whole = count(cell.why.pair.facts, "diverge")
        for id_, expected, cause in _of_cell(cell):
            group = found.setdefault((expected, id_, cell.adapter), CauseGroup(id_, cell.adapter, expected))
            group.cells.append((case, cell))
            if cause is not None:
                group.is_proven = not cause.is_unexplained
                group.declared |= cause.declared
                group.parameters[cause.parameter] += 1
                group.pixels += whole * (cause.explained or 0)
                if cause.recognised:
                    group.recognised[cause.parameter] = cause.recognised
    return tuple(sorted(found.values(), key=lambda group: group.gravity))


def _of_cell(cell: Cell) -> Iterator[tuple[str, bool, Cause | None]]:
    """Cause ids of a cell, whether they are expected, and what was found of them; the pins where nothing was found."""
    if cell.why is None:
        return
    foreseen = cell.judged == "diverge_expected"
    found = [*cell.why.causes, *([cell.why.left] if cell.why.left else [])]
    for cause in found:
        yield cause.id, foreseen or bool(cause.expected), cause
    if not found:
        for name in cell.causes or (NOT_DIAGNOSED,):
            yield name, foreseen, None


def stands(run: Run, adapters: Iterable[str]) -> tuple[Stand, ...]:
    """Of each renderer that was held against a truth."""
    out = []
    for adapter in adapters:
        stand = Stand(adapter)
        for case in run.cases:
            standing = standing_of(case.renders[adapter]) if adapter in case.renders else None
            if standing is not None:
                stand.findings[standing.finding] += 1
            pair = case.against_truth(adapter) if adapter != case.truth else None
            if pair is not None and pair.verdict == "diverge":
                explained = number(pair.facts, "explained")
                diverging = count(pair.facts, "diverge")
                stand.diverging += diverging
                stand.proven += diverging * (explained or 0)
                stand.sought |= explained is not None
        if stand.findings or stand.diverging:
            out.append(stand)
    return tuple(out)


def expectations(run: Run) -> tuple[Expectation, ...]:
    """All that had a say, those that no longer hold first."""
    found = [expectation for case in run.cases for expectation in expectations_of(case)]
    return tuple(sorted(found, key=lambda item: item.state != "gone"))


def cause_ids(cell: Cell) -> tuple[str, ...]:
    """Under which groups a cell is counted."""
    if cell.judged not in ("diverge_expected", "diverge_unexpected", "improved"):
        return ()
    return tuple(dict.fromkeys(id_ for id_, _, _ in _of_cell(cell)))


def cause_names(cell: Cell) -> tuple[str, ...]:
    """Causes of a cell with their parameters, for its label; ids of pins where nothing was found."""
    if cell.why is None or not (cell.why.causes or cell.why.left):
        return cell.causes
    left = (UNEXPLAINED,) if cell.why.left else ()
    return (*(cause.name for cause in cell.why.causes), *left)
