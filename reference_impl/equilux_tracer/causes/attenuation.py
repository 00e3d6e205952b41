"""Faults of how light falls off with distance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from equilux_scenes.case import Case
from equilux_scenes.model import Attenuation, Light, PointLight, Scene, SpotLight
from equilux_tracer.causes.rewrite import BLACK, CheckedRule, fading_lights, is_lit, with_lights
from equilux_tracer.causes.rule import Applied, Discrete, Parameter


class AttenuationIgnored(CheckedRule):
    """Light is as strong far away as near: VTK's and the fixed-function API's default attenuation is (1, 0, 0), and POV-Ray's
    lights do not fade unless told to."""

    id = "attenuation-ignored"
    group = "light"
    formula = ("E = I / (d_c + d_l r + d_q r²)", "E = I")
    readings: ClassVar[Mapping[str, str]] = {
        "": "E = I, of all lights",
        "inverse-square instead": "E = I / r², whatever the light's own terms are",
        "point lights only": "E = I of point lights; spot lights fall off",
        "spot lights only": "E = I of spot lights; point lights fall off",
    }
    suspects = "translation"

    def touches(self, scene: Scene) -> bool:
        return is_lit(scene) and any(fading_lights(scene))

    def change_case(self, case: Case, applied: Applied) -> Case:
        instead = Attenuation(quadratic=1.0) if applied.reading == "inverse-square instead" else Attenuation(constant=1.0)
        kinds = {"point lights only": PointLight, "spot lights only": SpotLight}.get(applied.reading, PointLight | SpotLight)
        return with_lights(case, lambda _, light: {"attenuation": instead} if isinstance(light, kinds) else {})


class AttenuationTermMissing(CheckedRule):
    """One term of the attenuation never reaches the light. Where no other is left, the denominator is 1, the default of VTK and
    of the fixed-function API."""

    id = "attenuation-term-missing"
    group = "light"
    formula = ("E = I / (d_c + d_l r + d_q r²)", "the same with d_c, d_l or d_q = 0; E = I where all are 0")
    readings: ClassVar[Mapping[str, str]] = {
        "": "the term is 0",
        "left at the default": "the term keeps its default in the fixed-function API: 1 for d_c, 0 for d_l and d_q",
        "one power lower": "the quadratic term counts as linear, or the linear one as constant: d_q r in place of d_q r²",
        "none left, none lit": "the term is 0, and a light of which no term is left does not shine",
    }
    parameter = Discrete("term")
    suspects = "translation"

    def touches(self, scene: Scene) -> bool:
        return is_lit(scene) and any(fading_lights(scene))

    def values(self, case: Case, reading: str) -> Sequence[Parameter]:
        return ("constant", "linear", "quadratic")

    def change_case(self, case: Case, applied: Applied) -> Case:
        term = str(applied.parameter)

        def change(_: str, light: Light) -> dict[str, Any]:
            return _without(light, term, applied.reading) if isinstance(light, PointLight | SpotLight) else {}

        return with_lights(case, change)


def _without(light: PointLight | SpotLight, term: str, reading: str) -> dict[str, Any]:
    terms = {name: getattr(light.attenuation, name) for name in ("constant", "linear", "quadratic")}
    if reading == "one power lower" and term != "constant":
        terms[{"quadratic": "linear", "linear": "constant"}[term]] += terms[term]
    terms[term] = 1.0 if reading == "left at the default" and term == "constant" else 0.0
    if not any(terms.values()):
        if reading == "none left, none lit":
            return {"intensity": BLACK}
        terms["constant"] = 1.0
    return {"attenuation": light.attenuation.model_copy(update=terms)}
