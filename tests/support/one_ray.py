"""One ray through a `raytraced` scene, and scenes as plain dicts: what the tests of that model have in common."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from equilux_scenes.case import Case
from equilux_scenes.mesh import TriangleMesh
from equilux_tracer import Tracer
from support.random_scenes import case_of

Spec = dict[str, Any]


def scene(*objects: Spec, materials: Mapping[str, Spec], eye: Sequence[float], target: Sequence[float], **more: Any) -> Spec:
    """A `raytraced` spec with a film of one pixel, whose ray goes from `eye` to `target`."""
    forward = np.subtract(target, eye)
    up = np.eye(3)[np.argmin(np.abs(forward))].tolist()
    lights = {f"l{k}": light for k, light in enumerate(more.pop("lights", ()))}
    return {
        "equilux": 1,
        "name": "some",
        "model": "raytraced",
        "camera": {"projection": "perspective", "eye": list(eye), "target": list(target), "up": up, "fov_y_deg": 20},
        "film": {"width": 1, "height": 1},
        "lights": lights,
        "materials": dict(materials),
        "objects": list(objects),
        **more,
    }


def radiance(*objects: Spec, **what: Any) -> float:
    """The first band of what the ray of `scene` sees."""
    return float(channels(*objects, **what)["radiance"][0])


def channels(*objects: Spec, meshes: Mapping[int, TriangleMesh] | None = None, **what: Any) -> dict[str, Any]:
    """Every channel of the ray of `scene`."""
    terms = ("emission", "ambient", "diffuse", "specular", "reflected", "transmitted")
    names = ("radiance", *terms, "rounding", "object_id", "signature")
    case = case_of(scene(*objects, **what))
    case = Case(case.name, case.scene, case.scene_name, meshes=dict(meshes or {}))
    return {name: array[0, 0] for name, array in Tracer(case).render(names).items()}


def sun(direction: Sequence[float], irradiance: float = 1.0) -> Spec:
    """A directional light; `direction` is the way its light travels."""
    return {"kind": "directional", "direction": list(direction), "irradiance": irradiance}


def lamp(position: Sequence[float], intensity: float = 1.0) -> Spec:
    """A point light."""
    return {"kind": "point", "position": list(position), "intensity": intensity}


def plane(point: Sequence[float], normal: Sequence[float], material: str) -> Spec:
    return {"kind": "plane", "point": list(point), "normal": list(normal), "material": material}


def sphere(center: Sequence[float], radius: float, material: str) -> Spec:
    return {"kind": "sphere", "center": list(center), "radius": radius, "material": material}


def box(low: Sequence[float], high: Sequence[float], material: str) -> Spec:
    return {"kind": "box", "min": list(low), "max": list(high), "material": material}


def close(got: float, expected: float, relative: float = 1e-13) -> None:
    """Equal to `relative`: a few hundred roundings of the expected value's own computation in double."""
    assert abs(got - expected) <= relative * abs(expected) + 1e-300, f"got {got!r}, expected {expected!r}"
