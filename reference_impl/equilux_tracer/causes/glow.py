"""Faults of the terms that need no light: ambient and emission."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from equilux_scenes.case import Case
from equilux_scenes.model import LightColours, Material, Scene
from equilux_tracer.causes.rewrite import (
    BLACK,
    BandTriple,
    CheckedRule,
    is_lit,
    used_materials,
    with_lights,
    with_materials,
    with_scene,
)
from equilux_tracer.causes.rule import Applied, Floats
from equilux_tracer.causes.seen import emitters_seen
from equilux_tracer.causes.tint import TINTS, tinted

PIGMENT = "× K_diff (1 − t): POV-Ray's pigment, which is as transparent as the surface"


def _has_ambient(scene: Scene) -> bool:
    """Whether anything ambient reaches a surface."""
    of_lights = scene.model == "opengl" and is_lit(scene) and any(any(light.ambient) for light in scene.delta_lights.values())
    return any(scene.ambient) or of_lights


class AmbientMissing(CheckedRule):
    """The ambient term is left out, the ambient shares of lights with it."""

    id = "ambient-missing"
    group = "light"
    formula = ("K_amb L_amb; opengl: a_m (a_global + Σ att_i spot_i a_i)", "0")
    readings: ClassVar[Mapping[str, str]] = {
        "": "the surfaces' ambient coefficient is 0",
        "global only": "the scene's ambient radiance is 0; that of lights counts",
        "lights only": "the lights' ambient shares are 0; the scene's ambient radiance counts",
    }

    def touches(self, scene: Scene) -> bool:
        return _has_ambient(scene) and any(any(material.ambient) for material in used_materials(scene))

    def values(self, case: Case, reading: str) -> tuple[None, ...]:
        both = any(case.scene.ambient) and any(any(light.ambient) for light in case.scene.delta_lights.values())
        return () if reading and not both else (None,)

    def change_case(self, case: Case, applied: Applied) -> Case:
        if applied.reading == "lights only":
            return with_lights(case, lambda _, light: {"ambient": BLACK} if isinstance(light, LightColours) else {})
        if applied.reading or case.scene.model != "opengl":
            return with_scene(case, ambient=BLACK)
        return with_materials(case, lambda _: {"ambient": BLACK})


def _tinted(term: BandTriple, material: Material, reading: str) -> BandTriple:
    plain = tinted(term, material, "" if reading == "pigment" else reading)
    share = 1 - material.transparency if reading == "pigment" else 1.0
    return plain[0] * share, plain[1] * share, plain[2] * share


class AmbientTinted(CheckedRule):
    """The ambient term has the surface's colour: in POV-Ray the pigment multiplies it (Q4)."""

    id = "ambient-tinted"
    group = "light"
    formula = ("K_amb L_amb", "K_amb K_diff L_amb")
    readings: ClassVar[Mapping[str, str]] = {
        **TINTS,
        "pigment": PIGMENT,
        "diffuse instead": "K_diff in place of K_amb: K_diff L_amb",
    }

    def touches(self, scene: Scene) -> bool:
        return _has_ambient(scene)

    def change_case(self, case: Case, applied: Applied) -> Case:
        return with_materials(case, lambda material: {"ambient": _tinted(material.ambient, material, applied.reading)})


class EmissionMissing(CheckedRule):
    """Surfaces do not glow."""

    id = "emission-missing"
    group = "light"
    formula = ("K_emit", "0")
    readings: ClassVar[Mapping[str, str]] = {
        "": "K_emit of surfaces is 0",
        "emitters seen black": "lights with an extent light as they should, and are seen black",
    }

    def touches(self, scene: Scene) -> bool:
        return True

    def values(self, case: Case, reading: str) -> tuple[None, ...]:
        return () if reading and not case.scene.area_emitters else (None,)

    def changes_picture(self, applied: Applied) -> bool:
        return bool(applied.reading)

    def change_case(self, case: Case, applied: Applied) -> Case:
        return case if applied.reading else with_materials(case, lambda _: {"emission": BLACK})

    def change_radiance(self, radiance: Floats, film_xy: Floats, case: Case, applied: Applied) -> Floats:
        return radiance - emitters_seen(case, list(case.scene.area_emitters), film_xy) if applied.reading else radiance


class EmissionTinted(CheckedRule):
    """What a surface emits has its colour: in POV-Ray the pigment multiplies emission (Q4)."""

    id = "emission-tinted"
    group = "light"
    formula = ("K_emit", "K_emit K_diff")
    readings: ClassVar[Mapping[str, str]] = {**TINTS, "pigment": PIGMENT}

    def touches(self, scene: Scene) -> bool:
        return any(any(material.emission) for material in used_materials(scene))

    def change_case(self, case: Case, applied: Applied) -> Case:
        def change(material: Material) -> dict[str, Any]:
            return {"emission": _tinted(material.emission, material, applied.reading)} if any(material.emission) else {}

        return with_materials(case, change)
