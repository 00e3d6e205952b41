"""Error curves of `equilux extremes` as SVG: error and stated uncertainty over a pushed quantity, one small chart a renderer.

Values stand side by side in the order of the axis, a step for each decade, whatever their numbers are: a quantity may end at 0 or
near 180°. The error's axis is logarithmic.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from equilux_report import numerals

WIDTH, HEIGHT = 340, 168
LEFT, RIGHT, TOP, BOTTOM = 36.0, 334.0, 10.0, 132.0
LOWEST, HIGHEST = -18, 2
"""Decades of the error; what lies beyond is drawn at the rim."""
LABELS = 6


def chart(curve: Mapping[str, Any], axis: Mapping[str, Any], title: str) -> str:
    """The chart of one curve of extremes.json."""
    points = curve["points"]
    places = _places(len(points))
    parts = [
        f'<svg class="push" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{escape(title, quote=True)}">',
        _grid(),
        _labels(points, places),
        _benign(axis, places),
        _line("push__uncertainty", points, places, "uncertainty"),
        _line("push__error", points, places, "error"),
        *(_mark(point, x) for point, x in zip(points, places, strict=True)),
        *(_breakdown(turn, points, places) for turn in curve["turns"]),
    ]
    return "".join(parts) + "</svg>"


def _places(count: int) -> list[float]:
    return [LEFT + 8 + (RIGHT - LEFT - 16) * (index / (count - 1) if count > 1 else 0.5) for index in range(count)]


def _height(value: float | None) -> float | None:
    """Where an error lies on paper; 0 at the bottom."""
    if value is None:
        return None
    decade = LOWEST if value <= 0 else min(max(math.log10(value), LOWEST), HIGHEST)
    return BOTTOM - (BOTTOM - TOP) * (decade - LOWEST) / (HIGHEST - LOWEST)


def _grid() -> str:
    parts = []
    for decade in range(LOWEST + 2, HIGHEST + 1, 4):
        y = _height(10.0**decade)
        parts.append(f'<path class="push__grid" d="M{LEFT} {y:.1f}H{RIGHT}"/>')
        parts.append(f'<text x="{LEFT - 4}" y="{(y or 0) + 3:.1f}" text-anchor="end">1e{decade}</text>')
    return "".join(parts) + f'<path class="push__axis" d="M{LEFT} {BOTTOM}H{RIGHT}"/>'


def _labels(points: Sequence[Mapping[str, Any]], places: Sequence[float]) -> str:
    step = max(1, -(-len(points) // LABELS))
    return "".join(
        f'<text x="{places[index]:.1f}" y="{BOTTOM + 14}" text-anchor="middle">{_short(points[index]["value"])}</text>'
        for index in range(0, len(points), step)
    )


def _short(value: float) -> str:
    return (
        numerals.shortest(value).replace("e-0", "e-").replace("e+", "e")
        if abs(value) < 1e5
        else f"{value:.0e}".replace("e+0", "e").replace("e+", "e")
    )


def _benign(axis: Mapping[str, Any], places: Sequence[float]) -> str:
    x = places[axis["values"].index(axis["benign"])]
    return f'<path class="push__benign" d="M{x:.1f} {TOP}V{BOTTOM}"><title>where every renderer must hold</title></path>'


def _line(name: str, points: Sequence[Mapping[str, Any]], places: Sequence[float], key: str) -> str:
    """A line that breaks where there is no number."""
    path, pen_down = [], False
    for point, x in zip(points, places, strict=True):
        y = _height(point[key])
        if y is not None:
            path.append(f"{'L' if pen_down else 'M'}{x:.1f} {y:.1f}")
        pen_down = y is not None
    return f'<path class="{name}" d="{"".join(path)}"/>' if path else ""


def _mark(point: Mapping[str, Any], x: float) -> str:
    """One picture: its error, and what came of it, told by shape as well as by colour."""
    outcome = point["outcome"]
    y = _height(point["error"])
    if y is None:
        y = TOP if outcome in ("outside", "failed") else BOTTOM
    said = f"<title>{escape(_said(point))}</title>"
    if outcome in ("outside", "failed"):
        return f'<path class="push__bad" d="M{x - 3:.1f} {y - 3:.1f}l6 6m0 -6l-6 6">{said}</path>'
    if outcome == "inside":
        return f'<circle class="push__good" cx="{x:.1f}" cy="{y:.1f}" r="2.2">{said}</circle>'
    if outcome == "blind":
        return f'<circle class="push__blind" cx="{x:.1f}" cy="{y:.1f}" r="2.4">{said}</circle>'
    return f'<path class="push__none" d="M{x - 3:.1f} {BOTTOM}h6">{said}</path>'


def _said(point: Mapping[str, Any]) -> str:
    said = f"{numerals.shortest(point['value'])}: {point['outcome']}"
    if point["error"] is not None:
        said += f", error {numerals.magnitude(point['error'])} of the largest radiance"
    if point["uncertainty"] is not None:
        said += f", stated {numerals.magnitude(point['uncertainty'])}"
    if point["symptom"]:
        said += f"; {point['symptom']['words']}"
    elif point["reason"]:
        said += f"; {point['reason']}"
    return said


def _breakdown(turn: Mapping[str, Any], points: Sequence[Mapping[str, Any]], places: Sequence[float]) -> str:
    """A line between the last good value and the first broken one, and what lies beyond it shaded."""
    if turn["breakdown"] is None:
        return ""
    index = next(i for i, point in enumerate(points) if point["value"] == turn["breakdown"])
    half = (places[1] - places[0]) / 2 if len(places) > 1 else 0.0
    x = places[index] + (half if turn["direction"] == "down" else -half)
    start, width = (LEFT, x - LEFT) if turn["direction"] == "down" else (x, RIGHT - x)
    return (
        f'<rect class="push__beyond" x="{start:.1f}" y="{TOP}" width="{max(width, 0):.1f}" height="{BOTTOM - TOP}"/>'
        f'<path class="push__break" d="M{x:.1f} {TOP}V{BOTTOM}"/>'
    )
