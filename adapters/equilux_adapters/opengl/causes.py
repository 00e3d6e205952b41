"""What this implementation of OpenGL does by a rule of its own, as a rule that the tracer can apply."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from equilux_scenes.case import Case
from equilux_scenes.model import Attenuation, DeltaLight, DirectionalLight, Scene, SpotLight
from equilux_tracer import Tracer
from equilux_tracer.causes import Applied, Floats, Rule

NO_ATTENUATION = Attenuation(constant=1)


class MesaShininessZero(Rule):
    """With `GL_SHININESS` 0 and a light that falls off, with distance or as a spot, Mesa leaves the half vector out and raises
    N·L to the power N·L (`build_lighting` with `material_shininess_is_zero`, then `emit_lit`; Q10)."""

    id = "mesa:shininess-zero"
    group = "highlight"
    formula = ("E K_spec (N·H)^0 = E K_spec", "E K_spec (N·L)^(N·L)")

    @property
    def summary(self) -> str:
        return "with exponent 0 and a light that falls off, the highlight is (N·L)^(N·L)"

    def hypotheses(self, case: Case) -> Sequence[Applied]:
        scene = case.scene
        lit = any(_falls_off(light) and any(light.specular) for light in scene.delta_lights.values())
        return [Applied(self.id)] if scene.model == "opengl" and lit and any(_shininess_zero(scene)) else []

    def change_radiance(self, radiance: Floats, film_xy: Floats, case: Case, applied: Applied) -> Floats:
        out = _tracer(case).evaluate(film_xy, ("specular", "normal", "position", "object_id"))
        seen = out["object_id"]
        concerned = (seen >= 0) & np.append(_shininess_zero(case.scene), False)[seen]
        if not concerned.any():
            return radiance
        changed = radiance.copy()
        position, normal = out["position"][concerned], out["normal"][concerned]
        for index, light in enumerate(case.scene.delta_lights.values()):
            if isinstance(light, DirectionalLight) or not _falls_off(light):
                continue
            towards = np.asarray(light.position) - position
            cosine = np.maximum((normal * towards).sum(axis=1) / np.linalg.norm(towards, axis=1), 0.0)
            # 0^0 is 1, and the gate of the highlight is closed there.
            changed[concerned] += out["specular"][concerned, index] * (cosine**cosine - 1)[:, None]
        return changed


def _falls_off(light: DeltaLight) -> bool:
    return isinstance(light, SpotLight) or (not isinstance(light, DirectionalLight) and light.attenuation != NO_ATTENUATION)


def _shininess_zero(scene: Scene) -> list[bool]:
    """Of each object, whether its highlight has the exponent 0."""
    materials = [scene.materials[each.material] for each in scene.objects]
    return [material.exponent == 0 and any(material.specular) for material in materials]


@lru_cache(maxsize=4)
def _tracer(case: Case) -> Tracer:
    return Tracer(case)


RULES: Sequence[Rule] = (MesaShininessZero(),)
