"""Faults of where rays end: how many are followed in succession, and how weak they may be."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np

from equilux_scenes.case import Case
from equilux_scenes.model import Scene
from equilux_tracer.causes.rewrite import CheckedRule, is_see_through, used_materials, with_scene
from equilux_tracer.causes.rule import Applied, Continuous, Discrete, Evidence, Floats, Parameter
from equilux_tracer.causes.seen import weight_at_depth
from equilux_tracer.shading_rules import ShadingRules

MOST_DEPTHS = 16
"""Small limits that are all tried; of larger ones only those next to the scene's own, and round ones."""
KNOWN_DEPTHS = (20, 25, 32, 50, 64, 100, 128, 255, 256)
KNOWN_CUTS = (1 / 255, 1 / 256, 0.01, 0.001, 0.0001, 0.1, 0.05, 0.02, 0.005, 0.2, 0.25, 0.5)
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
    parameter = Continuous("w", "", LEAST_WEIGHT, 1.0, "log")

    def touches(self, scene: Scene) -> bool:
        return follows_rays(scene)

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        return dataclasses.replace(rules, weight_cut=float(applied.parameter))  # type: ignore[arg-type]

    def estimates(self, hypothesis: Applied, evidence: Evidence) -> Sequence[Applied]:
        """One value between any two weights that rays of this scene have: others would make the same pictures. Those that
        renderers are known to use stand for the interval that they lie in."""
        weights = _weights(evidence.case.scene)
        found: list[float] = []
        for above, below in zip([2.0, *weights], [*weights, LEAST_WEIGHT], strict=True):
            known = [cut for cut in KNOWN_CUTS if below < cut <= above]
            found.append(known[0] if known else float(np.sqrt(min(above, 1.0) * below)))
        # A cut that no weight is below changes nothing.
        return [Applied(self.id, value) for value in dict.fromkeys(found) if value > min(weights, default=1.0)]


def _weights(scene: Scene) -> list[float]:
    """Largest bands that products of the scene's weights can have, descending, as long as they are worth following."""
    single = {
        tuple(share * band for band in coefficient)
        for m in used_materials(scene)
        for share, coefficient in (((1 - m.transparency), m.reflection), (m.transparency, m.transmission))
    }
    single = {weight for weight in single if any(weight)}
    reached = level = set(single)
    for _ in range(min(scene.recursion_limit, 40) - 1):
        level = {tuple(a * b for a, b in zip(x, y, strict=True)) for x in level for y in single}
        level = {tuple(float(f"{band:.12g}") for band in weight) for weight in level if max(weight) > LEAST_WEIGHT}
        if not level - reached or len(reached) > 200:
            break
        reached = reached | level
    return sorted({max(weight) for weight in reached}, reverse=True)[:40]


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
