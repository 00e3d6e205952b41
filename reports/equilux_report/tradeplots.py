"""Plots of a measurement of the trade as SVG: error over time with every renderer's front, and what features cost.

Input is what `equilux tradeoff` says in numbers; nothing is computed here but positions on paper.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from typing import Any

SERIES = 6
"""Colours and marks; more renderers than that share them."""
STYLE = """
.trade{font:11px system-ui,sans-serif;fill:none}
.trade .paper{fill:light-dark(#fff,#1a1c1f);stroke:none}
.trade text{fill:var(--ink,#17191c);stroke:none}
.trade .muted{fill:var(--muted,#5d6269)}
.trade .grid{stroke:var(--line,#dedfda)}
.trade .axis{stroke:var(--line-strong,#b9bbb6)}
.trade .front{stroke-width:1.8;stroke-linejoin:round}
.trade .whisker{stroke-width:1;opacity:.55}
.trade .beaten{opacity:.4}
.trade .halo{stroke:var(--surface,#fff);stroke-width:3;stroke-linejoin:round;paint-order:stroke}
.trade .all{stroke:var(--ink,#17191c);stroke-dasharray:2 4;stroke-width:1.2}
.trade .s0{--c:var(--accent,#1c58b0)}.trade .s1{--c:var(--expected,#8a5a00)}
.trade .s2{--c:var(--agree,#18774f)}.trade .s3{--c:var(--unexpected,#c0201f)}
.trade .s4{--c:var(--improved,#5a43c0)}.trade .s5{--c:var(--edge,#0b7fc4)}
.trade .line{stroke:var(--c)}.trade .mark{fill:var(--c);stroke:none}.trade .hollow{fill:none;stroke:var(--c);stroke-width:1.4}
""".strip()
"""Of a plot that stands alone; the report's own style sheet says the same in the page's colours."""

WIDTH, HEIGHT = 760, 430
LEFT, RIGHT, TOP, BOTTOM = 62.0, 742.0, 40.0, 384.0
LEAST_ERROR = -9
"""Decade below which errors lie on the lowest line, which then says so: what is exact would squeeze all others together."""
LETTER = 5.6
"""Width of a letter of a label, on average."""


@dataclass(frozen=True)
class Mark:
    """A setting on paper. x, low, high: seconds; y: error, 0 included."""

    series: int
    renderer: str
    label: str
    x: float
    low: float
    high: float
    y: float
    front: bool
    front_of_all: bool


def marks_of(case: Mapping[str, Any], clock: str, names: Sequence[str]) -> list[Mark]:
    """The settings of a case whose time and accuracy are known. names: all renderers of the measurement, in their order, so that
    one has the same colour in every plot."""
    found = []
    for name, trade in case["renderers"].items():
        for setting in trade["settings"]:
            if setting["times"] is None or setting["accuracy"] is None:
                continue
            total = setting["times"][clock]["total"]
            found.append(
                Mark(names.index(name), name, setting["label"], total["median"], total["low"], total["high"], setting["accuracy"],
                     setting["front"], setting["front_of_all"])
            )  # fmt: skip
    return found


@dataclass
class _Paper:
    """Where seconds and errors lie: both logarithmic; an error of 0 lies on the lowest line."""

    x_decades: tuple[int, int]
    y_decades: tuple[int, int]
    taken: list[tuple[float, float, float, float]] = field(default_factory=list)

    def x(self, seconds: float) -> float:
        low, high = self.x_decades
        place = math.log10(max(seconds, 10.0**low))
        return LEFT + (RIGHT - LEFT) * min(max((place - low) / (high - low), 0.0), 1.0)

    def y(self, error: float) -> float:
        low, high = self.y_decades
        place = math.log10(error) if error > 0 else low
        return BOTTOM - (BOTTOM - TOP) * min(max((place - low) / (high - low), 0.0), 1.0)

    def free(self, box: tuple[float, float, float, float]) -> bool:
        """Whether a box is on the paper and covers nothing."""
        x0, y0, x1, y1 = box
        inside = x0 >= LEFT and x1 <= RIGHT + 14 and y0 >= TOP - 4 and y1 <= BOTTOM
        return inside and not any(x0 < bx1 and bx0 < x1 and y0 < by1 and by0 < y1 for bx0, by0, bx1, by1 in self.taken)


def trade_plot(marks: Sequence[Mark], names: Sequence[str], title: str, clock: str, *, style: str = STYLE) -> str:
    """Error over time. Filled marks are on their renderer's front, which a line joins; the dashed line is the front of all."""
    if not marks:
        return ""
    low, high = _decades([mark.y for mark in marks])
    low = max(low, LEAST_ERROR)
    paper = _Paper(_decades([mark.low for mark in marks] + [mark.high for mark in marks]), (low, max(high, low + 1)))
    beneath = any(mark.y < 10.0**low for mark in marks)
    parts = [_head(title, WIDTH, HEIGHT, style), _axes(paper, clock, beneath=beneath)]
    best = sorted((mark for mark in marks if mark.front_of_all), key=lambda mark: mark.x)
    parts.append(_stairs(paper, best, "all"))
    for series in sorted({mark.series for mark in marks}):
        own = [mark for mark in marks if mark.series == series]
        parts.append(f'<g class="s{series % SERIES}"><title>{escape(own[0].renderer)}</title>')
        parts.append(_stairs(paper, sorted((mark for mark in own if mark.front), key=lambda mark: mark.x), "line front"))
        parts += [_mark(paper, mark) for mark in own]
        parts.append("</g>")
    paper.taken += [(paper.x(m.x) - 5, paper.y(m.y) - 5, paper.x(m.x) + 5, paper.y(m.y) + 5) for m in marks]
    parts += [_label(paper, mark) for mark in sorted(marks, key=lambda mark: not mark.front_of_all) if mark.front]
    parts.append(_legend([name for name in names if any(mark.renderer == name for mark in marks)], names))
    return "".join(parts) + "</svg>"


def feature_plot(features: Sequence[Mapping[str, Any]], names: Sequence[str], title: str, *, style: str = STYLE) -> str:
    """The extra CPU time of each feature, as a share of the scene's without it, with its interval; one row per renderer."""
    rows = [
        (feature["feature"], name, _shares(cost))
        for feature in features
        for name, cost in feature["renderers"].items()
        if cost["status"] == "measured" and cost["without_cpu"]["median"] > 0
    ]
    if not rows:
        return ""
    low = min(0.0, min(shares[1] for *_, shares in rows))
    high = max(0.1, max(shares[2] for *_, shares in rows))
    low, high = max(low, -1.0), min(high, 1.5)
    left, right, height = 250.0, 742.0, 20
    tall = 44 + height * len(rows) + 26

    def x(share: float) -> float:
        return left + (right - left) * min(max((share - low) / (high - low), 0.0), 1.0)

    parts = [_head(title, WIDTH, tall, style)]
    for step in _ticks(low, high):
        parts.append(f'<path class="grid" d="M{x(step):.1f} 34V{tall - 26}"/>')
        parts.append(f'<text class="muted" x="{x(step):.1f}" y="{tall - 10}" text-anchor="middle">{step:+.0%}</text>')
    parts.append(f'<path class="axis" d="M{x(0):.1f} 34V{tall - 26}"/>')
    before = ""
    for number, (feature, name, (median, least, most)) in enumerate(rows):
        y = 48 + height * number
        if feature != before:
            parts.append(f'<text x="8" y="{y + 4}">{escape(feature)}</text>')
        before = feature
        said = f"{feature}, {name}: {median:+.1%} ({least:+.1%} to {most:+.1%})"
        shown = f"{name} {'▸' if most > high else ''}{median:+.0%}"
        parts.append(
            f'<g class="s{names.index(name) % SERIES}"><title>{escape(said)}</title>'
            f'<path class="line whisker" d="M{x(least):.1f} {y}H{x(most):.1f}"/>'
            f'<path class="line front" d="M{x(0):.1f} {y}H{x(median):.1f}"/>'
            f'<circle class="mark" cx="{x(median):.1f}" cy="{y}" r="4"/></g>'
            f'<text class="muted" x="{left - 10}" y="{y + 4}" text-anchor="end">{escape(shown)}</text>'
        )
    parts.append(f'<text class="muted" x="{right}" y="18" text-anchor="end">extra CPU time, share of the scene without</text>')
    return "".join(parts) + "</svg>"


def _shares(cost: Mapping[str, Any]) -> tuple[float, float, float]:
    without, extra = cost["without_cpu"]["median"], cost["extra_cpu"]
    return extra["median"] / without, extra["low"] / without, extra["high"] / without


def _ticks(low: float, high: float) -> Iterable[float]:
    step = next(step for step in (0.05, 0.1, 0.25, 0.5, 1.0, 2.0) if (high - low) / step <= 9)
    number = math.ceil(low / step)
    while number * step <= high:
        yield number * step
        number += 1


def _decades(values: Iterable[float]) -> tuple[int, int]:
    positive = [value for value in values if value > 0 and math.isfinite(value)]
    if not positive:
        return -1, 0
    low, high = math.floor(math.log10(min(positive))), math.ceil(math.log10(max(positive)))
    return low, max(high, low + 1)


def _head(title: str, width: int, height: int, style: str) -> str:
    return (
        f'<svg class="trade" xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" role="img" '
        f'aria-label="{escape(title, quote=True)}"><title>{escape(title)}</title>'
        + (f'<style>{style}</style><rect class="paper" width="{width}" height="{height}"/>' if style else "")
    )


def _axes(paper: _Paper, clock: str, *, beneath: bool) -> str:
    parts = []
    low, high = paper.y_decades
    for power in range(low, high + 1, 1 + (high - low) // 10):
        y = paper.y(10.0**power)
        parts.append(f'<path class="grid" d="M{LEFT} {y:.1f}H{RIGHT}"/>')
        words = f"{'≤ ' if beneath and power == low else ''}{_power(power)}"
        parts.append(f'<text class="muted" x="{LEFT - 6}" y="{y + 4:.1f}" text-anchor="end">{words}</text>')
    for power in range(paper.x_decades[0], paper.x_decades[1] + 1):
        x = paper.x(10.0**power)
        parts.append(f'<path class="grid" d="M{x:.1f} {TOP}V{BOTTOM}"/>')
        parts.append(f'<text class="muted" x="{x:.1f}" y="{BOTTOM + 17}" text-anchor="middle">{_plain(power)}</text>')
    parts.append(f'<path class="axis" d="M{LEFT} {TOP}V{BOTTOM}H{RIGHT}"/>')
    words = {"wall": "wall seconds per picture", "cpu": "CPU seconds per picture"}[clock]
    parts.append(f'<text class="muted" x="{(LEFT + RIGHT) / 2}" y="{HEIGHT - 8}" text-anchor="middle">{words}</text>')
    parts.append(f'<text class="muted" x="8" y="{TOP - 12}">error: max |ΔL| / max |L|</text>')
    return "".join(parts)


def _power(power: int) -> str:
    if power == 0:
        return "1"
    return f'10<tspan dy="-4" font-size="8">{str(power).replace("-", "−")}</tspan>'


def _plain(power: int) -> str:
    return f"{10.0**power:g}"


def _stairs(paper: _Paper, marks: Sequence[Mark], kind: str) -> str:
    """The border of what a front leaves unreached: constant between its settings."""
    if len(marks) < 2:
        return ""
    path = f"M{paper.x(marks[0].x):.1f} {paper.y(marks[0].y):.1f}"
    path += "".join(f"H{paper.x(mark.x):.1f}V{paper.y(mark.y):.1f}" for mark in marks[1:])
    return f'<path class="{kind}" d="{path}"/>'


def _mark(paper: _Paper, mark: Mark) -> str:
    x, y = paper.x(mark.x), paper.y(mark.y)
    words = f"{mark.renderer}, {mark.label}: error {mark.y:.2g} in {mark.x:.3g} s ({mark.low:.3g} to {mark.high:.3g})"
    shape = _shape(mark.series, x, y, 5.0 if mark.front_of_all else 4.0)
    kind = "mark" if mark.front else "hollow"
    whisker = f'<path class="line whisker" d="M{paper.x(mark.low):.1f} {y:.1f}H{paper.x(mark.high):.1f}"/>'
    beaten = "" if mark.front else ' class="beaten"'
    return f'<g{beaten}><title>{escape(words)}</title>{whisker}<path class="{kind}" d="{shape}"/></g>'


def _shape(series: int, x: float, y: float, r: float) -> str:
    """Circle, square, triangle, diamond, triangle on its head, hexagon: colour is not all that tells renderers apart."""
    corners = (0, 4, 3, 4, 3, 6)[series % SERIES]
    if not corners:
        return f"M{x - r:.1f} {y:.1f}a{r:.1f} {r:.1f} 0 1 0 {2 * r:.1f} 0a{r:.1f} {r:.1f} 0 1 0 {-2 * r:.1f} 0z"
    start = (0.0, 45.0, 90.0, 0.0, -90.0, 0.0)[series % SERIES]
    points = (math.radians(start + 360 * i / corners) for i in range(corners))
    return "M" + "L".join(f"{x + 1.25 * r * math.cos(a):.1f} {y - 1.25 * r * math.sin(a):.1f}" for a in points) + "z"


def _label(paper: _Paper, mark: Mark) -> str:
    """The setting's name beside its mark, where there is room; nothing where it would cover something."""
    words = mark.label if len(mark.label) <= 44 else mark.label[:43] + "…"
    x, y, wide = paper.x(mark.x), paper.y(mark.y), LETTER * len(words)
    for left, dy in ((x + 9, 4), (x - 9 - wide, 4), (x + 6, -8), (x + 6, 16), (x - 6 - wide, -8), (x - 6 - wide, 16)):
        box = (left, y + dy - 10, left + wide, y + dy + 2)
        if paper.free(box):
            paper.taken.append(box)
            return f'<text class="halo" x="{left:.1f}" y="{y + dy:.1f}">{escape(words)}</text>'
    return ""


def _legend(shown: Sequence[str], names: Sequence[str]) -> str:
    parts, x = [], RIGHT
    for name in reversed(shown):
        x -= LETTER * len(name) + 24
        series = names.index(name)
        parts.append(
            f'<g class="s{series % SERIES}"><path class="mark" d="{_shape(series, x + 6, 16, 4.5)}"/>'
            f'<text x="{x + 15:.1f}" y="20">{escape(name)}</text></g>'
        )
    return "".join(parts)
