"""The job summary: what a reviewer should know of a run, in Markdown, what needs a look first."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence

from equilux.ci import words
from equilux.ci.markdown import code, plain, table
from equilux.ci.view import RunView, shown
from equilux.explain.gather import gather
from equilux.explain.numbers import BANDS, counted, number, share, short
from equilux.explain.sentences import short_or_infinite
from equilux.judge import FAILED
from equilux.results import CaseRecord, PairRecord
from equilux.trust import TRUTHS, trust_rank

SHOWN = 50
"""Rows of one table: what is worse than that is read in the report."""
GITHUB_BYTES = 1 << 20
"""A step's summary that is larger is refused whole by GitHub."""
VERDICTS = {
    "diverge_unexpected": "diverge unexpectedly", "improved": "expected to diverge, but gone", "diverge_expected":
    "diverge as expected", "agree": "agree", "not_comparable": "not comparable",
}  # fmt: skip


def summary(view: RunView) -> str:
    """The whole text."""
    parts = (
        _opening(view),
        _engine(view),
        _unexpected(view),
        _failed(view),
        _counts(view),
        _adapters(view),
        _known(view),
        _unsupported(view),
        _where(view),
    )
    return "\n".join(line for part in parts if (lines := list(part)) for line in (*lines, ""))


def job_summary(view: RunView) -> str:
    """The same, cut where GitHub would refuse it."""
    text = summary(view)
    if len(text.encode()) < GITHUB_BYTES:
        return text
    note = "\n\n… the rest is in summary.md of the results\n"
    cut = text.encode()[: GITHUB_BYTES - len(note.encode()) - 1].decode(errors="ignore")
    return cut.rpartition("\n")[0] + note


def verdict_line(view: RunView) -> str:
    """How it went, in one line."""
    pairs = view.results.summary.pairs
    failures = len(words.failed_renders(view.results.cases, view.named))
    parts = [
        _some(pairs.diverge_unexpected, "unexpected divergence"),
        _some(pairs.improved, "expected divergence", " gone"),
        _some(failures, "failed render"),
        _some(len(view.errors), "fault", " of the engine"),
    ]
    said = ", ".join(part for part in parts if part)
    if view.results.run.interrupted:
        said = ", ".join(part for part in (said, f"interrupted ({view.results.run.interrupted})") if part)
    return said or ("nothing was scored" if view.results.summary.exit_code == 4 else "every expectation held")


def _some(count: int, one: str, after: str = "") -> str:
    return f"{count} {one}{'s' if count != 1 else ''}{after}" if count else ""


def _opening(view: RunView) -> Iterator[str]:
    yield f"## equilux: {verdict_line(view)}"
    yield ""
    renders = view.results.summary.renders
    total = sum(renders.model_dump().values())
    pairs = sum(view.results.summary.pairs.model_dump().values())
    yield (
        f"{counted(view.results.summary.cases, 'case')}, {total} renders "
        f"({renders.ok} ok, {view.results.summary.reused} reused), {pairs} pairs; "
        f"{view.results.run.seconds:.1f} s; exit code {view.results.summary.exit_code}"
    )


def _engine(view: RunView) -> Iterator[str]:
    if view.errors:
        yield "### Faults of the engine itself"
        yield ""
        yield from (f"- {plain(error)}" for error in view.errors[:SHOWN])
        yield from _more(len(view.errors))


def _unexpected(view: RunView) -> Iterator[str]:
    """One row per pair with the truth; pairs of peers only where the truth does not speak for them."""
    found = [
        (case, pair)
        for judged in words.UNEXPECTED
        for case in view.results.cases
        for pair in case.pairs
        if pair.judged == judged and words.speaks_for_itself(case, pair)
    ]
    if not found:
        return
    yield "### To be looked at"
    yield ""
    rows = [_row(case, pair, view) for case, pair in found[:SHOWN]]
    yield from table(("case", "pair", "what", "pixels", "worst pixel: both numbers, bound B, E_n"), rows)
    yield from _more(len(found))


def _row(case: CaseRecord, pair: PairRecord, view: RunView) -> list[str]:
    if pair.judged == "improved":
        what = plain(words.pair_headline(case, pair))
    else:
        what = plain(words.causes_in_words(pair) or pair.reason or "no cause was proven")
        standing = case.renders[pair.a].standing if pair.a in case.renders else None
        if standing is not None:
            what += f" ({plain(standing.finding.replace('-', ' '))})"
        if pair.explained is not None:
            what += f", explains {share(pair.explained)}"
    pixels = f"{pair.diverge} of {pair.pixels} ({words.share_of(pair.diverge, pair.pixels)})"
    return [code(case.case), f"{plain(pair.a)} / {plain(pair.b)}", what, plain(pixels), _worst(case, pair, view)]


def _worst(case: CaseRecord, pair: PairRecord, view: RunView) -> str:
    worst = gather(view.read, case, pair).worst
    if worst is None:
        return plain(f"({pair.worst.x}, {pair.worst.y})") if pair.worst is not None else ""
    band = worst.band
    return plain(
        f"({worst.x}, {worst.y}) {BANDS[band]}: {pair.a} {number(worst.a[band], 7)}, {pair.b} {number(worst.b[band], 7)}, "
        f"B = {short(worst.bound[band])}, E_n = {short_or_infinite(worst.normalised_error[band])}"
    )


def _failed(view: RunView) -> Iterator[str]:
    found = words.failed_renders(view.results.cases, view.named)
    if not found:
        return
    yield "### Renders that failed"
    yield ""
    rows = [
        [code(case.case), plain(name), plain(case.renders[name].status), plain(case.renders[name].reason or "")]
        for case, name in found[:SHOWN]
    ]
    yield from table(("case", "adapter", "status", "why"), rows)
    yield from _more(len(found))


def _counts(view: RunView) -> Iterator[str]:
    counts = view.results.summary.pairs.model_dump()
    yield "### Verdicts"
    yield ""
    yield from table(("verdict", "pairs"), [[words_, str(counts[judged])] for judged, words_ in VERDICTS.items()], right=(1,))


def _adapters(view: RunView) -> Iterator[str]:
    names = sorted({name for case in view.results.cases for name in case.renders}, key=trust_rank, reverse=True)
    rows = []
    for name in names:
        statuses = Counter(str(case.renders[name].status) for case in view.results.cases if name in case.renders)
        judged = Counter(str(pair.judged) for case in view.results.cases for pair in case.pairs if name in (pair.a, pair.b))
        failed = sum(statuses[status] for status in (*FAILED, "invalid"))
        counts = [statuses["ok"], statuses["unsupported"], failed, statuses["missing"]]
        counts += [judged[verdict] for verdict in ("agree", "diverge_expected", "diverge_unexpected", "improved")]
        rows.append([plain(name), plain(view.results.run.adapters.get(name, "")), *map(str, counts)])
    if rows:
        header = ("adapter", "version", "ok", "unsupported", "failed", "missing", "agree", "expected", "unexpected", "gone")
        yield "### By adapter"
        yield ""
        yield from table(header, rows, right=range(2, len(header)))


def _known(view: RunView) -> Iterator[str]:
    """Divergences that the scenes expect, by adapter and cause."""
    cases: dict[tuple[str, str], list[str]] = defaultdict(list)
    for case in view.results.cases:
        for pair in case.pairs:
            if pair.judged != "diverge_expected" or pair.b not in TRUTHS:
                continue
            for cause in _causes_of(case, pair):
                if case.case not in cases[pair.a, cause]:
                    cases[pair.a, cause].append(case.case)
    if cases:
        yield "### Known divergences, by cause"
        yield ""
        rows = [
            [plain(adapter), code(cause), str(len(names)), _names(names)]
            for (adapter, cause), names in sorted(cases.items(), key=lambda item: (item[0][0], -len(item[1]), item[0][1]))
        ]
        yield from table(("adapter", "cause", "cases", "for example"), rows[:SHOWN], right=(2,))
        yield from _more(len(rows))


def _causes_of(case: CaseRecord, pair: PairRecord) -> list[str]:
    """The causes found; the expected ones where none was."""
    return [found.id for found in pair.causes] or [used.cause for used in case.expect if used.adapter == pair.a]


def _unsupported(view: RunView) -> Iterator[str]:
    cases: dict[tuple[str, tuple[str, ...]], list[str]] = defaultdict(list)
    for case in view.results.cases:
        for name, render in case.renders.items():
            if render.status == "unsupported":
                models = tuple(feature for feature in render.missing_features if feature.startswith("model."))
                cases[name, models or tuple(render.missing_features)].append(case.case)
    if cases:
        yield "### Not supported"
        yield ""
        rows = [
            [plain(adapter), ", ".join(map(code, features)), str(len(names)), _names(names)]
            for (adapter, features), names in sorted(cases.items(), key=lambda item: (item[0][0], -len(item[1]), item[0][1]))
        ]
        yield from table(("adapter", "lacks", "cases", "for example"), rows[:SHOWN], right=(2,))
        yield from _more(len(rows))


def _names(names: Sequence[str], shown: int = 3) -> str:
    return ", ".join(map(code, names[:shown])) + (f" and {len(names) - shown} more" if len(names) > shown else "")


def _more(count: int) -> Iterator[str]:
    if count > SHOWN:
        yield ""
        yield f"… and {count - SHOWN} more"


def _where(view: RunView) -> Iterator[str]:
    tree = shown(view.tree)
    yield f"Pictures and numbers: {code('report/index.html')} in the results ({code(tree)}); one pair in words: " + code(
        f"equilux explain {tree} CASE A B"
    )
