"""Axes of triangles: how small, how large, how slender."""

from __future__ import annotations

from typing import Any

from equilux.extremes.axes.pieces import CLAY, MATT, orthographic, perspective, point_light, spec
from equilux.extremes.axis import Axis, Spec, decades


def _mesh(vertices: list[list[float]], faces: list[list[int]], material: str, **rest: Any) -> dict[str, Any]:
    return {"kind": "mesh", "vertices": vertices, "faces": faces, "material": material, **rest}


def _size(size: float, model: str) -> Spec:
    """A bent sheet of four triangles before an eye whose distance does not change; the film goes with the sheet."""

    def at(x: float, y: float, z: float) -> list[float]:
        return [size * x, size * y, size * z]

    return spec(
        orthographic((0, 0, max(3.0, 3 * size)), (0, 0, 0), 2.5 * size),
        {"lamp": point_light(at(-1, 1.5, 2), 4.0 * size**2)},
        {"clay": MATT},
        [_mesh([at(-1.1, -0.9, 0), at(0.9, -1, 0.1), at(1, 0.8, -0.1), at(-0.8, 1, 0.05), at(0.1, 0.05, 0.4)],
               [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]], "clay")],
        background=0.0625,
    )  # fmt: skip


def _length(length: float, model: str) -> Spec:
    """A triangle whose far corner leaves the film: what is seen is its base."""
    return spec(
        perspective((0.1, 0.2, 3), (0.1, 0.2, 0), 30),
        {"lamp": point_light((-1, 1.5, 2), 5.0)},
        {"clay": CLAY if model != "opengl" else MATT},
        [_mesh([[-0.6, -0.5, 0.0], [0.7, -0.45, 0.1], [0.15 * length, length, -0.2 * length]], [[0, 1, 2]], "clay")],
        background=0.0625,
    )


def _sliver(width: float, model: str) -> Spec:
    """A flat square of three triangles, the one in the middle a sliver of this width from corner to corner: nothing of it is seen
    but a crack, should there be one."""
    return spec(
        perspective((0.1, 0.2, 3), (0.1, 0.05, 0), 30),
        {"lamp": point_light((-1, 1.5, 2), 5.0)},
        {"clay": MATT},
        [_mesh([[-0.6, -0.6, 0.0], [0.7, -0.6, 0.0], [0.7, 0.6, 0.0], [-0.6, 0.6, 0.0], [-0.6 + width, 0.6, 0.0]],
               [[0, 1, 2], [0, 2, 4], [0, 4, 3]], "clay")],
        background=0.0625,
    )  # fmt: skip


AXES = (
    Axis(
        "triangle-size", "size of a mesh's triangles", "m", 1.0, decades(-1, -15), decades(1, 12), _size,
        "A bent sheet of four triangles; film and light go with it, and the eye stays 3 m away until the sheet is larger.",
        "thresholds on edges or areas (POV-Ray's 1e-5), vertices in float32",
    ),
    Axis(
        "triangle-length", "length of a triangle over its base", "", 1.0, (), decades(1, 12), _length,
        "The far corner of a slanted triangle leaves the film; what is seen is its base.",
        "planes and barycentric coordinates in float32",
    ),
    Axis(
        "triangle-sliver", "width of a sliver in a square", "m", 1e-1, decades(-2, -15), (), _sliver,
        "A flat square of three triangles, one of which becomes ever thinner.",
        "cracks: degenerate triangles that are dropped or turned over",
    ),
)  # fmt: skip
