"""The camera in double precision, and triangles seen from it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

Array = Any


@dataclass(frozen=True)
class Mesh:
    """Triangles in coordinates relative to the eye (world axes, metres), double precision.

    points: (n, 3). normals: (n, 3), outward, not of unit length in general. triangles: (m, 3), counter-clockwise seen from
    outside. closed: the triangles enclose a volume, so that from outside only their fronts are seen. flat: the corners of every
    triangle have its normal.
    """

    points: Array
    normals: Array
    triangles: Array
    closed: bool = False
    flat: bool = False


@dataclass(frozen=True)
class View:
    """Where the picture is taken from; right, up and forward are unit. half_height: tan(fov_y / 2), or metres when `parallel`."""

    eye: Array
    right: Array
    up: Array
    forward: Array
    half_height: float
    width: int
    height: int
    parallel: bool = False

    @property
    def half_width(self) -> float:
        """Like half_height, along the film's rows: pixels are square."""
        return self.half_height * self.width / self.height

    @property
    def pixels_per_unit(self) -> float:
        """Pixels per unit of half_height."""
        return self.height / 2 / self.half_height


def look_at(eye: Array, target: Array, up: Array) -> dict[str, Array]:
    """Eye and right-handed axes: right = forward × up."""
    eye = np.asarray(eye, dtype=float)
    forward = np.asarray(target, dtype=float) - eye
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, np.asarray(up, dtype=float) / np.max(np.abs(up)))
    right /= np.linalg.norm(right)
    return {"eye": eye, "forward": forward, "right": right, "up": np.cross(right, forward)}


def mapped(points: Array, matrix: Array) -> Array:
    """(n, 3) → (n, 3): matrix (3, 3) times each point. Written out: the same digits on every machine, and no threads for a
    little work."""
    x, y, z = points.T
    return np.stack([row[0] * x + row[1] * y + row[2] * z for row in matrix], axis=1)


def seen_from(view: View, points: Array) -> Array:
    """(n, 3) relative to the eye → (n, 3): along right, up and forward."""
    return mapped(points, np.stack([view.right, view.up, view.forward]))


def linear_and_shift(matrix: Array | None) -> tuple[Array, Array]:
    """The linear part (3, 3) and the shift (3,) of an affine matrix (4, 4); of the identity where there is none."""
    full = np.eye(4) if matrix is None else np.asarray(matrix, dtype=float)
    return full[:3, :3], full[:3, 3]


def place(
    view: View,
    points: Array,
    normals: Array,
    triangles: Array,
    matrix: Array | None = None,
    closed: bool = False,
    flat: bool = False,
) -> Mesh:
    """Object space → relative to the eye, in double, so that a scene far from the origin keeps its digits in float32 later.

    Normals go by the inverse transpose and are *not* made unit again: what interpolates them does so linearly and normalises
    afterwards, so interpolating before and after the transform is the same. A mirroring matrix turns the winding, which must
    agree with the normals.
    """
    if matrix is None:
        return Mesh(points - view.eye, normals, triangles, closed, flat)
    linear, shift = linear_and_shift(matrix)
    inverse = np.linalg.inv(linear)
    if np.linalg.det(linear) < 0:
        triangles = triangles[:, ::-1]
    # the scale of normals is free: keep it near 1, float32 has to hold it
    normals = mapped(normals, inverse.T) * np.cbrt(abs(np.linalg.det(linear)))
    return Mesh(mapped(points, linear) + (shift - view.eye), normals, triangles, closed, flat)
