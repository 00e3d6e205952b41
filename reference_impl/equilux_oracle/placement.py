"""Where an object stands: the affine map between its own space and the world, in double-double.

The 4×4 matrix of `equilux_scenes.transforms.matrix` is taken as exact. With M = (A | m), a world point P has the object
coordinates A⁻¹ (P − m), a direction A⁻¹ d, and an object-space normal n becomes A⁻ᵀ n (the gradient of x ↦ g(A⁻¹ (x − m))).
A⁻¹ is the adjugate over the determinant, so that even a matrix of condition 1e10 leaves twenty digits.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equilux_oracle.camera import Rays
from equilux_oracle.doubledouble import DD, Array, cross, dot, stack, vector


@dataclass(frozen=True)
class Placement:
    """`eye` is the eye in object space, relative to the object's own origin (3, 1)."""

    linear: Array | None
    rows_of_inverse: tuple[DD, DD, DD] | None
    eye: DD
    translation: Array

    def to_object(self, rays: Rays, anchor: DD) -> tuple[DD, DD]:
        """Origins relative to the object-space point `anchor`, and directions, of the rays in object space."""
        return self._inverse(rays.offset) + (self.eye - anchor), self._inverse(rays.direction)

    def _inverse(self, v: DD) -> DD:
        return v if self.rows_of_inverse is None else stack([dot(row, v) for row in self.rows_of_inverse])

    def normal_to_world(self, normal: DD) -> DD:
        """A⁻ᵀ n, not normalised."""
        if self.rows_of_inverse is None:
            return normal
        rows = self.rows_of_inverse
        return rows[0] * normal[0] + rows[1] * normal[1] + rows[2] * normal[2]

    def sphere_to_world(self, center: Array, radius: float, eye: Array) -> tuple[Array, float]:
        """A world sphere, relative to the eye, that holds the object-space one: in plain double, for culling, with a margin."""
        linear = np.eye(3) if self.linear is None else self.linear
        stretch = float(np.linalg.norm(linear, 2))
        rounding = 1e-12 * float(stretch * np.linalg.norm(center) + np.linalg.norm(self.translation) + np.linalg.norm(eye))
        return linear @ center + self.translation - eye, radius * stretch * (1 + 1e-9) + rounding


def placement(matrix: Array, eye: tuple[float, float, float]) -> Placement:
    """The placement by a 4×4 object-to-world matrix, seen from `eye`."""
    linear, translation = matrix[:3, :3], matrix[:3, 3]
    eye_from_origin = vector(eye) - vector(translation)
    if np.array_equal(linear, np.eye(3)):
        return Placement(None, None, eye_from_origin, translation)
    rows = _inverse_rows(linear)
    return Placement(linear, rows, stack([dot(row, eye_from_origin) for row in rows]), translation)


def _inverse_rows(a: Array) -> tuple[DD, DD, DD]:
    """Rows of A⁻¹: the cross products of A's columns over its determinant."""
    c0, c1, c2 = (vector(a[:, k]) for k in range(3))
    first = cross(c1, c2)
    determinant = dot(c0, first)
    return first / determinant, cross(c2, c0) / determinant, cross(c0, c1) / determinant
