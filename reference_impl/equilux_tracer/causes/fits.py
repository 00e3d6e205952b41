"""Estimates of a parameter from the term channels of the unchanged tracer: one evaluation explains how every value would look.

They need not be exact (what mirrors show of a highlight is left out): they are where the search starts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np
import numpy.typing as npt

from equilux_scenes.case import Case
from equilux_scenes.model import DeltaLight, DirectionalLight, PerspectiveCamera, SpotLight
from equilux_tracer.causes.rewrite import delta_lights, strength
from equilux_tracer.causes.rule import Evidence, Floats

MOST_PIXELS = 600
"""Diverging pixels that a fit looks at; a parameter is one number."""
TINY = 1e-250
"""Powers below have no digits to be divided by."""
GOLDEN = 0.381966
INSENSITIVE = 1e-9
"""Relative: a misfit that varies by less over the whole grid says nothing about the parameter."""

Predict = Callable[[float], Floats]
"""A value of the parameter → the radiance that the chosen pixels would have, (n, 3)."""


def chosen_pixels(evidence: Evidence) -> npt.NDArray[np.intp]:
    """Diverging pixels that show an object, evenly thinned."""
    object_id = np.asarray(evidence.model["object_id"])
    on_object = (object_id >= 0) & (object_id < len(evidence.case.scene.objects))
    found = np.flatnonzero(evidence.diverging & on_object)
    return found[:: max(1, -(-len(found) // MOST_PIXELS))]


def best_values(predict: Predict, measured: Floats, bound: Floats, grid: Iterable[float], *, count: int = 3) -> list[float]:
    """The parameter values at which the prediction is nearest to what was measured, best first: the lowest local minima over
    the grid (positive, ascending), each refined. Nearness is the sum of log(1 + |E_n|): a few pixels of another fault do not
    pull it away. Empty where nothing can be told."""
    if measured.size == 0:
        return []
    floor = 1e-12 * float(np.abs(measured).max(initial=0.0)) + 1e-300

    def misfit(value: float) -> float:
        with np.errstate(all="ignore"):
            difference = np.abs(predict(value) - measured) / (bound + floor)
        return float(np.log1p(np.where(np.isfinite(difference), difference, 1e300)).sum())

    values = np.array(sorted(grid), np.float64)
    losses = np.array([misfit(value) for value in values])
    if np.ptp(losses) <= INSENSITIVE * losses.max(initial=0.0):
        return []
    around = np.pad(losses, 1, constant_values=np.inf)
    minima: npt.NDArray[np.intp] = np.flatnonzero((losses <= around[:-2]) & (losses <= around[2:]))
    ranked = sorted(minima.tolist(), key=lambda i: float(losses[i]))[:count]
    refined = [_refined(misfit, *(float(values[j]) for j in (max(0, i - 1), i, min(len(values) - 1, i + 1)))) for i in ranked]
    return [value for value, _ in sorted(refined, key=lambda pair: pair[1])]


def _refined(misfit: Callable[[float], float], low: float, middle: float, high: float) -> tuple[float, float]:
    """Golden section on the logarithm, from a bracket."""
    a, b = np.log(low), np.log(high)
    best, least = float(middle), misfit(middle)
    for _ in range(40):
        for share in (GOLDEN, 1 - GOLDEN):
            value = float(np.exp(a + share * (b - a)))
            loss = misfit(value)
            if loss < least:
                best, least = value, loss
        width, centre = GOLDEN * (b - a), np.log(best)
        a, b = max(a, centre - width), min(b, centre + width)
        if b - a < 1e-9:
            break
    return best, least


# --- what arrives from lights without an extent -----------------------------------------------------------------------


def toward_light(light: DeltaLight, position: Floats) -> tuple[Floats, Floats]:
    """L, unit, (n, 3), and r, (n,), 1 for a directional light."""
    if isinstance(light, DirectionalLight):
        to_light = -np.asarray(light.direction) / np.linalg.norm(light.direction)
        return np.broadcast_to(to_light, position.shape), np.ones(len(position))
    toward = np.asarray(light.position) - position
    distance = np.linalg.norm(toward, axis=-1)
    return toward / distance[:, None], distance


def spot_cosine(light: SpotLight, to_light: Floats) -> Floats:
    """Cosine of the angle to the spot's axis, (n,)."""
    axis = np.asarray(light.direction) / np.linalg.norm(light.direction)
    cosine: Floats = -(to_light @ axis)
    return cosine


def share_arriving(light: DeltaLight, to_light: Floats, distance: Floats) -> Floats:
    """E = strength × this, (n,)."""
    if isinstance(light, DirectionalLight):
        return np.ones(len(distance))
    fading = light.attenuation
    share = 1 / (fading.constant + fading.linear * distance + fading.quadratic * distance**2)
    if isinstance(light, SpotLight):
        cosine = spot_cosine(light, to_light)
        inside = cosine >= np.cos(np.radians(light.cone_half_angle_deg))
        share = share * np.where(inside, np.maximum(cosine, 0) ** light.exponent, 0)
    return share


def to_viewer(case: Case, position: Floats) -> Floats:
    """V of the camera's rays by the rule of the scene's model, unit, (n, 3)."""
    scene = case.scene
    eye, target = np.asarray(scene.camera.eye), np.asarray(scene.camera.target)
    to_point = scene.viewer == "local" if scene.model == "opengl" else isinstance(scene.camera, PerspectiveCamera)
    towards = eye - position if to_point else np.broadcast_to(eye - target, position.shape)
    unit: Floats = towards / np.linalg.norm(towards, axis=-1, keepdims=True)
    return unit


class Lobes:
    """The highlights of lights in front, at the chosen pixels, taken apart: weight × cosine^exponent.

    exponent: (n,). cosine: (n, lights) of R·V, or N·H where the model says so. weight: (n, lights, 3) E K_spec (1 − t) τ.
    rest: (n, 3) everything else that the model shows there.
    """

    def __init__(self, evidence: Evidence) -> None:
        chosen = chosen_pixels(evidence)
        scene = evidence.case.scene
        lights = delta_lights(scene)
        model = {
            name: np.asarray(evidence.model[name])[chosen] for name in ("radiance", "diffuse", "specular", "normal", "position")
        }
        materials = [scene.materials[obj.material] for obj in scene.objects]
        index = np.asarray(evidence.model["object_id"])[chosen]
        normal, position = model["normal"], model["position"]
        viewer = to_viewer(evidence.case, position)
        self.measured, self.bound = evidence.measured[chosen], evidence.bound[chosen]
        self.exponent = np.array([m.exponent for m in materials])[index]
        specular = np.array([m.specular for m in materials])[index] * (
            1 - np.array([m.transparency for m in materials])[index, None]
        )
        diffuse = np.array([m.diffuse for m in materials])[index].any(axis=-1)
        self.cosine = np.zeros((len(chosen), len(lights)))
        self.weight = np.zeros((len(chosen), len(lights), 3))
        self.rest = model["radiance"].copy()
        for k, light in enumerate(lights):
            to_light, distance = toward_light(light, position)
            facing = (normal * to_light).sum(axis=-1)
            if scene.model == "opengl":
                halfway = to_light + viewer
                cosine = (normal * halfway).sum(axis=-1) / np.linalg.norm(halfway, axis=-1)
            else:
                cosine = 2 * facing * (normal * viewer).sum(axis=-1) - (to_light * viewer).sum(axis=-1)
            shown = model["specular"][:, k]
            arriving = (
                np.asarray(strength(light)) * np.asarray(light.specular) * share_arriving(light, to_light, distance)[:, None]
            )
            seen_dark = diffuse & ~model["diffuse"][:, k].any(axis=-1)
            with np.errstate(all="ignore"):
                power = np.where(cosine > 0, np.maximum(cosine, 0) ** self.exponent, 0)
                weight = np.where(
                    (power > TINY)[:, None], shown / power[:, None], np.where(seen_dark[:, None], 0, arriving * specular)
                )
            in_front = (facing > 0)[:, None]
            self.cosine[:, k] = np.minimum(cosine, 1)
            self.weight[:, k] = np.where(in_front, weight, 0)
            self.rest -= np.where(in_front, shown, 0)

    def predicted(self, exponent: Floats | None = None, floor: float = 0.0) -> Floats:
        """The radiance with other exponents, (n,), or with the cosine raised to a floor."""
        p = (self.exponent if exponent is None else exponent)[:, None]
        raised = np.maximum(self.cosine, floor)
        power = np.where(raised > 0, np.maximum(raised, 0) ** p, 0)
        total: Floats = self.rest + (power[..., None] * self.weight).sum(axis=1)
        return total

    def best(self, predict: Predict, grid: Iterable[float]) -> list[float]:
        """`best_values` over these pixels."""
        return best_values(predict, self.measured, self.bound, grid)


class Cones:
    """What spot lights add at the chosen pixels, and how it changes with their exponents."""

    def __init__(self, evidence: Evidence) -> None:
        chosen = chosen_pixels(evidence)
        terms = sum(np.asarray(evidence.model[name])[chosen] for name in ("light_ambient", "diffuse", "specular"))
        position = np.asarray(evidence.model["position"])[chosen]
        usable = np.ones(len(chosen), bool)
        self._spots: list[tuple[float, Floats, Floats]] = []
        for k, light in enumerate(delta_lights(evidence.case.scene)):
            if not isinstance(light, SpotLight) or light.exponent == 0:
                continue
            cosine = np.clip(spot_cosine(light, toward_light(light, position)[0]), 0, 1)
            inside = cosine >= np.cos(np.radians(light.cone_half_angle_deg)) - 1e-12
            with np.errstate(all="ignore"):
                usable &= ~inside | (cosine**light.exponent > TINY)
            self._spots.append((light.exponent, np.where(inside & (cosine > 0), cosine, 1.0), np.asarray(terms)[:, k]))
        self._spots = [(exponent, cosine[usable], term[usable]) for exponent, cosine, term in self._spots]
        self._radiance = np.asarray(evidence.model["radiance"])[chosen][usable]
        self.measured, self.bound = evidence.measured[chosen][usable], evidence.bound[chosen][usable]

    def predicted(self, change: Callable[[float], float]) -> Floats:
        """The radiance with other spot exponents."""
        total = self._radiance.copy()
        for exponent, cosine, term in self._spots:
            total += term * (cosine ** (change(exponent) - exponent) - 1)[:, None]
        return total

    def best(self, predict: Predict, grid: Iterable[float]) -> list[float]:
        """`best_values` over these pixels."""
        return best_values(predict, self.measured, self.bound, grid)


def with_round_numbers(values: Sequence[float], known: Sequence[float]) -> list[float]:
    """The values, and those of `known` near them: before a value where that is off by less than a thousandth, after it where by
    less than two hundredths."""
    found: dict[float, None] = {}
    for value in values:
        off = {number: abs(number / value - 1) for number in known}
        near = sorted((number for number in known if off[number] < 0.02), key=lambda number: off[number])
        found |= dict.fromkeys([n for n in near if off[n] < 1e-3])
        found |= dict.fromkeys([value, *near])
    return list(found)
