"""Faults of what rays see that meet nothing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np

from equilux_scenes.case import Case
from equilux_scenes.model import Scene
from equilux_tracer.causes.recursion import follows_rays
from equilux_tracer.causes.rewrite import BLACK, CheckedRule, with_lights, with_scene
from equilux_tracer.causes.rule import Applied, Evidence, Floats, Vector
from equilux_tracer.causes.seen import background_seen


class BackgroundMissing(CheckedRule):
    """Rays that miss everything do not show the background: they are black, or show some other radiance."""

    id = "background-missing"
    group = "transport"
    formula = ("a ray that misses: background", "a ray that misses: 0, or something else")
    readings: ClassVar[Mapping[str, str]] = {
        "": "0",
        "ambient": "the scene's ambient radiance",
        "black in mirrors": "0 for mirrored and refracted rays; the camera's own rays are right",
        "black for the camera": "0 for the camera's own rays; mirrors, glass and, of an environment, light are right",
        "another radiance": "[R, G, B] everywhere, found in the picture; the other readings have no parameter",
    }
    parameter = Vector(("R", "G", "B"), "W/(m²·sr)", 1e-3)
    suspects = "translation"

    def touches(self, scene: Scene) -> bool:
        return True

    def values(self, case: Case, reading: str) -> Sequence[None]:
        scene = case.scene
        shown = scene.environment.radiance if scene.environment else scene.background
        match reading:
            case "another radiance":
                possible = True
            case "ambient":
                possible = scene.environment is None
            case "black in mirrors":
                possible = follows_rays(scene) and any(shown)
            case "black for the camera":
                possible = any(shown) and (follows_rays(scene) or scene.environment is not None)
            case _:
                possible = any(shown)
        return (None,) if possible else ()

    def hypotheses(self, case: Case) -> Sequence[Applied]:
        tried = super().hypotheses(case)
        return [*tried, Applied(self.id, None, "another radiance")]

    def estimates(self, hypothesis: Applied, evidence: Evidence) -> Sequence[Applied]:
        """The median, band by band, of what the picture shows where nothing is met."""
        if hypothesis.reading != "another radiance":
            return [hypothesis]
        missed = (np.asarray(evidence.model["object_id"]) < 0) & evidence.diverging
        if not missed.any():
            return []
        median = np.median(evidence.measured[missed], axis=0)
        return [Applied(self.id, tuple(float(band) for band in median), hypothesis.reading)] if median.min() >= 0 else []

    def changes_picture(self, applied: Applied) -> bool:
        return applied.reading in ("black in mirrors", "black for the camera")

    def change_case(self, case: Case, applied: Applied) -> Case:
        match applied.reading:
            case "black for the camera":
                return case
            case "another radiance":
                radiance = applied.parameter
                if not isinstance(radiance, tuple):
                    return case
            case "ambient":
                radiance = case.scene.ambient
            case _:
                radiance = BLACK
        return _with_background(case, tuple(float(band) for band in radiance))

    def change_radiance(self, radiance: Floats, film_xy: Floats, case: Case, applied: Applied) -> Floats:
        match applied.reading:
            case "black in mirrors":
                return radiance + background_seen(case, film_xy)
            case "black for the camera":
                return radiance - background_seen(case, film_xy)
            case _:
                return radiance


def _with_background(case: Case, radiance: tuple[float, ...]) -> Case:
    if case.scene.environment is None:
        return with_scene(case, background=radiance)
    return with_lights(case, lambda _, light: {"radiance": radiance} if light is case.scene.environment else {})
