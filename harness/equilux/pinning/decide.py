"""What the scene should expect after a run: proven causes that nothing pins are pinned, causes that are gone are not expected any
more. What is unexplained, and pixels that are no radiance, are never pinned."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from equilux.diagnose.diagnosis import Found
from equilux.explain.causes import UNEXPLAINED, name_of
from equilux.explain.numbers import counted, listed, parameter, share, some
from equilux.pinning.edit import Changes, Pin
from equilux.pinning.when import shortest_when
from equilux.results import CaseRecord, PairRecord
from equilux.trust import TRUTHS, truth_among
from equilux_scenes.case import Case
from equilux_scenes.causes import CAUSES
from equilux_scenes.expectation import applies
from equilux_scenes.model import Expectation


@dataclass(frozen=True)
class Decision:
    """changes: of the scene's `expect`. words: each of them in words. impossible: what cannot be pinned, and why."""

    changes: Changes
    words: tuple[str, ...] = ()
    impossible: tuple[str, ...] = ()


@dataclass
class _Wanted:
    """What one adapter should be expected to do. gone: cases by position of the expectation; new: causes by case."""

    gone: dict[int, set[str]] = field(default_factory=dict)
    new: dict[str, list[Found]] = field(default_factory=dict)


def decide(cases: Sequence[Case], expect: Sequence[Expectation], records: Mapping[str, CaseRecord]) -> Decision:
    """For one scene. cases: all of it, also those that were not run. expect: the scene's expectations. records: by case.

    What was not judged stays as it is: cases that were not run, renders that brought no picture, pairs that could not be
    compared.
    """
    wanted: dict[str, _Wanted] = {}
    impossible: list[str] = []
    for case in cases:
        record = records.get(case.name)
        if record is not None:
            _of_case(case, record, expect, wanted, impossible)
    whens: dict[int, str | None] = {}
    removed: list[int] = []
    added: list[Pin] = []
    words: list[str] = []
    for adapter, what in wanted.items():
        plan = _Plan(adapter, cases, expect, what)
        plan.make(whens, removed, added, words, impossible)
    return Decision(Changes(tuple(added), whens, tuple(sorted(removed))), tuple(words), tuple(impossible))


# --- what a case says -------------------------------------------------------------------------------------------------


def _of_case(
    case: Case, record: CaseRecord, expect: Sequence[Expectation], wanted: dict[str, _Wanted], impossible: list[str]
) -> None:
    truth = truth_among(name for name, render in record.renders.items() if render.status in ("ok", "invalid"))
    told: set[str] = set()
    for pair in record.pairs:
        if pair.b != truth or pair.judged not in ("improved", "diverge_unexpected"):
            continue
        why = _cannot_be_pinned(pair) if pair.judged == "diverge_unexpected" else None
        if why is not None:
            impossible.append(f"{case.name}: {pair.a} against {pair.b}: {why}")
            told.add(pair.a)
            continue
        mine = {index: item for index, item in enumerate(expect) if item.adapter == pair.a and applies(item, case.axes)}
        what = wanted.setdefault(pair.a, _Wanted())
        for index in _gone(pair, record, mine):
            what.gone.setdefault(index, set()).add(case.name)
        if pair.judged == "diverge_unexpected":
            pinned = {item.cause for item in mine.values()}
            what.new[case.name] = [cause for cause in _proven(pair) if not _names(cause) & pinned]
    impossible += _peers(case, record, truth, told, wanted, expect)


def _cannot_be_pinned(pair: PairRecord) -> str | None:
    if pair.a in TRUTHS:
        return "two truths disagree; one of them is wrong, and no scene should expect that"
    if pair.invalid:
        return f"{counted(pair.invalid, 'pixel')} without a radiance: no cause stands for that"
    left = [cause for cause in pair.causes if cause.id == UNEXPLAINED]
    proven = _proven(pair)
    if left or not proven:
        known = f" ({listed([name_of(cause) for cause in proven])} is proven)" if proven else ""
        amount = (
            f"{share(left[0].explained)} of the diverging pixels" if left and left[0].explained is not None else "the divergence"
        )
        reason = f" ({pair.reason})" if not left and pair.reason else ""
        return f"{amount} is unexplained{known}{reason}; nobody but you can say that this is expected"
    return None


def _proven(pair: PairRecord) -> list[Found]:
    return [cause for cause in pair.causes if cause.id != UNEXPLAINED and cause.side in (None, pair.a)]


def _names(cause: Found) -> set[str]:
    return {cause.id, *(other.id for other in cause.alternatives)}


def _gone(pair: PairRecord, record: CaseRecord, mine: Mapping[int, Expectation]) -> list[int]:
    """Expectations whose cause was looked for and not found."""
    held = {(used.adapter, used.cause, used.when): used.held for used in record.expect}
    gone = []
    for index, item in mine.items():
        holds = held.get((item.adapter, item.cause, item.when))
        if holds is False or (holds is None and pair.verdict == "agree"):
            gone.append(index)
    return gone


def _peers(
    case: Case,
    record: CaseRecord,
    truth: str | None,
    told: set[str],
    wanted: Mapping[str, _Wanted],
    expect: Sequence[Expectation],
) -> list[str]:
    """Unexpected divergences between peers that no expectation against the truth will cover."""
    out = []
    for pair in record.pairs:
        if pair.b == truth or pair.judged != "diverge_unexpected" or {pair.a, pair.b} & told:
            continue
        pinned = {item.adapter for item in expect if applies(item, case.axes)}
        pinned |= {adapter for adapter, what in wanted.items() if what.new.get(case.name)}
        if pair.invalid or not pinned & {pair.a, pair.b}:
            why = (
                "neither diverges from the truth by a cause"
                if truth is not None
                else "there is no truth to diagnose them against"
            )
            out.append(f"{case.name}: {pair.a} against {pair.b}: {why}, so there is nothing to pin")
    return out


# --- what follows for the scene ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Plan:
    """The changes for one adapter."""

    adapter: str
    cases: Sequence[Case]
    expect: Sequence[Expectation]
    what: _Wanted

    def make(
        self, whens: dict[int, str | None], removed: list[int], added: list[Pin], words: list[str], impossible: list[str]
    ) -> None:
        new = self._chosen()
        for index, item in enumerate(self.expect):
            if item.adapter != self.adapter:
                continue
            covered = {case.name for case in self.cases if applies(item, case.axes)}
            kept = covered - self.what.gone.get(index, set())
            extra = set(new[item.cause]) - covered if kept and item.cause in new else set()
            if not kept and covered:
                removed.append(index)
                words.append(f"remove {self.adapter}: {item.cause}{_when(item.when)}: it is gone{self._on(covered)}")
            elif kept != covered or extra:
                when = self._when(kept | extra, new.get(item.cause, {}).values())
                if when is None:
                    impossible.append(self._no_expression(item.cause, kept | extra))
                else:
                    whens[index] = when or None
                    change = "widen" if extra else "narrow"
                    words.append(f"{change} {self.adapter}: {item.cause}{_when(item.when)} to{_when(when) or ' all cases'}")
                if extra:
                    del new[item.cause]
        for cause, found in new.items():
            when = self._when(set(found), found.values())
            if when is None:
                impossible.append(self._no_expression(cause, set(found)))
            else:
                added.append(Pin(self.adapter, cause, when or None, _reason(cause, found)))
                words.append(f"add {self.adapter}: {cause}{_when(when)}: proven{self._on(set(found))}")

    def _chosen(self) -> dict[str, dict[str, Found]]:
        """Cause → case → what was found. Of causes that a scene cannot tell apart, the one that serves most cases."""
        left = [(case, found) for case, causes in self.what.new.items() for found in causes]
        pinned = {item.cause for item in self.expect if item.adapter == self.adapter}
        chosen: dict[str, dict[str, Found]] = {}
        while left:
            counts = Counter(name for _, found in left for name in _names(found))
            first = Counter(found.id for _, found in left)
            best = max(counts, key=lambda name: (counts[name], name in pinned, first[name], name))
            chosen[best] = {case: found for case, found in left if best in _names(found)}
            left = [(case, found) for case, found in left if best not in _names(found)]
        return chosen

    def _when(self, names: set[str], found: Iterable[Found]) -> str | None:
        parameters = [float(cause.parameter) for cause in found if isinstance(cause.parameter, int | float)]
        return shortest_when([case.axes for case in self.cases], [case.name in names for case in self.cases], parameters)

    def _on(self, names: set[str]) -> str:
        """On which cases, where there are several to choose from."""
        if len(self.cases) == 1:
            return ""
        return f" on {some([case.name for case in self.cases if case.name in names])}"

    def _no_expression(self, cause: str, names: set[str]) -> str:
        return (
            f"{self.adapter}: {cause} on {some(sorted(names))}: no `when` selects these cases alone, "
            "as they differ in values that are no numbers"
        )


def _when(when: str | None) -> str:
    return f" when {when}" if when else ""


def _reason(cause: str, found: Mapping[str, Found]) -> str:
    """The comment beside a new expectation: CONTRIBUTING wants a reason there."""
    first = max(found.values(), key=lambda each: each.explained or 0.0)
    words = (first.words if first.id == cause else "") or CAUSES.get(cause, "") or name_of(first)
    value = parameter(first.parameter)
    known = "" if not value or value in words else f" [{value}]"
    part = f", explains {share(first.explained)}" if first.explained is not None else ""
    return f"{words[:1].upper()}{words[1:].rstrip('.')}{known} (found by a run{part})"
