"""The same scene told differently: every light scaled, everything moved, everything enlarged, bands exchanged."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

Spec = dict[str, Any]
Matrix = npt.NDArray[np.float64]

POINTS = {"eye", "target", "position", "center", "point", "min", "max", "base", "top", "corner"}
DIRECTIONS = {"up", "direction", "normal"}
LENGTHS = {"radius", "height_m"}
VECTORS = {"edge_u", "edge_v"}
STRENGTHS = {"intensity", "irradiance"}
BANDS = {"ambient", "background", "intensity", "irradiance", "diffuse", "specular", "emission"}


def _parts(spec: Spec) -> list[Spec]:
    """Everything that has keys of its own: camera, lights, materials, objects, and the scene."""
    return [spec, spec["camera"], *spec["lights"].values(), *spec["materials"].values(), *spec["objects"]]


def with_lights_scaled(spec: Spec, factor: float) -> Spec:
    """Every light `factor` times as strong."""
    result = copy.deepcopy(spec)
    for light in result["lights"].values():
        for key in STRENGTHS & light.keys():
            light[key] = [factor * band for band in light[key]]
    return result


def exposed(spec: Spec, factor: float) -> Spec:
    """Every source of light `factor` times as strong: lights, ambient, emission, background."""
    result = with_lights_scaled(spec, factor)
    for part in [result, *result["materials"].values()]:
        for key in {"emission", "background"} & part.keys():
            part[key] = [factor * band for band in part[key]]
    result["ambient"] = [factor * band for band in result["ambient"]]
    return result


def without_own_light(spec: Spec) -> Spec:
    """No ambient, emission or background: what the lights alone do."""
    result = copy.deepcopy(spec)
    result |= {"ambient": [0, 0, 0], "background": [0, 0, 0]}
    for material in result["materials"].values():
        material["emission"] = [0, 0, 0]
    return result


def with_bands_exchanged(spec: Spec, order: Sequence[int]) -> Spec:
    """Band k of the result is band order[k] of the scene."""
    result = copy.deepcopy(spec)
    for part in _parts(result):
        for key in BANDS & part.keys():
            part[key] = [part[key][k] for k in order]
    return result


def turned_exactly(spec: Spec, axes: Sequence[int], signs: Sequence[float]) -> Spec:
    """Rotated by a signed permutation of the axes, which rounds nothing; only for objects without transforms."""
    assert np.linalg.det(np.eye(3)[list(axes)] * np.asarray(signs)[:, None]) > 0, "that would mirror the scene"

    def turn(v: Sequence[float]) -> list[float]:
        return [signs[k] * v[axes[k]] for k in range(3)]

    result = copy.deepcopy(spec)
    for part in _parts(result):
        for key in (POINTS | DIRECTIONS | VECTORS) & part.keys():
            part[key] = turn(part[key])
        if part.get("kind") == "box":
            part["min"], part["max"] = [list(map(f, part["min"], part["max"])) for f in (min, max)]
    return result


def on_a_grid(spec: Spec, step: float = 2.0**-20) -> Spec:
    """Every place rounded to a multiple of `step`, so that shifting by integers up to 2^32 rounds nothing."""
    result = copy.deepcopy(spec)
    for part in _parts(result):
        for key in POINTS & part.keys():
            part[key] = [round(c / step) * step for c in part[key]]
    return result


def shifted(spec: Spec, by: Sequence[float]) -> Spec:
    """Everything moved by a vector; only for objects without transforms."""
    result = copy.deepcopy(spec)
    for part in _parts(result):
        for key in POINTS & part.keys():
            part[key] = [c + d for c, d in zip(part[key], by, strict=True)]
    return result


def enlarged(spec: Spec, factor: float) -> Spec:
    """Everything `factor` times as large, lights at a place factor² times as strong: for inverse-square lights, no transforms."""
    result = copy.deepcopy(spec)
    for part in _parts(result):
        for key in (POINTS | VECTORS) & part.keys():
            part[key] = [factor * c for c in part[key]]
        for key in LENGTHS & part.keys():
            part[key] *= factor
    for light in result["lights"].values():
        if "intensity" in light:
            light["intensity"] = [factor * factor * band for band in light["intensity"]]
    return result


def moved(spec: Spec, rotation: Matrix, by: Sequence[float]) -> Spec:
    """Any rotation and shift: objects by one more step of their transforms, camera and lights by numbers."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation, by
    result = copy.deepcopy(spec)
    for part in [result["camera"], *result["lights"].values()]:
        for key in POINTS & part.keys():
            part[key] = (rotation @ part[key] + by).tolist()
        for key in DIRECTIONS & part.keys():
            part[key] = (rotation @ part[key]).tolist()
    for shape in result["objects"]:
        shape["transform"] = [*shape.get("transform", []), {"matrix": matrix.tolist()}]
    return result


def rotation_about(axis: Sequence[float], angle: float) -> Matrix:
    """Rodrigues, radians."""
    x, y, z = np.asarray(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    rotation: Matrix = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return rotation
