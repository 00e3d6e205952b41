"""How renders and expectations stand: each render judged three ways, each expectation held or gone."""

from __future__ import annotations

from dataclasses import dataclass

from equilux_report import words
from equilux_report.facts import Facts, mapping, objects, text
from equilux_report.tree import CaseRecord, Render


@dataclass(frozen=True)
class Standing:
    """A render against the truth, against what its adapter declares, and against its peers: "agree", "diverge" or ""."""

    adapter: str
    truth: str
    dialect: str
    agrees_with: tuple[str, ...]
    diverges_from: tuple[str, ...]
    finding: str
    reason: str

    @property
    def label(self) -> str:
        return words.FINDING.get(self.finding, self.finding)


def standing_of(render: Render) -> Standing | None:
    """None for a truth, and where the results do not say."""
    facts = mapping(render.facts, "standing")
    if not text(facts, "finding"):
        return None
    peers = mapping(facts, "peers")
    return Standing(
        render.adapter,
        text(facts, "truth"),
        text(facts, "dialect"),
        tuple(name for name in peers if peers[name] == "agree"),
        tuple(name for name in peers if peers[name] == "diverge"),
        text(facts, "finding"),
        text(facts, "reason"),
    )


@dataclass(frozen=True)
class Expectation:
    """One expectation of a scene. state: "held"; "gone": its cause is no longer found; "open": nothing could be judged."""

    case: str
    adapter: str
    cause: str
    when: str
    state: str


def expectations_of(case: CaseRecord) -> tuple[Expectation, ...]:
    """The expectations of a case that had a say."""
    return tuple(
        Expectation(case.name, text(item, "adapter"), text(item, "cause"), text(item, "when"), _state(case, item))
        for item in objects(case.facts, "expect")
    )


def _state(case: CaseRecord, item: Facts) -> str:
    """Results of earlier versions do not say what held: the judgement of the pair does."""
    if isinstance(item.get("held"), bool):
        return "held" if item["held"] else "gone"
    pair = case.against_truth(text(item, "adapter"))
    if "held" in item or pair is None:
        return "open"
    return {"diverge_expected": "held", "improved": "gone"}.get(pair.judged, "open")
