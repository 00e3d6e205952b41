"""What rules that rewrite the scene share: the scene with other materials or lights, and whether that makes any difference."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from equilux_scenes.case import Case
from equilux_scenes.model import DeltaLight, DirectionalLight, Emitter, Light, Material, PointLight, Scene, SpotLight
from equilux_tracer.causes.rule import Applied, Continuous, Parameter, Rule
from equilux_tracer.shading_rules import MODEL_RULES

BandTriple = tuple[float, float, float]
BLACK: BandTriple = (0.0, 0.0, 0.0)
WHITE: BandTriple = (1.0, 1.0, 1.0)


class CheckedRule(Rule):
    """A rule whose hypotheses all change something: what a case does not have is not tried, nor is the same thing twice."""

    def touches(self, scene: Scene) -> bool:
        """Whether the scene has what the rule is about."""
        return True

    def values(self, case: Case, reading: str) -> Sequence[Parameter]:
        """The parameters worth trying; for a continuous one None, once."""
        return (None,)

    def hypotheses(self, case: Case) -> Sequence[Applied]:
        if not self.touches(case.scene):
            return []
        found: list[Applied] = []
        seen: list[tuple[Any, ...]] = [(case.scene, MODEL_RULES, False)]
        for reading in self.readings:
            for value in self.values(case, reading):
                applied = Applied(self.id, value, reading)
                if isinstance(self.parameter, Continuous) and value is None:
                    found.append(applied)
                    continue
                outcome = (
                    self.change_case(case, applied).scene,
                    self.change_shading(MODEL_RULES, applied),
                    self.changes_picture(applied),
                )
                if outcome not in seen or outcome[2]:
                    seen.append(outcome)
                    found.append(applied)
        return found

    def changes_picture(self, applied: Applied) -> bool:
        """Whether this reading has a `change_radiance` of its own."""
        return False


def with_scene(case: Case, **update: Any) -> Case:
    """The case with these keys of its scene replaced, unchecked."""
    return dataclasses.replace(case, scene=case.scene.model_copy(update=update))


def with_materials(case: Case, change: Callable[[Material], dict[str, Any]]) -> Case:
    """The case with every material that an object uses changed: `change` gives the keys that are replaced."""
    used = {obj.material for obj in case.scene.objects}
    materials = {name: _replaced(m, change(m)) if name in used else m for name, m in case.scene.materials.items()}
    return with_scene(case, materials=materials)


def with_lights(case: Case, change: Callable[[str, Light], dict[str, Any]]) -> Case:
    """The case with its lights changed: `change` gives the keys that are replaced of the light with that name."""
    return with_scene(case, lights={name: _replaced(light, change(name, light)) for name, light in case.scene.lights.items()})


def with_spots(case: Case, change: Callable[[SpotLight], dict[str, Any]]) -> Case:
    """The case with its spot lights changed."""
    return with_lights(case, lambda _, light: change(light) if isinstance(light, SpotLight) else {})


def _replaced(part: Any, update: dict[str, Any]) -> Any:
    return part.model_copy(update=update) if any(getattr(part, key) != value for key, value in update.items()) else part


def times(a: Sequence[float], b: Sequence[float], factor: float = 1.0) -> BandTriple:
    """Band by band."""
    return a[0] * b[0] * factor, a[1] * b[1] * factor, a[2] * b[2] * factor


def used_materials(scene: Scene) -> Iterator[Material]:
    """The materials that objects use, each once."""
    return (scene.materials[name] for name in {obj.material: None for obj in scene.objects})


def strength(light: Light) -> BandTriple:
    """What the light's bands are, whatever its kind calls them."""
    if isinstance(light, Emitter):
        return light.radiance
    return light.irradiance if isinstance(light, DirectionalLight) else light.intensity


def is_lit(scene: Scene) -> bool:
    """Whether any light shines."""
    return any(any(strength(light)) for light in scene.lights.values())


def fading_lights(scene: Scene) -> Iterator[PointLight | SpotLight]:
    """The lights that have an attenuation."""
    return (light for light in scene.lights.values() if isinstance(light, PointLight | SpotLight))


def spots(scene: Scene) -> list[SpotLight]:
    """The spot lights that shine."""
    return [light for light in scene.lights.values() if isinstance(light, SpotLight) and any(light.intensity)]


def has_highlight(scene: Scene) -> bool:
    """Whether any surface has a highlight of any light."""
    return is_lit(scene) and any(is_shiny(material, scene) for material in used_materials(scene))


def is_shiny(material: Material, scene: Scene) -> bool:
    """Whether a surface of this material has a highlight."""
    return any(material.specular) and (scene.model != "reflection-equation" or material.brdf != "lambert")


def is_see_through(scene: Scene) -> bool:
    """Whether any surface is transparent."""
    return scene.model == "raytraced" and any(material.transparency > 0 for material in used_materials(scene))


def delta_lights(scene: Scene) -> list[DeltaLight]:
    """The lights without an extent, in the order of the tracer's channels."""
    return list(scene.delta_lights.values())
