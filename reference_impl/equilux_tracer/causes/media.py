"""Faults of refraction: which index is on which side, and what total reflection weighs."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import ClassVar, Literal

from equilux_scenes.case import Case
from equilux_scenes.model import Scene
from equilux_tracer.causes.rewrite import CheckedRule, is_see_through, used_materials, with_materials
from equilux_tracer.causes.rule import Applied
from equilux_tracer.shading_rules import ShadingRules

_WEIGHTS: dict[str, Literal["mirror", "transmitted", "none"]] = {"": "mirror", "transmitted too": "transmitted", "none": "none"}


def _bends(scene: Scene) -> bool:
    """Whether any ray is bent."""
    return is_see_through(scene) and any(m.transparency > 0 and m.ior != 1 for m in used_materials(scene))


class IndexInverted(CheckedRule):
    """The ratio of the indices is taken the other way round: rays are bent away from the normal where they should be bent
    towards it."""

    id = "index-inverted"
    group = "transport"
    formula = ("sin θ_t = (n_front / n_behind) sin θ_i", "sin θ_t = (n_behind / n_front) sin θ_i")
    suspects = "translation"

    def touches(self, scene: Scene) -> bool:
        return _bends(scene)

    def change_case(self, case: Case, applied: Applied) -> Case:
        return with_materials(case, lambda m: {"ior": 1 / m.ior} if m.transparency > 0 else {})


class TirWeight(CheckedRule):
    """What is totally reflected is weighted like something that is not: like a mirror's reflection, or like what would have gone
    through."""

    id = "tir-weight"
    group = "transport"
    formula = ("total reflection: 1 × L_refl", "total reflection: another weight × L_refl")
    readings: ClassVar[Mapping[str, str]] = {
        "": "(1 − t) k_refl: the mirror's weight",
        "transmitted too": "(1 − t) k_refl + t k_trans: what would have gone through is added",
        "none": "0: black",
    }

    def touches(self, scene: Scene) -> bool:
        return _bends(scene) and scene.recursion_limit > 0

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        return dataclasses.replace(rules, total_reflection=_WEIGHTS[applied.reading])


class NestedMedia(CheckedRule):
    """A ray that enters an object inside another one bends from the outer object's index. POV-Ray keeps a stack of media, and
    tells by it alone whether a ray enters or leaves (Q36, Q43): one that an interpolated normal sent to the wrong side of its
    face bends the wrong way at the next one."""

    id = "nested-media"
    group = "transport"
    formula = ("1 outside each object", "outside an object the index of the one around it")
    readings: ClassVar[Mapping[str, str]] = {
        "": "the side that the ray meets says whether it enters or leaves",
        "counted": "the ray is in what it went through once and not a second time, whichever side it meets (POV-Ray Q36)",
    }

    def touches(self, scene: Scene) -> bool:
        return _bends(scene)

    def values(self, case: Case, reading: str) -> Sequence[None]:
        transparent = [i for i, obj in enumerate(case.scene.objects) if case.scene.materials[obj.material].transparency > 0]
        # only beyond an interpolated normal are the two sides told apart otherwise than by counting
        smooth = any(i in case.meshes and case.meshes[i].vertex_normals is not None for i in transparent)
        return (None,) if (smooth if reading == "counted" else len(transparent) > 1) else ()

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        if applied.reading == "counted":
            return dataclasses.replace(rules, media_counted=True)
        return dataclasses.replace(rules, nested_media=True)
