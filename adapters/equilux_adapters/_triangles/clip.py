"""Cutting triangles in double, so that nothing is left for the rasteriser to clip in single precision."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from equilux_adapters._triangles.view import Mesh, View, seen_from

Array = Any


def cut(points: Array, triangles: Array, distance: Array) -> tuple[Array, Array]:
    """The part of triangles where `distance` (n,), linear over each of them, is not negative: all points, old and new, and
    triangles.

    A new point is worked out from the inner to the outer end of its edge: triangles that share an edge get equal points, no
    cracks.
    """
    inside = distance >= 0
    count = inside[triangles].sum(axis=1)
    kept = [triangles[count == 3]]
    for inner in (1, 2):
        crossing = triangles[count == inner]
        # turn each triangle until the corner that is alone on its side comes first
        first = np.argmax(inside[crossing] == (inner == 1), axis=1)
        a, b, c = (crossing[np.arange(len(crossing)), (first + k) % 3] for k in range(3))
        ends = []
        for end in (b, c):
            start, stop = (a, end) if inner == 1 else (end, a)
            t = distance[start] / (distance[start] - distance[stop])
            ends.append(len(points) + np.arange(len(a)))
            points = np.concatenate([points, points[start] + (points[stop] - points[start]) * t[:, None]])
        ab, ac = ends
        corners = [(a, ab, ac)] if inner == 1 else [(ab, b, c), (ab, c, ac)]
        kept += [np.stack(triangle, axis=1) for triangle in corners]
    return points, np.concatenate(kept)


def in_frame(view: View, mesh: Mesh, margin: float = 1.1) -> Mesh:
    """What the film can see of a mesh, a little beyond its border so that no edge of geometry lies on the border of the picture.

    Nothing is cut near or far: the side planes meet in the eye, and of a parallel view only what is behind the eye's plane goes.
    """
    points, triangles = np.concatenate([mesh.points, mesh.normals], axis=1), mesh.triangles
    x, y = margin * view.half_width, margin * view.half_height
    for side in ((1 / x, 0.0), (-1 / x, 0.0), (0.0, 1 / y), (0.0, -1 / y)):
        across = seen_from(view, points[:, :3])
        room = (1.0 if view.parallel else across[:, 2]) - across[:, :2] @ side
        points, triangles = only_inside(points, triangles, room)
    depth = seen_from(view, points[:, :3])[:, 2]
    floor = 0.0 if view.parallel else 1e-9 * np.max(depth[triangles], initial=0.0)
    points, triangles = only_inside(points, triangles, depth - floor)
    return replace(mesh, points=points[:, :3], normals=points[:, 3:], triangles=triangles)


def only_inside(points: Array, triangles: Array, distance: Array) -> tuple[Array, Array]:
    """What is on the side of distance ≥ 0, without points that no triangle uses."""
    if np.min(distance, initial=0.0) >= 0:
        return points, triangles
    points, triangles = cut(points, triangles, distance)
    used = np.zeros(len(points), dtype=bool)
    used[triangles] = True
    return points[used], (np.cumsum(used) - 1)[triangles]
