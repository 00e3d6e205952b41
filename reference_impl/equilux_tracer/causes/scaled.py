"""Radiance, or one part of it, times a constant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np

from equilux_scenes.case import Case
from equilux_tracer.causes.rewrite import used_materials
from equilux_tracer.causes.rule import Applied, Continuous, Evidence, Floats, Group, Rule
from equilux_tracer.causes.strengths import Bands, with_lights, with_materials

_LOW, _HIGH = 1e-4, 1e5
"""4π, 683 and their inverses lie well inside; a term that is left out altogether is another cause."""


class Scaled(Rule):
    """Radiance is multiplied by a constant: π or 1/π of an albedo taken for K_diff, 4π of a flux taken for an intensity, 683 of
    lumens, 255/256, an exposure.

    Also where the constant goes to one part only: the lights, K_diff, K_spec; or where each band has its own (a white balance).
    """

    id = "scaled"
    group: ClassVar[Group] = "image"
    suspects = "translation"
    formula = ("L", "k L")
    parameter = Continuous("k", "", _LOW, _HIGH, "log", neutral=1.0)
    readings: ClassVar[Mapping[str, str]] = {
        "": "k L",
        "each band": "k_R L_R, k_G L_G, k_B L_B",
        "lights": "k E_i of every light; emission, ambient and background as they are",
        "diffuse": "k K_diff",
        "highlight": "k K_spec",
        "surfaces": "k K_diff and k K_spec",
    }

    def hypotheses(self, case: Case) -> Sequence[Applied]:
        materials = list(used_materials(case.scene))
        diffuse = any(any(material.diffuse) for material in materials)
        specular = any(any(material.specular) for material in materials)
        other = any(any(material.emission) or any(material.ambient) for material in materials) or any(case.scene.background)
        lit = bool(case.scene.lights) and (diffuse or specular)
        worth = {
            "": True,
            "each band": True,
            "lights": lit and other,
            "diffuse": lit and diffuse and (specular or other),
            "highlight": lit and specular and (diffuse or other),
            # an emitter is seen itself, but not by a surface whose coefficients are scaled
            "surfaces": lit and (other or bool(case.scene.area_emitters) or case.scene.environment is not None),
        }
        return [Applied(self.id, None, reading) for reading, useful in worth.items() if useful]

    def estimates(self, hypothesis: Applied, evidence: Evidence) -> Sequence[Applied]:
        """The weighted median of (measured − what is not scaled) / what is, then least squares over the pixels that agree."""
        part = _scaled_part(hypothesis.reading, evidence)
        rest = evidence.measured - (evidence.model["radiance"] - part)
        if hypothesis.reading == "each band":
            factors = [_factor(rest[:, band], part[:, band], evidence.bound[:, band]) for band in range(3)]
            known = [factor for factor in factors if factor is not None]
            if len(known) < 3 or not all(_LOW <= factor <= _HIGH for factor in known) or np.ptp(known) <= 1e-9 * max(known):
                return []
            return [Applied(self.id, tuple(known), hypothesis.reading)]
        factor = _factor(rest, part, evidence.bound)
        if factor is None or not _LOW <= factor <= _HIGH:
            return []
        return [Applied(self.id, factor, hypothesis.reading)]

    def change_case(self, case: Case, applied: Applied) -> Case:
        def times(bands: Bands) -> Bands:
            factor = float(_factors(applied)[0])
            return bands[0] * factor, bands[1] * factor, bands[2] * factor

        match applied.reading:
            case "lights":
                return with_lights(case, ("intensity", "irradiance", "radiance"), times)
            case "diffuse":
                return with_materials(case, ("diffuse",), times)
            case "highlight":
                return with_materials(case, ("specular",), times)
            case "surfaces":
                return with_materials(case, ("diffuse", "specular"), times)
            case _:
                return case

    def change_radiance(self, radiance: Floats, film_xy: Floats, case: Case, applied: Applied) -> Floats:
        return radiance * _factors(applied) if applied.reading in ("", "each band") else radiance


def _factors(applied: Applied) -> Floats:
    factors = np.atleast_1d(np.asarray(1.0 if applied.parameter is None else applied.parameter, dtype=np.float64))
    if factors.shape not in ((1,), (3,)):
        raise ValueError(f"{applied.cause}: got parameter {applied.parameter!r}, allowed one number, or one per band")
    return factors


def _scaled_part(reading: str, evidence: Evidence) -> Floats:
    """(n, 3): what of the model's radiance the factor goes to; where rays are followed, only its first part."""
    radiance = evidence.model["radiance"]
    diffuse, specular = (evidence.model[name].sum(axis=1) for name in ("diffuse", "specular"))
    match reading:
        case "lights":
            ambient = evidence.model["light_ambient"].sum(axis=1)
            return np.asarray(diffuse + specular + ambient + evidence.model["reflected"] + evidence.model["transmitted"])
        case "diffuse":
            return np.asarray(diffuse)
        case "highlight":
            return np.asarray(specular)
        case "surfaces":
            return np.asarray(diffuse + specular)
        case _:
            return np.asarray(radiance)


def _factor(rest: Floats, part: Floats, bound: Floats) -> float | None:
    """k with rest ≈ k part; None where nothing is lit."""
    rest, part, bound = rest.ravel(), part.ravel(), np.maximum(bound.ravel(), 1e-300)
    weight = part / bound
    usable = np.isfinite(rest) & (weight > 1e-6 * weight.max(initial=0)) & (part > 0)
    if not usable.any():
        return None
    rest, part, weight = rest[usable], part[usable], weight[usable]
    ratio = rest / part
    order = np.argsort(ratio)
    cumulative = np.cumsum(weight[order])
    median = float(ratio[order[np.searchsorted(cumulative, cumulative[-1] / 2)]])
    # 1e-3 keeps pixels with the same factor together, whatever their own uncertainty
    agreeing = np.abs(rest - median * part) * weight <= (4 + 1e-3 * abs(median) * weight) * part
    if not agreeing.any():
        return median
    scale = weight[agreeing] / part[agreeing]
    a, b = part[agreeing] * scale, rest[agreeing] * scale
    return float(a @ b / (a @ a))
