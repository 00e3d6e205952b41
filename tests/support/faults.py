"""Faulty renderers for tests of the diagnosis: rules of the tests' own, which share nothing with the catalogue."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from equilux.compare import PairResult, RenderedImage, compare_pair
from equilux.uncertainty import Uncertainty
from equilux_scenes.case import Case
from equilux_scenes.model import Scene
from equilux_tracer import Tracer
from equilux_tracer.causes import Applied, ChangedTracer, Continuous, Discrete, Evidence, Rule
from equilux_tracer.causes.rule import Floats

STATED = 1e-6
"""Relative uncertainty of the faulty renderers: far above the tracer's own, far below what any fault does."""

SCENE: dict[str, Any] = {
    "equilux": 1,
    "name": "two-balls",
    "model": "phong",
    "camera": {"projection": "perspective", "eye": [0, 0.4, 4], "target": [0.1, 0, 0], "up": [0, 1, 0], "fov_y_deg": 32},
    "film": {"width": 64, "height": 48},
    "ambient": [0.2, 0.1, 0.3],
    "background": [0.05, 0.02, 0.01],
    "lights": {
        "key": {"kind": "point", "position": [1.5, 2, 3], "intensity": [9, 8, 6]},
        "fill": {"kind": "directional", "direction": [1, -0.4, -1], "irradiance": [0.5, 0.7, 0.9]},
    },
    "materials": {
        "clay": {"diffuse": [0.5, 0.3, 0.2], "specular": [0.4, 0.4, 0.4], "exponent": 60, "ambient": [0.5, 0.5, 0.5]},
        "floor": {"diffuse": [0.2, 0.3, 0.4]},
    },
    "objects": [
        {"kind": "sphere", "center": [-0.3, 0.1, 0], "radius": 0.6, "material": "clay"},
        {"kind": "plane", "point": [0, -0.5, 0], "normal": [0, 1, 0], "material": "floor"},
    ],
}


def two_balls(**changes: Any) -> Case:
    """A small picture in which nothing is symmetric; keys of the spec may be replaced."""
    scene = Scene.model_validate_json(json.dumps(SCENE | changes))
    return Case(scene.name, scene, scene.name)


class Scaled(Rule):
    """Radiance times k, without an estimate of its own: the search's grid must do."""

    id, group, formula = "scaled", "image", ("L", "k L")
    parameter = Continuous("k", "", 1e-3, 1e3, "log", neutral=1.0)

    def change_radiance(self, radiance: Floats, film_xy: Floats, case: Case, applied: Applied) -> Floats:
        return radiance * float(applied.parameter)  # type: ignore[arg-type]


class FlippedX(Rule):
    id, group, formula = "flipped-x", "image", ("x", "W − x")

    def change_film(self, film_xy: Floats, case: Case, applied: Applied) -> Floats:
        return np.stack([case.scene.film.width - film_xy[:, 0], film_xy[:, 1]], axis=-1)


class MirroredByColumns(Rule):
    """What `FlippedX` does, by another name: no picture can tell them apart."""

    id, group, formula = "mirrored-handedness", "geometry", ("x", "W − x")

    def change_film(self, film_xy: Floats, case: Case, applied: Applied) -> Floats:
        return np.stack([case.scene.film.width - film_xy[:, 0], film_xy[:, 1]], axis=-1)


class ExponentClamped(Rule):
    id, group, formula = "exponent-clamped", "highlight", ("p", "min(p, max)")
    parameter = Continuous("max", "", 1.0, 1e4, "log")

    def change_case(self, case: Case, applied: Applied) -> Case:
        def clamped(material: Any) -> Any:
            return material.model_copy(update={"exponent": min(material.exponent, float(applied.parameter))})  # type: ignore[arg-type]

        materials = {name: clamped(material) for name, material in case.scene.materials.items()}
        return Case(case.name, case.scene.model_copy(update={"materials": materials}), case.scene_name, meshes=case.meshes)


class LightMissing(Rule):
    id, group, formula = "light-missing", "light", ("Σ over lights", "all but one")
    parameter = Discrete("name")

    def hypotheses(self, case: Case) -> Sequence[Applied]:
        return [Applied(self.id, name) for name in case.scene.lights]

    def change_case(self, case: Case, applied: Applied) -> Case:
        def dark(light: Any) -> Any:
            return light.model_copy(update={"irradiance" if light.kind == "directional" else "intensity": (0.0, 0.0, 0.0)})

        lights = {name: dark(light) if name == applied.parameter else light for name, light in case.scene.lights.items()}
        return Case(case.name, case.scene.model_copy(update={"lights": lights}), case.scene_name, meshes=case.meshes)


class DiffuseMissing(Rule):
    id, group, formula = "diffuse-missing", "highlight", ("K_diff", "0")

    def change_case(self, case: Case, applied: Applied) -> Case:
        materials = {name: m.model_copy(update={"diffuse": (0.0, 0.0, 0.0)}) for name, m in case.scene.materials.items()}
        return Case(case.name, case.scene.model_copy(update={"materials": materials}), case.scene_name, meshes=case.meshes)


class DimCorner(Rule):
    """A few pixels only: the first sample need not hold enough of them."""

    id, group, formula = "acme:dim-corner", "image", ("L", "L/2 in the corner")

    def change_radiance(self, radiance: Floats, film_xy: Floats, case: Case, applied: Applied) -> Floats:
        in_corner = (film_xy < 5).all(axis=1) & (film_xy[:, :1] != film_xy[:, 1:]).all(axis=1)
        return np.where(in_corner[:, None], radiance * (0.4 + film_xy[:, :1] / 20), radiance)


class Raises(Rule):
    """A third party's rule that cannot be applied."""

    id, group, formula = "acme:raises", "image", ("", "")

    def change_radiance(self, radiance: Floats, film_xy: Floats, case: Case, applied: Applied) -> Floats:
        raise RuntimeError("no such picture")

    def estimates(self, hypothesis: Applied, evidence: Evidence) -> Sequence[Applied]:
        raise RuntimeError("no estimate")


ALL = (FlippedX, Scaled, MirroredByColumns, DiffuseMissing, ExponentClamped, LightMissing, DimCorner, Raises)
RULES: Mapping[str, Rule] = {rule.id: rule() for rule in ALL}


@dataclass(frozen=True)
class Faulty:
    """A pair that can be diagnosed."""

    case: Case
    side: RenderedImage
    truth: RenderedImage
    scored: PairResult


def truth_of(case: Case) -> RenderedImage:
    channels = Tracer(case).render(("radiance", "rounding"))
    return RenderedImage(
        "reference", channels["radiance"], Uncertainty(per_pixel=channels["rounding"].astype(np.float32) * 1.001)
    )


def faulty(case: Case, *causes: Applied, picture: npt.NDArray[np.floating] | None = None, rel: float = STATED) -> Faulty:
    """A renderer with these faults, or with this picture, held against the reference."""
    shown = ChangedTracer(case, causes, RULES).render()["radiance"] if picture is None else picture
    side, truth = RenderedImage("lab", shown, Uncertainty(rel=rel)), truth_of(case)
    return Faulty(case, side, truth, compare_pair(side, truth, Tracer(case)))
