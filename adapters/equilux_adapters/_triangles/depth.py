"""The depth buffer: what range it has to span, and surfaces that share a place in it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from equilux_adapters._triangles.clip import in_frame
from equilux_adapters._triangles.view import Mesh, View, seen_from

Array = Any


def clipping_range(view: View, meshes: Iterable[Mesh]) -> tuple[float, float]:
    """Depths just around everything that is seen, so that depth keeps as many digits as it can."""
    depths = [seen_from(view, mesh.points)[:, 2] for mesh in meshes if len(mesh.points)]
    if not depths:
        return 1.0, 2.0
    near, far = (float(f([f(depth) for depth in depths])) for f in (np.min, np.max))
    room = 1e-3 * (far - near) + 1e-3 * near
    return (near - room if view.parallel else 0.999 * near), far + room


DEPTH_STEP = 2.0**-20
"""Distance in the depth buffer, which has 24 digits between 1/2 and 1, that surely separates two surfaces."""


def set_back(view: View, meshes: Sequence[Mesh], steps: Iterable[int]) -> list[Mesh]:
    """Draw objects that lie in one surface a few steps of the depth buffer apart, so that the first is seen.

    Points move along the rays they are seen by: 1/depth (depth, of a parallel view) changes by a constant, which keeps their
    place on the film, and flat things flat.
    """
    seen = [in_frame(view, mesh) for mesh in meshes]
    near, far = clipping_range(view, seen)
    result = []
    for mesh, count in zip(seen, steps, strict=True):
        if view.parallel:
            points = mesh.points + count * DEPTH_STEP * (far - near) * view.forward
        else:
            depth = seen_from(view, mesh.points)[:, 2:]
            points = mesh.points / np.maximum(1 - count * DEPTH_STEP * (1 / near - 1 / far) * depth, 0.5)
        result.append(replace(mesh, points=points) if count else mesh)
    return result
