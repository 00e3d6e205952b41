"""A dialect as a page of Markdown."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from equilux.dialect import Declared
from equilux.dialects.evidence import Evidence, Seen
from equilux.explain.causes import name_of
from equilux.explain.numbers import UNIT, counted, listed, parameter, share, short

if TYPE_CHECKING:
    from equilux_tracer.causes import Rule

FINDINGS = {
    "as-modelled": "agree with the truth",
    "model-difference": "depart from it exactly as declared here",
    "implementation-bug": "depart from it otherwise than declared",
    "translation-bug": "depart from it by what is more likely a fault of the translation",
    "unexplained": "depart from it, and no named cause accounts for that",
}
"""Finding (results.json) → what is said of cases with it."""


def page(evidence: Evidence, rules: Mapping[str, Rule]) -> str:
    """The whole page. It holds no date and no folder: the same run of the same versions makes the same page."""
    parts = [_head(evidence), *(_rule(evidence, declared, seen, rules) for declared, seen in evidence.declared)]
    parts += [_beyond(evidence, rules), _unexplained(evidence)]
    return "\n".join(part for part in parts if part)


def _head(evidence: Evidence) -> str:
    counts = [f"{evidence.findings[finding]} {words}" for finding, words in FINDINGS.items() if evidence.findings[finding]]
    rules = counted(len(evidence.declared), "rule")
    return (
        f"# What {evidence.title}'s Phong is\n\n"
        f"What {evidence.title} always does otherwise than the lighting model says: {rules}, declared by its adapter and put to "
        "the test. A rule is proven on a case where the reference, rendered under it, shows what the renderer shows, within the "
        "uncertainty of both. *Explained* is the share of the diverging pixels that would diverge again if this rule alone were "
        "left out; *left* the largest difference that remains with all rules of the case applied; *fitted* the parameter as it "
        "is found when none is given.\n\n"
        f"From a run of equilux {evidence.equilux} with {evidence.title} {evidence.version}: "
        f"of {counted(evidence.cases, 'case')} {listed(counts) if counts else 'none was compared'}. "
        f"{_pixels(evidence)}"
        "Written by `equilux dialects`; not edited by hand.\n"
    )


def _pixels(evidence: Evidence) -> str:
    if not evidence.diverging:
        return ""
    part = share(evidence.accounted / evidence.diverging)
    return f"Of the {counted(evidence.diverging, 'pixel')} that diverge from it, {part} carry a proven cause. "


def _rule(evidence: Evidence, declared: Declared, seen: Sequence[Seen], rules: Mapping[str, Rule]) -> str:
    rule = rules.get(declared.cause)
    lines = [f"## `{declared.cause}`", ""]
    if rule is not None:
        model, instead = rule.formula
        lines += [f"{_sentence(rule.summary)} {_where(evidence, declared)}".rstrip(), ""]
        lines += ["| | |", "| --- | --- |", f"| the model | {_cell(model)} |", f"| {evidence.title} | {_cell(instead)} |"]
        reading = rule.readings.get(declared.reading, "")
        if reading:
            lines.append(f"| in this reading | {_cell(reading)} |")
        if rule.parameter is not None:
            name = ", ".join(getattr(rule.parameter, "names", ())) or getattr(rule.parameter, "name", "parameter")
            value = parameter(declared.parameter) or "depends on the scene"
            lines.append(f"| {_cell(name)} | {_cell(value)} |")
    else:
        lines += [f"No rule can be applied for this cause. {_where(evidence, declared)}".rstrip()]
    lines.append("")
    lines += _table(seen) if seen else ["Declared, and seen on no case of this run.", ""]
    return "\n".join(lines)


def _where(evidence: Evidence, declared: Declared) -> str:
    parts = []
    if declared.models:
        parts.append(f"In scenes of model {listed([f'`{model}`' for model in declared.models], 'or')}.")
    if declared.unless:
        parts.append(f"Not in scenes with {listed([f'`{feature}`' for feature in declared.unless], 'or')}.")
    if declared.quirk:
        parts.append(f"Fact {declared.quirk} of the adapter's `QUIRKS.md`.")
    return " ".join(parts)


def _table(seen: Sequence[Seen]) -> list[str]:
    with_parameter = any(each.found.parameter is not None for each in seen)
    with_fit = any(each.fitted is not None for each in seen)
    numbers = [*(["parameter"] if with_parameter else []), *(["fitted"] if with_fit else [])]
    header = ["case", *numbers, "explained", f"left, {UNIT}"]
    lines = [f"| {' | '.join(header)} |", f"| {' | '.join('---' for _ in header)} |"]
    for each in seen:
        cells = [f"`{each.case}`" + ("" if each.alone else " (with others)")]
        if with_parameter:
            cells.append(_cell(parameter(each.found.parameter)))
        if with_fit:
            cells.append(_cell(parameter(each.fitted)))
        cells += [_share(each), short(each.found.residual_max_abs) if each.found.residual_max_abs is not None else ""]
        lines.append(f"| {' | '.join(cells)} |")
    return [*lines, ""]


def _beyond(evidence: Evidence, rules: Mapping[str, Rule]) -> str:
    if not evidence.beyond:
        return "## Found and not declared\n\nNothing.\n"
    lines = ["## Found and not declared", "", "| case | cause | explained |", "| --- | --- | --- |"]
    for each in evidence.beyond:
        lines.append(f"| `{each.case}` | {_cell(name_of(each.found))} | {_share(each)} |")
    return "\n".join([*lines, ""])


def _unexplained(evidence: Evidence) -> str:
    if not evidence.unexplained:
        return ""
    lines = ["## What no rule accounts for", "", "| case | of the diverging pixels | what is known |", "| --- | --- | --- |"]
    lines += [f"| `{each.case}` | {_share(each)} | {_cell(each.found.words)} |" for each in evidence.unexplained]
    return "\n".join([*lines, ""])


def _share(seen: Seen) -> str:
    return share(seen.found.explained) if seen.found.explained is not None else ""


def _sentence(text: str) -> str:
    """A summary of a cause as a sentence."""
    return text[:1].upper() + text[1:] + "." if text else ""


def _cell(text: str) -> str:
    """Text that may hold the bars of a table or of an absolute value."""
    return text.replace("|", "\\|")
