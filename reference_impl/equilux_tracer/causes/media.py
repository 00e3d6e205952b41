"""Faults of refraction: which index is on which side, and what total reflection weighs."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import ClassVar, Literal

import numpy as np

from equilux_scenes.case import Case
from equilux_scenes.model import Material, Scene
from equilux_tracer.causes.rewrite import BandTriple, CheckedRule, is_lit, is_see_through, used_materials, with_materials
from equilux_tracer.causes.rule import Applied
from equilux_tracer.shading_rules import ShadingRules

_Total = Literal["mirror", "transmitted", "none", "k-refl", "one-minus-t", "through", "k-trans", "t", "mirror-and-t"]

_WEIGHTS: Mapping[str, tuple[_Total, str]] = {
    "": ("mirror", "(1 − t) k_refl: the mirror's weight"),
    "k_refl": ("k-refl", "k_refl: the mirror's, not weighted"),
    "t k_trans": ("through", "t k_trans: that of what would have gone through"),
    "transmitted too": ("transmitted", "(1 − t) k_refl + t k_trans: what would have gone through is added"),
    "none": ("none", "0: black"),
    "t": ("t", "t: L_refl in place of k_trans L_trans"),
    "t too": ("mirror-and-t", "(1 − t) k_refl + t"),
    "k_trans": ("k-trans", "k_trans: that of what would have gone through, not weighted"),
    "1 − t": ("one-minus-t", "1 − t: a mirror of k_refl 1"),
}
"""The rule's readings: which weight, and in words."""


def _bends(scene: Scene) -> bool:
    """Whether any ray is bent."""
    return is_see_through(scene) and any(m.transparency > 0 and m.ior != 1 for m in used_materials(scene))


def shines_through(scene: Scene) -> bool:
    """Whether light from behind may make a highlight: then T shows in the picture."""
    return is_lit(scene) and any(m.transparency > 0 and any(m.specular) for m in used_materials(scene))


class IndexInverted(CheckedRule):
    """The ratio of the indices is taken the other way round: rays are bent away from the normal where they should be bent
    towards it."""

    id = "index-inverted"
    group = "transport"
    formula = ("sin θ_t = (n_front / n_behind) sin θ_i", "sin θ_t = (n_behind / n_front) sin θ_i")
    readings: ClassVar[Mapping[str, str]] = {
        "": "of view rays, and of T in the highlight of light from behind",
        "view rays": "of view rays alone; T is right",
        "always entering": "only when leaving an object: always sin θ_t = sin θ_i / ior; T likewise",
        "always entering, view rays": "the same of view rays alone; T is right",
    }
    suspects = "translation"

    def touches(self, scene: Scene) -> bool:
        return _bends(scene)

    def values(self, case: Case, reading: str) -> Sequence[None]:
        return (None,) if not reading.endswith("view rays") or shines_through(case.scene) else ()

    def change_case(self, case: Case, applied: Applied) -> Case:
        return case if applied.reading else with_materials(case, lambda m: {"ior": 1 / m.ior} if m.transparency > 0 else {})

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        match applied.reading:
            case "view rays":
                return dataclasses.replace(rules, transmitted_ray="inverted")
            case "always entering":
                return dataclasses.replace(rules, always_entering=True)
            case "always entering, view rays":
                return dataclasses.replace(rules, transmitted_ray="entering")
            case _:
                return rules


class TirWeight(CheckedRule):
    """What is totally reflected is weighted like something that is not: like a mirror's reflection, or like what would have gone
    through."""

    id = "tir-weight"
    group = "transport"
    formula = ("total reflection: 1 × L_refl", "total reflection: another weight × L_refl")
    readings: ClassVar[Mapping[str, str]] = {name: words for name, (_, words) in _WEIGHTS.items()}

    def touches(self, scene: Scene) -> bool:
        return _bends(scene) and scene.recursion_limit > 0

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        return dataclasses.replace(rules, total_reflection=_WEIGHTS[applied.reading][0])

    def values(self, case: Case, reading: str) -> Sequence[None]:
        bending = [m for m in used_materials(case.scene) if m.transparency > 0 and m.ior != 1]
        before = list(_WEIGHTS)[: list(_WEIGHTS).index(reading)]
        known = [[(1.0,) * 3 for _ in bending], *([_weight(m, other) for m in bending] for other in before)]
        return () if [_weight(m, reading) for m in bending] in known else (None,)


def _weight(material: Material, reading: str) -> BandTriple:
    """What is totally reflected counts so much."""
    t, mirror, through = material.transparency, material.reflection, material.transmission
    grey = {"none": 0.0, "t": t, "1 − t": 1 - t}
    if reading in grey:
        return grey[reading], grey[reading], grey[reading]
    if reading in ("k_refl", "k_trans"):
        return mirror if reading == "k_refl" else through
    own = np.array(mirror) * (0.0 if reading == "t k_trans" else 1 - t)
    added = np.full(3, t) if reading == "t too" else t * np.array(through) if reading in ("t k_trans", "transmitted too") else 0.0
    red, green, blue = (own + added).tolist()
    return red, green, blue


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
