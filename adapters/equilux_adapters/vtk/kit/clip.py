"""Cutting triangles in double, so that nothing is left for the rasteriser to clip in single precision."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from equilux_adapters.vtk.kit.view import Mesh, View, seen_from

Array = Any


def cut(points: Array, triangles: Array, distance: Array) -> tuple[Array, Array, Array]:
    """Split triangles where `distance` (n,) changes sign: all points, triangles with distance ≥ 0, triangles with distance ≤ 0.

    A new point is worked out from the inner to the outer end of its edge: triangles that share an edge get equal points, no cracks.
    """
    inside = distance >= 0
    count = inside[triangles].sum(axis=1)
    kept, dropped = [triangles[count == 3]], [triangles[count == 0]]
    for inner, lone, others in ((1, kept, dropped), (2, dropped, kept)):
        crossing = triangles[count == inner]
        if len(crossing) == 0:
            continue
        # turn each triangle until the corner that is alone on its side comes first
        first = np.argmax(inside[crossing] == (inner == 1), axis=1)
        a, b, c = (crossing[np.arange(len(crossing)), (first + k) % 3] for k in range(3))
        ends = []
        for end in (b, c):
            start, stop = (a, end) if inner == 1 else (end, a)
            t = distance[start] / (distance[start] - distance[stop])
            ends.append(len(points) + np.arange(len(a)))
            points = np.concatenate([points, points[start] + (points[stop] - points[start]) * t[:, None]])
            distance = np.concatenate([distance, np.zeros(len(a))])
        ab, ac = ends
        lone.append(np.stack([a, ab, ac], axis=1))
        others += [np.stack([ab, b, c], axis=1), np.stack([ab, c, ac], axis=1)]
    return points, np.concatenate(kept), np.concatenate(dropped)


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
    if not view.parallel:
        points, triangles = in_octaves(points, triangles, lambda points: points[:, :3] @ view.forward)
    return replace(mesh, points=points[:, :3], normals=points[:, 3:], triangles=triangles)


def only_inside(points: Array, triangles: Array, distance: Array) -> tuple[Array, Array]:
    """What is on the side of distance ≥ 0, without points that no triangle uses."""
    if np.min(distance, initial=0.0) >= 0:
        return points, triangles
    points, triangles, _ = cut(points, triangles, distance)
    return only_used(points, triangles)


def only_used(points: Array, triangles: Array) -> tuple[Array, Array]:
    """The same without points that no triangle uses."""
    used = np.zeros(len(points), dtype=bool)
    used[triangles] = True
    return points[used], (np.cumsum(used) - 1)[triangles]


def in_octaves(points: Array, triangles: Array, size: Callable[[Array], Array]) -> tuple[Array, Array]:
    """Cut triangles where `size`, a positive linear function of the points, is a power of two.

    The rasteriser interpolates 1/depth linearly in single precision: over many octaves the far end keeps no digits. All triangles are
    cut alike, and nothing is when no triangle reaches over more than one octave, so that neighbours still share their points.
    """
    sizes = size(points)[triangles]
    if len(triangles) == 0 or np.max(sizes.max(axis=1) / sizes.min(axis=1)) <= 2:
        return points, triangles
    all_points, all_triangles, total = [], [], 0
    for octave in range(int(np.floor(np.log2(sizes.min()))), int(np.floor(np.log2(sizes.max()))) + 1):
        overlapping = triangles[(sizes.min(axis=1) < 2.0 ** (octave + 1)) & (sizes.max(axis=1) >= 2.0**octave)]
        part, inside, _ = cut(points, overlapping, size(points) - 2.0**octave)
        part, _, inside = cut(part, inside, size(part) - 2.0 ** (octave + 1))
        part, inside = only_used(part, inside)
        all_points.append(part)
        all_triangles.append(inside + total)
        total += len(part)
    return np.concatenate(all_points), np.concatenate(all_triangles)
