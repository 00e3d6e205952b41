"""Faults of what light meets on its way: shadows, mirrors, glass."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import ClassVar, Literal

import numpy as np

from equilux_scenes.case import Case
from equilux_scenes.features import required_features
from equilux_scenes.model import DirectionalLight, Scene
from equilux_tracer.causes.background import BackgroundMissing
from equilux_tracer.causes.glass import RefractionMissing, TransparencyWeightIgnored
from equilux_tracer.causes.media import IndexInverted, NestedMedia, TirWeight
from equilux_tracer.causes.recursion import RecursionCut, TransmissionUncounted, WeightCut
from equilux_tracer.causes.rewrite import (
    BLACK,
    BandTriple,
    CheckedRule,
    is_lit,
    is_see_through,
    strength,
    used_materials,
    with_materials,
    with_scene,
)
from equilux_tracer.causes.rule import Applied, Continuous, Evidence, Rule
from equilux_tracer.causes.seen import reach
from equilux_tracer.shading_rules import ShadingRules


def _occludes(scene: Scene) -> bool:
    return "occlusion" in required_features(scene)


class OcclusionIgnored(CheckedRule):
    """Nothing stands between a light and a surface: no shadows, not even a body's own (VTK, the fixed-function API)."""

    id = "occlusion-ignored"
    group = "transport"
    formula = ("E τ", "E")

    def touches(self, scene: Scene) -> bool:
        return _occludes(scene)

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        return dataclasses.replace(rules, occlusion=False)


class TransparentShadowRule(CheckedRule):
    """What a transparent object does to the light that crosses it is not what the scene says: it casts a full shadow, or none, or
    another share of the light comes through."""

    id = "transparent-shadow-rule"
    group = "transport"
    formula = ("τ = Π t k_trans over the crossings (attenuate), or 1 (ignore)", "τ by another rule")
    readings: ClassVar[Mapping[str, str]] = {
        "": "the model's other rule: ignore for attenuate, attenuate for ignore",
        "opaque": "τ = 0: a full shadow",
        "t only": "τ = Π t",
        "k_trans only": "τ = Π k_trans",
        "once per object": "τ = Π t k_trans over the objects that are crossed, however often",
        "1 − t": "τ = Π (1 − t)",
    }

    def touches(self, scene: Scene) -> bool:
        return is_lit(scene) and is_see_through(scene)

    def values(self, case: Case, reading: str) -> Sequence[None]:
        attenuates = case.scene.transparent_shadows == "attenuate"
        return (None,) if attenuates or reading != "once per object" else ()

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        match applied.reading:
            case "opaque":
                return dataclasses.replace(rules, transparent_shadow="opaque")
            case "t only":
                return dataclasses.replace(rules, transparent_shadow="t-only")
            case "k_trans only":
                return dataclasses.replace(rules, transparent_shadow="k-only")
            case "once per object":
                return dataclasses.replace(rules, transparent_shadow="once")
            case "1 − t":
                return dataclasses.replace(rules, transparent_shadow="one-minus-t")
            case _:
                return rules

    def change_case(self, case: Case, applied: Applied) -> Case:
        other = "ignore" if case.scene.transparent_shadows == "attenuate" else "attenuate"
        return case if applied.reading else with_scene(case, transparent_shadows=other)


def _bounces(scene: Scene) -> bool:
    return scene.model == "raytraced" and scene.recursion_limit > 0


class ReflectionMissing(CheckedRule):
    """Mirrors show nothing: the local terms stay, the reflected radiance is left out (VTK Q16, OpenGL Q8)."""

    id = "reflection-missing"
    group = "transport"
    formula = ("L_1 = Σ … + k_refl L_refl", "L_1 = Σ …")
    readings: ClassVar[Mapping[str, str]] = {
        "": "k_refl = 0; total internal reflection stays",
        "total reflection too": "k_refl = 0, and total internal reflection shows black",
    }

    def touches(self, scene: Scene) -> bool:
        return _bounces(scene)

    def values(self, case: Case, reading: str) -> Sequence[None]:
        mirrors = any(any(m.reflection) and m.transparency < 1 for m in used_materials(case.scene))
        bends = any(m.transparency > 0 and m.ior != 1 for m in used_materials(case.scene))
        return (None,) if mirrors and (bends or not reading) else ()

    def change_case(self, case: Case, applied: Applied) -> Case:
        return with_materials(case, lambda _: {"reflection": BLACK})

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        return dataclasses.replace(rules, total_reflection="none") if applied.reading else rules


_Bias = Literal["along-ray", "along-normal", "along-lit-normal", "along-lit-face", "not-aimed", "before-light", "both-ends"]

_BIASES: Mapping[str, tuple[_Bias, str]] = {
    "": ("along-ray", "s along the shadow ray"),
    "off the surface": ("along-lit-normal", "the shadow ray starts a length off the surface along N, on the light's side"),
    "off the viewer's side": ("along-normal", "the same, on the viewer's side wherever the light is"),
    "off the face": ("along-lit-face", "along the geometric normal, on the light's side"),
    "off the surface, not aimed": ("not-aimed", "on the light's side, and on in the direction that L had at the surface"),
    "before the light": ("before-light", "τ: crossings with s ≤ r − length, r the distance of the light"),
    "both ends": ("both-ends", "τ: crossings with length ≤ s ≤ r − length"),
}
"""The rule's readings: which bias, and in words."""


class ShadowBias(CheckedRule):
    """Shadow rays start off the surface, end before the light, or drop what is near: blockers nearer than a length are missed,
    and shadows do not reach the feet of what casts them. 1e-3 of its unit in POV-Ray (Q37), 1500 × 2^-24 of its coordinates at
    the surface and 1e-3 of a ray's length at the light in Mitsuba (Q9)."""

    id = "shadow-bias"
    group = "transport"
    formula = ("τ: crossings with 0 < s", "τ: crossings with length ≤ s, s from the surface")
    readings: ClassVar[Mapping[str, str]] = {name: words for name, (_, words) in _BIASES.items()}
    parameter = Continuous("length", "m", 1e-12, 1e12, "log")

    def touches(self, scene: Scene) -> bool:
        return _occludes(scene) and any(any(light) for light in _strengths_of_delta(scene))

    def values(self, case: Case, reading: str) -> Sequence[None]:
        near = any(not isinstance(light, DirectionalLight) for light in case.scene.delta_lights.values())
        possible = {
            "off the viewer's side": is_see_through(case.scene),
            "off the face": any(mesh.vertex_normals is not None for mesh in case.meshes.values()),
            "off the surface, not aimed": near,
            "before the light": near,
            "both ends": near,
        }
        return (None,) if possible.get(reading, True) else ()

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        length = float(applied.parameter)  # type: ignore[arg-type]
        return dataclasses.replace(rules, shadow_bias_m=length, shadow_bias=_BIASES[applied.reading][0])

    def estimates(self, hypothesis: Applied, evidence: Evidence) -> Sequence[Applied]:
        """Three lengths a decade, from 1e-6 of the scene's size to that size, round ones. Of those that do the same the shortest
        comes first: a bias is meant to be small."""
        largest = np.floor(np.log10(reach(evidence.case)))
        lengths = [round(step * 10.0**power, 15) for power in np.arange(largest - 5, largest + 1) for step in (1, 2, 5)]
        return [Applied(self.id, float(length), hypothesis.reading) for length in lengths if length > 0]


def _strengths_of_delta(scene: Scene) -> list[BandTriple]:
    return [strength(light) for light in scene.delta_lights.values()]


RULES: Sequence[Rule] = (
    OcclusionIgnored(),
    TransparentShadowRule(),
    ReflectionMissing(),
    RefractionMissing(),
    RecursionCut(),
    WeightCut(),
    IndexInverted(),
    TirWeight(),
    NestedMedia(),
    TransmissionUncounted(),
    ShadowBias(),
    TransparencyWeightIgnored(),
    BackgroundMissing(),
)
