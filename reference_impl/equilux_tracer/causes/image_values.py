"""Faults of how a pixel's value is written down: curves, limits, order of the bands, factors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import permutations
from typing import ClassVar

import numpy as np

from equilux_scenes.case import Case
from equilux_tracer.causes.encodings import CURVES, decoded, encoded
from equilux_tracer.causes.rule import Applied, Continuous, Discrete, Evidence, Floats, Group, Rule
from equilux_tracer.causes.strengths import band_values, with_bands_ordered

_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Of linear Rec.709."""


class GammaEncoded(Rule):
    """Pixels hold encoded values where linear radiance is asked for: what a picture made for a screen holds.

    The parameter is the curve: srgb, rec709, or the exponent of a power law. Decoded values come from a picture that was linear
    and was taken for an encoded one.
    """

    id = "gamma-encoded"
    group: ClassVar[Group] = "image"
    formula = ("L", "L^(1/γ), or the curve's formula")
    parameter = Discrete("curve")
    readings: ClassVar[Mapping[str, str]] = {
        "": "L^(1/γ), whatever L is",
        "clipped": "min(L, 1)^(1/γ)",
        "decoded": "L^γ: decoded once too often",
        "decoded, clipped": "min(L, 1)^γ",
    }

    def estimates(self, hypothesis: Applied, evidence: Evidence) -> Sequence[Applied]:
        """The two named curves that fit best, and the power law that does."""
        candidates = [*CURVES, *self._power(hypothesis.reading, evidence)]
        tried = [Applied(self.id, curve, hypothesis.reading) for curve in candidates]
        return sorted(tried, key=lambda applied: _misfit(self, applied, evidence))[:2]

    def _power(self, reading: str, evidence: Evidence) -> list[str]:
        model, measured = evidence.model["radiance"], evidence.measured
        usable = (model > 1e-6) & (measured > 1e-6) & (np.abs(np.log(np.maximum(model, 1e-300))) > 0.1)
        usable &= (model < 1) | (not reading.endswith("clipped"))
        if usable.sum() < 4:
            return []
        slope = float(np.median(np.log(measured[usable]) / np.log(model[usable])))
        power = slope if reading.startswith("decoded") else 1 / slope if slope else 0.0
        # a power below 1 is the other reading's; one next to a named power law is that
        known = any(abs(power / float(curve) - 1) < 1e-3 for curve in CURVES if curve[0].isdigit())
        return [f"{power:.10g}"] if 1 + 1e-6 < power < 10 and not known else []

    def change_radiance(self, radiance: Floats, film_xy: Floats, case: Case, applied: Applied) -> Floats:
        curve = str(applied.parameter)
        limited = np.minimum(radiance, 1.0) if applied.reading.endswith("clipped") else radiance
        return decoded(limited, curve) if applied.reading.startswith("decoded") else encoded(limited, curve)


class Clamped(Rule):
    """Radiance is cut off: above 1 where a picture was made for a screen, above 65504 in half floats."""

    id = "clamped"
    group: ClassVar[Group] = "image"
    formula = ("L", "min(L, value), each band by itself")
    parameter = Continuous("value", "W/(m²·sr)", 1e-9, 1e9, "log")
    readings: ClassVar[Mapping[str, str]] = {
        "": "min(L, value), each band by itself",
        "from below": "max(L, value)",
        "by the largest band": "L value / max(L_R, L_G, L_B), where that is less: the hue is kept",
        "by luminance": "L value / Y, where the luminance Y of L is more",
    }

    def estimates(self, hypothesis: Applied, evidence: Evidence) -> Sequence[Applied]:
        """The largest value in the picture (the least, from below), or the round number that is the same within B."""
        picture = np.asarray(evidence.picture, np.float64)
        finite = picture[np.isfinite(picture).all(axis=2)]
        if not len(finite):
            return []
        match hypothesis.reading:
            case "from below":
                value, changes = float(finite.min()), evidence.truth.min() < finite.min()
            case "by luminance":
                value = float((finite @ _LUMINANCE).max())
                changes = bool((evidence.truth @ _LUMINANCE).max() > value)
            case _:
                value, changes = float(finite.max()), evidence.truth.max() > finite.max()
        if not changes or value <= 0:
            return []
        tolerance = max(float(np.median(evidence.bound)), 1e-7 * value)
        rounded = (float(f"{value:.{digits}g}") for digits in (1, 2, 3))
        values = [*(near for near in rounded if abs(near - value) <= tolerance), value]
        return [Applied(self.id, each, hypothesis.reading) for each in dict.fromkeys(values)][:2]

    def change_radiance(self, radiance: Floats, film_xy: Floats, case: Case, applied: Applied) -> Floats:
        value = _number(applied)
        match applied.reading:
            case "from below":
                return np.maximum(radiance, value)
            case "by the largest band":
                largest = radiance.max(axis=1, keepdims=True)
            case "by luminance":
                largest = (radiance @ _LUMINANCE)[:, None]
            case _:
                return np.minimum(radiance, value)
        result: Floats = radiance * np.minimum(value / np.maximum(largest, 1e-300), 1.0)
        return result


class BandsSwapped(Rule):
    """The bands come in another order: `bgr` is the picture whose first band is the blue one, as many file formats and image
    libraries have it."""

    id = "bands-swapped"
    group: ClassVar[Group] = "image"
    suspects = "translation"
    formula = ("(L_R, L_G, L_B)", "(L_B, L_G, L_R), or another order")
    parameter = Discrete("order")
    readings: ClassVar[Mapping[str, str]] = {
        "": "of the picture",
        "materials": "of the materials, not of lights and background",
        "lights": "of lights, ambient and background, not of the materials",
    }

    def hypotheses(self, case: Case) -> Sequence[Applied]:
        of_materials, of_lights = band_values(case, "materials"), band_values(case, "lights")
        orders = [order for order in permutations(range(3)) if order != (0, 1, 2)]
        result = []
        for order in orders:
            name = "".join("rgb"[band] for band in order)
            materials_change = (of_materials != of_materials[:, order]).any()
            lights_change = (of_lights != of_lights[:, order]).any()
            if materials_change or lights_change:
                result.append(Applied(self.id, name))
            if materials_change and lights_change:
                result += [Applied(self.id, name, "materials"), Applied(self.id, name, "lights")]
        return result

    def change_case(self, case: Case, applied: Applied) -> Case:
        return with_bands_ordered(case, applied.reading, _order(applied)) if applied.reading else case

    def change_radiance(self, radiance: Floats, film_xy: Floats, case: Case, applied: Applied) -> Floats:
        return radiance if applied.reading else radiance[:, _order(applied)]


def _order(applied: Applied) -> tuple[int, ...]:
    return tuple("rgb".index(band) for band in str(applied.parameter))


def _number(applied: Applied) -> float:
    if not isinstance(applied.parameter, float | int):
        raise ValueError(f"{applied.cause}: got parameter {applied.parameter!r}, allowed a number")
    return float(applied.parameter)


def _misfit(rule: Rule, applied: Applied, evidence: Evidence) -> float:
    """Median of |measured − changed model| in units of B: the less, the likelier."""
    changed = rule.change_radiance(evidence.model["radiance"], evidence.film_xy, evidence.case, applied)
    off = np.abs(evidence.measured - changed) / np.maximum(evidence.bound, 1e-300)
    return float(np.median(np.nan_to_num(off[evidence.diverging], nan=1e300))) if evidence.diverging.any() else 0.0
