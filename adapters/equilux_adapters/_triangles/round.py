"""Tessellation of what is round: finer where it is seen at a grazing angle, where a flat facet misplaces the normal most.

On a facet whose corners lie on a circle of radius R and whose normals are radial, the interpolated normal is exactly the radial
one *of the facet's point*. The facet lies s = R θ²/8 below the arc of angle θ, so a ray coming in at the angle i from the
normal meets it s tan i aside of where it meets the circle: the normal is off by θ²/8 · tan i, and nothing else is.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from equilux_adapters._triangles.view import View, linear_and_shift

Array = Any

FACET_MIN_PX = 1 / 256
"""Facets are not made narrower on the film: corners are moved to multiples of 1/256 pixel."""

CHORD_PX = 1 / 64
"""How far on the film a chord may stay off its circle, at 192 segments."""


@dataclass(frozen=True)
class Scale:
    """Size on the film of one unit of length in object space, in pixels: where and along which it is smallest, and largest.

    small: like the smallest, but at no more than four times the nearest depth: no division serves both ends of what reaches over
    more. stretch: the transform's largest factor by its smallest.
    """

    smallest: float
    small: float
    large: float
    stretch: float


def film_scale(view: View, matrix: Array | None, points: Array, reach: float, clearance: float = 0.0) -> Scale:
    """The scale near `points` of object space, give or take `reach`; nothing of it is nearer to the eye than `clearance`.

    What is nearer than a thousandth of the farthest depth counts as that.
    """
    linear, shift = linear_and_shift(matrix)
    factors = np.linalg.svd(linear, compute_uv=False)
    if view.parallel:
        least, most = view.pixels_per_unit * factors[-1], view.pixels_per_unit * factors[0]
        return Scale(least, least, most, factors[0] / factors[-1])
    depth = (np.atleast_2d(points) @ linear.T + (shift - view.eye)) @ view.forward
    far = max(float(np.max(depth) + reach * factors[0]), 1e-300)
    oblique = np.sqrt(1 + view.half_height**2 + view.half_width**2)
    near = min(max(float(np.min(depth) - reach * factors[0]), clearance * factors[-1] / oblique, far / 1e3), far)
    least, most = view.pixels_per_unit * factors[-1], view.pixels_per_unit * factors[0] * oblique
    return Scale(least / far, least / min(far, 4 * near), most / near, factors[0] / factors[-1])


@dataclass(frozen=True)
class Round:
    """How a circle (or a sphere's meridian) is seen, and how it is divided.

    angles: from 0, towards the eye, to π. rim: index of the angle where the surface is seen edge-on, len(angles) − 1 when the
    eye is inside. steepness: tan i at each angle (inf at the rim). across: the largest step allowed along the parallels at each
    angle.
    """

    angles: Array
    rim: int
    steepness: Array
    across: Array

    @property
    def has_rim(self) -> bool:
        """Whether there is such an angle: the eye is outside."""
        return self.rim < len(self.angles) - 1


def divide(distance: float, segments: int, radius: float, scale: Scale, largest: float, grazing: bool = True) -> Round:
    """Angles of a circle seen from `distance` radii away (inf: parallel rays), at a tolerance of (2π/segments)²/8 on the normal.

    largest: no step is greater, radians. grazing: whether steps become smaller where the surface is seen at a grazing angle.
    """

    def steepness(angles: Array) -> Array:
        with np.errstate(divide="ignore", invalid="ignore"):
            if np.isinf(distance):
                return np.abs(np.tan(angles))
            return distance * np.abs(np.sin(angles)) / np.abs(distance * np.cos(angles) - 1)

    tolerance = (2 * np.pi / segments) ** 2 / 8 / scale.stretch
    smallest = FACET_MIN_PX / (radius * scale.small)

    def wanted(tan_i: Array) -> Array:
        if not grazing:
            return np.full_like(tan_i, largest)
        return np.minimum(np.sqrt(4 * tolerance / np.maximum(tan_i, 1e-300)), largest)

    def stretch_of(start: float, end: float) -> Array:
        # a fine grid, denser at both ends, where the density of steps may be singular
        grid = start + (end - start) * (1 - np.cos(np.linspace(0, np.pi, 8193))) / 2
        middle = (grid[1:] + grid[:-1]) / 2
        tan_i = steepness(middle)
        per_angle = np.minimum(1 / wanted(tan_i), 1 / np.sqrt(1 + tan_i**2) / smallest)
        steps = np.concatenate([[0.0], np.cumsum(per_angle * np.diff(grid))])
        count = max(3, int(steps[-1]))
        return np.interp(np.linspace(0, steps[-1], count + 1), steps, grid)

    if distance > 1:
        rim = np.pi / 2 if np.isinf(distance) else np.arccos(1 / distance)
        front, back = stretch_of(0.0, rim), stretch_of(rim, np.pi)
        angles, rim_index = np.concatenate([front, back[1:]]), len(front) - 1
    else:
        angles = stretch_of(0.0, np.pi)
        rim_index = len(angles) - 1
    tan_i = steepness(angles)
    if distance > 1:
        tan_i[rim_index] = np.inf
    # across as along: no finer where the width on the film limits the steps along
    steps = np.diff(angles)
    along = np.minimum(np.append(steps, np.inf), np.insert(steps, 0, np.inf))
    return Round(angles, rim_index, tan_i, np.maximum(wanted(tan_i), along))


def sectors(segments: int, radius: float, scale: Scale) -> int:
    """How many equal chords keep within CHORD_PX of a circle; (192/segments)² times that at other settings."""
    allowed = CHORD_PX * (192 / segments) ** 2
    # nor so many that the sides become slivers where they are far away
    most = min(16.0 * segments, 16 * np.pi * radius * np.sqrt(scale.small * scale.smallest))
    return max(8, int(min(np.ceil(np.pi * np.sqrt(radius * scale.large / 2 / allowed)), most)))


def axes_towards(direction: Array) -> Array:
    """(3, 3): rows u, v, w, right-handed and unit, w along `direction`."""
    w = np.asarray(direction, dtype=float) / np.linalg.norm(direction)
    u = np.cross(w, np.eye(3)[np.argmin(np.abs(w))])
    u /= np.linalg.norm(u)
    return np.stack([u, np.cross(w, u), w])


def eye_in_object(view: View, matrix: Array | None) -> tuple[Array, Array]:
    """The eye, and the direction against the view, in object space."""
    linear, shift = linear_and_shift(matrix)
    inverse = np.linalg.inv(linear)
    return inverse @ (view.eye - shift), -inverse @ view.forward


def sphere_scale(view: View, center: Array, radius: float, matrix: Array | None) -> Scale:
    """The scale near a sphere's surface."""
    eye, _ = eye_in_object(view, matrix)
    return film_scale(view, matrix, center, radius, abs(float(np.linalg.norm(eye - np.asarray(center))) - radius))


def sphere_division(
    view: View, center: Array, radius: float, segments: int, matrix: Array | None = None, grazing: bool = True
) -> tuple[Array, Round, Array]:
    """Axes (w towards the eye), the meridian's division, and the number of points on each parallel (a power of two times 8)."""
    center = np.asarray(center, dtype=float)
    eye, against = eye_in_object(view, matrix)
    axes = axes_towards(against if view.parallel or np.allclose(eye, center, rtol=0, atol=1e-12 * radius) else eye - center)
    scale = sphere_scale(view, center, radius, matrix)
    distance = np.inf if view.parallel else float(np.linalg.norm(eye - center)) / radius
    meridian = divide(distance, segments, radius, scale, np.sqrt(2) * np.pi / segments, grazing)
    levels = np.ceil(np.log2(np.maximum(2 * np.pi * np.sin(meridian.angles) / meridian.across / 8, 1))).astype(int)
    # parallels next to each other differ by a factor of two at most
    for k in range(len(levels) - 2, 0, -1):
        levels[k] = max(levels[k], levels[k + 1] - 1)
    for k in range(2, len(levels)):
        levels[k] = max(levels[k], levels[k - 1] - 1)
    return axes, meridian, 8 * 2**levels
