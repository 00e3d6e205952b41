"""Distance laws of point and spot lights as POV-Ray lights: sums of A · 2 / (1 + (r/d)^p)."""

from __future__ import annotations

import math
from dataclasses import dataclass

from equilux.adapter import Unsupported
from equilux_scenes.model import Attenuation

SMALLEST_FADE = 1e-9  # units; POV-Ray ignores a fade_distance below 1e-10 (Q8)
LEAST_SPLIT = 1e-3  # below this relative distance of its roots the three-term law cancels in float32 to more than 1e-4
FLOAT32 = 2.0**-24


@dataclass(frozen=True)
class Term:
    """One light: intensity · factor · 2 / (1 + (r/fade_distance)^fade_power), lengths in written units.

    No fading, and no factor 2, when the power is 0. near: the distance stands for zero, so it is as small as accuracy asks.
    """

    factor: float
    fade_power: int = 0
    fade_distance: float = 0.0
    near: bool = False


@dataclass(frozen=True)
class Law:
    """The terms of one light's law 1 / (d_c + d_l r + d_q r²), and what they get wrong.

    relative: bound on |ΔE| / E. cancelled: bound on |ΔE| per unit of intensity, by cancellation of terms of opposite sign.
    """

    terms: tuple[Term, ...]
    relative: float = 0.0
    cancelled: float = 0.0


def law(attenuation: Attenuation, scale: float, nearest_m: float, fade_ratio: float) -> Law:
    """The exact sum of POV-Ray terms for `attenuation`, in a frame of `scale` units per metre.

    nearest_m: lower bound of the lit distances. Raises Unsupported, naming the terms, where no finite sum exists:
    d_l² ≤ 4 d_c d_q with all three terms present.
    """
    c, linear, q = attenuation.constant, attenuation.linear, attenuation.quadratic
    if linear == 0:
        return _even(c, q, scale, nearest_m, fade_ratio)
    if q == 0:
        return _linear(c, linear, scale, nearest_m, fade_ratio)
    return _two_roots(c, linear, q, scale, nearest_m, fade_ratio)


def _even(c: float, q: float, scale: float, nearest_m: float, fade_ratio: float) -> Law:
    """1/d_c, or 1/(d_c + d_q r²) = (1/d_c) / (1 + (r/d)²) with d = √(d_c/d_q); d_c = 0 is d → 0 (Q9)."""
    if q == 0:
        return Law((Term(1.0 / c),))
    if c > 0 and scale * math.sqrt(c / q) > SMALLEST_FADE:
        return Law((Term(0.5 / c, 2, scale * math.sqrt(c / q)),))
    d = _small(fade_ratio * nearest_m * scale)
    return Law((Term(0.5 * (scale / d) ** 2 / q, 2, d, near=True),), relative=(d / (nearest_m * scale)) ** 2)


def _linear(c: float, linear: float, scale: float, nearest_m: float, fade_ratio: float) -> Law:
    """1/(d_c + d_l r) = (1/d_c) / (1 + r/d) with d = d_c/d_l; d_c = 0 is d → 0, of the first order only (Q9)."""
    if c > 0 and scale * c / linear > SMALLEST_FADE:
        return Law((Term(0.5 / c, 1, scale * c / linear),))
    d = _small(fade_ratio**2 * nearest_m * scale)
    return Law((Term(0.5 * scale / d / linear, 1, d, near=True),), relative=d / (nearest_m * scale))


def _two_roots(c: float, linear: float, q: float, scale: float, nearest_m: float, fade_ratio: float) -> Law:
    """1/(d_q (r + r₁)(r + r₂)) = (1/(d_q (r₂ − r₁))) (1/(r + r₁) − 1/(r + r₂)): two lights, the second negative (Q10)."""
    discriminant = linear * linear - 4.0 * c * q
    law_text = f"1 / ({c:g} + {linear:g} r + {q:g} r²)"
    names = ["attenuation.constant", "attenuation.linear", "attenuation.quadratic"]
    if discriminant <= 0:
        raise Unsupported(names, f"{law_text} is no sum of POV-Ray's 1 / (1 + (r/d)^p): linear² ≤ 4 constant quadratic")
    r2 = (linear + math.sqrt(discriminant)) / (2.0 * q)
    r1 = c / (q * r2)
    if r2 - r1 < LEAST_SPLIT * (r1 + r2):
        raise Unsupported(names, f"{law_text} has nearly a double root: POV-Ray's two float32 lights cancel")
    amplitude = 1.0 / (q * (r2 - r1))
    d1 = scale * r1 if scale * r1 > SMALLEST_FADE else _small(fade_ratio**2 * nearest_m * scale)
    first = Term(0.5 * amplitude * scale / d1, 1, d1, near=d1 != scale * r1)
    second = Term(-0.5 * amplitude / r2, 1, scale * r2)
    # the first term is E₁ = E (r + r₂)/(r₂ − r₁); its own error counts against E, largest relative to it at the farthest r, but
    # in absolute value at the nearest
    displaced = abs(d1 / scale - r1)
    r = nearest_m
    sizes = amplitude * (1.0 / (r + r1) + 1.0 / (r + r2))
    return Law((first, second), cancelled=8 * FLOAT32 * sizes + amplitude * displaced / (r + r1) ** 2)


def _small(wanted: float) -> float:
    """A fade distance that stands for zero, rounded down to a power of ten so that it reads as what it is."""
    return max(10.0 ** math.floor(math.log10(wanted)), SMALLEST_FADE)
