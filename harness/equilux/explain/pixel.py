"""One pixel of a pair: both values, and the uncertainty they are held against, part by part."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from equilux.explain.numbers import short

Bands = tuple[float, float, float]
NOT_FINITE: Bands = (math.nan, math.nan, math.nan)
CLASSES = ("agree", "diverge", "edge", "invalid")


@dataclass(frozen=True)
class SidePixel:
    """What one render says there. stated: the `uncertainty` of its render.json. per_pixel, sigma: uncertainty.exr there."""

    adapter: str
    radiance: Bands
    stated: Mapping[str, Any]
    per_pixel: Bands = (0.0, 0.0, 0.0)
    sigma: Bands = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Part:
    """What one term, or several that were propagated together, contributes to B, W/(m²·sr) by band."""

    adapter: str
    term: str
    kind: str
    amount: Bands
    reason: str


@dataclass(frozen=True)
class PixelFacts:
    """Both values, B and its parts, E_n and the class; `band` is the one with the largest |E_n|."""

    x: int
    y: int
    a: Bands
    b: Bands
    bound: Bands
    normalised_error: Bands
    band: int
    parts: tuple[Part, ...]
    pixel_class: str | None = None

    @property
    def difference(self) -> Bands:
        return _by_band(lambda band: self.a[band] - self.b[band])

    def to_json(self) -> dict[str, Any]:
        """NaN and infinities are null."""
        numbers = {
            "a": self.a, "b": self.b, "difference": self.difference, "bound": self.bound, "en": self.normalised_error,
        }  # fmt: skip
        return {
            "x": self.x,
            "y": self.y,
            "class": self.pixel_class,
            "band": "RGB"[self.band],
            **{name: [_finite(value) for value in values] for name, values in numbers.items()},
            "parts": [asdict(part) | {"amount": [_finite(value) for value in part.amount]} for part in self.parts],
        }


def pixel_facts(x: int, y: int, a: SidePixel, b: SidePixel, coverage_factor: float, pixel_class: str | None = None) -> PixelFacts:
    """B = Σ bounds of both + k √(σ_a² + σ_b²) at a pixel, E_n = (L_a − L_b)/B, by band."""
    parts = [*_bounds(a), *_bounds(b), *_sampled(a, b, coverage_factor)]
    bound = _by_band(lambda band: math.fsum(part.amount[band] for part in parts))
    en = _by_band(lambda band: _ratio(a.radiance[band] - b.radiance[band], bound[band]))
    largest = max(range(3), key=lambda band: math.inf if math.isnan(en[band]) else abs(en[band]))
    parts.sort(key=lambda part: -part.amount[largest] if math.isfinite(part.amount[largest]) else 0.0)
    return PixelFacts(x, y, a.radiance, b.radiance, bound, en, largest, tuple(parts), pixel_class)


def _bounds(side: SidePixel) -> Sequence[Part]:
    """The hard parts: each term with a number of its own, and what varies per pixel in one part, as it was propagated in one."""
    parts, together = [], []
    for term in side.stated.get("terms", ()):
        if term["kind"] == "bound" and not isinstance(term.get("abs"), Mapping):
            amount = _linear(side, float(term.get("abs") or 0.0), float(term.get("rel") or 0.0))
            parts.append(Part(side.adapter, term["name"], "bound", amount, term.get("reason", "")))
            continue
        if term["kind"] == "bound":
            rel = float(term.get("rel") or 0.0)
            if rel:
                parts.append(Part(side.adapter, term["name"], "bound", _linear(side, 0.0, rel), term.get("reason", "")))
            together.append(term)
        elif term["kind"] == "geometric" and (_any(term.get("normal")) or _any(term.get("position_m"))):
            together.append(term)
    if any(side.per_pixel):
        names = " + ".join(str(term["name"]) for term in together) or "what varies per pixel"
        reason = "; ".join(dict.fromkeys(_reason(term) for term in together))
        kind = "geometric" if any(term["kind"] == "geometric" for term in together) else "bound"
        parts.append(Part(side.adapter, names, kind, side.per_pixel, reason))
    if not side.stated.get("terms"):
        amount = _linear(side, float(side.stated.get("abs") or 0.0), float(side.stated.get("rel") or 0.0))
        parts.append(Part(side.adapter, "stated", "bound", amount, "abs + rel |L|"))
    return parts


def _reason(term: Mapping[str, Any]) -> str:
    """A geometric term says what it bounds, as its share of the radiance cannot be told apart."""
    if term["kind"] != "geometric":
        return str(term.get("reason", ""))
    symbols = {"normal": "|ΔN|", "position_m": "|ΔP|"}
    bounds = [f"{symbol} ≤ {_size(term[key])}" for key, symbol in symbols.items() if _any(term.get(key))]
    return f"{', '.join(bounds)} ({term.get('reason', '')})"


def _size(value: Any) -> str:
    numbers = list(value.values()) if isinstance(value, Mapping) else [value]
    return short(max((float(number) for number in numbers), default=0.0))


def _any(value: Any) -> bool:
    return any(value.values()) if isinstance(value, Mapping) else bool(value)


def _sampled(a: SidePixel, b: SidePixel, k: float) -> Sequence[Part]:
    if not (any(a.sigma) or any(b.sigma)):
        return ()
    sides = [side for side in (a, b) if any(side.sigma)]
    names = [
        term["name"] for side in sides for term in side.stated.get("terms", ()) if term["kind"] == "sampled"
    ] or ["sampling"]  # fmt: skip
    amount = _by_band(lambda band: k * math.hypot(a.sigma[band], b.sigma[band]))
    reason = f"{short(k)} standard deviations of the mean: no false alarm in 1e6 pictures"
    return (Part(" and ".join(side.adapter for side in sides), " + ".join(names), "sampled", amount, reason),)


def _linear(side: SidePixel, absolute: float, relative: float) -> Bands:
    return _by_band(lambda band: absolute + relative * abs(side.radiance[band]))


def _by_band(value: Any) -> Bands:
    return (value(0), value(1), value(2))


def _ratio(difference: float, bound: float) -> float:
    if bound > 0 or math.isnan(difference):
        return difference / bound if bound > 0 else math.nan
    return 0.0 if difference == 0 else math.copysign(math.inf, difference)


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
