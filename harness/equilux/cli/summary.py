"""The table a run ends with: per adapter what came back, per judgement how many pairs, and whatever needs a look."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from equilux.accuracy import Kept, kept
from equilux.cli.inputs import table
from equilux.diagnose.diagnosis import Found
from equilux.explain.causes import name_of
from equilux.explain.numbers import counted
from equilux.judge import FAILED
from equilux.results import AccuracyRecord, CaseRecord, PairRecord, Results
from equilux.trust import TRUTHS, trust_rank

SHOWN = 20
SHOWN_UNMET = 5
HEADER: tuple[str, ...] = (
    "adapter", "version", "ok", "unsupported", "failed", "missing", "agree", "expected", "unexpected", "gone", "render s",
)  # fmt: skip


def summary(results: Results) -> str:
    """The whole text, plain."""
    parts = [_adapters(results), _accuracy(results), _look_at(results), _counts(results)]
    if results.run.interrupted:
        parts.append(f"interrupted ({results.run.interrupted}): only what was finished is in the results\n")
    return "\n".join(part for part in parts if part)


def _adapters(results: Results) -> str:
    names = sorted({name for case in results.cases for name in case.renders}, key=trust_rank)
    rows = [HEADER]
    for name in sorted(names, key=trust_rank, reverse=True):
        statuses = Counter(str(case.renders[name].status) for case in results.cases if name in case.renders)
        judged = Counter(str(pair.judged) for case in results.cases for pair in case.pairs if name in (pair.a, pair.b))
        spent = sum(case.renders[name].seconds.get("render", 0.0) for case in results.cases if name in case.renders)
        failed = sum(statuses[status] for status in (*FAILED, "invalid"))
        counts = [
            statuses["ok"], statuses["unsupported"], failed, statuses["missing"],
            judged["agree"], judged["diverge_expected"], judged["diverge_unexpected"], judged["improved"],
        ]  # fmt: skip
        rows.append((name, results.run.adapters.get(name, ""), *map(str, counts), f"{spent:.1f}"))
    return table(rows, right=frozenset(range(2, len(HEADER)))) if names else ""


def _accuracy(results: Results) -> str:
    """Who claims the accuracy that was asked for, on how many pictures, and how that stands to the truth; and who does not, and
    why."""
    asked = [
        (case, name, render.accuracy)
        for case in results.cases
        for name, render in case.renders.items()
        if render.accuracy is not None
    ]
    if not asked:
        return ""
    claims = kept(results.cases)
    lines = []
    for adapter in sorted({name for _, name, _ in asked}, key=trust_rank, reverse=True):
        own = [(case, said) for case, name, said in asked if name == adapter]
        unmet = [(case, said) for case, said in own if not said.met]
        met = f"{len(own) - len(unmet)} of {counted(len(own), 'picture')}"
        held = _held(claim for claim in claims if claim.adapter == adapter)
        lines.append(f"accuracy {own[0][1].asked:g}: {adapter} claims it on {met}{held}")
        lines += [f"  not on {case.case}: {_unmet(said)}" for case, said in unmet[:SHOWN_UNMET]]
        if len(unmet) > SHOWN_UNMET:
            lines.append(f"  … and {len(unmet) - SHOWN_UNMET} more: see results.json")
    lines += [
        f"{claim.case}: {claim.adapter} claims {claim.claimed:.2g} and is off by {claim.error:.2g}"
        for claim in claims
        if claim.holds is False
    ]
    return "".join(f"{line}\n" for line in lines)


def _held(claims: Iterable[Kept]) -> str:
    claims = list(claims)
    if not claims:
        return ""
    held = sum(claim.holds is True for claim in claims)
    declared = sum(claim.by_dialect for claim in claims)
    unknown = sum(claim.holds is None for claim in claims)
    words = f"; {held} of {len(claims)} hold against the truth"
    words += f", {declared} of them but for what it declares to do otherwise" if declared else ""
    return words + (f"; {unknown} could not be compared" if unknown else "")


def _unmet(said: AccuracyRecord) -> str:
    return f"{f'it claims {said.claimed:.2g}; ' if said.claimed is not None else ''}{said.reason}"


def _look_at(results: Results) -> str:
    """Failures, unexpected divergences and expectations that no longer hold, one line each."""
    lines = [
        f"{case.case}: {name} {render.status}: {render.reason}"
        for case in results.cases
        for name, render in case.renders.items()
        if render.status in FAILED
    ]
    lines += [
        _pair_line(case, pair)
        for case in results.cases
        for pair in case.pairs
        if pair.judged in ("diverge_unexpected", "improved")
    ]
    more = len(lines) - SHOWN
    return "".join(f"{line}\n" for line in lines[:SHOWN]) + (f"… and {more} more: see results.json\n" if more > 0 else "")


def _pair_line(case: CaseRecord, pair: PairRecord) -> str:
    if pair.judged == "improved":
        gone = [used.cause for used in case.expect if used.adapter == pair.a and (pair.verdict == "agree" or used.held is False)]
        if pair.verdict == "agree":
            what = f"agrees with {pair.b}, but the scene expects it to diverge ({', '.join(gone)})"
        else:
            found = ", ".join(dict.fromkeys(cause.id for cause in pair.causes))
            what = f"diverges from {pair.b} by {found}, and no more by {', '.join(gone)} as the scene expects"
        return f"{case.case}: {pair.a} {what}: remove the expectation{'s' if len(gone) > 1 else ''}"
    if pair.diverge:
        size = f", largest difference {pair.max_abs:.3g}" if pair.max_abs is not None else ""
        far = pair.look_at
        share = f"{pair.diverge} of {pair.pixels} pixels{size}"
    else:
        share, far = pair.reason or "no pixel could be scored", pair.worst
    place = f" at ({far.x}, {far.y})" if far is not None else ""
    found = ", ".join(dict.fromkeys(f"{_who(cause, pair)}{name_of(cause)}" for cause in pair.causes))
    return f"{case.case}: {pair.a} diverges from {pair.b}: {share}{place}{f'; by {found}' if found else ''}"


def _who(cause: Found, pair: PairRecord) -> str:
    """Whose cause it is, where it might be either side's."""
    return f"{cause.side}'s " if pair.b not in TRUTHS and cause.side else ""


def _counts(results: Results) -> str:
    pairs, renders = results.summary.pairs, results.summary.renders
    total = sum(renders.model_dump().values())
    reused = f", {results.summary.reused} reused" if results.summary.reused else ""
    return (
        f"{counted(results.summary.cases, 'case')}, {total} renders ({renders.ok} ok{reused}), pairs: {pairs.agree} agree, "
        f"{pairs.diverge_expected} diverge as expected, {pairs.diverge_unexpected} unexpectedly, "
        f"{pairs.improved} expected but gone, {pairs.not_comparable} not comparable; {results.run.seconds:.1f} s\n"
    )
