"""By how much a picture that is lit at corners departs from one that is lit at every point: a bound per pixel.

OpenGL evaluates the formula at the corners of a triangle and interpolates the radiance linearly over it. So the departure is not
estimated but worked out, in double, for every triangle that may show at a pixel's centre: the interpolated radiance
Σ λ_k L(P_k, N_k) against L(P, N) at the point P of the true surface that the same ray meets, λ the perspective barycentric
coordinates of the centre. That covers curved highlights as well as gates and cones that cross a triangle and are smeared over it.

Where the centre is so near a side that the move of corners to the grid may give it to the neighbour, the neighbour's value is
held against the truth as well.

To that comes what rounding may do. L/w and 1/w, w the depth, are interpolated by planes over the film and divided; each is off as
if the centre were ε pixels away (`bounds.rounding_px`), so the radiance by ε w (|∇(L/w)| + L |∇(1/w)|), with |∇f| at most
Σ |f_k − f̄| / h_k, h_k the triangle's heights: much, where one triangle reaches over many octaves of depth. A corner within
rounding of a gate or a cone's edge may fall on the other side. And every corner's value is off by what single precision loses
of directions and positions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from equilux_adapters._triangles.bounds import Floats, rounding_px
from equilux_adapters._triangles.view import Mesh, View, seen_from
from equilux_adapters.opengl.formula import Lighting, Lit, lit
from equilux_adapters.opengl.kit.stage import Surface

GRID_PX = 1 / 256
"""Corners are moved to multiples of this (Q5): a triangle may show where it is up to √2/2 of it away."""

NEAR = 1e-3
"""Of its depth: what lies farther than this behind a triangle that surely covers a pixel's centre is not seen there."""


class Shown(NamedTuple):
    """Pairs of a triangle and a pixel whose centre it may show.

    pixel: row-major index. shares: barycentric coordinates on the film, (n, 3). weights: λ, in space. heights: of the triangle on
    the film, pixels, (n, 3). surely: whether it shows there however corners are moved.
    """

    triangle: npt.NDArray[np.int64]
    pixel: npt.NDArray[np.int64]
    shares: Floats
    weights: Floats
    heights: Floats
    depth: Floats
    surely: npt.NDArray[np.bool_]

    def of(self, chosen: npt.NDArray[np.bool_]) -> Shown:
        """Some of the pairs."""
        return Shown(
            self.triangle[chosen], self.pixel[chosen], self.shares[chosen], self.weights[chosen], self.heights[chosen],
            self.depth[chosen], self.surely[chosen],
        )  # fmt: skip


class Left(NamedTuple):
    """What is left open, W/(m²·sr), (h, w, 3) each. interpolation: by lighting at corners. rounding: by single precision."""

    interpolation: Floats
    rounding: Floats


def left_open(
    view: View, objects: Sequence[tuple[Mesh, Surface, Mapping[str, Any] | None]], lighting: Lighting
) -> Left:
    """objects: what is drawn, relative to the eye, with its surface, and of what is round its true shape: see `on_surface`.

    Where a value is not finite (a corner in the place of a light) nothing is stated: 0.
    """
    pixels = view.height * view.width
    result = Left(np.zeros((pixels, 3)), np.zeros((pixels, 3)))
    found = [shown(view, mesh) for mesh, _, _ in objects]
    nearest = np.full(pixels, np.inf)
    for pairs in found:
        np.minimum.at(nearest, pairs.pixel[pairs.surely], pairs.depth[pairs.surely])
    for (mesh, surface, true), everything in zip(objects, found, strict=True):
        pairs = everything.of(everything.depth <= nearest[everything.pixel] * (1 + NEAR))
        if len(pairs.pixel):
            values = evaluated(view, mesh, surface, true, pairs, lighting)
            np.maximum.at(result.interpolation, pairs.pixel, _finite(_departure(pairs, values, pixels) + values.slack))
            np.maximum.at(result.rounding, pairs.pixel, _finite(values.rounding))
    return Left(*(part.reshape(view.height, view.width, 3) for part in result))


def _finite(values: Floats) -> Floats:
    return np.where(np.isfinite(values), values, 0.0)


def shown(view: View, mesh: Mesh) -> Shown:
    """All pairs of a triangle and a pixel that it may show at."""
    across = seen_from(view, mesh.points)
    depth = across[:, 2]
    over = np.ones_like(depth) if view.parallel else np.maximum(depth, 1e-300)
    film = np.array([1, -1]) * across[:, :2] / over[:, None] * view.pixels_per_unit + np.array([view.width, view.height]) / 2
    triangle, pixel_xy = _candidates(film[mesh.triangles], view)
    corners = film[mesh.triangles[triangle]] - (pixel_xy + 0.5)[:, None, :]
    after, before = np.roll(corners, -1, axis=1), np.roll(corners, -2, axis=1)
    parts = after[..., 0] * before[..., 1] - after[..., 1] * before[..., 0]
    twice_area = parts.sum(axis=1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        heights = np.abs(twice_area) / np.linalg.norm(after - before, axis=2)
        shares = parts / twice_area
        weights = shares / over[mesh.triangles[triangle]]
        inverse_depth = weights.sum(axis=1)
        weights = weights / inverse_depth[:, None]
        at = np.sum(shares * depth[mesh.triangles[triangle]], axis=1) if view.parallel else 1 / inverse_depth
        inside = np.min(shares * heights, axis=1)
    reach = GRID_PX * np.sqrt(0.5) * 1.01
    pairs = Shown(triangle, pixel_xy[:, 1] * view.width + pixel_xy[:, 0], shares, weights, heights, at, inside >= reach)
    return pairs.of((inside >= -reach) & np.isfinite(weights).all(axis=1))


def _candidates(film: Floats, view: View) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Triangles (n,) and pixels (n, 2) where a triangle's bounding box holds the pixel's centre."""
    size = np.array([view.width, view.height])
    low = np.clip(np.ceil(film.min(axis=1) - 0.5 - GRID_PX), 0, size).astype(np.int64)
    high = np.clip(np.floor(film.max(axis=1) - 0.5 + GRID_PX), -1, size - 1).astype(np.int64)
    columns, rows = np.maximum(high - low + 1, 0).T
    count = columns * rows
    triangle = np.repeat(np.arange(len(film)), count)
    within = np.arange(len(triangle)) - np.repeat(np.cumsum(count) - count, count)
    return triangle, low[triangle] + np.stack([within % columns[triangle], within // columns[triangle]], axis=1)


class Values(NamedTuple):
    """Per pair, (n, 3): the interpolated radiance, the formula's at the point itself, what rounding on the film and at gates may
    add, and what it may at the corners."""

    interpolated: Floats
    true: Floats
    slack: Floats
    rounding: Floats


def evaluated(
    view: View, mesh: Mesh, surface: Surface, true: Mapping[str, Any] | None, pairs: Shown, lighting: Lighting
) -> Values:
    """See the module."""
    corners = mesh.triangles[pairs.triangle]
    used, inverse = np.unique(corners, return_inverse=True)
    inverse = inverse.reshape(corners.shape)
    at_corners = Lit(*(part[inverse] for part in lit(mesh.points[used], mesh.normals[used], surface, lighting)))
    points = np.einsum("nk,nkd->nd", pairs.weights, mesh.points[corners])
    normals = np.einsum("nk,nkd->nd", pairs.weights, mesh.normals[corners])
    if true is not None:
        points, normals = on_surface(view, true, points, normals, mesh.normals[corners])
    interpolated = np.einsum("nk,nkd->nd", pairs.weights, at_corners.radiance)
    nearness = np.ones((*corners.shape, 1)) if view.parallel else 1 / seen_from(view, mesh.points[used])[inverse, 2:]
    slope = _slope(nearness * at_corners.radiance, pairs) + np.abs(interpolated) * _slope(nearness, pairs)
    slope /= np.abs(np.einsum("nk,nkd->nd", pairs.shares, nearness))
    doubt, rounding = (np.einsum("nk,nkd->nd", np.abs(pairs.weights), part) for part in (at_corners.doubt, at_corners.rounding))
    here = lit(points, normals, surface, lighting).radiance
    return Values(interpolated, here, doubt + rounding_px(view) * slope, rounding)


def _departure(pairs: Shown, values: Values, pixels: int) -> Floats:
    """(n, 3): of each pair's interpolated radiance from the formula's at its own point, and from that of the nearest triangle of
    the object that holds the pixel's centre, unless this is another part of the object."""
    own: Floats = np.abs(values.interpolated - values.true)
    holding = np.flatnonzero(pairs.shares.min(axis=1) >= 0)
    holding = holding[np.lexsort((pairs.depth[holding], pairs.pixel[holding]))]
    shown_pixels, first = np.unique(pairs.pixel[holding], return_index=True)
    holder = np.full(pixels, -1)
    holder[shown_pixels] = holding[first]
    other = holder[pairs.pixel]
    near = (other >= 0) & (np.abs(pairs.depth - pairs.depth[other]) <= NEAR * pairs.depth)
    return np.where(near[:, None], np.maximum(own, np.abs(values.interpolated - values.true[other])), own)


def _slope(values: Floats, pairs: Shown) -> Floats:
    """(n, d) of values at corners (n, 3, d), linear over the film: at most so much per pixel."""
    slope: Floats = np.sum(np.abs(values - values.mean(axis=1, keepdims=True)) / pairs.heights[..., None], axis=1)
    return slope


def on_surface(
    view: View, true: Mapping[str, Any], points: Floats, normals: Floats, corner_normals: Floats
) -> tuple[Floats, Floats]:
    """Where the rays through points of facets meet the round surface itself, and its normals there, towards the viewer.

    true: center and radius of a sphere, or center, axis (unit) and radius of a cylinder's side, in object space, and the matrix
    into the world. Facets whose corners have one normal are a cylinder's caps: they stay. So do points whose ray misses.
    """
    matrix = np.asarray(true["matrix"])
    inverse = np.linalg.inv(matrix[:3, :3])
    center, radius = np.asarray(true["center"]), true["radius"]
    foot = (points + view.eye - matrix[:3, 3]) @ inverse.T - center
    ray = (np.broadcast_to(view.forward, points.shape) if view.parallel else points) @ inverse.T
    across, over = (_without(vectors, true.get("axis")) for vectors in (ray, foot))
    # |over + s across| = radius, for the smallest |s|: s = −c / (b ± √(b² − ac))
    a, b = np.sum(across**2, axis=1), np.sum(across * over, axis=1)
    c = np.sum(over**2, axis=1) - radius**2
    with np.errstate(divide="ignore", invalid="ignore"):
        step = -c / (b + np.copysign(np.sqrt(np.maximum(b**2 - a * c, 0)), b))
    capped = np.ptp(corner_normals, axis=1).max(axis=1) < 1e-9
    step = np.where(capped | ~np.isfinite(step), 0.0, step)[:, None]
    outward = (over + step * across) @ inverse
    outward *= np.sign(np.sum(outward * normals, axis=1, keepdims=True))
    met = points + step * (view.forward if view.parallel else points)
    return met, np.where(capped[:, None], normals, outward)


def _without(vectors: Floats, axis: Any) -> Floats:
    """Without the part along an axis, if there is one."""
    return vectors if axis is None else vectors - (vectors @ np.asarray(axis))[:, None] * np.asarray(axis)
