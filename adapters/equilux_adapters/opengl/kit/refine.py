"""Dividing triangles until they are small: OpenGL lights corners and nothing between them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from equilux_adapters._triangles.clip import in_frame
from equilux_adapters._triangles.facing import towards_eye
from equilux_adapters._triangles.view import Mesh, View, seen_from

Array = Any

MOST_TRIANGLES = 1 << 21
"""Of one object; beyond this nothing is divided any further."""


def drawn(view: View, mesh: Mesh, triangle_px: float, turn: float = 0.0) -> Mesh:
    """What is drawn of a mesh: the triangles on the film, their fronts to the eye, divided until they are small."""
    return divided(view, in_frame(view, towards_eye(view, mesh)), triangle_px, turn)


def divided(view: View, mesh: Mesh, triangle_px: float, turn: float) -> Mesh:
    """Halve sides until none is longer than triangle_px on the film, or has normals at its ends that differ by more than `turn`
    (a chord of the unit sphere), unless it is shorter than a sixteenth of triangle_px.

    Whether a side is halved, and where, depends on its ends alone: triangles that share it stay together, no cracks open. It is
    halved on the film. Normals are divided as they are, not made unit, which gives in every point the direction that
    interpolation over the whole gives.
    """
    points, normals, triangles = mesh.points, mesh.normals, mesh.triangles
    film, directions = on_film(view, points), unit_rows(normals)
    done: list[Array] = []
    while len(triangles):
        sides = [triangles[:, [k, (k + 1) % 3]] for k in range(3)]
        long = np.stack([is_long(film, directions, side, triangle_px, 0 if mesh.flat else turn) for side in sides], axis=1)
        cut = long.any(axis=1)
        done.append(triangles[~cut])
        if sum(map(len, done)) + 4 * cut.sum() > MOST_TRIANGLES:
            done.append(triangles[cut])
            break
        middle = np.where(long, len(points) + np.cumsum(long.ravel()).reshape(long.shape) - 1, -1)
        a, b = np.stack(sides, axis=1)[long].T
        triangles = split(triangles[cut], middle[cut])
        w_a, w_b = depths(view, points[a]), depths(view, points[b])
        between, normal_between = ((of[a] * w_b + of[b] * w_a) / (w_a + w_b) for of in (points, normals))
        points, normals = np.concatenate([points, between]), np.concatenate([normals, normal_between])
        film = np.concatenate([film, on_film(view, between)])
        directions = np.concatenate([directions, unit_rows(normal_between)])
    return replace(mesh, points=points, normals=normals, triangles=np.concatenate([*done, triangles[:0]]))


def depths(view: View, points: Array) -> Array:
    """(n, 1): what points are divided by to get to the film."""
    if view.parallel:
        return np.ones((len(points), 1))
    return np.maximum(seen_from(view, points)[:, 2:], 1e-300)


def is_long(film: Array, directions: Array, side: Array, triangle_px: float, turn: float) -> Array:
    """(m,) bool, of sides (m, 2) between corners with these film positions and unit normals; turn 0: never mind the normals."""
    span = film[side[:, 0]] - film[side[:, 1]]
    square = span[:, 0] ** 2 + span[:, 1] ** 2
    long: Array = square > triangle_px**2
    if turn > 0:
        bend = directions[side[:, 0]] - directions[side[:, 1]]
        long |= (np.einsum("ij,ij->i", bend, bend) > turn**2) & (square > (triangle_px / 16) ** 2)
    return long


def unit_rows(vectors: Array) -> Array:
    """(n, 3), each made unit."""
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def on_film(view: View, points: Array) -> Array:
    """(n, 2) pixels from the middle of the film."""
    return seen_from(view, points)[:, :2] / depths(view, points) * view.pixels_per_unit


def split(triangles: Array, middle: Array) -> Array:
    """Triangles cut at the middles of their sides 01, 12, 20 (m, 3), −1 where a side stays whole; at least one is cut."""
    count = (middle >= 0).sum(axis=1)
    a, b, c = triangles[count == 3].T
    ab, bc, ca = middle[count == 3].T
    result = [np.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
    for halves in (1, 2):
        chosen = count == halves
        # turn each triangle until the side that is alone in its state comes first
        first = np.argmax((middle[chosen] >= 0) == (halves == 1), axis=1)
        rows = np.arange(len(first))
        a, b, c = (triangles[chosen][rows, (first + k) % 3] for k in range(3))
        ab, bc, ca = (middle[chosen][rows, (first + k) % 3] for k in range(3))
        parts = ((a, ab, c), (ab, b, c)) if halves == 1 else ((c, ca, bc), (ca, a, bc), (a, b, bc))
        result += [np.stack(part, axis=1) for part in parts]
    return np.concatenate(result)
