"""How far the tessellation departs from the scene's shapes: worked out from the very divisions that the script makes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from equilux.adapter import Case
from equilux_adapters.vtk.kit.round import Round, film_scale, sectors, sphere_division
from equilux_adapters.vtk.kit.shapes import cut_by_eye_plane, cylinder_division
from equilux_adapters.vtk.kit.view import View, look_at, seen_from
from equilux_adapters.vtk.knobs import VtkKnobs
from equilux_scenes.model import Camera, Cylinder, Disc, Film, Sphere
from equilux_scenes.transforms import matrix

Floats = npt.NDArray[np.float64]

RIM_STRIPS = 4
"""This many strips on either side of where a round surface is seen edge-on are not covered by the bounds on normal and position, which
grow without limit there, but by the film position: what a pixel shows there, the truth shows within the width of these strips."""


def view_of(camera: Camera, film: Film) -> View:
    """The view that the script sets up."""
    axes = look_at(camera.eye, camera.target, camera.up)
    if camera.projection == "perspective":
        return View(**axes, half_height=math.tan(math.radians(camera.fov_y_deg) / 2), width=film.width, height=film.height)
    return View(**axes, half_height=camera.height_m / 2, width=film.width, height=film.height, parallel=True)


def geometry_of(case: Case, knobs: VtkKnobs) -> dict[str, Any]:
    """JSON: bounds on normal and position (metres) per object index (as text), and on the film position of silhouettes (pixels)."""
    view = view_of(case.scene.camera, case.scene.film)
    bounds = {index: _bounds(view, obj, knobs.tessellation) for index, obj in enumerate(case.scene.objects)}
    return {
        "normal": {str(index): normal for index, (normal, _, _) in bounds.items() if normal > 0},
        "position_m": {str(index): position for index, (_, position, _) in bounds.items() if position > 0},
        "film_px": max((film for _, _, film in bounds.values()), default=0.0),
    }


def _bounds(view: View, obj: Any, segments: int) -> tuple[float, float, float]:
    """(normal, position in metres, film position in pixels) of one object."""
    placed = matrix(obj) if obj.transform else None
    if isinstance(obj, Sphere):
        return _sphere(view, obj, segments, placed)
    if isinstance(obj, Cylinder):
        return _cylinder(view, obj, segments, placed)
    if isinstance(obj, Disc):
        scale = film_scale(view, placed, np.asarray(obj.center), obj.radius)
        return 0.0, 0.0, _chord_px(2 * math.pi / sectors(segments, obj.radius, scale), obj.radius * scale.large)
    return 0.0, 0.0, 0.0


def _chord_px(step: float, radius_px: float) -> float:
    """How far the chord of an angle stays off its circle."""
    return radius_px * step**2 / 8


def _sphere(view: View, obj: Sphere, segments: int, placed: Floats | None) -> tuple[float, float, float]:
    axes, meridian, counts = sphere_division(view, obj.center, obj.radius, segments, placed)
    scale = film_scale(view, placed, np.asarray(obj.center), obj.radius)
    across = 2 * np.pi * np.sin(meridian.angles) / counts
    sees_back = cut_by_eye_plane(view, obj.center, obj.radius, placed) or meridian.rim == len(meridian.angles) - 1
    normal, position = _facets(meridian, across, len(meridian.angles) - 1 if sees_back else meridian.rim)
    turn = 2 * np.pi * np.arange(64) / 64
    edge, inner = (
        np.asarray(obj.center)
        + obj.radius * (np.sin(a) * (np.cos(turn)[:, None] * axes[0] + np.sin(turn)[:, None] * axes[1]) + np.cos(a) * axes[2])
        for a in _rim_angles(meridian)
    )
    film = _film_distance(view, placed, edge, inner) + _chord_px(float(across[meridian.rim]), obj.radius * scale.large)
    return normal * scale.stretch, position * obj.radius * _largest_factor(placed), film


def _cylinder(view: View, obj: Cylinder, segments: int, placed: Floats | None) -> tuple[float, float, float]:
    axes, half = cylinder_division(view, obj.base, obj.top, obj.radius, segments, placed)
    scale = film_scale(view, placed, np.stack([obj.base, obj.top]), obj.radius)
    normal, position = _facets(half, np.zeros(len(half.angles)), len(half.angles) - 1)
    base, top = np.asarray(obj.base), np.asarray(obj.top)
    along = base + np.linspace(0, 1, 33)[:, None] * (top - base)
    film = 0.0
    for side in (1, -1):
        edge, inner = (along + obj.radius * (np.cos(a) * axes[0] + side * np.sin(a) * axes[1]) for a in _rim_angles(half))
        film = max(film, _film_distance(view, placed, edge, inner))
    film += _chord_px(float(np.max(np.diff(half.angles))), obj.radius * scale.large)
    # along the axis a ray goes on for as long as it is between facet and circle
    return normal * scale.stretch, position * _slant(view, axes[2], placed, along) * obj.radius * _largest_factor(placed), film


def _facets(division: Round, across: Floats, last: int) -> tuple[float, float]:
    """Largest error of the normal and of the position, unit radius, over the facets that the bounds cover: see `kit.round`."""
    k = np.arange(last)
    k = k[(k < division.rim - RIM_STRIPS) | (k >= division.rim + RIM_STRIPS)] if division.rim < len(division.angles) - 1 else k
    if len(k) == 0:
        return 0.0, 0.0
    sagitta = (np.diff(division.angles)[k] ** 2 + np.maximum(across[k], across[k + 1]) ** 2) / 8
    steepness = np.maximum(division.steepness[k], division.steepness[k + 1])
    return float(np.max(sagitta * steepness)), float(np.max(sagitta * np.sqrt(1 + steepness**2)))


def _rim_angles(division: Round) -> tuple[float, float]:
    if division.rim == len(division.angles) - 1:
        return float(division.angles[-1]), float(division.angles[-1])
    return float(division.angles[division.rim]), float(division.angles[max(division.rim - RIM_STRIPS, 0)])


def _film_distance(view: View, placed: Floats | None, a: Floats, b: Floats) -> float:
    """Largest distance on the film, pixels, between points of object space that belong together, of those the film shows."""
    films, shown = [], np.zeros(len(a), dtype=bool)
    for points in (a, b):
        if placed is not None:
            points = points @ placed[:3, :3].T + placed[:3, 3]
        x, y, depth = seen_from(view, points - view.eye).T
        over = np.where(depth > 0, 1.0 if view.parallel else depth, np.nan)
        films.append(np.stack([x / over, y / over], axis=1))
        shown |= (depth > 0) & (abs(x) <= 1.1 * view.half_width * over) & (abs(y) <= 1.1 * view.half_height * over)
    distance = np.linalg.norm(films[0] - films[1], axis=1)[shown] * view.pixels_per_unit
    return float(np.nanmax(distance, initial=0.0))


def _slant(view: View, axis: Floats, placed: Floats | None, along: Floats) -> float:
    """1 / sin of the smallest angle between a cylinder's axis and the rays that meet it, limited to 100."""
    linear, shift = (np.eye(3), np.zeros(3)) if placed is None else (placed[:3, :3], placed[:3, 3])
    inverse = np.linalg.inv(linear)
    rays = (inverse @ view.forward)[None] if view.parallel else along - inverse @ (view.eye - shift)
    cosine = np.max(np.abs(rays @ axis) / np.linalg.norm(rays, axis=1))
    return float(1 / math.sqrt(max(1 - min(cosine, 1.0) ** 2, 1e-4)))


def _largest_factor(placed: Floats | None) -> float:
    return 1.0 if placed is None else float(np.linalg.svd(placed[:3, :3], compute_uv=False)[0])
