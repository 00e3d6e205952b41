"""The fixed-function formula at points, in double: what every corner is lit by (OpenGL 2.1 specification, section 2.14.1).

Not to judge by. It is evaluated only to see by how much interpolation between corners departs from it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from equilux_adapters._triangles.bounds import U
from equilux_adapters.opengl.kit.stage import Light, Surface, unit

Floats = npt.NDArray[np.float64]

GATE_ROUNDINGS = 24
"""Of a cosine near a gate in single precision: three vectors made unit, 8 u each."""

POSITION_ROUNDINGS = 6
"""Of a point's coordinates relative to the eye: to single precision, the rotation into view coordinates, the light's own."""


class Lighting(NamedTuple):
    """All that lights a corner; positions relative to the eye, world axes. forward: V = −forward everywhere, or None: V goes to
    the eye point."""

    lights: Sequence[Light]
    ambient: Floats
    forward: Floats | None


class Lit(NamedTuple):
    """radiance: (n, 3). doubt: by how much it changes when a gate that is within rounding opens or closes, (n, 3)."""

    radiance: Floats
    doubt: Floats


def lit(points: Floats, normals: Floats, surface: Surface, lighting: Lighting) -> Lit:
    """points: (n, 3). normals: (n, 3), towards the viewer, of any length."""
    normals = rows_unit(normals)
    to_viewer = rows_unit(-points) if lighting.forward is None else np.broadcast_to(-lighting.forward, points.shape)
    flat = np.asarray(surface.emission) + np.asarray(surface.ambient) * lighting.ambient
    radiance, doubt = np.broadcast_to(flat, points.shape).copy(), np.zeros_like(points)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for light in lighting.lights:
            one = _of_one(light, points, normals, to_viewer, surface)
            radiance += one.radiance
            doubt += one.doubt
    return Lit(radiance, doubt)


def _of_one(light: Light, points: Floats, normals: Floats, to_viewer: Floats, surface: Surface) -> Lit:
    rounding: float | Floats = GATE_ROUNDINGS * U
    if light.position is None:
        to_light = np.broadcast_to(-unit(light.direction), points.shape)
        arriving, strength_in_doubt = np.ones(len(points)), np.zeros(len(points))
    else:
        away = np.asarray(light.position) - points
        r = np.linalg.norm(away, axis=1)
        to_light = away / r[:, None]
        rounding = rounding + POSITION_ROUNDINGS * U * np.linalg.norm(points, axis=1) / r
        constant, linear, quadratic = light.attenuation
        arriving, strength_in_doubt = _within_cone(light, to_light, rounding)
        fall = 1 / (constant + linear * r + quadratic * r**2)
        arriving, strength_in_doubt = arriving * fall, strength_in_doubt * fall
    cosine = np.sum(normals * to_light, axis=1)
    half = np.maximum(np.sum(normals * rows_unit(to_light + to_viewer), axis=1), 0.0)
    highlight = half[:, None] ** surface.shininess * np.asarray(surface.specular) * light.specular
    always = np.asarray(surface.ambient) * light.ambient
    diffuse = np.maximum(cosine, 0.0)[:, None] * np.asarray(surface.diffuse) * light.diffuse
    shone = always + diffuse + highlight * (cosine > 0)[:, None]
    gated = np.where(np.abs(cosine) <= rounding, 1.0, 0.0)[:, None] * highlight
    return Lit(
        arriving[:, None] * shone,
        np.maximum(arriving, strength_in_doubt)[:, None] * gated + strength_in_doubt[:, None] * shone,
    )


def _within_cone(light: Light, to_light: Floats, rounding: float | Floats) -> tuple[Floats, Floats]:
    """The spot's factor, and what it would be if the point is on the other side of the cone's edge, where that is in doubt."""
    if light.cutoff_deg > 90:
        return np.ones(len(to_light)), np.zeros(len(to_light))
    along = -(to_light @ unit(light.direction))
    edge = np.cos(np.radians(light.cutoff_deg))
    factor = np.maximum(along, 0.0) ** light.exponent
    return np.where(along >= edge, factor, 0.0), np.where(np.abs(along - edge) <= rounding, factor, 0.0)


def rows_unit(vectors: Floats) -> Floats:
    """(n, 3), each made unit."""
    made: Floats = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
    return made
