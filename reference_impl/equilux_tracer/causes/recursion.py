"""Faults of where rays end: how many are followed in succession, and how weak they may be."""

from __future__ import annotations

import dataclasses
import heapq
from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np

from equilux_scenes.case import Case
from equilux_scenes.model import Scene
from equilux_tracer.causes.changed import ChangedTracer
from equilux_tracer.causes.rewrite import CheckedRule, is_see_through, used_materials, with_scene
from equilux_tracer.causes.rule import Applied, Continuous, Discrete, Evidence, Floats, Parameter
from equilux_tracer.causes.seen import weight_at_depth
from equilux_tracer.shading_rules import ShadingRules

MOST_DEPTHS = 16
"""Small limits that are all tried; of larger ones only those next to the scene's own, and round ones."""
KNOWN_DEPTHS = (20, 25, 32, 50, 64, 100, 128, 255, 256)
KNOWN_CUTS = (1 / 255, 1 / 256, 0.01, 0.001, 0.0001, 0.1, 0.05, 0.02, 0.005, 0.2, 0.25, 0.5, 0.002, 1e-5, 1e-6)
FEW_CUTS, MOST_WEIGHTS = 12, 2000
LEAST_WEIGHT = 1e-7
"""Below that, nothing that any renderer shows would change."""


def follows_rays(scene: Scene) -> bool:
    """Whether the picture has rays that are mirrored or go through."""
    mirrors = any(any(m.reflection) and m.transparency < 1 for m in used_materials(scene))
    return scene.model == "raytraced" and scene.recursion_limit > 0 and (mirrors or is_see_through(scene))


class RecursionCut(CheckedRule):
    """Fewer reflected and refracted rays are followed in succession than the scene allows: POV-Ray's `max_trace_level` is 5 by
    default, and counts the camera's ray as one."""

    id = "recursion-cut"
    group = "transport"
    formula = ("rays beyond recursion_limit contribute 0", "rays beyond min(recursion_limit, n) contribute 0")
    readings: ClassVar[Mapping[str, str]] = {
        "": "at most n rays in succession",
        "beyond the limit": "n rays in succession, more than the scene's limit: the limit is counted from another ray on",
        "then background": "at most n rays in succession; the next one shows the background wherever it goes, not 0",
    }
    parameter = Discrete("n")
    suspects = "translation"

    def touches(self, scene: Scene) -> bool:
        return follows_rays(scene)

    def values(self, case: Case, reading: str) -> Sequence[Parameter]:
        limit = case.scene.recursion_limit
        if reading == "beyond the limit":
            return (limit + 1, limit + 2)
        if reading:
            return sorted({limit, max(limit - 1, 0)}) if any(case.scene.background) else ()
        depths = {*range(MOST_DEPTHS), limit - 1, limit - 2, limit // 2, *KNOWN_DEPTHS}
        return sorted(n for n in depths if 0 <= n < limit)

    def change_case(self, case: Case, applied: Applied) -> Case:
        n, limit = int(applied.parameter), case.scene.recursion_limit  # type: ignore[arg-type]
        return with_scene(case, recursion_limit=max(n, limit) if applied.reading == "beyond the limit" else min(n, limit))

    def changes_picture(self, applied: Applied) -> bool:
        return applied.reading == "then background"

    def change_radiance(self, radiance: Floats, film_xy: Floats, case: Case, applied: Applied) -> Floats:
        if applied.reading != "then background":
            return radiance
        n = min(int(applied.parameter), case.scene.recursion_limit)  # type: ignore[arg-type]
        beyond: Floats = weight_at_depth(case, n + 1, film_xy) * np.array(case.scene.background)
        return radiance + beyond


class WeightCut(CheckedRule):
    """Rays that would add little are not followed: below 1/255 with POV-Ray's default `adc_bailout`."""

    id = "weight-cut"
    group = "transport"
    formula = (
        "every ray within the limit is followed",
        "rays whose weight, Π of (1 − t) k_refl or t k_trans, is below w are not",
    )
    readings: ClassVar[Mapping[str, str]] = {
        "": "the weight of the whole path, its largest band",
        "each ray alone": "the weight of the last ray alone",
    }
    parameter = Continuous("w", "", LEAST_WEIGHT, 1.0, "log")

    def touches(self, scene: Scene) -> bool:
        return follows_rays(scene)

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        cut = float(applied.parameter)  # type: ignore[arg-type]
        return dataclasses.replace(rules, weight_cut=cut, weight_cut_alone=bool(applied.reading))

    def estimates(self, hypothesis: Applied, evidence: Evidence) -> Sequence[Applied]:
        """One value between any two weights that rays of this scene have: others would make the same pictures. Those that
        renderers are known to use stand for the interval that they lie in. Of many intervals: the known ones, and, since a
        picture gets darker the higher the cut, the one that halving the range leads to, with those beside it."""
        weights = _weights(evidence.case.scene, alone=bool(hypothesis.reading))
        # A cut that no weight is below changes nothing.
        values = [_value_between(above, below) for above, below in zip([2.0, *weights], weights, strict=False)]
        if len(values) > FEW_CUTS:
            best = self._halved(values, hypothesis, evidence)
            values = [value for k, value in enumerate(values) if value in KNOWN_CUTS or abs(k - best) <= 1]
        return [Applied(self.id, value, hypothesis.reading) for value in values]

    def _halved(self, values: Sequence[float], hypothesis: Applied, evidence: Evidence) -> int:
        """Which of these cuts, descending, makes the picture neither too dark nor too bright."""
        first, last = 0, len(values) - 1
        while first < last:
            middle = (first + last) // 2
            applied = Applied(self.id, values[middle], hypothesis.reading)
            shown = ChangedTracer(evidence.case, [applied], {self.id: self}).evaluate(evidence.film_xy)["radiance"]
            too_dark = (evidence.measured - shown > evidence.bound).any(axis=1).sum()
            if too_dark > (shown - evidence.measured > evidence.bound).any(axis=1).sum():
                first = middle + 1
            else:
                last = middle
        return first


def _value_between(above: float, below: float) -> float:
    known = [cut for cut in KNOWN_CUTS if below < cut <= above]
    return known[0] if known else float(np.sqrt(min(above, 1.0) * below))


def _weights(scene: Scene, *, alone: bool) -> list[float]:
    """Largest bands that products of the scene's weights can have, descending, as long as they are worth following; alone: of
    single weights."""
    single = {
        tuple(share * band for band in coefficient)
        for m in used_materials(scene)
        for share, coefficient in (((1 - m.transparency), m.reflection), (m.transparency, m.transmission))
    }
    single = {weight for weight in single if max(weight) > LEAST_WEIGHT}
    depths: dict[tuple[float, ...], int] = {(1.0, 1.0, 1.0): 0}
    waiting: list[tuple[float, int, tuple[float, ...]]] = [
        (-1.0, 0, (1.0, 1.0, 1.0))
    ]  # the largest first: what follows from it is no larger
    found: dict[float, None] = {}
    while waiting and len(found) < MOST_WEIGHTS:
        largest, depth, weight = heapq.heappop(waiting)
        if depth:
            found[-largest] = None
        if depth == (1 if alone else scene.recursion_limit):
            continue
        for other in single:
            product = tuple(float(f"{a * b:.12g}") for a, b in zip(weight, other, strict=True))
            if max(product) > LEAST_WEIGHT and depth + 1 < depths.get(product, scene.recursion_limit + 1):
                depths[product] = depth + 1
                heapq.heappush(waiting, (-max(product), depth + 1, product))
    return list(found)


class TransmissionUncounted(CheckedRule):
    """Only mirrored rays count towards the recursion limit: transmitted ones go on. POV-Ray does so where the indices on both
    sides are equal."""

    id = "transmission-uncounted"
    group = "transport"
    formula = ("every reflected and refracted ray counts 1", "a refracted ray counts 0")

    def touches(self, scene: Scene) -> bool:
        return is_see_through(scene)

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        return dataclasses.replace(rules, transmission_counted=False)
