"""The page of `equilux extremes`: where each renderer breaks on each axis, what breaks, and the pictures beside the truth.

Made from extremes.json and the pictures of the same results tree, and from nothing else.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup

from equilux_report import numerals, thumbnail
from equilux_report.build import MARKER, replaceable, replacing
from equilux_report.extremecharts import chart
from equilux_report.links import Links, encode
from equilux_report.pages import Pages
from equilux_report.pixels import BANDS, Plane, UnreadableImage, read_planes, require

SCHEMA = "equilux/extremes/1"
TRUTHS = ("oracle", "reference")


@dataclass(frozen=True)
class ExtremesLinks(Links):
    """This report has one page."""

    def overview(self) -> str:
        return "extremes.html"


@dataclass(frozen=True)
class Picture:
    """A thumbnail and what it shows. href: None where there is no picture."""

    caption: str
    href: str | None


@dataclass(frozen=True)
class TurnView:
    """One direction: the mark of the matrix, the sentence, and truth and renderer at the last good and the first bad value."""

    direction: str
    state: str
    mark: str
    sentence: str
    causes: tuple[str, ...]
    finding: str
    pictures: tuple[Picture, ...]


@dataclass(frozen=True)
class CurveView:
    adapter: str
    title: str
    model: str
    note: str
    chart: Markup | None
    turns: tuple[TurnView, ...]


@dataclass(frozen=True)
class AxisView:
    name: str
    title: str
    about: str
    watch: str
    truth: str
    curves: tuple[CurveView, ...]

    def curve(self, adapter: str) -> CurveView | None:
        return next((curve for curve in self.curves if curve.adapter == adapter), None)


def build_extremes(root: Path) -> Path:
    """Write RUN/report/extremes.html with its thumbnails, and return it; an older report is replaced whole.

    Raises FileNotFoundError if `root` holds no extremes.json, ValueError for one of another schema, FileExistsError if report/
    holds something that is no report.
    """
    content = json.loads((root / "extremes.json").read_bytes())
    if content.get("schema") != SCHEMA:
        raise ValueError(f"{root / 'extremes.json'}: schema is {content.get('schema')!r}, allowed '{SCHEMA}'")
    out = (root / "report").absolute()
    if not replaceable(out):
        raise FileExistsError(f"{out}: is not empty and not a report of ours: not replaced")
    with replacing(out) as folder:
        (folder / MARKER).write_text(json.dumps({"schema": "equilux/report/1", "extremes": len(content["axes"])}) + "\n")
        pages = Pages(single_file=False)
        pages.write_static(folder / "static")
        shelf = _Shelf(root, folder)
        adapters = _adapters(content)
        page = pages.environment.get_template("extremes.html.j2").render(
            links=ExtremesLinks(single_file=False),
            title=root.resolve().name,
            adapters=adapters,
            axes=[_axis(axis, adapters, shelf) for axis in content["axes"]],
            run=content["run"],
        )
        (folder / "extremes.html").write_text(page, encoding="utf-8")
    return out / "extremes.html"


def _adapters(content: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    """The renderers in the order of columns: laboratories, then the reference; the oracle is held against nothing."""
    judged = [
        name
        for name in content["adapters"]
        if any(curve["adapter"] == name and _is_judged(curve)
               for axis in content["axes"] for curve in axis["curves"])
    ]  # fmt: skip
    return {name: content["adapters"][name] for name in sorted(judged, key=lambda name: (name in TRUTHS, name))}


def _is_judged(curve: Mapping[str, Any]) -> bool:
    """Whether anything was found of a renderer on an axis."""
    return any(point["outcome"] not in ("missing", "unjudged") for point in curve["points"])


class _Shelf:
    """Thumbnails, each made once. A picture is shown at the exposure of its truth, whatever the magnitude of its radiance."""

    def __init__(self, root: Path, folder: Path) -> None:
        self._root, self._folder = root, folder

    def picture(self, case: str, adapter: str, truth: str) -> str | None:
        """The address of the thumbnail; None where there is no picture."""
        target = self._folder / "thumbnails" / case / f"{adapter}.png"
        if not target.exists():
            planes, reference = self._read(case, adapter), self._read(case, truth)
            if planes is None:
                return None
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(_thumbnail(planes, reference or planes))
        return f"thumbnails/{encode(case)}/{encode(adapter)}.png"

    def _read(self, case: str, adapter: str) -> dict[str, Plane] | None:
        path = self._root / "cases" / case / adapter / "image.exr"
        try:
            return require(read_planes(path), BANDS, path)
        except UnreadableImage:
            return None


def _thumbnail(planes: Mapping[str, Plane], truth: Mapping[str, Plane]) -> bytes:
    """Divided by the truth's largest radiance first: it may be 1e-38."""
    values = np.concatenate([truth[band].ravel() for band in BANDS]).astype(np.float64)
    largest = float(np.abs(values[np.isfinite(values)]).max(initial=0.0)) or 1.0
    with np.errstate(over="ignore"):
        scaled = {band: (planes[band].astype(np.float64) / largest).astype(np.float32) for band in BANDS}
        level = {band: (truth[band].astype(np.float64) / largest).astype(np.float32) for band in BANDS}
    return thumbnail.of_render(scaled, thumbnail.exposure_stops(level))


def _axis(axis: Mapping[str, Any], adapters: Mapping[str, Mapping[str, Any]], shelf: _Shelf) -> AxisView:
    curves = {curve["adapter"]: curve for curve in axis["curves"]}
    truths = sorted({point["truth"] for curve in axis["curves"] for point in curve["points"] if point["truth"]})
    return AxisView(
        axis["name"],
        axis["title"] + (f" ({axis['unit']})" if axis["unit"] else ""),
        axis["about"],
        axis["watch"],
        " and ".join(truths),
        tuple(_curve(curves[name], axis, facts["title"], shelf) for name, facts in adapters.items() if name in curves),
    )


def _curve(curve: Mapping[str, Any], axis: Mapping[str, Any], title: str, shelf: _Shelf) -> CurveView:
    if curve["model"] is None or not _is_judged(curve):
        note = (
            curve["reason"]
            or next((point["reason"] for point in curve["points"] if point["reason"]), "")
            or "nothing to judge by"
        )
        return CurveView(curve["adapter"], title, curve["model"] or "", note, None, ())
    drawn = Markup(chart(curve, axis, f"{title} on {axis['title']}: error over the pushed quantity"))
    turns = tuple(_turn(turn, curve, axis, shelf) for turn in curve["turns"])
    return CurveView(curve["adapter"], title, curve["model"], "", drawn, turns)


def _turn(turn: Mapping[str, Any], curve: Mapping[str, Any], axis: Mapping[str, Any], shelf: _Shelf) -> TurnView:
    state, mark, sentence = _words(turn, axis["unit"])
    pictures = []
    for what, value in (("last good", turn["last_good"]), ("first bad", turn["breakdown"])):
        point = next((point for point in curve["points"] if point["value"] == value), None)
        if turn["breakdown"] is not None and point is not None and point["case"]:
            at = f"{what}, {_value(value, axis['unit'])}"
            truth = point["truth"] or "reference"
            pictures.append(Picture(f"{truth}, {at}", shelf.picture(point["case"], truth, truth)))
            pictures.append(Picture(f"{curve['adapter']}, {at}", shelf.picture(point["case"], curve["adapter"], truth)))
    causes = tuple(_cause(cause) for cause in turn["causes"])
    return TurnView(turn["direction"], state, mark, sentence, causes, turn["finding"] or "", tuple(pictures))


def _words(turn: Mapping[str, Any], unit: str) -> tuple[str, str, str]:
    """State (breaks, gives-up, holds), the mark in the matrix, and a sentence."""
    how = []
    if turn["coarse"] is not None:
        how.append(f"off by more than 0.1 %, as it states, from {_value(turn['coarse'], unit)} on")
    if turn["blind"] is not None:
        how.append(f"states no more than that it knows nothing from {_value(turn['blind'], unit)} on")
    if turn["refused"] is not None:
        how.append(f"refused from {_value(turn['refused'], unit)} on")
    if turn["breakdown"] is not None:
        sentence = f"Breaks at {_value(turn['breakdown'], unit)}: {turn['what']}"
        if turn["bumps"]:
            sentence += f"; good again at {', '.join(_value(value, unit) for value in turn['bumps'])}"
        return "breaks", _value(turn["breakdown"], unit), "; ".join([sentence, *how]) + "."
    if turn["gives_up"] is not None:
        text = "; ".join(how)
        return "gives-up", _value(turn["gives_up"], unit), text[:1].upper() + text[1:] + "."
    return "holds", "", f"Holds to {_value(turn['reached'], unit)}."


def _value(value: float | None, unit: str) -> str:
    if value is None:
        return numerals.NONE
    return numerals.shortest(value) + ("" if not unit else unit if unit == "°" else f"{numerals.NARROW}{unit}")


def _cause(cause: Mapping[str, Any]) -> str:
    parameter = numerals.parameter(cause.get("parameter"))
    return str(cause["id"]) + (f" {parameter}" if parameter else "") + (" (declared)" if cause.get("declared") else "")
