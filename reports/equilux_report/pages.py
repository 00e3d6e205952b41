"""Turns view models into HTML, through Jinja templates with autoescape on."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import jinja2

from equilux_report import assets, facts, numerals, words
from equilux_report.calibration import Calibration
from equilux_report.casepage import CasePage
from equilux_report.dialects import Dialect
from equilux_report.links import Links
from equilux_report.overview import Overview
from equilux_report.runfacts import run_facts
from equilux_report.tree import Run

if TYPE_CHECKING:
    from equilux_report.tradeoff import TradeView


class Pages:
    """The templates, ready to be filled."""

    def __init__(self, *, single_file: bool) -> None:
        self.environment = jinja2.Environment(
            loader=jinja2.PackageLoader("equilux_report"),
            autoescape=True,
            trim_blocks=True,
            lstrip_blocks=True,
            undefined=jinja2.StrictUndefined,
        )
        self.environment.filters |= {
            "count": numerals.count,
            "magnitude": numerals.magnitude,
            "percent": numerals.percent,
            "seconds": numerals.seconds,
            "size": numerals.size,
            "plural": numerals.plural,
            "share": numerals.share,
            "term": numerals.term,
            "describe": describe,
        }
        self.environment.globals |= {
            "facts": facts,
            "words": words,
            "single_file": single_file,
            "csp": assets.csp(single_file=single_file),
            "style": assets.style(),
            "script": assets.script(),
            "log10": math.log10,
            "min": min,
            "max": max,
        }

    def overview_page(self, run: Run, view: Overview, calibrations: list[Calibration], links: Links) -> str:
        return self.environment.get_template("overview.html.j2").render(
            run=run, view=view, calibrations=calibrations, links=links, title=title(run), about=run_facts(run)
        )

    def case_page(self, run: Run, page: CasePage, links: Links) -> str:
        return self.environment.get_template("case.html.j2").render(
            run=run, page=page, links=links, title=title(run), about=run_facts(run)
        )

    def dialects_page(self, run: Run, dialects: tuple[Dialect, ...], links: Links) -> str:
        return self.environment.get_template("dialects.html.j2").render(
            run=run, dialects=dialects, links=links, title=title(run), about=run_facts(run)
        )

    def tradeoff_page(self, view: TradeView, links: Links) -> str:
        return self.environment.get_template("tradeoff.html.j2").render(view=view, links=links, title=view.title)

    def single_page(
        self,
        run: Run,
        view: Overview,
        calibrations: list[Calibration],
        dialects: tuple[Dialect, ...],
        cases: Iterable[CasePage],
        links: Links,
        payloads: Iterable[tuple[str, str]],
    ) -> Iterator[str]:
        """The whole page in pieces: it may be larger than memory should be asked for at once."""
        return self.environment.get_template("single.html.j2").generate(
            run=run,
            view=view,
            calibrations=calibrations,
            dialects=dialects,
            pages=cases,
            links=links,
            payloads=payloads,
            title=title(run),
            about=run_facts(run),
        )

    def write_static(self, folder: Path) -> None:
        folder.mkdir(parents=True)
        (folder / "report.css").write_text(assets.style(), encoding="utf-8")
        (folder / "report.js").write_text(assets.script(), encoding="utf-8")


def title(run: Run) -> str:
    """What the run is called: the folder it lies in."""
    return run.root.resolve().name


def describe(value: Any) -> str:
    """A JSON value as a reader wants it: strings bare, the rest as JSON."""
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
