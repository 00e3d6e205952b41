"""What the overview shows: the verdict of the run, what needs attention, and the matrix of cases × renderers."""

from __future__ import annotations

import json
import math
import re
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from equilux_report import numerals, words
from equilux_report.causegroups import CauseGroup, Stand, cause_groups, cause_ids, cause_names, expectations, stands
from equilux_report.facts import count, items, mapping, number, text
from equilux_report.links import Links
from equilux_report.standing import Expectation, standing_of
from equilux_report.tree import HAS_PIXELS, CaseRecord, Pair, Run
from equilux_report.why import Why, why_of

Thumbnails = Callable[[str, str], str | None]
"""(case, render or pair) → address of its thumbnail, None where there is no picture."""

FAILED = ("crashed", "failed", "timeout", "invalid", "incomplete")
GRAVITY = {name: rank for rank, name in enumerate(words.JUDGED)}
SKYLINE_DECADES = (-3, 5)


@dataclass(frozen=True)
class Cell:
    """One render held against another, or the reason why there is nothing to hold."""

    adapter: str
    against: str
    href: str
    judged: str
    """A judgement, a render status, or "truth"."""
    label: str
    words: str
    picture: str | None
    heat: str | None
    en: float | None = None
    max_abs: float | None = None
    share: float | None = None
    numbers: tuple[tuple[str, str], ...] = ()
    causes: tuple[str, ...] = ()
    reason: str = ""
    """Why there are no numbers."""
    why: Why | None = None
    finding: str = ""
    """Of the render, where it is held against the truth."""

    @property
    def cause_ids(self) -> tuple[str, ...]:
        """What the filter by cause looks for."""
        return cause_ids(self)

    @property
    def named_causes(self) -> tuple[str, ...]:
        """With their parameters."""
        return cause_names(self)

    @property
    def height(self) -> float:
        """Height on the skyline, [0, 1]: the logarithm of the largest |E_n|."""
        if self.judged not in words.JUDGED:
            return 0.0
        if self.en is None:
            return 1.0 if self.judged.startswith("diverge") else 0.0
        if math.isinf(self.en):
            return 1.0
        low, high = SKYLINE_DECADES
        return min(max((math.log10(self.en) - low) / (high - low), 0.03), 1.0) if self.en > 0 else 0.03


@dataclass(frozen=True)
class Row:
    """One case."""

    case: CaseRecord
    href: str
    label: str
    detail: str
    """What stands behind an axis value that is not a number."""
    truth_picture: str | None
    cells: tuple[Cell, ...]
    peers: tuple[Cell, ...]

    @property
    def search(self) -> str:
        """What the search box looks in."""
        facts = self.case.facts
        found = [name for cell in (*self.cells, *self.peers) for name in cell.named_causes]
        parts = [
            self.case.name,
            text(facts, "about"),
            self.case.family,
            text(facts, "model"),
            *map(str, items(facts, "requires")),
            *found,
        ]
        return " ".join(dict.fromkeys(parts)).lower()

    @property
    def worst(self) -> dict[str, float]:
        """Sort keys: the gravest of the row's cells."""
        return {
            key: max((value for cell in self.cells if (value := getattr(cell, key)) is not None), default=-1.0)
            for key in ("en", "max_abs", "share")
        }

    @property
    def gravity(self) -> int:
        return min((GRAVITY.get(cell.judged, len(GRAVITY)) for cell in self.cells), default=len(GRAVITY))


@dataclass(frozen=True)
class Group:
    """The cases of one scene: a single one, or a sweep."""

    scene: str
    about: str
    family: str
    axes: tuple[str, ...]
    rows: tuple[Row, ...]

    @property
    def size(self) -> int:
        return len(self.rows)


@dataclass(frozen=True)
class Attention:
    """One line of "needs attention"."""

    kind: str
    case: str
    href: str
    words: str
    picture: str | None = None
    """Where it diverges."""
    why: Why | None = None


@dataclass(frozen=True)
class Overview:
    """All that the overview's template needs."""

    adapters: tuple[str, ...]
    peers: tuple[tuple[str, str], ...]
    groups: tuple[Group, ...]
    attention: tuple[Attention, ...]
    causes: tuple[CauseGroup, ...]
    stands: tuple[Stand, ...]
    expectations: tuple[Expectation, ...]
    judged: Counter[str]
    judged_all: Counter[str]
    statuses: Counter[str]
    families: tuple[str, ...]
    features: tuple[str, ...]

    @property
    def rows(self) -> list[Row]:
        return [row for group in self.groups for row in group.rows]

    @property
    def cause_ids(self) -> list[str]:
        return sorted({group.cause for group in self.causes})

    @property
    def findings(self) -> Counter[str]:
        """Over all renders that were held against a truth, but not the truths themselves."""
        return sum((stand.findings for stand in self.stands), Counter())

    @property
    def headline(self) -> tuple[str, str]:
        """Kind and words of the run's verdict."""
        bad: list[str] = []
        unexpected = Counter(cell.adapter for row in self.rows for cell in row.cells if cell.judged == "diverge_unexpected")
        for adapter, cases in unexpected.most_common():
            verb = "" if bad else " diverges unexpectedly"
            bad.append(f"{adapter}{verb} in {numerals.plural(cases, 'case')}")
        if gone := max(self.judged["improved"], sum(item.state == "gone" for item in self.expectations)):
            bad.append(f"{numerals.plural(gone, 'expectation')} no longer {'holds' if gone == 1 else 'hold'}")
        failed = sum(self.statuses[name] for name in ("crashed", "failed", "timeout", "incomplete"))
        if failed:
            bad.append(f"{numerals.plural(failed, 'render')} gave no image")
        if bad:
            kind = "diverge_unexpected" if self.judged["diverge_unexpected"] else "crashed" if failed else "improved"
            return kind, words.listed(bad)
        if not sum(self.judged_all.values()):
            return "not_comparable", "Nothing was compared"
        pinned = self.judged["diverge_expected"]
        return "agree", "Every expectation held" + (
            f": {numerals.plural(pinned, 'divergence')}, all of them pinned" if pinned else ": nothing diverges"
        )


def overview(run: Run, links: Links, thumbnails: Thumbnails) -> Overview:
    """Arrange a run for the overview page."""
    adapters = tuple(name for name in run.adapters if any(case.truth != name for case in run.cases) and name != "oracle")
    rows = [_row(case, adapters, links, thumbnails) for case in run.cases]
    scenes: dict[str, list[Row]] = {}
    for row in sorted(rows, key=lambda row: (row.case.family, row.case.scene)):
        scenes.setdefault(row.case.scene, []).append(row)
    groups = tuple(_group(scene, members) for scene, members in scenes.items())
    cells = [(row.case, cell) for row in rows for cell in row.cells]
    peers = dict.fromkeys((cell.adapter, cell.against) for row in rows for cell in row.peers)
    return Overview(
        adapters=adapters,
        peers=tuple(sorted(peers)),
        groups=groups,
        attention=tuple(sorted(_attention(run, cells, links), key=lambda line: [*GRAVITY, *FAILED].index(line.kind))),
        causes=cause_groups(cells),
        stands=stands(run, adapters),
        expectations=expectations(run),
        judged=Counter(cell.judged for _, cell in cells if cell.judged in words.JUDGED),
        judged_all=Counter(pair.judged for case in run.cases for pair in case.pairs),
        statuses=Counter(render.status for case in run.cases for render in case.renders.values()),
        families=tuple(sorted({case.family for case in run.cases} - {""})),
        features=tuple(
            sorted({feature for case in run.cases for feature in items(case.facts, "requires") if isinstance(feature, str)})
        ),
    )


def _group(scene: str, rows: list[Row]) -> Group:
    first = rows[0].case
    axes = tuple(mapping(first.facts, "axes"))
    return Group(scene, text(first.facts, "about"), first.family, axes, tuple(rows))


def _row(case: CaseRecord, adapters: tuple[str, ...], links: Links, thumbnails: Thumbnails) -> Row:
    axes = mapping(case.facts, "axes")
    values = [f"{axis} = {_axis_value(case.name, axis, value)}" for axis, value in axes.items()]
    label = ", ".join(values) or case.name.partition("[")[2].rstrip("]") or case.name
    detail = "; ".join(json.dumps(value) for value in axes.values() if not _is_number(value))
    cells = tuple(_cell(case, adapter, links, thumbnails) for adapter in adapters)
    peers = tuple(_pair_cell(case, pair, links, thumbnails) for pair in case.pairs if case.truth not in (pair.a, pair.b))
    picture = thumbnails(case.name, case.truth) if case.truth else None
    return Row(case, links.case(case.name), label, detail, picture, cells, peers)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _axis_value(name: str, axis: str, value: Any) -> str:
    """A number as it is; anything else by its place in the sweep (`#0`), as the case's name has it."""
    place = re.search(rf"[\[,]{re.escape(axis)}=(#\d+)[\],]", name)
    return numerals.shortest(value) if _is_number(value) else place[1] if place else json.dumps(value)


def _cell(case: CaseRecord, adapter: str, links: Links, thumbnails: Thumbnails) -> Cell:
    render = case.renders.get(adapter)
    if render is None:
        return Cell(adapter, "", links.case(case.name), "absent", "not run", f"{adapter} was not run on {case.name}.", None, None)
    if adapter == case.truth:
        return Cell(
            adapter,
            adapter,
            links.case(case.name),
            "truth",
            "is the truth here",
            f"{adapter} is what the others are judged against.",
            thumbnails(case.name, adapter),
            None,
        )
    pair = case.against_truth(adapter)
    if pair is not None:
        return _pair_cell(case, pair, links, thumbnails)
    status = render.status if render.status not in HAS_PIXELS else "not_comparable"
    label = words.STATUS.get(status, words.JUDGED.get(status, status))
    why = text(render.facts, "reason") or ", ".join(str(item) for item in items(render.facts, "missing_features"))
    picture = thumbnails(case.name, adapter)
    return Cell(adapter, "", links.case(case.name), status, label, words.render_sentence(render), picture, None, reason=why)


def _pair_cell(case: CaseRecord, pair: Pair, links: Links, thumbnails: Thumbnails) -> Cell:
    facts, place = pair.facts, words.worst_pixel(pair) if pair.verdict == "diverge" else None
    whole, bad = count(facts, "pixels"), count(facts, "diverge") + count(facts, "invalid")
    en, max_abs = words.en_max(pair), number(facts, "max_abs")
    standing = standing_of(case.renders[pair.a]) if case.truth == pair.b and pair.a in case.renders else None
    shown = (
        ("max |Eₙ|", numerals.magnitude(en)),
        ("pixels", numerals.percent(bad, whole)),
        ("max |Δ|", numerals.magnitude(max_abs)),
    )
    return Cell(
        pair.a,
        pair.b,
        links.case(case.name, pair=pair.name, x=place[0] if place else None, y=place[1] if place else None),
        pair.judged,
        words.JUDGED.get(pair.judged, pair.judged),
        words.sentence(case, pair),
        thumbnails(case.name, pair.a),
        thumbnails(case.name, pair.name),
        en,
        max_abs,
        bad / whole if whole else None,
        shown if whole and pair.verdict != "not-comparable" else (),
        tuple(words.causes(case, pair)),
        words.reason(pair),
        why_of(case, pair),
        standing.finding if standing else "",
    )


def _attention(run: Run, cells: list[tuple[CaseRecord, Cell]], links: Links) -> Iterator[Attention]:
    for case, cell in sorted(cells, key=lambda item: -(item[1].en or 0)):
        if cell.judged in ("diverge_unexpected", "improved"):
            yield Attention(cell.judged, case.name, cell.href, cell.words, cell.heat, cell.why)
    for case in run.cases:
        for render in case.renders.values():
            if render.status in FAILED:
                yield Attention(render.status, case.name, links.case(case.name), words.render_sentence(render))
