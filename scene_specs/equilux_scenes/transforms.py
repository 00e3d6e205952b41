"""Object → world matrices: the one definition that every adapter, the tracer and the oracle share.

Matrices act on column vectors, x_world = M x_object. Steps are applied in the order they are written, so the last step is the
leftmost factor. Normals go by the inverse transpose. A mirroring matrix (det < 0) keeps the meaning of "outward".
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from equilux_scenes.model import Rotation, Shape, TransformStep

Matrix = npt.NDArray[np.float64]

_QUARTERS = {0: (0.0, 1.0), 1: (1.0, 0.0), 2: (0.0, -1.0), 3: (-1.0, 0.0)}


def matrix(obj: Shape) -> Matrix:
    """(4, 4) float64, object → world; the identity for an object without `transform`."""
    return matrix_of(obj.transform)


def matrix_of(steps: Sequence[TransformStep]) -> Matrix:
    """(4, 4) float64 of steps applied in the order they are written."""
    result = np.eye(4)
    for step in steps:
        result = step_matrix(step) @ result
    return result


def step_matrix(step: TransformStep) -> Matrix:
    """(4, 4) float64 of one step."""
    result = np.eye(4)
    if step.scale is not None:
        result[:3, :3] = np.diag(np.broadcast_to(np.asarray(step.scale, dtype=np.float64), 3))
    elif step.rotate is not None:
        result[:3, :3] = rotation(step.rotate)
    elif step.translate is not None:
        result[:3, 3] = step.translate
    elif step.matrix is not None:
        result = np.array(step.matrix, dtype=np.float64)
    return result


def rotation(rotate: Rotation) -> Matrix:
    """(3, 3) right-handed rotation about an axis through the origin (Rodrigues).

    Exact at multiples of 90° about a coordinate axis.
    """
    x, y, z = unit(rotate.axis)
    s, c = sin_cos_deg(rotate.degrees)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    axis = np.array([x, y, z])
    result: Matrix = c * np.eye(3) + s * cross + (1.0 - c) * np.outer(axis, axis)
    return result


def sin_cos_deg(degrees: float) -> tuple[float, float]:
    """Sine and cosine of an angle in degrees, exact at multiples of 90."""
    turn = math.fmod(degrees, 360.0)
    quarter = round(turn / 90.0)
    rest = math.radians(turn - 90.0 * quarter)
    s, c = _QUARTERS[quarter % 4]
    return s * math.cos(rest) + c * math.sin(rest), c * math.cos(rest) - s * math.sin(rest)


def unit(vector: Sequence[float]) -> tuple[float, float, float]:
    """The direction of a non-zero vector, whatever its length (1e-300 and 1e300 included)."""
    largest = max(abs(component) for component in vector)
    x, y, z = (component / largest for component in vector)
    length = math.hypot(x, y, z)
    return x / length, y / length, z / length
