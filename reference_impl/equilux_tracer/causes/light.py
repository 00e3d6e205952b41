"""Faults of lights, ambient and emission."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from typing import Any, ClassVar

import numpy as np

from equilux_scenes.case import Case
from equilux_scenes.model import (
    AreaEmitter,
    DirectionalLight,
    EnvironmentEmitter,
    Light,
    PointLight,
    Scene,
    SpotLight,
)
from equilux_tracer.causes.attenuation import AttenuationIgnored, AttenuationTermMissing
from equilux_tracer.causes.glow import AmbientMissing, AmbientTinted, EmissionMissing, EmissionTinted
from equilux_tracer.causes.rewrite import BLACK, WHITE, CheckedRule, is_lit, strength, with_lights, with_scene
from equilux_tracer.causes.rule import Applied, Discrete, Evidence, Floats, Parameter, Rule
from equilux_tracer.causes.seen import absent_emitter, emitters_seen
from equilux_tracer.causes.spot import (
    SpotConeDoubled,
    SpotConeHalved,
    SpotConeIgnored,
    SpotExponentClamped,
    SpotExponentIgnored,
    SpotIgnored,
)
from equilux_tracer.causes.strengths import Bands
from equilux_tracer.causes.strengths import with_lights as with_light_bands

MOST_LIGHTS_TRIED = 8
"""Beyond that many lights the evidence picks those that are worth a trial."""


class LightMissing(CheckedRule):
    """A light is left out; or several, named one after the other: all from one on (the fixed-function API has eight), or all of a
    kind. A light with an extent is then not seen, and hides nothing."""

    id = "light-missing"
    group = "light"
    formula = ("Σ over all lights", "Σ over all lights but [name]")
    readings: ClassVar[Mapping[str, str]] = {
        "": "it is not there",
        "dark": "an emitter is there, is seen black, and hides what is behind it",
        "lights nothing": "an emitter or environment is seen as it is, and lights nothing",
    }
    parameter = Discrete("name")
    suspects = "translation"

    def touches(self, scene: Scene) -> bool:
        return is_lit(scene)

    def values(self, case: Case, reading: str) -> Sequence[Parameter]:
        lights = case.scene.lights
        if reading == "dark":
            return [name for name, light in lights.items() if isinstance(light, AreaEmitter)]
        if reading == "lights nothing":
            return [name for name, light in lights.items() if isinstance(light, AreaEmitter | EnvironmentEmitter)]
        lit = [name for name, light in lights.items() if any(strength(light))]
        single: list[Parameter] = list(lit) if len(lit) <= MOST_LIGHTS_TRIED else [None]
        return single + _groups(lights, lit)

    def hypotheses(self, case: Case) -> Sequence[Applied]:
        # Leaving out a light that shines always changes something: there is no need to build every changed scene.
        if not self.touches(case.scene):
            return []
        return [Applied(self.id, value, reading) for reading in self.readings for value in self.values(case, reading)]

    def estimates(self, hypothesis: Applied, evidence: Evidence) -> Sequence[Applied]:
        """The lights without which the model's first hits come nearest to what was measured."""
        terms = sum(np.asarray(evidence.model[name]) for name in ("light_ambient", "diffuse", "specular"))
        missing = np.asarray(evidence.model["radiance"]) - evidence.measured
        away = [float(np.abs(missing - np.asarray(terms)[:, k]).mean()) for k in range(np.shape(terms)[1])]
        order = [*evidence.case.scene.delta_lights, *evidence.case.scene.area_emitters]
        order += [name for name in evidence.case.scene.lights if name not in order]
        ranked = sorted(zip(away, order, strict=False), key=lambda pair: pair[0])
        return [Applied(self.id, name) for _, name in ranked[:MOST_LIGHTS_TRIED]]

    def change_case(self, case: Case, applied: Applied) -> Case:
        names = _names(applied)
        if applied.reading == "lights nothing" and any(isinstance(case.scene.lights[n], EnvironmentEmitter) for n in names):
            case = with_scene(case, background=case.scene.environment.radiance)  # type: ignore[union-attr]
            return with_scene(case, lights={n: absent_emitter(case) if n in names else v for n, v in case.scene.lights.items()})
        if applied.reading:
            return with_lights(case, lambda name, _: {"radiance": BLACK} if name in names else {})
        gone = {name: _left_out(case, light) for name, light in case.scene.lights.items() if name in names}
        return with_scene(case, lights={**case.scene.lights, **gone})

    def change_radiance(self, radiance: Floats, film_xy: Floats, case: Case, applied: Applied) -> Floats:
        names = [name for name in _names(applied) if isinstance(case.scene.lights[name], AreaEmitter)]
        if applied.reading != "lights nothing" or not names:
            return radiance
        return radiance + emitters_seen(case, names, film_xy)


def _names(applied: Applied) -> tuple[str, ...]:
    given = applied.parameter
    return tuple(str(name) for name in given) if isinstance(given, tuple) else (str(given),)


def _groups(lights: dict[str, Light], lit: Sequence[str]) -> list[Parameter]:
    """All lights from one on, all of a kind, all: as far as these are more than one light."""
    groups = [tuple(lit[k:]) for k in range(1, len(lit) - 1)] if len(lit) <= MOST_LIGHTS_TRIED else [tuple(lit[8:])]
    for kind in dict.fromkeys(lights[name].kind for name in lit):
        groups.append(tuple(name for name in lit if lights[name].kind == kind))
    groups.append(tuple(lit))
    return [group for group in dict.fromkeys(groups) if len(group) > 1]


def _left_out(case: Case, light: Light) -> Light:
    """The light as if it were not there; there still are as many lights, in the same order."""
    if isinstance(light, AreaEmitter):
        return absent_emitter(case)
    key = {DirectionalLight: "irradiance", EnvironmentEmitter: "radiance"}.get(type(light), "intensity")
    return light.model_copy(update={key: BLACK})


_SHARES = {"ambient": BLACK, "diffuse": WHITE, "specular": WHITE}
"""A light's separate colours where nobody sets them."""


_GREYS: Mapping[str, tuple[str, tuple[float, float, float] | None]] = {
    "grey": ("each has the mean of its bands", (1 / 3, 1 / 3, 1 / 3)),
    "grey by luminance": ("each has its luminance, 0.2126 R + 0.7152 G + 0.0722 B", (0.2126, 0.7152, 0.0722)),
    "grey by luma": ("each has its luma, 0.299 R + 0.587 G + 0.114 B", (0.299, 0.587, 0.114)),
    "grey, largest": ("each has the largest of its bands", None),
    "grey, first": ("each has its first band in all", (1.0, 0.0, 0.0)),
    "grey, middle": ("each has its second band in all", (0.0, 1.0, 0.0)),
    "white": ("each has 1 in all bands", (0.0, 0.0, 0.0)),
}
"""Lights whose own colour is not known: in words, and the weights of the bands."""


def _grey(bands: Bands, reading: str) -> Bands:
    if reading == "white":
        return WHITE if any(bands) else BLACK
    weights = _GREYS[reading][1]
    value = max(bands) if weights is None else sum(w * band for w, band in zip(weights, bands, strict=True))
    return value, value, value


def _colour_readings() -> Iterator[tuple[str, str]]:
    yield "", "ambient, diffuse and specular colour have no effect: 0, 1, 1"
    for names in (*combinations(_SHARES, 1), *combinations(_SHARES, 2)):
        yield (
            " and ".join(names),
            f"the {' and '.join(names)} colour has no effect: {', '.join(f'{_SHARES[n][0]:g}' for n in names)}",
        )
    yield "diffuse for the highlight", "the diffuse colour serves the highlight too, and the ambient one has no effect (VTK Q18)"
    yield "diffuse for the highlight, ambient kept", "the diffuse colour serves the highlight too; the ambient one is right"
    yield "diffuse for all", "the diffuse colour serves the highlight and the ambient share"
    yield "strength for all", "ambient, diffuse and specular colour are the light's strength itself: 1, 1, 1"
    yield from ((reading, f"lights are grey: {words}") for reading, (words, _) in _GREYS.items())


class LightColoursIgnored(CheckedRule):
    """Lights have one colour: the separate ones of the fixed-function model have no effect (VTK Q18, where the diffuse colour
    serves the highlight too). Or lights have none at all: they shine grey, in every model."""

    id = "light-colours-ignored"
    group = "light"
    formula = ("a_i, d_i, s_i = strength × ambient, diffuse, specular", "a_i, d_i, s_i = 0, strength, strength")
    readings: ClassVar[Mapping[str, str]] = dict(_colour_readings())

    def touches(self, scene: Scene) -> bool:
        return is_lit(scene) and (scene.model == "opengl" or _is_coloured(scene))

    def values(self, case: Case, reading: str) -> Sequence[None]:
        possible = _is_coloured(case.scene) if reading in _GREYS else case.scene.model == "opengl"
        return (None,) if possible else ()

    def change_case(self, case: Case, applied: Applied) -> Case:
        if applied.reading in _GREYS:
            return with_light_bands(case, ("intensity", "irradiance", "radiance"), lambda bands: _grey(bands, applied.reading))

        def change(_: str, light: Light) -> dict[str, Any]:
            return _colours(light, applied.reading) if isinstance(light, PointLight | DirectionalLight | SpotLight) else {}

        return with_lights(case, change)


def _is_coloured(scene: Scene) -> bool:
    return any(len(set(strength(light))) > 1 for light in scene.lights.values())


def _colours(light: PointLight | DirectionalLight | SpotLight, reading: str) -> dict[str, Any]:
    match reading:
        case "":
            return dict(_SHARES)
        case "diffuse for the highlight":
            return {"ambient": BLACK, "specular": light.diffuse}
        case "diffuse for the highlight, ambient kept":
            return {"specular": light.diffuse}
        case "diffuse for all":
            return {"ambient": light.diffuse, "specular": light.diffuse}
        case "strength for all":
            return {"ambient": WHITE, "diffuse": WHITE, "specular": WHITE}
        case _:
            return {name: _SHARES[name] for name in reading.split(" and ")}


RULES: Sequence[Rule] = (
    LightMissing(),
    AttenuationIgnored(),
    AttenuationTermMissing(),
    SpotIgnored(),
    SpotConeDoubled(),
    SpotConeHalved(),
    SpotExponentIgnored(),
    SpotExponentClamped(),
    SpotConeIgnored(),
    LightColoursIgnored(),
    AmbientMissing(),
    AmbientTinted(),
    EmissionMissing(),
    EmissionTinted(),
)
