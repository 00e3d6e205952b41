"""What a run says of an adapter's dialect: on which cases each declared rule was proven, and what else was found."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from equilux.diagnose.diagnosis import Diagnosis, Found
from equilux.diagnosing import load
from equilux.dialect import Declared
from equilux.judge import UNEXPLAINED
from equilux.readrun import ReadRun

if TYPE_CHECKING:
    from equilux_tracer.causes import Rule


@dataclass(frozen=True)
class Seen:
    """A cause found on one case."""

    case: str
    found: Found
    alone: bool
    """Whether it was the only cause found there."""
    fitted: Any = None
    """Its parameter as the search finds it when it is told none (`refit.py`); None where that was not asked, or nothing found."""


@dataclass
class Evidence:
    """All that a run says of one adapter. cases: compared with a truth; findings: how many of them by finding (results.json).
    declared: the cases of each declared rule, in the dialect's order; beyond: of what was found and not declared. diverging:
    pixels that diverge from the truth, over all cases; accounted: those of them that proven causes account for.
    """

    adapter: str
    title: str
    version: str
    equilux: str
    cases: int = 0
    findings: Counter[str] = field(default_factory=Counter)
    declared: list[tuple[Declared, list[Seen]]] = field(default_factory=list)
    beyond: list[Seen] = field(default_factory=list)
    unexplained: list[Seen] = field(default_factory=list)
    diverging: int = 0
    accounted: int = 0


def gathered(run: ReadRun, adapter: str, title: str, dialect: Sequence[Declared]) -> Evidence:
    """Read the diagnoses of an adapter's renders. Raises ValueError for a diagnosis.json that is none."""
    out = Evidence(adapter, title, run.results.run.adapters.get(adapter, ""), run.results.run.equilux)
    out.declared = [(declared, []) for declared in dialect]
    for case in sorted(run.results.cases, key=lambda case: case.case):
        render = case.renders.get(adapter)
        if render is None or render.standing is None:
            continue
        out.cases += 1
        out.findings[str(render.standing.finding)] += 1
        diagnosis = load(run.render_folder(case.case, adapter))
        if diagnosis is not None:
            _sorted_in(out, case.case, diagnosis)
    return out


def with_fits(evidence: Evidence, run: ReadRun, rules: Mapping[str, Rule]) -> None:
    """Find the number of each declared rule anew, on the cases where it is the only cause."""
    from equilux.dialects.refit import refitted

    records = {case.case: case for case in run.results.cases}
    for declared, seen in evidence.declared:
        rule = rules.get(declared.cause)
        if rule is None or rule.parameter is None:
            continue
        for index, each in enumerate(seen):
            found = refitted(run, records[each.case], evidence.adapter, rule) if each.alone else None
            if found is not None:
                seen[index] = replace(each, fitted=found.parameter)


def _sorted_in(out: Evidence, case: str, diagnosis: Diagnosis) -> None:
    out.diverging += diagnosis.diverging
    if any(found.id != UNEXPLAINED for found in diagnosis.causes):
        out.accounted += round(diagnosis.explained * diagnosis.diverging)
    for found in diagnosis.causes:
        seen = Seen(case, found, len(diagnosis.causes) == 1)
        if found.id == UNEXPLAINED:
            out.unexplained.append(seen)
            continue
        matching = [cases for declared, cases in out.declared if declared.cause == found.id]
        (matching[0] if matching and found.declared else out.beyond).append(seen)
