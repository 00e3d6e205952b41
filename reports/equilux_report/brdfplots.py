"""Plots of BRDFs as SVG: the lecture's polar plot for a fixed incoming direction, and reflectance over the angle of incidence.

Input is what `equilux brdf` says in numbers; nothing is computed here but positions on paper.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

STYLE = """
.brdf{font:11px system-ui,sans-serif;fill:none}
.brdf .paper{fill:light-dark(#fff,#1a1c1f);stroke:none}
.brdf text{fill:var(--ink,#17191c);stroke:none}
.brdf .muted{fill:var(--muted,#5d6269)}
.brdf .grid{stroke:var(--line,#dedfda)}
.brdf .axis{stroke:var(--line-strong,#b9bbb6)}
.brdf .light{stroke:var(--expected,#8a5a00);stroke-width:1.5}
.brdf .head{fill:var(--expected,#8a5a00)}
.brdf .mirror{stroke:var(--muted,#5d6269);stroke-dasharray:2 3}
.brdf .one{stroke:var(--unexpected,#c0201f);stroke-dasharray:4 3}
.brdf .said{font-size:10px}
.brdf .curve{stroke-width:1.8;stroke-linejoin:round}
.brdf .all{stroke:var(--ink,#17191c)}
.brdf .r{stroke:light-dark(#c22f2f,#ff8a80)}
.brdf .g{stroke:light-dark(#1d7a35,#7bd88f)}.brdf .b{stroke:light-dark(#2456c8,#8ab4ff)}
""".strip()
"""Of a plot that stands alone; the report's own style sheet says the same in the page's colours."""

_BANDS = {"all": "all bands", "r": "R", "g": "G", "b": "B"}


@dataclass(frozen=True)
class Curve:
    """One band's study (`equilux.brdf.Study.to_json`); band: all, r, g or b."""

    band: str
    study: Mapping[str, Any]


def polar_plot(curves: Sequence[Curve], title: str, *, style: str = STYLE) -> str:
    """f_r in the plane of incidence as distance from the point of reflection, 1/sr; the light comes from the left."""
    width, height, radius, cx, cy = 360, 226, 150.0, 180.0, 196.0
    top = _nice(max(value for curve in curves for value in curve.study["curve"]))
    scale = radius / top
    theta = math.radians(curves[0].study["theta_i_deg"])
    parts = [_head(width, height, title, style)]
    for share in (0.25, 0.5, 0.75, 1.0):
        r = radius * share
        parts.append(f'<path class="grid" d="M{cx - r:.1f} {cy}A{r:.1f} {r:.1f} 0 0 1 {cx + r:.1f} {cy}"/>')
        parts.append(f'<text class="muted" x="{cx + r:.1f}" y="{cy + 13}" text-anchor="middle">{top * share:.3g}</text>')
    parts.append(f'<path class="axis" d="M{cx - radius} {cy}H{cx + radius}M{cx} {cy}V{cy - radius}"/>')
    lx, ly = cx - radius * math.sin(theta), cy - radius * math.cos(theta)
    parts.append(f'<path class="mirror" d="M{cx} {cy}L{2 * cx - lx:.1f} {ly:.1f}"/>')
    parts.append(f'<path class="light" d="M{lx:.1f} {ly:.1f}L{cx} {cy}"/>{_arrow(lx, ly, cx, cy)}')
    for curve in curves:
        points = " ".join(
            f"{cx + value * scale * math.sin(math.radians(angle)):.2f},{cy - value * scale * math.cos(math.radians(angle)):.2f}"
            for angle, value in zip(curve.study["curve_deg"], curve.study["curve"], strict=True)
        )
        parts.append(f'<polyline class="curve {curve.band}" points="{points}"><title>{_BANDS[curve.band]}</title></polyline>')
    caption = f"f_r, 1/sr, light at {curves[0].study['theta_i_deg']:g}° from the normal"
    parts.append(f'<text class="muted" x="{cx}" y="{height - 3}" text-anchor="middle">{caption}</text>')
    parts.append(_coefficients(curves))
    return "".join(parts) + "</svg>"


def reflectance_plot(curves: Sequence[Curve], title: str, *, style: str = STYLE) -> str:
    """ρ over the angle of incidence; the dashed line is 1, above which more light leaves than arrives."""
    width, height, left, right, top_y, bottom = 360, 226, 38.0, 350.0, 46.0, 182.0
    largest = max(value for curve in curves for value in curve.study["rho"])
    top = max(_nice(min(largest, 4.0)), 1.0)
    parts = [_head(width, height, title, style)]
    for step in range(5):
        y = bottom - (bottom - top_y) * step / 4
        parts.append(f'<path class="grid" d="M{left} {y:.1f}H{right}"/>')
        parts.append(f'<text class="muted" x="{left - 5}" y="{y + 4:.1f}" text-anchor="end">{top * step / 4:.3g}</text>')
    for angle in (0, 30, 60, 90):
        x = left + (right - left) * angle / 90
        parts.append(f'<text class="muted" x="{x:.1f}" y="{bottom + 15}" text-anchor="middle">{angle}°</text>')
    one = bottom - (bottom - top_y) / top
    parts.append(f'<path class="one" d="M{left} {one:.1f}H{right}"/>')
    for curve in curves:
        shown = [(a, v) for a, v in zip(curve.study["rho_deg"], curve.study["rho"], strict=True) if v <= top]
        points = " ".join(f"{left + (right - left) * a / 90:.1f},{bottom - (bottom - top_y) * v / top:.1f}" for a, v in shown)
        parts.append(f'<polyline class="curve {curve.band}" points="{points}"><title>{_BANDS[curve.band]}</title></polyline>')
    beyond = f", up to {largest:.3g}" if largest > top else ""
    parts.append(
        f'<text class="muted" x="{(left + right) / 2}" y="{height - 8}" text-anchor="middle">ρ(θ_i){beyond}; dashed: 1</text>'
    )
    parts.append(_coefficients(curves))
    return "".join(parts) + "</svg>"


def _coefficients(curves: Sequence[Curve]) -> str:
    """Kind, K_diff, K_spec and p, one line for each curve: a plot that is mailed on says what it is of."""
    lines = []
    for row, curve in enumerate(curves):
        brdf = curve.study["brdf"]
        said = f"{brdf['kind']}  K_diff {brdf['diffuse']:g}  K_spec {brdf['specular']:g}  p {brdf['exponent']:g}"
        band = "" if curve.band == "all" else f"{_BANDS[curve.band]}  "
        lines.append(f'<text class="said" x="356" y="{11 + 13 * row}" text-anchor="end">{escape(band + said)}</text>')
    return "".join(lines)


def _head(width: int, height: int, title: str, style: str) -> str:
    return (
        f'<svg class="brdf" xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" role="img" '
        f'aria-label="{escape(title, quote=True)}"><title>{escape(title)}</title>'
        + (f'<style>{style}</style><rect class="paper" width="{width}" height="{height}"/>' if style else "")
    )


def _arrow(x0: float, y0: float, x1: float, y1: float) -> str:
    """A head at the end of the light's ray, a little before the point of reflection."""
    length = math.hypot(x1 - x0, y1 - y0) or 1.0
    ux, uy = (x1 - x0) / length, (y1 - y0) / length
    points = ((0.0, 0.0), (-9.0, 4.0), (-9.0, -4.0))
    return (
        '<path class="head" d="M' + "L".join(f"{x1 + a * ux - b * uy:.1f} {y1 + a * uy + b * ux:.1f}" for a, b in points) + 'z"/>'
    )


def _nice(value: float) -> float:
    """The next round number, for the end of an axis."""
    if not value > 0 or not math.isfinite(value):
        return 1.0
    power = 10.0 ** math.floor(math.log10(value))
    return next(step * power for step in (1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10) if step * power >= value * (1 - 1e-12))
