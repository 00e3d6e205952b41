"""Growth curves as SVG: costs over sizes, both logarithmic, with the power law of the largest sizes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from html import escape

from bench.fit import PowerLaw

Curve = tuple[Sequence[float], Sequence[float], PowerLaw]

WIDTH, HEIGHT = 560, 340
LEFT, RIGHT, TOP, BOTTOM = 60.0, 400.0, 34.0, 296.0
STYLE = (
    "svg{font:11px system-ui,sans-serif;color-scheme:light dark}.paper{fill:light-dark(#fff,#1a1c1f)}"
    "text{fill:light-dark(#17191c,#e8e9ea)}.muted{fill:light-dark(#5d6269,#a3a8ae)}.grid{stroke:light-dark(#dedfda,#34373b)}"
    ".s0{color:light-dark(#1c58b0,#8ab4ff)}.s1{color:light-dark(#8a5a00,#e0b050)}.s2{color:light-dark(#18774f,#7bd88f)}"
    ".s3{color:light-dark(#c0201f,#ff8a80)}.s4{color:light-dark(#5a43c0,#b9a8ff)}"
    ".dot{fill:currentColor}.law{stroke:currentColor;stroke-width:1.4;stroke-dasharray:4 3}g text{fill:currentColor}"
)
SERIES = 5


def growth_plot(title: str, of_size: str, of_cost: str, curves: Mapping[str, Curve]) -> str:
    """One plot; of_size, of_cost: what the axes are, with units. A curve: sizes, costs, law."""
    x_low, x_high = _decades([size for sizes, _, _ in curves.values() for size in sizes])
    y_low, y_high = _decades([cost for _, costs, _ in curves.values() for cost in costs])

    def x(size: float) -> float:
        return LEFT + (RIGHT - LEFT) * (math.log10(size) - x_low) / (x_high - x_low)

    def y(cost: float) -> float:
        return BOTTOM - (BOTTOM - TOP) * (math.log10(cost) - y_low) / (y_high - y_low)

    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" role="img"><title>{escape(title)}</title>',
        f'<style>{STYLE}</style><rect class="paper" width="{WIDTH}" height="{HEIGHT}"/>',
        f'<text x="{LEFT}" y="18">{escape(title)}</text>',
    ]
    for decade in range(x_low, x_high + 1):
        at = x(10.0**decade)
        parts.append(f'<path class="grid" d="M{at:.1f} {TOP}V{BOTTOM}"/>{_said(at, BOTTOM + 16, _power(decade), "middle")}')
    for decade in range(y_low, y_high + 1):
        at = y(10.0**decade)
        parts.append(f'<path class="grid" d="M{LEFT} {at:.1f}H{RIGHT}"/>{_said(LEFT - 6, at + 4, _power(decade), "end")}')
    parts += [_said(RIGHT, BOTTOM + 34, of_size, "end"), _said(LEFT, TOP - 4, of_cost, "end")]
    for index, (name, (sizes, costs, law)) in enumerate(curves.items()):
        ends = [sizes[-4 if len(sizes) >= 4 else 0], sizes[-1]]
        line = " ".join(f"{x(size):.1f},{min(max(y(law(size)), TOP), BOTTOM):.1f}" for size in ends)
        label = TOP + 12 + 34 * index
        dots = [(x(size), y(cost)) for size, cost in zip(sizes, costs, strict=True)] + [(RIGHT + 12, label - 4)]
        parts.append(
            f'<g class="s{index % SERIES}">'
            + "".join(f'<circle class="dot" cx="{across:.1f}" cy="{down:.1f}" r="3"/>' for across, down in dots)
            + f'<polyline class="law" points="{line}"/>'
            f'<text x="{RIGHT + 20}" y="{label}">{escape(name)}</text>'
            f'<text x="{RIGHT + 20}" y="{label + 14}">{_exponent(law)}</text></g>'
        )
    return "".join(parts) + "</svg>\n"


def _said(x: float, y: float, words: str, anchor: str) -> str:
    return f'<text class="muted" x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{escape(words)}</text>'


def _exponent(law: PowerLaw) -> str:
    return f"exponent {law.exponent:.2f} [{law.low:.2f}, {law.high:.2f}]"


def _decades(values: Sequence[float]) -> tuple[int, int]:
    low, high = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))
    return low, max(high, low + 1)


def _power(decade: int) -> str:
    return f"10{str(decade).translate(str.maketrans('-0123456789', '⁻⁰¹²³⁴⁵⁶⁷⁸⁹'))}"
