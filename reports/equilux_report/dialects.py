"""What each renderer's lighting model is: the rules that its adapter declares, each with the evidence of the run."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

from equilux_report import numerals, words
from equilux_report.causes import Cause, causes_of
from equilux_report.facts import Facts, items, mapping, objects, text
from equilux_report.links import Links
from equilux_report.overview import Thumbnails
from equilux_report.standing import standing_of
from equilux_report.tree import TRUTHS, CaseRecord, Pair, Run

SHOWN = 6
"""Cases of a rule that are shown before the others are folded away."""


@dataclass(frozen=True)
class Seen:
    """A cause on one case. alone: no other was found there. picture: where the case diverges."""

    case: str
    href: str
    picture: str | None
    cause: Cause
    alone: bool


@dataclass
class Rule:
    """One declared rule. where: which scenes it is declared for, in words."""

    cause: str
    parameter: str
    words: str
    formula: tuple[str, str] | None
    where: str
    seen: list[Seen] = field(default_factory=list)

    @property
    def sentence(self) -> str:
        return self.words[:1].upper() + self.words[1:] + "." if self.words else ""

    @property
    def found(self) -> str:
        """The parameters that it was found with, where they say more than the declared one."""
        values = list(dict.fromkeys(seen.cause.parameter for seen in self.seen if seen.cause.parameter))
        return (
            ""
            if not values or values == [self.parameter]
            else words.listed(values)
            if len(values) < 4
            else f"{len(values)} values"
        )


@dataclass
class Dialect:
    """All that a run says of one renderer. cases: compared with a truth."""

    adapter: str
    title: str
    version: str
    rules: list[Rule]
    cases: int = 0
    findings: Counter[str] = field(default_factory=Counter)
    beyond: list[Seen] = field(default_factory=list)
    unexplained: list[Seen] = field(default_factory=list)

    @property
    def counts(self) -> str:
        """ "112 agree with the truth and 16 depart from it exactly as declared here"."""
        return words.listed([f"{self.findings[name]} {said}" for name, said in SAID.items() if self.findings[name]])


SAID = {
    "as-modelled": "agree with the truth",
    "model-difference": "depart from it exactly as declared here",
    "implementation-bug": "depart from it otherwise than declared",
    "translation-bug": "depart from it by what is more likely a fault of the translation",
    "unexplained": "depart from it, and no named cause accounts for that",
}


def dialects(run: Run, links: Links, thumbnails: Thumbnails) -> tuple[Dialect, ...]:
    """Of every renderer that declares a rule, or that anything was found of."""
    out = []
    for adapter in run.adapters:
        if adapter not in TRUTHS and (found := _dialect(run, adapter, links, thumbnails)):
            out.append(found)
    return tuple(out)


def _dialect(run: Run, adapter: str, links: Links, thumbnails: Thumbnails) -> Dialect | None:
    manifest = mapping(mapping(run.manifest, "adapters"), adapter)
    rules = [_rule(facts) for facts in objects(manifest, "dialect")]
    out = Dialect(adapter, text(manifest, "title") or adapter, text(manifest, "version"), rules)
    for case in sorted(run.cases, key=lambda case: case.name):
        standing = standing_of(case.renders[adapter]) if adapter in case.renders else None
        if standing is None:
            continue
        out.cases += 1
        out.findings[standing.finding] += 1
        pair = case.against_truth(adapter)
        if pair is not None and pair.verdict == "diverge":
            _sort_in(out, case, pair, links, thumbnails)
    return out if out.rules or out.beyond or out.unexplained else None


def _sort_in(out: Dialect, case: CaseRecord, pair: Pair, links: Links, thumbnails: Thumbnails) -> None:
    found = causes_of(case, pair)
    for cause in found:
        href = links.case(case.name, pair=pair.name, box=cause.region.box if cause.region else None)
        seen = Seen(case.name, href, thumbnails(case.name, pair.name), cause, len(found) == 1)
        if cause.is_unexplained:
            out.unexplained.append(seen)
        elif cause.declared:
            _declared(out, cause).seen.append(seen)
        else:
            out.beyond.append(seen)


def _declared(out: Dialect, cause: Cause) -> Rule:
    """The rule that a declared cause belongs to; runs of earlier versions do not list what was declared."""
    rule = next((rule for rule in out.rules if rule.cause == cause.id), None)
    if rule is None:
        rule = Rule(cause.id, cause.parameter, cause.sentence.rstrip("."), cause.formula, "")
        out.rules.append(rule)
    return rule


def _rule(facts: Facts) -> Rule:
    formula = [part for part in items(facts, "formula") if isinstance(part, str)]
    where = []
    if models := [str(model) for model in items(facts, "models")]:
        where.append(f"in scenes of model {' or '.join(models)}")
    if unless := [str(feature) for feature in items(facts, "unless")]:
        where.append(f"not in scenes with {' or '.join(unless)}")
    if quirk := text(facts, "quirk"):
        where.append(f"fact {quirk} of the adapter's QUIRKS.md")
    return Rule(
        text(facts, "cause"),
        numerals.parameter(facts.get("parameter")),
        text(facts, "words"),
        (formula[0], formula[1]) if len(formula) == 2 else None,
        "; ".join(where),
    )
