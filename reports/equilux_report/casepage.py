"""What the page of one case shows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from equilux_report import words
from equilux_report.brdfs import BrdfView, brdf_views
from equilux_report.calibration import Bin, rebin
from equilux_report.causes import causes_of
from equilux_report.facts import Facts, count, mapping, number, numbers, objects, text
from equilux_report.links import Links
from equilux_report.programfiles import ProgramFile, program_files
from equilux_report.standing import Expectation, Standing, expectations_of, standing_of
from equilux_report.tree import CaseRecord, Pair, Render
from equilux_report.why import Why, why_of, whys

PHASES = ("translate", "start", "render", "read")


@dataclass(frozen=True)
class Statement:
    """A verdict in words."""

    kind: str
    words: str
    pair: str | None
    worst: tuple[int, int] | None
    why: Why | None = None


@dataclass(frozen=True)
class PairView:
    """One pair's statistics."""

    pair: Pair
    is_against_truth: bool
    label: str
    causes: tuple[str, ...]
    worst: tuple[int, int] | None
    bins: tuple[Bin, ...]
    invalid: tuple[tuple[str, str], ...]
    """Side and its invalid values by kind, in words."""

    @property
    def classes(self) -> list[tuple[str, int]]:
        return [(name, count(self.pair.facts, name)) for name in words.CLASSES]


@dataclass(frozen=True)
class RenderView:
    """One render: how it came about."""

    render: Render
    phases: tuple[tuple[str, float], ...]
    total_s: float | None
    terms: tuple[Facts, ...]
    files: tuple[ProgramFile, ...]
    image: Facts
    """Size, type and invalid values of the picture."""

    @property
    def label(self) -> str:
        return words.STATUS.get(self.render.status, self.render.status)


@dataclass(frozen=True)
class CasePage:
    """All that the case page's template needs. `config` is what the viewer's script needs."""

    case: CaseRecord
    statements: tuple[Statement, ...]
    pairs: tuple[PairView, ...]
    renders: tuple[RenderView, ...]
    config: Mapping[str, Any]
    brdfs: tuple[BrdfView, ...]
    whys: tuple[Why, ...]
    standings: tuple[Standing, ...]
    expectations: tuple[Expectation, ...]
    previous: CaseRecord | None
    next: CaseRecord | None

    @property
    def longest_s(self) -> float:
        return max((view.total_s or 0 for view in self.renders), default=0) or 1.0


def case_page(
    case: CaseRecord,
    neighbours: tuple[CaseRecord | None, CaseRecord | None],
    links: Links,
    packed: Mapping[str, Any],
    stops: float,
) -> CasePage:
    """Arrange one case. `packed`: which pictures have data, by render or pair name; `stops`: the exposure to start with."""
    ordered = sorted(case.pairs, key=lambda pair: (case.truth not in (pair.a, pair.b), pair.name))
    return CasePage(
        case,
        tuple(_statements(case)),
        tuple(_pair_view(case, pair) for pair in ordered),
        tuple(_render_view(case.renders[name]) for name in _order(case)),
        _config(case, ordered, links, packed, stops),
        brdf_views(case),
        whys(case, ordered),
        tuple(standing for name in _order(case) if (standing := standing_of(case.renders[name])) is not None),
        expectations_of(case),
        *neighbours,
    )


def _order(case: CaseRecord) -> list[str]:
    """The truth first, then the others in alphabetical order."""
    return sorted(case.renders, key=lambda name: (name != case.truth, name))


def _statements(case: CaseRecord) -> list[Statement]:
    found = []
    for adapter, render in case.renders.items():
        pair = case.against_truth(adapter) if adapter != case.truth else None
        if pair is not None:
            found.append(
                Statement(pair.judged, words.sentence(case, pair), pair.name, words.worst_pixel(pair), why_of(case, pair))
            )
        elif render.status != "ok":
            found.append(Statement(render.status, words.render_sentence(render), None, None))
    gravity = [*words.JUDGED, *words.STATUS]
    return sorted(
        found, key=lambda item: (item.kind == "unsupported", gravity.index(item.kind) if item.kind in gravity else len(gravity))
    )


def _pair_view(case: CaseRecord, pair: Pair) -> PairView:
    kinds = mapping(pair.facts, "invalid_kinds")
    invalid = [(name, words.invalid_kinds(mapping(kinds, side))) for side, name in (("a", pair.a), ("b", pair.b))]
    return PairView(
        pair,
        case.truth in (pair.a, pair.b),
        words.JUDGED.get(pair.judged, pair.judged),
        _names(case, pair),
        words.worst_pixel(pair),
        rebin([pair]),
        tuple((name, told) for name, told in invalid if told),
    )


def _names(case: CaseRecord, pair: Pair) -> tuple[str, ...]:
    """Causes with their parameters, else the pins."""
    found = [cause.name for cause in causes_of(case, pair)]
    return tuple(found or words.causes(case, pair))


def _render_view(render: Render) -> RenderView:
    seconds = mapping(render.facts, "seconds")
    names = [*(name for name in PHASES if name in seconds), *(name for name in seconds if name not in PHASES)]
    phases = tuple((name, value) for name in names if (value := number(seconds, name)) is not None)
    return RenderView(
        render,
        phases,
        sum(value for _, value in phases) if phases else None,
        tuple(objects(mapping(render.facts, "uncertainty"), "terms")),
        tuple(program_files(render)),
        {key: value for key, value in mapping(render.facts, "image").items() if key != "digest"} | _luminance(render),
    )


def _luminance(render: Render) -> dict[str, str]:
    """Of the picture, in words."""
    told = mapping(render.facts, "luminance")
    values = {name: value for name in ("min", "mean", "max") if (value := number(told, name)) is not None}
    return {"luminance, cd/m²": ", ".join(f"{name} {value:.5g}" for name, value in values.items())} if values else {}


def _photometry(case: CaseRecord) -> dict[str, Any] | None:
    """How the bands weigh in luminance, lm/W, and in words; None where the results do not say."""
    told = mapping(case.facts, "photometry")
    weights, k_m = numbers(told, "luminance_weights"), number(told, "k_m")
    if len(weights) != 3 or not k_m:
        return None
    sum_of_bands = " + ".join(f"{weight:.5g} {band}" for weight, band in zip(weights, "RGB", strict=True))
    words_of_it = f"{sum_of_bands} cd/m²; {text(told, 'bands')}; K_m = {text(told, 'k_m_text')}"
    return {"weights": weights, "kM": k_m, "words": words_of_it}


def _config(case: CaseRecord, pairs: list[Pair], links: Links, packed: Mapping[str, Any], stops: float) -> dict[str, Any]:
    def data(name: str) -> dict[str, Any]:
        return {"key": f"{case.name}/{name}", "src": links.data(case.name, name) if name in packed else None}

    worst = min(
        pairs,
        key=lambda pair: (
            case.truth not in (pair.a, pair.b),
            [*words.JUDGED].index(pair.judged) if pair.judged in words.JUDGED else 9,
            -(number(pair.facts, "en_max") or 0),
        ),
        default=None,
    )
    return {
        "case": case.name,
        "photometry": _photometry(case),
        "width": count(case.facts, "width"),
        "height": count(case.facts, "height"),
        "truth": case.truth,
        "stops": stops,
        "renders": [{"name": name, "status": case.renders[name].status, **data(name)} for name in _order(case) if name in packed],
        "pairs": [
            {
                "name": pair.name,
                "a": pair.a,
                "b": pair.b,
                "judged": pair.judged,
                "worst": words.worst_pixel(pair),
                **data(pair.name),
                "classes": {name: count(pair.facts, name) for name in words.CLASSES},
            }
            for pair in pairs
            if pair.name in packed
        ],
        "pair": worst.name if worst is not None and worst.name in packed else None,
    }
