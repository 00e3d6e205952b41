"""How a pair or a render counts for a CI: passed, failed or skipped, exactly as `equilux run` counts it (judge.exit_code)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from equilux.ci import text, words
from equilux.ci.view import RunView
from equilux.explain.causes import name_of
from equilux.judge import DELIVERED, FAILED
from equilux.results import CaseRecord, PairRecord

Result = Literal["passed", "failed", "skipped"]


@dataclass(frozen=True)
class Outcome:
    """One thing that a CI counts. kind: a pair's judgement, or the status of a render that brought no picture. message: one line.
    text: everything, empty for what did not fail. scored: as exit code 4 counts. facts: name and value, causes among them.
    """

    name: str
    result: Result
    kind: str
    message: str
    text: str = ""
    scored: bool = False
    facts: tuple[tuple[str, str], ...] = ()
    seconds: float = 0.0


def of_pair(case: CaseRecord, pair: PairRecord, view: RunView, seconds: float = 0.0) -> Outcome:
    """A divergence that is unexpected, and a pinned one that is gone, fail; what cannot be compared is skipped."""
    result: Result = "passed"
    if pair.judged in words.UNEXPECTED:
        result = "failed"
    elif pair.judged == "not_comparable":
        result = "skipped"
    return Outcome(
        name=f"{pair.a}--{pair.b}",
        result=result,
        kind=pair.judged,
        message=words.pair_headline(case, pair),
        text=text.pair_text(case, pair, view) if result == "failed" else "",
        scored=pair.judged != "not_comparable" and (not view.named or bool({pair.a, pair.b} & view.named)),
        facts=tuple(_facts(case, pair)),
        seconds=seconds,
    )


def of_render(case: CaseRecord, adapter: str, view: RunView, seconds: float = 0.0) -> Outcome | None:
    """A render that failed, or is missing though asked for by name, fails; unsupported and other missing ones are skipped. None
    for one that brought a picture.
    """
    status = case.renders[adapter].status
    if status in DELIVERED:
        return None
    failed = status in FAILED or (status == "missing" and adapter in view.named)
    return Outcome(
        name=adapter,
        result="failed" if failed else "skipped",
        kind=status,
        message=words.render_headline(case, adapter),
        text=text.render_text(case, adapter, view) if failed else "",
        facts=tuple(("missing feature", feature) for feature in case.renders[adapter].missing_features),
        seconds=seconds,
    )


def of_case(case: CaseRecord, view: RunView) -> Iterator[Outcome]:
    """Every pair, then every render without a picture. What a render took is counted once, in the first that it has a part in."""
    spent = {name: sum(render.seconds.values()) for name, render in case.renders.items() if not render.reused}
    for pair in case.pairs:
        yield of_pair(case, pair, view, spent.pop(pair.a, 0.0) + spent.pop(pair.b, 0.0))
    for name in case.renders:
        if (outcome := of_render(case, name, view, spent.pop(name, 0.0))) is not None:
            yield outcome


def _facts(case: CaseRecord, pair: PairRecord) -> Iterator[tuple[str, str]]:
    """For machines: the causes found, and those the scene expected."""
    yield "verdict", pair.judged
    if pair.explained is not None:
        yield "explained", f"{pair.explained:.6g}"
    for found in pair.causes:
        yield "cause", f"{found.side or pair.a}: {name_of(found)}"
    if pair.judged == "diverge_expected":
        for used in case.expect:
            if used.adapter in (pair.a, pair.b):
                yield "expected cause", f"{used.adapter}: {used.cause}"
