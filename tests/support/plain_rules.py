"""The local formulas with rules changed, in plain NumPy: what the tracer should show, given where it looks and with which N.

A formula is a function (c, rv, nh, p) of N·L, R·V, N·H and the exponent that returns what K_diff and K_spec are multiplied with.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from equilux_scenes.case import Case
from support import plain_phong

Array = npt.NDArray[np.float64]
Formula = Callable[[Array, Array, Array, Array], tuple[Array, Array]]


def powered(cosine: Array, exponent: Array) -> Array:
    """max(0, cosine)^exponent, 0 where the cosine is not above 0."""
    return np.where(cosine > 0, np.maximum(cosine, 1e-300) ** exponent, 0.0)


def phong(c: Array, rv: Array, nh: Array, p: Array) -> tuple[Array, Array]:
    """The model's own."""
    return np.maximum(0, c), np.where(c > 0, powered(rv, p), 0)


def blinn(c: Array, rv: Array, nh: Array, p: Array) -> tuple[Array, Array]:
    """Model opengl's own."""
    return np.maximum(0, c), np.where(c > 0, powered(nh, p), 0)


def terms(case: Case, formula: Formula, object_id: Any, point: Array, normal: Array, to_viewer: Array) -> dict[str, Array]:
    """Channels "diffuse" and "specular", (n, lights, 3), and "radiance", (n, 3), at points of these objects."""
    scene = case.scene
    materials = [scene.materials[scene.objects[k].material] for k in object_id]

    def bands(name: str) -> Array:
        return np.array([getattr(material, name) for material in materials], dtype=float)

    exponent = np.array([[material.exponent] for material in materials])
    diffuse, specular = [], []
    radiance = bands("emission") + bands("ambient") * np.array(scene.ambient)
    for light in scene.delta_lights.values():
        irradiance, to_light = plain_phong.arriving(light, point)
        cosine = _dot(normal, to_light)
        mirrored = _dot(2 * cosine * normal - to_light, to_viewer)
        half = to_light + to_viewer
        halfway = _dot(normal, half / np.linalg.norm(half, axis=1, keepdims=True))
        of_diffuse, of_specular = formula(cosine, mirrored, halfway, exponent)
        diffuse.append(irradiance * bands("diffuse") * np.array(light.diffuse) * of_diffuse)
        specular.append(irradiance * bands("specular") * np.array(light.specular) * of_specular)
        radiance += irradiance * bands("ambient") * np.array(light.ambient) + diffuse[-1] + specular[-1]
    return {"diffuse": np.stack(diffuse, axis=1), "specular": np.stack(specular, axis=1), "radiance": radiance}


def _dot(a: Array, b: Array) -> Array:
    result: Array = np.sum(a * b, axis=-1, keepdims=True)
    return result
