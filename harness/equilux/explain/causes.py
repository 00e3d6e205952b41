"""Causes in words: the rule, its formula on either side, parameter, share, region, and what the scene cannot tell from it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from equilux.diagnose.diagnosis import Diagnosis, Found, Region
from equilux.explain.numbers import UNIT, counted, listed, parameter, share, short
from equilux.results import CaseRecord, PairRecord

UNEXPLAINED = "unexplained"
STRONG = 0.1
"""Correlations below this are not worth a word."""


def causes_of(case: CaseRecord, pair: PairRecord, diagnoses: Mapping[str, Diagnosis]) -> list[Found]:
    """What was found of a pair; where its own record is silent (a pair of peers), what was found of each side against the
    truth."""
    if pair.causes or pair.verdict != "diverge":
        return list(pair.causes)
    return [
        cause.model_copy(update={"side": cause.side or adapter})
        for adapter in (pair.a, pair.b)
        for cause in (diagnoses[adapter].causes if adapter in diagnoses else _against_the_truth(case, adapter))
    ]


def _against_the_truth(case: CaseRecord, adapter: str) -> Sequence[Found]:
    return next((other.causes for other in case.pairs if other.a == adapter and other.causes), ())


def name_of(found: Any) -> str:
    """A cause with its parameter: "exponent-clamped [128]", "scaled [3.14159, which is π]"."""
    value = parameter(found.parameter)
    recognised = getattr(found, "recognised", None)
    known = f", which is {recognised}" if value and recognised and recognised != value else ""
    reading = f" ({found.reading})" if getattr(found, "reading", "") else ""
    return f"{found.id} [{value}{known}]{reading}" if value else f"{found.id}{reading}"


def is_expected(found: Found, adapter: str, case: CaseRecord) -> str | None:
    """The expectation that pins a cause, or one that the scene cannot tell from it, as the spec has it; None where none does."""
    names = {found.id, *(other.id for other in found.alternatives)}
    for used in case.expect:
        if used.adapter == adapter and used.cause in names:
            return used.cause + (f" when {used.when}" if used.when else "")
    return None


def departs(found: Found, pair: PairRecord) -> str:
    """The adapter that departs from the model."""
    return found.side or pair.a


def cause_lines(position: int, found: Found, case: CaseRecord, pair: PairRecord) -> list[str]:
    """One proven cause."""
    who = departs(found, pair)
    lines = [f"  {position}. {who}: {name_of(found)}" + (f": {found.words}" if found.words else "")]
    if found.formula is not None:
        model, instead = found.formula
        width = max(len("model"), len(who))
        lines += [f"     {'model'.ljust(width)}  {model}", f"     {who.ljust(width)}  {instead}"]
    if found.explained is not None:
        lines.append(f"     explains {share(found.explained)} of the diverging pixels{_residual(found)}")
    if found.region is not None:
        lines.append(f"     where: {region_words(found.region)}")
    if found.alternatives:
        names = listed([name_of(other) for other in found.alternatives], "or")
        lines.append(f"     this scene cannot tell it from {names}")
    lines.append(f"     {_known(found, who, case)}")
    return lines


def _residual(found: Found) -> str:
    if found.residual_max_abs is None:
        return ""
    return f"; with every cause applied at most {short(found.residual_max_abs)} {UNIT} is left"


def _known(found: Found, who: str, case: CaseRecord) -> str:
    declared = f"{who} declares it in its dialect" if found.declared else f"{who} does not declare it"
    pinned = is_expected(found, who, case)
    expected = f"the scene expects it ({pinned})" if pinned else "the scene does not expect it"
    suspect = f"; suspected: the {found.suspects}" if found.suspects and not found.declared else ""
    return f"{declared}; {expected}{suspect}"


def unexplained_lines(found: Found, pair: PairRecord) -> list[str]:
    """What no cause accounts for."""
    left = f"{share(found.explained)} of the diverging pixels" if found.explained is not None else "a part"
    lines = [f"  unexplained: {left} of {departs(found, pair)}" + (f": {found.words}" if found.words else "")]
    if found.residual_max_abs is not None:
        lines.append(f"     at most {short(found.residual_max_abs)} {UNIT} is left")
    if found.region is not None:
        lines.append(f"     where: {region_words(found.region)}")
    strong = [(term, value) for term, value in found.terms.items() if abs(value) >= STRONG]
    if strong:
        said = ", ".join(f"{term} {value:+.2f}" for term, value in strong[:5])
        lines.append(f"     what is left correlates with: {said} (a hint, no proof)")
    elif found.terms:
        lines.append("     what is left correlates with no term of the model")
    return lines


def region_words(region: Region) -> str:
    """The pixels, the box around them, and what is seen there."""
    place = f"({region.x0}, {region.y0})"
    if (region.x0, region.y0) != (region.x1, region.y1):
        place = f"within {place} to ({region.x1}, {region.y1})"
    return f"{counted(region.pixels, 'pixel')} {place}" + (f", {region.words}" if region.words else "")
