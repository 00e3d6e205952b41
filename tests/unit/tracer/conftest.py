"""Scenes of the tracer's tests: a spec with a few things in it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

from equilux_scenes.case import Case
from equilux_scenes.mesh import TriangleMesh
from equilux_tracer import Tracer
from support.random_scenes import case_of

Spec = dict[str, Any]
GLOW = {"emission": 1.0}


@pytest.fixture
def make_case() -> Callable[..., Case]:
    """Objects, lights and a material; by default an orthographic view along −z, one pixel per unit, 8 × 8, row 0 at y = 3.5.

    `meshes` replaces the mesh of an object by arrays: index → TriangleMesh.
    """

    def make(
        *objects: Spec,
        lights: Sequence[Spec] = (),
        meshes: dict[int, TriangleMesh] | None = None,
        material: Spec | None = None,
        **scene: Any,
    ) -> Case:
        spec = {
            "equilux": 1,
            "name": "some",
            "model": "phong",
            "camera": {"projection": "orthographic", "eye": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0], "height_m": 8},
            "film": {"width": 8, "height": 8},
            "lights": {f"l{k}": light for k, light in enumerate(lights)},
            "materials": {"m": material or GLOW},
            "objects": [{"material": "m", **obj} for obj in objects],
        }
        case = case_of({**spec, **scene})
        return Case(case.name, case.scene, case.scene_name, meshes=meshes) if meshes else case

    return make


@pytest.fixture
def look(make_case: Callable[..., Case]) -> Callable[..., dict[str, np.ndarray]]:
    """Trace one ray from `eye` towards `target` through a 1 × 1 film: every channel of that ray."""

    def trace(*objects: Spec, eye: Sequence[float], target: Sequence[float], up: Sequence[float] = (0, 1, 0), **scene: Any):
        camera = {"projection": "perspective", "eye": list(eye), "target": list(target), "up": list(up), "fov_y_deg": 40}
        case = make_case(*objects, **{"camera": camera, "film": {"width": 1, "height": 1}, **scene})
        names = ["radiance", "object_id", "depth", "normal", "position", "signature", "diffuse", "specular"]
        return {name: array[0, 0] for name, array in Tracer(case).render(names).items()}

    return trace
