"""The scene's shapes as triangles with outward normals, in double precision, relative to the eye."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from equilux_adapters._triangles.clip import only_inside
from equilux_adapters._triangles.facing import is_watertight
from equilux_adapters._triangles.round import (
    Round,
    Scale,
    axes_towards,
    divide,
    eye_in_object,
    film_scale,
    sectors,
    sphere_division,
)
from equilux_adapters._triangles.view import Mesh, View, linear_and_shift, mapped, place

Array = Any


def sphere(
    view: View, center: Array, radius: float, segments: int, matrix: Array | None = None, grazing: bool = True
) -> Mesh:
    """Rings about the axis towards the eye; what the sphere itself hides is left out. grazing: see `divide`."""
    axes, meridian, counts = sphere_division(view, center, radius, segments, matrix, grazing)
    hides_back = meridian.has_rim and not cut_by_eye_plane(view, center, radius, matrix)
    last = meridian.rim if hides_back else len(meridian.angles) - 1
    rings, start, total = [], [], 0
    for k in range(last + 1):
        pole = k == 0 or (not hides_back and k == last)
        turn = np.zeros(1) if pole else 2 * np.pi * np.arange(counts[k]) / counts[k]
        s, c = (0.0, np.cos(meridian.angles[k])) if pole else (np.sin(meridian.angles[k]), np.cos(meridian.angles[k]))
        rings.append(np.stack([s * np.cos(turn), s * np.sin(turn), np.full(len(turn), c)], axis=1))
        start.append(total)
        total += len(turn)
    # the strip behind the rim would stand out in front of the rim's own where corners move on the film: it is left out
    triangles = [strip(start[k], len(rings[k]), start[k + 1], len(rings[k + 1])) for k in range(last) if k != meridian.rim]
    directions = mapped(np.concatenate(rings), axes.T)
    return place(view, np.asarray(center, dtype=float) + radius * directions, directions, np.concatenate(triangles), matrix)


def strip(a: int, count_a: int, b: int, count_b: int) -> Array:
    """Triangles between a ring of count_a points from index a and the next ring, of as many, twice or half as many, or one."""
    j = np.arange(max(count_a, count_b))
    if count_a == count_b:
        corners = [[a + j, b + j, b + (j + 1) % count_b], [a + j, b + (j + 1) % count_b, a + (j + 1) % count_a]]
    elif count_a == 1:
        corners = [[np.full_like(j, a), b + j, b + (j + 1) % count_b]]
    elif count_b == 1:
        corners = [[a + j, np.full_like(j, b), a + (j + 1) % count_a]]
    elif count_b == 2 * count_a:
        i = np.arange(count_a)
        corners = [[a + j // 2, b + j, b + (j + 1) % count_b], [a + i, b + 2 * i + 1, a + (i + 1) % count_a]]
        corners[0][0] = a + (j + 1) // 2 % count_a
    else:
        i = np.arange(count_b)
        corners = [[a + j, b + (j + 1) // 2 % count_b, a + (j + 1) % count_a], [a + 2 * i + 1, b + i, b + (i + 1) % count_b]]
    return np.concatenate([np.stack(c, axis=1) for c in corners])


def cut_by_eye_plane(view: View, center: Array, radius: float, matrix: Array | None) -> bool:
    """Whether a parallel view starts inside the sphere somewhere, and so looks at its inner side."""
    if not view.parallel:
        return False
    linear, shift = linear_and_shift(matrix)
    depth = view.forward @ (linear @ np.asarray(center, dtype=float) + (shift - view.eye))
    return bool(depth < 1.0001 * radius * np.linalg.norm(view.forward @ linear))


def cylinder_division(
    view: View, base: Array, top: Array, radius: float, segments: int, matrix: Array | None, grazing: bool = True
) -> tuple[Array, Round, Scale]:
    """Axes (w along the cylinder, u towards the eye), the division of half its circumference, and the scale it is made for."""
    base, top = np.asarray(base, dtype=float), np.asarray(top, dtype=float)
    u, v, w = axes_towards(top - base)
    eye, against = eye_in_object(view, matrix)
    towards = against if view.parallel else eye - base
    along, beside = float((eye - base) @ w), float(np.linalg.norm(np.cross(eye - base, w)))
    beyond = max(-along, along - float(np.linalg.norm(top - base)), 0.0)
    clearance = math.hypot(beside - radius, beyond)
    aside = np.array([towards @ u, towards @ v])
    if np.linalg.norm(aside) > 1e-9 * np.linalg.norm(towards):
        u, v = (aside[0] * u + aside[1] * v) / np.linalg.norm(aside), (aside[0] * v - aside[1] * u) / np.linalg.norm(aside)
    scale = film_scale(view, matrix, np.stack([base, top]), radius, clearance)
    distance = np.inf if view.parallel else float(np.linalg.norm(aside)) / radius
    largest = 2 * np.pi / sectors(segments, radius, scale)
    return np.stack([u, v, w]), divide(distance, segments, radius, scale, largest, grazing), scale


def cylinder(
    view: View, base: Array, top: Array, radius: float, capped: bool, segments: int, matrix: Array | None = None,
    grazing: bool = True,
) -> Mesh:  # fmt: skip
    """Side with radial normals, and caps that share its rim. grazing: see `divide`."""
    axes, half, _ = cylinder_division(view, base, top, radius, segments, matrix, grazing)
    turn = np.concatenate([half.angles, -half.angles[-2:0:-1]])
    count = len(turn)
    radial = np.cos(turn)[:, None] * axes[0] + np.sin(turn)[:, None] * axes[1]
    low, high = (np.asarray(end, dtype=float) + radius * radial for end in (base, top))
    j = np.arange(count)
    if not capped and half.has_rim:  # see `sphere`
        j = j[(j != half.rim) & (j != count - half.rim - 1)]
    following = (j + 1) % count
    points, normals = [low, high], [radial, radial]
    triangles = [np.stack([j, following, count + following], axis=1), np.stack([j, count + following, count + j], axis=1)]
    if capped:
        for start, rim, normal in ((2 * count, low, -axes[2]), (3 * count, high, axes[2])):
            points.append(rim)
            normals.append(np.tile(normal, (count, 1)))
            cap = start + polygon(count)
            triangles.append(cap if rim is high else cap[:, ::-1])
    return place(view, np.concatenate(points), np.concatenate(normals), np.concatenate(triangles), matrix, closed=capped)


def polygon(count: int) -> Array:
    """Triangles of a convex polygon: cut off every other corner, until three are left. Slivers lie along the rim only."""
    corners, triangles = np.arange(count), []
    while len(corners) >= 3:
        every = np.arange(0, len(corners) - 1, 2)
        triangles.append(np.stack([corners[every], corners[every + 1], corners[(every + 2) % len(corners)]], axis=1))
        corners = np.delete(corners, every + 1)
    return np.concatenate(triangles)


def disc(view: View, center: Array, normal: Array, radius: float, segments: int, matrix: Array | None = None) -> Mesh:
    """A polygon of equal sides."""
    axes = axes_towards(normal)
    count = sectors(segments, radius, film_scale(view, matrix, np.asarray(center, dtype=float), radius))
    turn = 2 * np.pi * np.arange(count) / count
    rim = np.asarray(center, dtype=float) + radius * (np.cos(turn)[:, None] * axes[0] + np.sin(turn)[:, None] * axes[1])
    return place(view, rim, np.tile(axes[2], (count, 1)), polygon(count), matrix, flat=True)


def rectangle(view: View, corner: Array, edge_u: Array, edge_v: Array, matrix: Array | None = None) -> Mesh:
    """Two triangles; the normal is edge_u × edge_v."""
    corner, edge_u, edge_v = (np.asarray(x, dtype=float) for x in (corner, edge_u, edge_v))
    points = np.stack([corner, corner + edge_u, corner + edge_u + edge_v, corner + edge_v])
    normal = np.cross(edge_u / np.linalg.norm(edge_u), edge_v / np.linalg.norm(edge_v))
    return place(view, points, np.tile(normal, (4, 1)), np.array([[0, 1, 2], [0, 2, 3]]), matrix, flat=True)


def box(view: View, low: Array, high: Array, matrix: Array | None = None) -> Mesh:
    """Six faces with normals of their own."""
    bounds = np.stack([np.asarray(low, dtype=float), np.asarray(high, dtype=float)])
    points: list[Array] = []
    normals: list[Array] = []
    triangles: list[Array] = []
    for axis in range(3):
        for side in (0, 1):
            across, along = (axis + 1) % 3, (axis + 2) % 3
            start = len(points)
            for i, j in ((0, 0), (1, 0), (1, 1), (0, 1)):
                point = np.empty(3)
                point[axis], point[across], point[along] = bounds[side, axis], bounds[i, across], bounds[j, along]
                points.append(point)
                normals.append(np.eye(3)[axis] * (2 * side - 1))
            face = np.array([[0, 1, 2], [0, 2, 3]]) + start
            triangles.append(face if side else face[:, ::-1])
    return place(view, np.stack(points), np.stack(normals), np.concatenate(triangles), matrix, closed=True, flat=True)


def mesh(view: View, vertices: Array, faces: Array, vertex_normals: Array | None = None, matrix: Array | None = None) -> Mesh:
    """A triangle mesh; without vertex normals each triangle gets corners of its own with the face's normal."""
    corners = vertices[faces]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(across, axis=1)
    closed = is_watertight(vertices, faces)
    faces, across = faces[area > 0], across[area > 0] / area[area > 0, None]
    if vertex_normals is None:
        own = np.arange(3 * len(faces)).reshape(-1, 3)
        return place(view, vertices[faces].reshape(-1, 3), np.repeat(across, 3, axis=0), own, matrix, closed, flat=True)
    # normals are turned to the eye with their triangle: one wound against its normals is wound anew, and then encloses nothing
    against = np.einsum("ijk,ik->ij", vertex_normals[faces], across).sum(axis=1) < 0
    faces = np.where(against[:, None], faces[:, ::-1], faces)
    return place(view, vertices, vertex_normals, faces, matrix, closed and not (against.any() and not against.all()))


def plane(view: View, point: Array, normal: Array, matrix: Array | None = None) -> Mesh:
    """The part of an infinite plane that the film can see, worked out on the film, where 1/depth is linear.

    It ends a little beyond what the farthest pixel centre sees, short of the horizon.
    """
    point, normal = np.asarray(point, dtype=float), np.asarray(normal, dtype=float)
    linear, shift = linear_and_shift(matrix)
    point, normal = linear @ point + shift, np.linalg.inv(linear).T @ normal
    normal = normal / np.max(np.abs(normal))
    normal /= np.linalg.norm(normal)
    height = normal @ (point - view.eye)
    across = np.array([normal @ view.right, normal @ view.up])
    along = normal @ view.forward
    half = np.array([view.half_width, view.half_height])
    film, triangles = 1.1 * half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]), np.array([[0, 1, 2], [0, 2, 3]])
    if (along if view.parallel else height) == 0:  # seen edge-on: no ray meets it
        return Mesh(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3), dtype=int))
    if view.parallel:
        film, triangles = only_inside(film, triangles, (height - film @ across) / along)
        depth = (height - film @ across) / along
        points = film @ np.stack([view.right, view.up]) + depth[:, None] * view.forward
        facing = along < 0
    else:
        film, triangles, nearness = plane_to_horizon(view, film, triangles, across / height, along / height)
        points = (view.forward + film @ np.stack([view.right, view.up])) / nearness[:, None]
        facing = height < 0
    return Mesh(points, np.tile(normal, (len(points), 1)), triangles if facing else triangles[:, ::-1], flat=True)


def plane_to_horizon(view: View, film: Array, triangles: Array, slope: Array, offset: float) -> tuple[Array, Array, Array]:
    """Cut the film where the plane's 1/depth = slope · film + offset falls well below what any pixel centre sees."""
    rows = (1 - (2 * np.arange(view.height) + 1) / view.height) * view.half_height
    columns = ((2 * np.arange(view.width) + 1) / view.width - 1) * view.half_width
    centres = columns[None, :] * slope[0] + rows[:, None] * slope[1] + offset
    least = np.min(centres, initial=np.inf, where=centres > 0)
    grid = np.linalg.norm(slope) / view.pixels_per_unit / 256
    # as near to the horizon as does not reach beyond it when corners move on the film
    end = min(0.9 * least, max(least / 16, grid))
    film, triangles = only_inside(film, triangles, film @ slope + offset - end)
    return film, triangles, film @ slope + offset


def read_mesh(name: str) -> dict[str, Array]:
    """The arrays of a file beside the script: vertices, faces and, where the mesh is smooth, vertex_normals."""
    with np.load(Path(__file__).parent / name) as file:
        return dict(file)
