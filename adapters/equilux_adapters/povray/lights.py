"""Lights as POV-Ray light sources."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from equilux.adapter import Unsupported
from equilux_adapters._bounds import distances
from equilux_adapters.povray import attenuation
from equilux_adapters.povray.frame import Frame
from equilux_adapters.povray.gl_lights import shown_light
from equilux_adapters.povray.numbers import bands, number, vector
from equilux_scenes.case import Case
from equilux_scenes.model import DeltaLight, DirectionalLight, SpotLight
from equilux_scenes.transforms import unit

FAR = 1e7  # units; POV-Ray finds nothing beyond (Q14)


@dataclass(frozen=True)
class Lamp:
    """One light of the scene as written, with what bounds its light.

    irradiance: per object, an upper bound of the band values that arrive. relative: bound on |ΔE|/E. cancelled: bound on |ΔE|.
    sources: how many POV-Ray lights it takes.
    """

    text: str
    irradiance: tuple[float, ...]
    relative: float
    cancelled: float
    sources: int


def lamps(case: Case, frame: Frame, fade_ratio: float) -> list[Lamp]:
    """Every light of the scene, in file order. Raises Unsupported naming all that cannot be expressed."""
    result, problems = [], []
    for name, light in case.scene.delta_lights.items():
        try:
            shown = shown_light(light, case)
            result.append(_lamp(case, name, shown, frame, fade_ratio))
        except Unsupported as problem:
            problems.append((name, problem))
    if problems:
        features = sorted({feature for _, problem in problems for feature in problem.missing_features})
        raise Unsupported(features, "; ".join(f"light '{name}': {problem.reason}" for name, problem in problems))
    return result


def _lamp(case: Case, name: str, light: DeltaLight, frame: Frame, fade_ratio: float) -> Lamp:
    if isinstance(light, DirectionalLight):
        brightest = max(light.irradiance)
        return Lamp(_directional(name, light, case), (brightest,) * len(case.scene.objects), 0.0, 0.0, 1)
    position = np.array(light.position)
    reach = [max(distances.nearest(case, index, position), 1e-6 / frame.scale) for index in range(len(case.scene.objects))]
    law = attenuation.law(light.attenuation, frame.scale, min(reach), fade_ratio)
    terms = light.attenuation
    brightest = max(light.intensity)
    irradiance = tuple(brightest / (terms.constant + terms.linear * r + terms.quadratic * r * r) for r in reach)
    sources = [_source(light, term, frame) for term in law.terms]
    comment = f"// {name}: 1 / ({' + '.join(_terms(light))})"
    return Lamp("\n".join([comment, *sources]), irradiance, law.relative, law.cancelled * brightest, len(sources))


def _terms(light: DeltaLight) -> Iterator[str]:
    assert not isinstance(light, DirectionalLight)
    for factor, power in ((light.attenuation.constant, ""), (light.attenuation.linear, "r"), (light.attenuation.quadratic, "r²")):
        if factor:
            yield power if power and factor == 1 else f"{number(factor)} {power}".rstrip()


def _directional(name: str, light: DirectionalLight, case: Case) -> str:
    """`parallel` makes every ray parallel to location − point_at, wherever the point lies (Q12).

    Where there are shadows, a shadow ray ends in the plane through the location: that is far off then (Q33).
    """
    towards = np.negative(unit(light.direction)) * (FAR if "occlusion" in case.requires else 1.0)
    colour = f"rgb {bands(light.irradiance)} * Exposure"
    return f"// {name}\nlight_source {{ {vector(towards)}, {colour} parallel point_at <0, 0, 0> }}"


def _source(light: DeltaLight, term: attenuation.Term, frame: Frame) -> str:
    assert not isinstance(light, DirectionalLight)
    position = frame.point(light.position)
    colour = f"rgb {bands(light.intensity)} * {_factor(term, frame)}Exposure"
    parts = [f"light_source {{ {vector(position)}, {colour}"]
    if term.fade_power:
        parts.append(f"fade_power {term.fade_power} fade_distance {number(term.fade_distance)}")
    if isinstance(light, SpotLight):
        # far enough along the axis that rounding at the light's position does not turn it
        ahead = position + np.array(unit(light.direction)) * max(1.0, float(np.abs(position).max()))
        angle = number(light.cone_half_angle_deg)
        # radius = falloff: a hard edge (Q11)
        parts.append(f"spotlight point_at {vector(ahead)} radius {angle} falloff {angle}")
        if light.exponent:
            parts.append(f"tightness {number(light.exponent)}")
    return "\n  ".join(parts) + " }" if len(parts) > 1 else parts[0] + " }"


def _factor(term: attenuation.Term, frame: Frame) -> str:
    return "" if term.factor == 1.0 else f"{number(term.factor)} * "
