"""Spheres, cylinders and discs: how far their facets, divided just as the script divides them, are from what is round."""

from __future__ import annotations

import math

import numpy as np

from equilux_adapters._triangles.bounds import Bounds, Floats, largest_factor, on_film, rounding_px
from equilux_adapters._triangles.round import Round, Scale, film_scale, sectors, sphere_division, sphere_scale
from equilux_adapters._triangles.shapes import cut_by_eye_plane, cylinder_division
from equilux_adapters._triangles.view import View
from equilux_scenes.model import Cylinder, Disc, Sphere

RIM_STRIPS = 4
"""This many strips on either side of where a round surface is seen edge-on are not covered by the bounds on normal and
position, which grow without limit there, but by the film position: what a pixel shows there, the truth shows within the width of
these strips."""


def of_sphere(view: View, obj: Sphere, segments: int, placed: Floats | None) -> Bounds:
    """Bounds of a sphere's facets."""
    axes, meridian, counts = sphere_division(view, obj.center, obj.radius, segments, placed)
    scale = sphere_scale(view, obj.center, obj.radius, placed)
    across = 2 * np.pi * np.sin(meridian.angles) / counts
    sees_back = cut_by_eye_plane(view, obj.center, obj.radius, placed) or not meridian.has_rim
    last = len(meridian.angles) - 1 if sees_back else meridian.rim
    facets = _facets(meridian, across, last, rounding_px(view) / (obj.radius * scale.smallest))
    if not meridian.has_rim:
        return _in_world(facets, 0.0, obj.radius, scale, placed)
    turn = 2 * np.pi * np.arange(64) / 64
    edge, inner = (
        np.asarray(obj.center)
        + obj.radius * (np.sin(a) * (np.cos(turn)[:, None] * axes[0] + np.sin(turn)[:, None] * axes[1]) + np.cos(a) * axes[2])
        for a in _rim_angles(meridian)
    )
    film = _film_distance(view, placed, edge, inner) + _chord_px(float(across[meridian.rim]), obj.radius * scale.large)
    return _in_world(facets, film, obj.radius, scale, placed)


def of_cylinder(view: View, obj: Cylinder, segments: int, placed: Floats | None) -> Bounds:
    """Bounds of a cylinder's side, and of its rims."""
    axes, half, scale = cylinder_division(view, obj.base, obj.top, obj.radius, segments, placed)
    facets = _facets(half, np.zeros(len(half.angles)), len(half.angles) - 1, rounding_px(view) / (obj.radius * scale.smallest))
    base, top = np.asarray(obj.base), np.asarray(obj.top)
    along = base + np.linspace(0, 1, 33)[:, None] * (top - base)
    film = 0.0
    for side in (1, -1) if half.has_rim else ():
        edge, inner = (along + obj.radius * (np.cos(a) * axes[0] + side * np.sin(a) * axes[1]) for a in _rim_angles(half))
        film = max(film, _film_distance(view, placed, edge, inner))
    film += _chord_px(float(np.max(np.diff(half.angles))), obj.radius * scale.large)
    # along the axis a ray goes on for as long as it is between facet and circle
    radial = obj.radius * (np.cos(half.angles)[:, None] * axes[0] + np.sin(half.angles)[:, None] * axes[1])
    surface = np.concatenate([along + step for step in radial[:: max(1, len(radial) // 32)]])
    slanted = (facets[0], facets[1] * _slant(view, axes[2], placed, surface))
    return _in_world(slanted, film, obj.radius, scale, placed)


def of_disc(view: View, obj: Disc, segments: int, placed: Floats | None) -> Bounds:
    """Bounds of a disc's rim; the rest of it is exact."""
    scale = film_scale(view, placed, np.asarray(obj.center), obj.radius)
    return Bounds(film_px=_chord_px(2 * math.pi / sectors(segments, obj.radius, scale), obj.radius * scale.large))


def _chord_px(step: float, radius_px: float) -> float:
    """How far the chord of an angle stays off its circle."""
    return radius_px * step**2 / 8


def _facets(division: Round, across: Floats, last: int, rounding: float) -> tuple[float, float]:
    """Largest error of the normal and of the position, for radius 1, over the facets that the bounds cover: see `kit.round`.

    rounding: of a place on the film, in radii.
    """
    k = np.arange(last)
    if division.has_rim:
        k = k[(k < division.rim - RIM_STRIPS) | (k >= division.rim + RIM_STRIPS)]
    if len(k) == 0:
        return 0.0, 0.0
    sagitta = (np.diff(division.angles)[k] ** 2 + np.maximum(across[k], across[k + 1]) ** 2) / 8
    steepness = np.maximum(division.steepness[k], division.steepness[k + 1])
    slant = np.sqrt(1 + steepness**2)
    return float(np.max(sagitta * steepness + rounding * slant)), float(np.max((sagitta + rounding) * slant))


def _in_world(facets: tuple[float, float], film: float, radius: float, scale: Scale, placed: Floats | None) -> Bounds:
    """From radius 1 in object space to the world; and how far the terminator, N·L = 0, is displaced on the film.

    N turns by 1/radius per length, so an error of N moves the terminator by radius times as much.
    """
    normal, position = facets
    film += normal * radius * scale.large
    return Bounds(float(normal * scale.stretch), position * radius * largest_factor(placed), float(film))


def _rim_angles(division: Round) -> tuple[float, float]:
    return float(division.angles[division.rim]), float(division.angles[max(division.rim - RIM_STRIPS, 0)])


def _film_distance(view: View, placed: Floats | None, edge: Floats, inner: Floats) -> float:
    """Largest distance on the film, pixels, from points near an edge to the edge, of those the film shows.

    edge, inner: (n, 3) in object space, points that belong together; `edge` runs along the edge.
    """
    points = np.stack([edge, inner])
    if placed is not None:
        points = points @ placed[:3, :3].T + placed[:3, 3]
    film, _ = on_film(view, points - view.eye)
    border = 1.1 * np.array([view.width, view.height]) / 2
    shown = (np.abs(film) <= border).all(axis=2).any(axis=0)
    along, across = np.gradient(film[0], axis=0), film[1] - film[0]
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = np.abs(along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0]) / np.linalg.norm(along, axis=1)
    distance = np.where(np.isfinite(distance), distance, np.linalg.norm(across, axis=1))[shown]
    return float(np.nanmax(distance, initial=0.0))


def _slant(view: View, axis: Floats, placed: Floats | None, surface: Floats) -> float:
    """1 / sin of the smallest angle between a cylinder's axis and the rays that meet its surface, limited to 100."""
    linear, shift = (np.eye(3), np.zeros(3)) if placed is None else (placed[:3, :3], placed[:3, 3])
    inverse = np.linalg.inv(linear)
    rays = (inverse @ view.forward)[None] if view.parallel else surface - inverse @ (view.eye - shift)
    cosine = np.max(np.abs(rays @ axis) / np.linalg.norm(rays, axis=1))
    return float(1 / math.sqrt(max(1 - min(cosine, 1.0) ** 2, 1e-4)))
