"""Changes as sentences: the same change on many cases is one, the most important first."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from equilux.difference.changes import IMPORTANCE, Change
from equilux.explain.numbers import counted
from equilux.results import Results

SHOWN = 3


@dataclass(frozen=True)
class Group:
    """One change and where it happened, the largest first."""

    changes: tuple[Change, ...]

    @property
    def first(self) -> Change:
        return self.changes[0]

    def lines(self, common: int) -> list[str]:
        """common: how many cases both runs have. Cases with numbers of their own get a line each."""
        cases = [change for change in self.changes if change.case is not None]
        what = self.first.what
        if not cases:
            return [what]
        if len(cases) == 1:
            (only,) = cases
            return [
                f"{what} on {only.case}{f': {only.detail}' if only.detail else ''}"
                if self._is_where()
                else f"{what}: {only.case}"
            ]
        count = f"all {len(cases)} cases" if len(cases) == common else counted(len(cases), "case")
        head = f"{what} on {count}" if self._is_where() else f"{what}: {count}"
        rest = len(cases) - SHOWN
        more = f"and {rest} more" if rest > 0 else ""
        if any(change.detail for change in cases[:SHOWN]):
            shown = [f"  {change.case}: {change.detail}" for change in cases[:SHOWN]]
            return [f"{head}:", *shown, *([f"  {more}"] if more else [])]
        return [f"{head}: {', '.join(str(change.case) for change in cases[:SHOWN])}{f' {more}' if more else ''}"]

    def _is_where(self) -> bool:
        """Whether the change is one of something on a case, and not of cases."""
        return self.first.kind != "case"


def grouped(changes: Iterable[Change]) -> list[Group]:
    """By importance: what matters first, then the kind, then how many cases it concerns."""
    groups: dict[tuple[str, str, bool], list[Change]] = {}
    for change in changes:
        groups.setdefault((change.kind, change.what, change.matters), []).append(change)
    found = [Group(tuple(sorted(each, key=lambda change: -change.amount))) for each in groups.values()]
    found.sort(
        key=lambda group: (
            not group.first.matters,
            IMPORTANCE.index(group.first.kind),
            _badness(group.first),
            -len(group.changes),
        )
    )
    return found


def _badness(change: Change) -> int:
    """What got worse before what got better."""
    order = ("diverge_unexpected", "improved", "not_comparable", "diverge_expected", "agree")
    if change.kind == "judgement":
        return order.index(str(change.after))
    return int(change.kind == "status" and change.after == "ok")


def tell(a: Results, b: Results, changes: Sequence[Change], names: tuple[str, str] = ("", "")) -> list[str]:
    """The whole text. names: what the runs are called, their folders."""
    common = len({case.case for case in a.cases} & {case.case for case in b.cases})
    groups = grouped(changes)
    sections = {
        "what is different about the runs:": [group for group in groups if group.first.kind == "run"],
        "what changed:": [group for group in groups if group.first.kind != "run" and group.first.matters],
        "what changed and does not matter by itself:": [
            group for group in groups if group.first.kind != "run" and not group.first.matters
        ],
    }
    lines = [_run_line("A", names[0], a), _run_line("B", names[1], b)]
    for title, held in sections.items():
        if held:
            lines += ["", title, *(f"  {line}" for group in held for line in group.lines(common))]
    if not any(change.matters for change in changes):
        lines += ["", f"nothing that matters changed on the {counted(common, 'case')} of both"]
    return lines


def _run_line(letter: str, name: str, results: Results) -> str:
    run, code = results.run, results.summary.exit_code
    facts = f"{run.started}, {counted(len(results.cases), 'case')}, {run.seconds:.1f} s, exit code {code}"
    return f"{letter}: {f'{name}, ' if name else ''}{facts}"
