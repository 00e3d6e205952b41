"""Two results, compared: pure, from their records alone."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from equilux.diagnose.diagnosis import Found
from equilux.difference.changes import MARKED_FACTOR, MARKED_SECONDS, SAME_PARAMETER, Change, arrow
from equilux.explain.causes import name_of
from equilux.explain.numbers import parameter, short
from equilux.results import CaseRecord, RenderRecord, Results
from equilux.trust import truth_among

JUDGED_WORDS = {
    "agree": "agree", "diverge_expected": "diverge as expected", "diverge_unexpected": "diverge unexpectedly",
    "improved": "expected to diverge, and gone", "not_comparable": "not comparable",
}  # fmt: skip


def compare_runs(
    a: Results, b: Results, manifest_a: Mapping[str, Any] | None = None, manifest_b: Mapping[str, Any] | None = None
) -> list[Change]:
    """Everything that changed from a to b, pictures apart. The manifests are their run.json."""
    before, after = ({case.case: case for case in results.cases} for results in (a, b))
    changes = [*_run(a, b, manifest_a or {}, manifest_b or {})]
    changes += [Change("case", "only in A", case=name) for name in before if name not in after]
    changes += [Change("case", "only in B", case=name) for name in after if name not in before]
    changes += _scenes(before, manifest_a or {}, manifest_b or {})
    both_ran = _adapters(a) & _adapters(b)
    for name, case in before.items():
        if name in after:
            changes += _case(case, after[name], both_ran)
    return changes


def _adapters(results: Results) -> set[str]:
    return {name for case in results.cases for name in case.renders}


# --- the runs ---------------------------------------------------------------------------------------------------------


def _run(a: Results, b: Results, manifest_a: Mapping[str, Any], manifest_b: Mapping[str, Any]) -> Iterator[Change]:
    """Versions, machine, knobs, command. They explain changes, and are none by themselves."""

    def change(what: str, before: Any, after: Any, adapter: str | None = None) -> Iterator[Change]:
        if before != after:
            words = f"{what}: {arrow(_or_none(before), _or_none(after))}"
            yield Change("run", words, matters=False, adapter=adapter, before=before, after=after)

    yield from change("equilux", a.run.equilux, b.run.equilux)
    for name in sorted(_adapters(a) | _adapters(b)):
        if name not in _adapters(a) or name not in _adapters(b):
            where = "B" if name in _adapters(b) else "A"
            yield Change("run", f"{name} took part in {where} alone", matters=True, adapter=name)
            continue
        yield from change(name, a.run.adapters.get(name), b.run.adapters.get(name), name)
        ours, theirs = (_dig(manifest, "adapters", name) for manifest in (manifest_a, manifest_b))
        yield from change(f"{name}: distribution", ours.get("distribution"), theirs.get("distribution"), name)
        for knob in sorted({*_dig(ours, "knobs"), *_dig(theirs, "knobs")}):
            yield from change(f"{name}: knob {knob}", _dig(ours, "knobs").get(knob), _dig(theirs, "knobs").get(knob), name)
        codes = [_dig(manifest, "identity", "adapters", name).get("code") for manifest in (manifest_a, manifest_b)]
        if None not in codes and codes[0] != codes[1]:
            yield Change("run", f"{name}: the adapter's code", matters=False, adapter=name, before=codes[0], after=codes[1])
    for part in ("libraries", "machine", "options"):
        ours, theirs = _dig(manifest_a, part), _dig(manifest_b, part)
        for key in sorted({*ours, *theirs}):
            yield from change(key if part == "libraries" else f"{part}: {key}", ours.get(key), theirs.get(key))
    yield from change("command", " ".join(a.run.command), " ".join(b.run.command))
    yield from change("interrupted", a.run.interrupted, b.run.interrupted)


def _or_none(value: Any) -> Any:
    return "none" if value is None or value == "" else value


def _dig(content: Mapping[str, Any], *keys: str) -> Mapping[str, Any]:
    """A mapping inside mappings; empty where there is none."""
    for key in keys:
        inner = content.get(key)
        content = inner if isinstance(inner, Mapping) else {}
    return content


def _scenes(cases: Mapping[str, CaseRecord], manifest_a: Mapping[str, Any], manifest_b: Mapping[str, Any]) -> Iterator[Change]:
    """Cases of the same name whose scene is another one."""
    ours, theirs = (_dig(manifest, "identity", "cases") for manifest in (manifest_a, manifest_b))
    for name in cases:
        if name in ours and name in theirs and ours[name] != theirs[name]:
            yield Change("case", "the scene itself changed", case=name, before=ours[name], after=theirs[name])


# --- a case -----------------------------------------------------------------------------------------------------------


def _case(a: CaseRecord, b: CaseRecord, both_ran: set[str]) -> Iterator[Change]:
    for adapter in sorted(both_ran & (set(a.renders) | set(b.renders))):
        yield from _render(a, a.renders.get(adapter), b.renders.get(adapter), adapter)
    yield from _judgements(a, b)
    yield from _causes(a, b)
    expected_a, expected_b = ({(item.adapter, item.cause, item.when) for item in case.expect} for case in (a, b))
    for adapter, cause, when in sorted(expected_a ^ expected_b, key=str):
        words = "now expected" if (adapter, cause, when) in expected_b else "no longer expected"
        yield Change(
            "expectation", f"{adapter}: {cause}{f' when {when}' if when else ''} is {words}", case=a.case, adapter=adapter
        )


def _render(case: CaseRecord, a: RenderRecord | None, b: RenderRecord | None, adapter: str) -> Iterator[Change]:
    before, after = (render.status if render is not None else "not asked" for render in (a, b))
    if before != after:
        told = b if after != "ok" else a  # the reason of whichever did not go well
        reason = (told.reason or "") if told is not None else ""
        detail = f"it was: {reason}" if reason and after == "ok" else reason
        yield Change("status", f"{adapter}: {arrow(before, after)}", True, case.case, adapter, before, after, detail)
    if a is None or b is None:
        return
    if a.standing is not None and b.standing is not None and a.standing.finding != b.standing.finding:
        change = arrow(a.standing.finding, b.standing.finding)
        yield Change("finding", f"{adapter}: {change}", True, case.case, adapter, a.standing.finding, b.standing.finding)
    yield from _uncertainty(case, a, b, adapter)
    yield from _time(case, a, b, adapter)


def _uncertainty(case: CaseRecord, a: RenderRecord, b: RenderRecord, adapter: str) -> Iterator[Change]:
    """A stated uncertainty that changed markedly: what is claimed is another thing now."""
    if a.uncertainty is None or b.uncertainty is None:
        return
    parts = {
        "abs": (a.uncertainty.abs, b.uncertainty.abs),
        "rel": (a.uncertainty.rel, b.uncertainty.rel),
        "per pixel": tuple(
            (stated.per_pixel.max or 0.0) if stated.per_pixel is not None else 0.0 for stated in (a.uncertainty, b.uncertainty)
        ),
    }
    for name, (before, after) in parts.items():
        if max(before, after) > MARKED_FACTOR * min(before, after):
            larger = "larger" if after > before else "smaller"
            what = f"{adapter}: the stated uncertainty ({name}) is markedly {larger}"
            yield Change("uncertainty", what, True, case.case, adapter, before, after, arrow(short(before), short(after)),
                         _log_ratio(before, after))  # fmt: skip


def _time(case: CaseRecord, a: RenderRecord, b: RenderRecord, adapter: str) -> Iterator[Change]:
    before, after = a.seconds.get("render"), b.seconds.get("render")
    if before is None or after is None or abs(after - before) < MARKED_SECONDS:
        return
    if max(before, after) > MARKED_FACTOR * min(before, after):
        slower = "slower" if after > before else "faster"
        detail = f"{before:.2f} s → {after:.2f} s"
        yield Change("time", f"{adapter}: rendering is markedly {slower}", False, case.case, adapter, before, after, detail,
                     abs(after - before))  # fmt: skip


def _log_ratio(before: float, after: float) -> float:
    return abs(math.log(after / before)) if before > 0 and after > 0 else math.inf


# --- pairs and causes -------------------------------------------------------------------------------------------------


def _judgements(a: CaseRecord, b: CaseRecord) -> Iterator[Change]:
    """Pairs that are in both; where one is missing, the status of a render says why."""
    after = {(pair.a, pair.b): pair for pair in b.pairs}
    for pair in a.pairs:
        now = after.get((pair.a, pair.b))
        if now is not None and (now.judged, now.verdict) != (pair.judged, pair.verdict):
            before_words, after_words = (
                JUDGED_WORDS[each.judged] + (f" ({each.verdict})" if each.judged == "improved" else "") for each in (pair, now)
            )
            size = f"{now.diverge} of {now.pixels} pixels, at most {short(now.max_abs)}" if now.diverge else ""
            what = f"{pair.a} against {pair.b}: {arrow(before_words, after_words)}"
            yield Change("judgement", what, True, a.case, pair.a, pair.judged, now.judged, size, now.max_abs or 0.0)


def _causes(a: CaseRecord, b: CaseRecord) -> Iterator[Change]:
    before, after = _found(a), _found(b)
    for adapter in sorted({*before, *after}):
        ours, theirs = before.get(adapter, {}), after.get(adapter, {})
        if not _is_comparable(a, adapter) or not _is_comparable(b, adapter):
            continue
        for cause in dict.fromkeys([*ours, *theirs]):
            yield from _cause(a.case, adapter, cause, ours.get(cause), theirs.get(cause))


def _found(case: CaseRecord) -> dict[str, dict[str, Found]]:
    """Adapter → cause → what was found, of the pairs with the truth."""
    truth = truth_among(name for name, render in case.renders.items() if render.status in ("ok", "invalid"))
    return {pair.a: {cause.id: cause for cause in pair.causes} for pair in case.pairs if pair.b == truth}


def _is_comparable(case: CaseRecord, adapter: str) -> bool:
    """A render that brought no picture has lost no cause."""
    return adapter in case.renders and case.renders[adapter].status in ("ok", "invalid")


def _cause(case: str, adapter: str, cause: str, a: Found | None, b: Found | None) -> Iterator[Change]:
    if a is None or b is None:
        known = a or b
        assert known is not None
        words = f"{name_of(known)} {'vanished' if b is None else 'appeared'}"
        yield Change("cause", f"{adapter}: {words}", True, case, adapter, a and a.parameter, b and b.parameter)
    elif a.reading != b.reading:
        what = f"{adapter}: {arrow(name_of(a), name_of(b))}"
        yield Change("cause", what, True, case, adapter, a.reading, b.reading)
    elif not _same(a.parameter, b.parameter):
        what = f"{adapter}: {cause} {arrow(parameter(a.parameter) or 'none', parameter(b.parameter) or 'none')}"
        yield Change("cause", what, True, case, adapter, a.parameter, b.parameter)


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, list | tuple) and isinstance(b, list | tuple):
        return len(a) == len(b) and all(_same(x, y) for x, y in zip(a, b, strict=True))
    if isinstance(a, int | float) and isinstance(b, int | float):
        return math.isclose(a, b, rel_tol=SAME_PARAMETER)
    return bool(a == b)
