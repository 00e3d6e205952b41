"""Radiance that is rounded to so many bits."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import ClassVar

import numpy as np

from equilux_scenes.case import Case
from equilux_tracer.causes.encodings import decoded, encoded
from equilux_tracer.causes.rule import Applied, Discrete, Evidence, Floats, Group, Rule

MOST_BITS = 16


class Quantised(Rule):
    """Radiance is rounded to n bits: what 8-bit (and 16-bit) files and buffers do, or floats of few digits.

    Values beyond 1 are cut off at 1, as integers of n bits do, unless the reading says otherwise. Where the range is the
    picture's own, the parameter is (bits, largest value).
    """

    id = "quantised"
    group: ClassVar[Group] = "image"
    formula = ("L", "round(min(L, 1) (2ⁿ − 1)) / (2ⁿ − 1)")
    parameter = Discrete("bits", "bit")
    readings: ClassVar[Mapping[str, str]] = {
        "": "round(min(L, 1) (2ⁿ − 1)) / (2ⁿ − 1)",
        "unclipped": "round(L (2ⁿ − 1)) / (2ⁿ − 1)",
        "floor": "floor(min(L, 1) (2ⁿ − 1)) / (2ⁿ − 1)",
        "floor, unclipped": "floor(L (2ⁿ − 1)) / (2ⁿ − 1)",
        "equal steps": "min(floor(L 2ⁿ), 2ⁿ − 1) / (2ⁿ − 1)",
        "power of two": "round(L 2ⁿ) / 2ⁿ",
        "power of two, floor": "floor(L 2ⁿ) / 2ⁿ",
        "power of two, floor, clipped": "min(floor(L 2ⁿ), 2ⁿ − 1) / 2ⁿ",
        "middle of steps": "(floor(min(L, 1) 2ⁿ) + ½) / 2ⁿ, at most 1",
        "of the range": "round(L/m (2ⁿ − 1)) / (2ⁿ − 1) m, m the picture's largest value",
        "of the range, floor": "floor(L/m (2ⁿ − 1)) / (2ⁿ − 1) m",
        "encoded by srgb": "the sRGB curve's encoding of L is rounded, then decoded",
        "encoded by 2.2": "L^(1/2.2) is rounded, then decoded",
        "half float": "IEEE 754 binary16",
        "significant": "a binary floating-point number of n significant digits",
        "significant, cut": "the same, the other digits cut off",
    }

    def hypotheses(self, case: Case) -> Sequence[Applied]:
        return [Applied(self.id)]

    def estimates(self, hypothesis: Applied, evidence: Evidence) -> Sequence[Applied]:
        """The two readings and numbers of bits that come nearest on the pixels that diverge: all are tried."""
        if not evidence.diverging.any():
            return []
        model, measured = evidence.model["radiance"][evidence.diverging], evidence.measured[evidence.diverging]
        bound = np.maximum(evidence.bound[evidence.diverging], 1e-300)
        picture = np.asarray(evidence.picture, np.float64)
        tops = dict.fromkeys(float(image[np.isfinite(image)].max(initial=0)) for image in (evidence.truth, picture))
        ranked = []
        for position, reading in enumerate(self.readings):
            of_range = reading.startswith("of the range")
            for bits in [16] if reading == "half float" else range(1, MOST_BITS + 1):
                for parameter in [(bits, top) for top in tops] if of_range else [bits]:
                    applied = Applied(self.id, parameter, reading)
                    off = np.abs(measured - _quantised(model, applied)) / bound
                    ranked.append((float(np.mean(1 - 1 / (1 + np.nan_to_num(off, nan=1e9)))), position, bits, applied))
        return [applied for *_, applied in sorted(ranked, key=lambda entry: entry[:3])[:2]]

    def change_radiance(self, radiance: Floats, film_xy: Floats, case: Case, applied: Applied) -> Floats:
        return _quantised(radiance, applied)


def _quantised(radiance: Floats, applied: Applied) -> Floats:
    given = applied.parameter if isinstance(applied.parameter, tuple) else (applied.parameter, 1.0)
    if not all(isinstance(number, float | int) for number in given):
        raise ValueError(f"{applied.cause}: got parameter {applied.parameter!r}, allowed a number of bits")
    bits, largest = float(given[0] or 0), float(given[1] or 0)
    steps, levels = 2.0**bits - 1, 2.0**bits
    cut = np.minimum(radiance, 1.0)
    match applied.reading:
        case "unclipped":
            value = np.rint(radiance * steps) / steps
        case "floor":
            value = np.floor(cut * steps) / steps
        case "floor, unclipped":
            value = np.floor(radiance * steps) / steps
        case "equal steps":
            value = np.minimum(np.floor(radiance * levels), steps) / steps
        case "power of two":
            value = np.rint(radiance * levels) / levels
        case "power of two, floor":
            value = np.floor(radiance * levels) / levels
        case "power of two, floor, clipped":
            value = np.minimum(np.floor(radiance * levels), steps) / levels
        case "middle of steps":
            value = np.minimum((np.floor(cut * levels) + 0.5) / levels, 1.0)
        case "of the range" | "of the range, floor":
            rounded: Callable[[Floats], Floats] = np.rint if applied.reading == "of the range" else np.floor
            unit = (largest or 1.0) / steps
            value = rounded(radiance / unit) * unit
        case "encoded by srgb" | "encoded by 2.2":
            curve = applied.reading.removeprefix("encoded by ")
            value = decoded(np.rint(encoded(cut, curve) * steps) / steps, curve)
        case "significant" | "significant, cut":
            mantissa, exponent = np.frexp(radiance)
            digits = np.rint(mantissa * levels) if applied.reading == "significant" else np.trunc(mantissa * levels)
            value = np.ldexp(digits / levels, exponent)
        case "half float":
            with np.errstate(over="ignore"):
                value = radiance.astype(np.float16).astype(np.float64)
        case _:
            value = np.rint(cut * steps) / steps
    result: Floats = np.asarray(value, dtype=np.float64)
    return result
