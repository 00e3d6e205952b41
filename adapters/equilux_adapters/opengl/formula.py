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

DIRECTION_ROUNDINGS = 8
"""Of a unit vector in single precision: three subtracted components at 2 u each, and the normalisation's 2 u."""

COSINE_ROUNDINGS = 6
"""Of a cosine beyond the directions of its vectors: their lengths, 2 u each, and the sum of three products, 2 u. In a power it
stands for what log2 and exp2 lose, too: some 3 u s."""

POSITION_ROUNDINGS = 6
"""Of a point's coordinates relative to the eye: to single precision, and the light's own."""

GATE_ROUNDINGS = 2 * DIRECTION_ROUNDINGS + COSINE_ROUNDINGS
"""Of a cosine near a gate: those of two vectors, and its own."""


class Lighting(NamedTuple):
    """All that lights a corner; positions relative to the eye, world axes. forward: V = −forward everywhere, or None: V goes to
    the eye point. by_mesa: with Mesa's (N·L)^(N·L) where the exponent is 0 and the light falls off (Q10)."""

    lights: Sequence[Light]
    ambient: Floats
    forward: Floats | None
    by_mesa: bool = False


class Lit(NamedTuple):
    """radiance: (n, 3). doubt: by how much it changes when a gate that is within rounding opens or closes, (n, 3). rounding: by
    how much when vectors and positions are off by what single precision loses of them, (n, 3)."""

    radiance: Floats
    doubt: Floats
    rounding: Floats


def lit(points: Floats, normals: Floats, surface: Surface, lighting: Lighting) -> Lit:
    """points: (n, 3). normals: (n, 3), towards the viewer, of any length."""
    normals = rows_unit(normals)
    to_viewer = rows_unit(-points) if lighting.forward is None else np.broadcast_to(-lighting.forward, points.shape)
    flat = np.asarray(surface.emission) + np.asarray(surface.ambient) * lighting.ambient
    total = Lit(np.broadcast_to(flat, points.shape), np.zeros_like(points), np.zeros_like(points))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for light in lighting.lights:
            one = _of_one(light, points, normals, to_viewer, surface, lighting.by_mesa)
            total = Lit(*(a + b for a, b in zip(total, one, strict=True)))
    return total


def _of_one(light: Light, points: Floats, normals: Floats, to_viewer: Floats, surface: Surface, by_mesa: bool) -> Lit:
    arriving = _arriving(light, points)
    cosine = np.sum(normals * arriving.to_light, axis=1)
    sum_of_both = arriving.to_light + to_viewer
    half = np.sum(normals * rows_unit(sum_of_both), axis=1)
    of_light = DIRECTION_ROUNDINGS * U + arriving.moved
    of_half = (of_light + (DIRECTION_ROUNDINGS + POSITION_ROUNDINGS) * U) / np.linalg.norm(sum_of_both, axis=1)
    off_cosine = _off(cosine, DIRECTION_ROUNDINGS * U + of_light)
    off_half = _off(half, DIRECTION_ROUNDINGS * U + of_half)

    diffuse = np.asarray(surface.diffuse) * light.diffuse
    specular = np.asarray(surface.specular) * light.specular
    shape, shape_off = _power(half, surface.shininess), _power_off(half, off_half, surface.shininess)
    if by_mesa and raised_to_itself(light, surface):
        shape, shape_off = _to_itself(cosine), _to_itself_off(cosine, off_cosine)
    highlight = shape[:, None] * specular
    always = np.asarray(surface.ambient) * light.ambient
    shone = always + np.maximum(cosine, 0.0)[:, None] * diffuse + highlight * (cosine > 0)[:, None]
    gated = np.where(np.abs(cosine) <= GATE_ROUNDINGS * U + arriving.moved, 1.0, 0.0)[:, None] * highlight
    open_gate = np.where(cosine > -off_cosine, 1.0, 0.0)[:, None]
    moved = open_gate * (off_cosine[:, None] * diffuse + shape_off[:, None] * specular)
    return Lit(
        arriving.share[:, None] * shone,
        np.maximum(arriving.share, arriving.doubt)[:, None] * gated + arriving.doubt[:, None] * shone,
        arriving.share[:, None] * moved + arriving.off[:, None] * shone,
    )


class _Arriving(NamedTuple):
    """What of a light arrives: its direction, the share left by attenuation and spot, the share where it is in doubt whether
    the cone holds the point, by how much rounding moves the share, and by what angle it moves the direction (n,)."""

    to_light: Floats
    share: Floats
    doubt: Floats
    off: Floats
    moved: Floats


def _arriving(light: Light, points: Floats) -> _Arriving:
    nothing = np.zeros(len(points))
    if light.position is None:
        return _Arriving(np.broadcast_to(-unit(light.direction), points.shape), nothing + 1, nothing, nothing, nothing)
    away = np.asarray(light.position) - points
    r = np.linalg.norm(away, axis=1)
    to_light, moved = away / r[:, None], POSITION_ROUNDINGS * U * np.linalg.norm(points, axis=1) / r
    constant, linear, quadratic = light.attenuation
    fall = 1 / (constant + linear * r + quadratic * r**2)
    if light.cutoff_deg > 90:
        return _Arriving(to_light, fall, nothing, 2 * moved * fall, moved)
    along = -(to_light @ unit(light.direction))
    edge = np.cos(np.radians(light.cutoff_deg))
    factor = _power(along, light.exponent) * fall
    inside, in_doubt = along >= edge, np.abs(along - edge) <= GATE_ROUNDINGS * U + moved
    off = _power_off(along, _off(along, 2 * DIRECTION_ROUNDINGS * U + moved), light.exponent) * fall + 2 * moved * factor
    return _Arriving(to_light, np.where(inside, factor, 0), np.where(in_doubt, factor, 0), np.where(inside, off, 0), moved)


def _off(cosine: Floats, angle: Floats) -> Floats:
    """By how much a cosine is off when the angle is, and by its own rounding."""
    sine = np.sqrt(np.maximum(1 - cosine**2, 0))
    return np.asarray(sine * angle + angle**2 / 2 + COSINE_ROUNDINGS * U)


def _power(cosine: Floats, exponent: float) -> Floats:
    return np.asarray(np.maximum(cosine, 0.0) ** exponent)


def _power_off(cosine: Floats, off: Floats, exponent: float) -> Floats:
    """By how much a power is off at most when the cosine is."""
    middle = _power(cosine, exponent)
    return np.maximum(_power(cosine + off, exponent) - middle, middle - _power(cosine - off, exponent))


def raised_to_itself(light: Light, surface: Surface) -> bool:
    """Whether Mesa raises N·L to the power N·L (Q10)."""
    falls_off = light.position is not None and (tuple(light.attenuation) != (1, 0, 0) or light.cutoff_deg <= 90)
    return surface.shininess == 0 and any(surface.specular) and falls_off


def _to_itself(cosine: Floats) -> Floats:
    """c^c, 1 at 0; least, 0.69, at 1/e."""
    positive = np.maximum(cosine, 0.0)
    return np.asarray(positive**positive)


def _to_itself_off(cosine: Floats, off: Floats) -> Floats:
    """By how much c^c is off at most when c is: its slope has no bound near 0."""
    middle = _to_itself(cosine)
    ends = [_to_itself(cosine - off), _to_itself(cosine + off), _to_itself(np.clip(np.exp(-1.0), cosine - off, cosine + off))]
    return np.asarray(np.max([np.abs(end - middle) for end in ends], axis=0))


def rows_unit(vectors: Floats) -> Floats:
    """(n, 3), each made unit."""
    made: Floats = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
    return made
