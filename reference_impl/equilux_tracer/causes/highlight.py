"""Faults of the diffuse term and of the highlight."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from equilux_scenes.case import Case
from equilux_scenes.model import Material, PerspectiveCamera, Scene
from equilux_tracer.causes.exponent import ExponentClamped, ExponentScaled, SpecularFloored
from equilux_tracer.causes.recursion import follows_rays
from equilux_tracer.causes.rewrite import (
    BLACK,
    CheckedRule,
    has_highlight,
    is_lit,
    is_see_through,
    is_shiny,
    used_materials,
    with_materials,
)
from equilux_tracer.causes.rule import Applied, Rule
from equilux_tracer.causes.tint import TINTS, tinted
from equilux_tracer.shading_rules import ShadingRules


class _Highlight(CheckedRule):
    """Base: a rule about the highlight of any light."""

    group = "highlight"

    def touches(self, scene: Scene) -> bool:
        return has_highlight(scene)


def _is_opengl(scene: Scene) -> bool:
    return scene.model == "opengl"


def _has_diffuse(scene: Scene) -> bool:
    return is_lit(scene) and any(any(material.diffuse) for material in used_materials(scene))


class DiffuseMissing(CheckedRule):
    """Surfaces have no diffuse term: neither of light from in front nor, where they are transparent, of light from behind."""

    id = "diffuse-missing"
    group = "highlight"
    formula = ("E K_diff (N·L)", "0")

    def touches(self, scene: Scene) -> bool:
        return is_lit(scene)

    def change_case(self, case: Case, applied: Applied) -> Case:
        return with_materials(case, lambda _: {"diffuse": BLACK})


class DiffuseTwoSided(CheckedRule):
    """Light that falls on the side of a surface that is not seen is counted as if it fell on the one that is. Known from shaders
    that take the absolute value of N·L where they mean to turn N to the viewer."""

    id = "diffuse-two-sided"
    group = "highlight"
    formula = ("K_diff max(0, N·L)", "K_diff |N·L|")
    readings: ClassVar[Mapping[str, str]] = {
        "": "the diffuse term alone; the highlight keeps its gate",
        "highlight too": "the highlight too shows where N·L < 0, as light from in front would make it",
        "in L_1 alone": "of transparent surfaces L_1 alone counts both sides; L_2 keeps to light from behind",
        "in L_1 alone, highlight too": "N is turned to the light in L_1; L_2 is as it was",
    }

    def touches(self, scene: Scene) -> bool:
        return _has_diffuse(scene)

    def values(self, case: Case, reading: str) -> Sequence[None]:
        without_highlight = "highlight" in reading and not has_highlight(case.scene)
        without_behind = "L_1" in reading and not is_see_through(case.scene)
        return () if without_highlight or without_behind else (None,)

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        return dataclasses.replace(
            rules,
            diffuse_two_sided=True,
            two_sided_behind="L_1" not in applied.reading,
            highlight_two_sided="highlight" in applied.reading,
        )


class HalfVector(_Highlight):
    """The highlight is Blinn's, of the half vector, with the exponent as it is: what the fixed-function API has (OpenGL Q7), and
    POV-Ray's `specular`. In model opengl the other way round: Phong's, of the mirrored light (VTK)."""

    id = "half-vector"
    formula = ("K_spec max(0, R·V)^p; opengl: s_m max(0, N·H)^s", "K_spec max(0, N·H)^p; opengl: s_m max(0, R·V)^s")

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        return dataclasses.replace(rules, half_vector=True)


class HighlightUngated(_Highlight):
    """The highlight has no gate: it also shows on surfaces that face away from the light. The lecture's own formula has none."""

    id = "highlight-ungated"
    formula = ("g K_spec max(0, R·V)^p, g = 1 if N·L > 0 else 0", "K_spec max(0, R·V)^p")
    readings: ClassVar[Mapping[str, str]] = {
        "": "R = 2 (N·L) N − L, or H, as the formula stands",
        "about −N": "light from behind makes the highlight that it would make about −N: max(0, −N·H)^s; R is the same about both",
    }

    def values(self, case: Case, reading: str) -> Sequence[None]:
        return () if reading and not _is_opengl(case.scene) else (None,)

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        if applied.reading:
            return dataclasses.replace(rules, highlight_two_sided=True)
        return dataclasses.replace(rules, highlight_ungated=True)


class HighlightCosine(_Highlight):
    """The highlight is multiplied by the cosine of the light's incidence, as the lecture's BRDF says and what renderers call
    "Phong" does not."""

    id = "highlight-cosine"
    formula = ("E K_spec max(0, R·V)^p", "E K_spec max(0, R·V)^p (N·L)")
    readings: ClassVar[Mapping[str, str]] = {
        "": "every highlight; in model reflection-equation every phong-classic is a phong-cosine",
        "in front": "that of light from in front alone; the transmitted highlight of light from behind is as it was",
        "left out": "the other way round: reflection-equation's phong-cosine is drawn as phong-classic",
    }

    def values(self, case: Case, reading: str) -> Sequence[None]:
        if reading == "in front":
            return (None,) if is_see_through(case.scene) else ()
        return () if reading and case.scene.model != "reflection-equation" else (None,)

    def change_case(self, case: Case, applied: Applied) -> Case:
        if case.scene.model != "reflection-equation":
            return case
        before, after = ("phong-cosine", "phong-classic") if applied.reading else ("phong-classic", "phong-cosine")
        return with_materials(case, lambda m: {"brdf": after} if m.brdf == before and any(m.specular) else {})

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        # In model reflection-equation it is a change of the BRDF; the flag is for the kernels of the other models.
        if applied.reading == "left out":
            return rules
        return dataclasses.replace(rules, highlight_cosine=True, cosine_behind=not applied.reading)


class HighlightTinted(_Highlight):
    """The highlight has the surface's colour, as metals do and as renderers with one colour per surface do (POV-Ray's `metallic`
    and its pigment)."""

    id = "highlight-tinted"
    formula = ("K_spec max(0, R·V)^p", "K_spec K_diff max(0, R·V)^p")
    readings: ClassVar[Mapping[str, str]] = {**TINTS, "diffuse instead": "K_diff in place of K_spec: K_diff max(0, R·V)^p"}

    def change_case(self, case: Case, applied: Applied) -> Case:
        def change(material: Material) -> dict[str, Any]:
            if not is_shiny(material, case.scene):
                return {}
            return {"specular": tinted(material.specular, material, applied.reading)}

        return with_materials(case, change)


class HighlightMissing(_Highlight):
    """Surfaces have no highlight at all."""

    id = "highlight-missing"
    formula = ("K_spec max(0, R·V)^p", "0")

    def change_case(self, case: Case, applied: Applied) -> Case:
        return with_materials(case, lambda m: {"specular": BLACK} if is_shiny(m, case.scene) else {})


def _shines_through(scene: Scene) -> bool:
    """Whether a transparent surface has a highlight."""
    return is_see_through(scene) and is_lit(scene) and any(m.transparency > 0 and any(m.specular) for m in used_materials(scene))


class TransmittedHighlightMissing(CheckedRule):
    """Light that comes through a surface from behind makes no highlight: no common renderer has that term (POV-Ray, VTK)."""

    id = "transmitted-highlight-missing"
    group = "highlight"
    formula = ("L_2: E τ (K_diff |N·L| + K_spec max(0, T·V)^p)", "L_2: E τ K_diff |N·L|")

    def touches(self, scene: Scene) -> bool:
        return _shines_through(scene)

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        return dataclasses.replace(rules, transmitted_highlight=False)


class TransparentHighlightUnweighted(CheckedRule):
    """The highlight of a transparent surface is as strong as that of an opaque one: POV-Ray's `phong` is not scaled by the
    pigment's transparency."""

    id = "transparent-highlight-unweighted"
    group = "highlight"
    formula = ("(1 − t) K_spec max(0, R·V)^p", "K_spec max(0, R·V)^p")

    def touches(self, scene: Scene) -> bool:
        return _shines_through(scene)

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        return dataclasses.replace(rules, highlight_weighted=False)


_FIRST = "on what the camera's own rays meet; on what mirrors and glass show, V is right"


class ViewVectorFromEye(_Highlight):
    """V is always taken to the eye point: where the rays of the view are parallel (VTK Q9), where the viewer is infinite, and in
    what mirrors and glass show, where it should be minus the ray's direction."""

    id = "view-vector-from-eye"
    formula = ("V = −(direction of the ray); opengl, infinite viewer: −(view direction)", "V = unit(eye − P)")
    readings: ClassVar[Mapping[str, str]] = {"": "on every surface", "camera rays only": _FIRST}

    def touches(self, scene: Scene) -> bool:
        if _is_opengl(scene):
            return scene.viewer == "infinite" and has_highlight(scene)
        return (follows_rays(scene) or not isinstance(scene.camera, PerspectiveCamera)) and has_highlight(scene)

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        return dataclasses.replace(rules, viewer="from-eye-first" if applied.reading else "from-eye")

    def values(self, case: Case, reading: str) -> Sequence[None]:
        # With perspective, the camera's own rays come from the eye anyway.
        parallel = not isinstance(case.scene.camera, PerspectiveCamera)
        return (None,) if not reading or (parallel and follows_rays(case.scene)) else ()


class ViewVectorFixed(_Highlight):
    """V is one direction for the whole picture, as if the viewer were at infinity: the fixed-function API's default."""

    id = "view-vector-fixed"
    formula = ("V = −(direction of the ray); opengl: unit(eye − P)", "V = −(view direction)")
    readings: ClassVar[Mapping[str, str]] = {"": "on every surface", "camera rays only": _FIRST}

    def touches(self, scene: Scene) -> bool:
        if _is_opengl(scene):
            return scene.viewer == "local" and has_highlight(scene)
        return (follows_rays(scene) or isinstance(scene.camera, PerspectiveCamera)) and has_highlight(scene)

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        return dataclasses.replace(rules, viewer="fixed-first" if applied.reading else "fixed")

    def values(self, case: Case, reading: str) -> Sequence[None]:
        # Where views are parallel, the camera's own rays all come from there anyway.
        spread = isinstance(case.scene.camera, PerspectiveCamera)
        return (None,) if not reading or (spread and follows_rays(case.scene)) else ()


RULES: Sequence[Rule] = (
    DiffuseMissing(),
    DiffuseTwoSided(),
    HalfVector(),
    ExponentClamped(),
    ExponentScaled(),
    SpecularFloored(),
    HighlightUngated(),
    HighlightCosine(),
    HighlightTinted(),
    HighlightMissing(),
    TransmittedHighlightMissing(),
    TransparentHighlightUnweighted(),
    ViewVectorFromEye(),
    ViewVectorFixed(),
)
