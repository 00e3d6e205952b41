"""Faults of what is seen through a transparent surface, and of what it weighs."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from equilux_scenes.case import Case
from equilux_scenes.model import Material, Scene
from equilux_tracer.causes.media import shines_through
from equilux_tracer.causes.rewrite import (
    BLACK,
    WHITE,
    CheckedRule,
    is_lit,
    is_see_through,
    used_materials,
    with_materials,
)
from equilux_tracer.causes.rule import Applied
from equilux_tracer.shading_rules import ShadingRules

BARELY = 1e-30
"""A transparency that shows nothing of what is behind, and still is none of an opaque object where shadows are concerned."""


class RefractionMissing(CheckedRule):
    """Nothing is seen through transparent surfaces, or it is seen unbent. VTK (Q17) and the fixed-function API (OpenGL Q8) draw
    them opaque, with 1 − t of their own."""

    id = "refraction-missing"
    group = "transport"
    formula = ("t k_trans L_trans, L_trans along the refracted ray", "0, or L_trans straight on, or the surface is opaque")
    readings: ClassVar[Mapping[str, str]] = {
        "": "k_trans = 0: black is seen through it, and it casts a full shadow under attenuate",
        "not followed": "t k_trans L_trans is left out, all else is right: its shadow, and total reflection",
        "not followed, nor totally reflected": "the same, and where light is totally reflected black is seen",
        "black, shadows by t": "black is seen through it; its shadow lets t through",
        "opaque": "t = 0: the surface's own terms in full, and a full shadow",
        "opaque, shadows kept": "L_1 in place of (1 − t) L_1 + t L_2, and its shadow is right",
        "opaque, 1 − t of its own": "(1 − t) L_1 alone, and a full shadow (VTK Q17)",
        "opaque, 1 − t of its own, shadows kept": "(1 − t) L_1 alone, and its shadow is right",
        "not bent": "ior = 1: straight on, and no total reflection",
        "not bent, view rays": "the same of view rays alone; T, in the highlight of light from behind, is bent",
    }

    def touches(self, scene: Scene) -> bool:
        return is_see_through(scene)

    def values(self, case: Case, reading: str) -> Sequence[None]:
        lit = is_lit(case.scene)
        attenuates = case.scene.transparent_shadows == "attenuate" and lit
        bends = any(m.transparency > 0 and m.ior != 1 for m in used_materials(case.scene))
        possible = {
            "black, shadows by t": attenuates,
            "not followed": attenuates and case.scene.recursion_limit > 0,
            "not followed, nor totally reflected": bends and case.scene.recursion_limit > 0,
            "not bent": bends,
            "not bent, view rays": bends and shines_through(case.scene),
        }
        return (None,) if possible.get(reading, lit or not reading.endswith("kept")) else ()

    def change_case(self, case: Case, applied: Applied) -> Case:
        if applied.reading.startswith("not followed") or applied.reading == "not bent, view rays":
            return case
        changed = with_materials(
            case, lambda material: _seen_through(material, applied.reading) if material.transparency > 0 else {}
        )
        if applied.reading.startswith("opaque") and applied.reading.endswith("kept"):
            return with_materials(changed, lambda material: _shadow_of(material, case.scene) if material.transparency > 0 else {})
        return changed

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        match applied.reading:
            case "not followed":
                return dataclasses.replace(rules, transmitted_ray="none")
            case "not followed, nor totally reflected":
                return dataclasses.replace(rules, transmitted_ray="none", total_reflection="none")
            case "not bent, view rays":
                return dataclasses.replace(rules, transmitted_ray="straight")
            case "black, shadows by t":
                return dataclasses.replace(rules, transparent_shadow="t-only")
            case "opaque, shadows kept" | "opaque, 1 − t of its own, shadows kept":
                return dataclasses.replace(rules, transparent_shadow="k-only")
            case _:
                return rules


def _seen_through(material: Material, reading: str) -> dict[str, Any]:
    if reading == "not bent":
        return {"ior": 1.0}
    if not reading.startswith("opaque"):
        return {"transmission": BLACK}
    own = 1 - material.transparency if "1 − t" in reading else 1.0
    kept = {name: tuple(own * band for band in getattr(material, name)) for name in ("diffuse", "specular", "reflection")}
    if not reading.endswith("kept"):
        return {"transparency": 0.0, "ior": 1.0, **kept}
    through = tuple(material.transparency * band for band in material.transmission)
    return {"transparency": BARELY, "ior": 1.0, "transmission": through, **kept}


def _shadow_of(material: Material, scene: Scene) -> dict[str, Any]:
    """Under the rule k-only: k_trans of a surface that `_seen_through` made is what its shadow lets through, all under ignore."""
    return {} if scene.transparent_shadows == "attenuate" else {"transmission": WHITE}


class TransparencyWeightIgnored(CheckedRule):
    """A transparent surface has all of its own light, or all of what is behind it: the terms are added, not shared out."""

    id = "transparency-weight-ignored"
    group = "transport"
    formula = ("(1 − t) L_1 + t L_2", "L_1 + L_2 where t > 0")
    readings: ClassVar[Mapping[str, str]] = {
        "": "L_1 + L_2",
        "1 − t left out": "L_1 + t L_2",
        "t left out": "(1 − t) L_1 + L_2",
        "in shadows too": "L_1 + L_2, and shadows let k_trans through in place of t k_trans",
        "opaque surfaces too": "L_1 + L_2 of every surface: where t = 0, light from behind and k_trans L_trans are added, too",
    }

    def touches(self, scene: Scene) -> bool:
        return is_see_through(scene)

    def values(self, case: Case, reading: str) -> Sequence[None]:
        shadowed = case.scene.transparent_shadows == "attenuate" and is_lit(case.scene)
        return () if reading == "in shadows too" and not shadowed else (None,)

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        if applied.reading == "in shadows too":
            rules = dataclasses.replace(rules, transparent_shadow="k-only")
        if applied.reading == "opaque surfaces too":
            rules = dataclasses.replace(rules, opaque_behind=True)
        front, behind = applied.reading == "t left out", applied.reading == "1 − t left out"
        return dataclasses.replace(rules, front_weighted=front, behind_weighted=behind)
