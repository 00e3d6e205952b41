"""The page of a measurement of the trade: reads tradeoff.json, writes the plots beside it and a page below report/."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from equilux_report.links import Links
from equilux_report.pages import Pages
from equilux_report.tradeplots import feature_plot, marks_of, trade_plot

FILE = "tradeoff.json"
PAGE = "tradeoff.html"
PRESETS = ("fast", "balanced", "exact")


class TradeLinks(Links):
    """The page stands alone: it is its own overview."""

    def overview(self) -> str:
        return PAGE


@dataclass(frozen=True)
class Setting:
    """A row of a case's table."""

    renderer: str
    series: int
    facts: Mapping[str, Any]
    wall: Mapping[str, Any] | None
    cpu: Mapping[str, Any] | None


@dataclass(frozen=True)
class AnswerRow:
    """One question, and of each renderer (and of any) what answers it; None where nothing does."""

    question: str
    found: Mapping[str, Mapping[str, Any] | None]


@dataclass(frozen=True)
class CaseView:
    """One case: its plot, every setting with the front first, and the answers."""

    facts: Mapping[str, Any]
    plot: str
    settings: tuple[Setting, ...]
    others: tuple[tuple[str, str], ...]
    """Renderers that were not measured, and why."""
    renderers: tuple[str, ...]
    answers: tuple[AnswerRow, ...]


@dataclass(frozen=True)
class TradeView:
    """All that the page's template needs."""

    title: str
    made: Mapping[str, Any]
    command: str
    names: tuple[str, ...]
    confidence: float
    cases: tuple[CaseView, ...]
    start_up: Mapping[str, Any]
    features: tuple[Mapping[str, Any], ...]
    feature_plot: str
    presets: tuple[tuple[str, str, Mapping[str, Any]], ...]
    ladders: tuple[tuple[str, tuple[Mapping[str, Any], ...]], ...]


def build_tradeoff(folder: Path) -> Path:
    """Write OUT/*.svg and OUT/report/tradeoff.html from OUT/tradeoff.json. Returns the page.

    Raises OSError where something cannot be read or written, ValueError for a file that is no measurement.
    """
    measured = json.loads((folder / FILE).read_bytes())
    if not str(measured.get("schema", "")).startswith("equilux/tradeoff/"):
        raise ValueError(f"{folder / FILE}: the schema is {measured.get('schema')!r}, expected equilux/tradeoff/1")
    for name, plot in _plots(measured):
        _write(folder / f"{name}.svg", plot)
    pages = Pages(single_file=False)
    report = folder / "report"
    report.mkdir(exist_ok=True)
    shutil.rmtree(report / "static", ignore_errors=True)
    pages.write_static(report / "static")
    view = trade_view(measured, folder.resolve().name)
    _write(report / PAGE, pages.tradeoff_page(view, TradeLinks(single_file=False)))
    return (report / PAGE).absolute()


def trade_view(measured: Mapping[str, Any], title: str) -> TradeView:
    """Arrange a measurement for its page."""
    made, names = measured["made"], _names(measured)
    adapters = measured["presets"]["adapters"]
    return TradeView(
        title=title,
        made=made,
        command=shlex.join(str(word) for word in made["command"]),
        names=names,
        confidence=_confidence(measured),
        cases=tuple(_case(case, measured, names) for case in measured["cases"]),
        start_up=measured["start_up"],
        features=tuple(measured["features"]),
        feature_plot=feature_plot(measured["features"], names, "What a feature costs", style=""),
        presets=tuple(
            (name, preset, adapters[name]["presets"][preset])
            for name in adapters
            for preset in PRESETS
            if preset in adapters[name]["presets"]
        ),
        ladders=tuple((name, tuple(adapter["ladder"])) for name, adapter in adapters.items() if adapter["ladder"]),
    )


def _names(measured: Mapping[str, Any]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(name for case in measured["cases"] for name in case["renderers"]))


def _confidence(measured: Mapping[str, Any]) -> float:
    """What the intervals of whole pictures are worth, at least."""
    found = [
        setting["times"]["wall"]["total"]["confidence"]
        for case in measured["cases"]
        for trade in case["renderers"].values()
        for setting in trade["settings"]
        if setting["times"] is not None
    ]
    return min(found, default=0.0)


def _case(case: Mapping[str, Any], measured: Mapping[str, Any], names: tuple[str, ...]) -> CaseView:
    clock = measured["made"]["clock"]
    rows = [
        Setting(name, names.index(name), setting, _total(setting, "wall"), _total(setting, "cpu"))
        for name, trade in case["renderers"].items()
        for setting in trade["settings"]
    ]
    rows.sort(key=lambda row: (not row.facts["front"], row.series, row.wall["median"] if row.wall else 0.0))
    renderers = tuple(name for name, trade in case["renderers"].items() if trade["status"] == "measured")
    others = tuple(
        (name, f"{trade['status']}: {trade['reason'] or 'no reason given'}")
        for name, trade in case["renderers"].items()
        if trade["status"] != "measured"
    )
    plot = trade_plot(marks_of(case, clock, names), names, f"{case['case']}: error over time", clock, style="")
    answers = tuple(_answers([answer for answer in measured["answers"] if answer["case"] == case["case"]]))
    return CaseView(case, plot, tuple(rows), others, renderers, answers)


def _total(setting: Mapping[str, Any], clock: str) -> Mapping[str, Any] | None:
    """Of a whole picture; None where none was made."""
    return setting["times"][clock]["total"] if setting["times"] else None


def _answers(answers: list[Mapping[str, Any]]) -> Iterator[AnswerRow]:
    questions = dict.fromkeys((answer["question"], answer["bound"]) for answer in answers)
    for question, bound in questions:
        words = f"cheapest with error ≤ {bound:g}" if question == "error" else f"most accurate within {bound:g} s"
        own = [answer for answer in answers if (answer["question"], answer["bound"]) == (question, bound)]
        yield AnswerRow(words, {answer["renderer"]: answer if answer["found"] else None for answer in own})


def _plots(measured: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Names and texts of the plots as files of their own; those without a point are left out."""
    names = _names(measured)
    for case in measured["cases"]:
        for clock in ("wall", "cpu"):
            plot = trade_plot(marks_of(case, clock, names), names, f"{case['case']}: error over {clock} time", clock)
            if plot:
                yield f"{re.sub(r'[^A-Za-z0-9=.,-]+', '_', case['case'])}-{clock}", plot
    if plot := feature_plot(measured["features"], names, "What a feature costs"):
        yield "features", plot


def _write(path: Path, text: str) -> None:
    """The file appears whole or not at all."""
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    os.close(handle)
    temporary = Path(name)
    try:
        temporary.write_text(text, encoding="utf-8")
        temporary.chmod(0o644)
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)
