"""Faults of what is seen through a transparent surface, and of what it weighs."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from equilux_scenes.case import Case
from equilux_scenes.model import Material, Scene
from equilux_tracer.causes.rewrite import BLACK, CheckedRule, is_lit, is_see_through, with_materials
from equilux_tracer.causes.rule import Applied
from equilux_tracer.shading_rules import ShadingRules


class RefractionMissing(CheckedRule):
    """Nothing is seen through transparent surfaces, or it is seen unbent. VTK (Q17) and the fixed-function API (OpenGL Q8) draw
    them opaque, with 1 − t of their own."""

    id = "refraction-missing"
    group = "transport"
    formula = ("t k_trans L_trans, L_trans along the refracted ray", "0, or L_trans straight on, or the surface is opaque")
    readings: ClassVar[Mapping[str, str]] = {
        "": "k_trans = 0: black is seen through it, and it casts a full shadow under attenuate",
        "black, shadows by t": "nothing is seen through it; shadows are attenuated by t",
        "opaque": "t = 0: the surface's own terms in full, and a full shadow",
        "opaque, 1 − t of its own": "t = 0, with K_diff, K_spec and k_refl times 1 − t (VTK Q17)",
        "not bent": "ior = 1: straight on, and no total reflection",
    }

    def touches(self, scene: Scene) -> bool:
        return is_see_through(scene)

    def values(self, case: Case, reading: str) -> Sequence[None]:
        shadowed = case.scene.transparent_shadows == "attenuate" and is_lit(case.scene)
        return () if reading == "black, shadows by t" and not shadowed else (None,)

    def change_case(self, case: Case, applied: Applied) -> Case:
        return with_materials(
            case, lambda material: _seen_through(material, applied.reading) if material.transparency > 0 else {}
        )

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        return dataclasses.replace(rules, transparent_shadow="t-only") if applied.reading == "black, shadows by t" else rules


def _seen_through(material: Material, reading: str) -> dict[str, Any]:
    match reading:
        case "not bent":
            return {"ior": 1.0}
        case "opaque":
            return {"transparency": 0.0, "ior": 1.0}
        case "opaque, 1 − t of its own":
            own = 1 - material.transparency
            kept = {name: tuple(own * band for band in getattr(material, name)) for name in ("diffuse", "specular", "reflection")}
            return {"transparency": 0.0, "ior": 1.0, **kept}
        case _:
            return {"transmission": BLACK}


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
