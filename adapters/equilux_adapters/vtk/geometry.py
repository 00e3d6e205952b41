"""How far the tessellation departs from the scene's shapes: worked out from the very divisions that the script makes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt
from equilux.adapter import Case
from equilux_scenes.model import Box, Camera, Cylinder, Disc, Film, Mesh, Rectangle, Sphere, SpotLight
from equilux_scenes.transforms import matrix

from equilux_adapters.vtk.coincident import flats, set_backs
from equilux_adapters.vtk.drawing import build
from equilux_adapters.vtk.kit import view as kit
from equilux_adapters.vtk.kit.clip import in_frame
from equilux_adapters.vtk.kit.depth import set_back
from equilux_adapters.vtk.kit.facing import towards_eye
from equilux_adapters.vtk.kit.round import Round, Scale, film_scale, sectors, sphere_division, sphere_scale
from equilux_adapters.vtk.kit.shapes import cut_by_eye_plane, cylinder_division
from equilux_adapters.vtk.kit.view import View, look_at, seen_from
from equilux_adapters.vtk.knobs import VtkKnobs

Floats = npt.NDArray[np.float64]

RIM_STRIPS = 4
"""This many strips on either side of where a round surface is seen edge-on are not covered by the bounds on normal and position, which
grow without limit there, but by the film position: what a pixel shows there, the truth shows within the width of these strips."""


U = 2.0**-24
"""Half a unit in the last place of single precision."""

SLIVER_PX = 1 / 16
"""Triangles of smooth meshes that are thinner on the film are left to the film position: the edge of one is never farther than half of
this from a pixel that shows it."""


def film_rounding_px(film: Film) -> float:
    """How far rounding displaces a corner on the film, and with it what is interpolated: 8 u of the film's size.

    One u each for the corner's coordinates, for the matrix, for their product and for the way from the middle of the film to pixels; and four
    for interpolating by planes that start in a corner of the film.
    """
    return 8 * U * max(film.width, film.height)


def view_of(camera: Camera, film: Film) -> View:
    """The view that the script sets up."""
    axes = look_at(camera.eye, camera.target, camera.up)
    if camera.projection == "perspective":
        return View(**axes, half_height=math.tan(math.radians(camera.fov_y_deg) / 2), width=film.width, height=film.height)
    return View(**axes, half_height=camera.height_m / 2, width=film.width, height=film.height, parallel=True)


def geometry_of(case: Case, knobs: VtkKnobs) -> dict[str, Any]:
    """JSON: bounds on normal and position (metres) per object index (as text), and on the film position of silhouettes (pixels)."""
    view = view_of(case.scene.camera, case.scene.film)
    bounds = {index: _bounds(case, view, index, knobs) for index in range(len(case.scene.objects))}
    # an error of position moves the border of a cone by at most as much as it moves the point
    spots = any(isinstance(light, SpotLight) for light in case.scene.lights.values())
    cones = max((position * _pixels_per_metre(case, view, index) for index, (_, position, _) in bounds.items()), default=0.0) if spots else 0.0
    return {
        "normal": {str(index): normal for index, (normal, _, _) in bounds.items() if normal > 0},
        "position_m": {str(index): position for index, (_, position, _) in bounds.items() if position > 0},
        "film_px": cones + float(max((film for _, _, film in bounds.values()), default=0.0)),
    }


def _bounds(case: Case, view: View, index: int, knobs: VtkKnobs) -> tuple[float, float, float]:
    """(normal, position in metres, film position in pixels) of one object."""
    obj, segments = case.scene.objects[index], knobs.tessellation
    placed = matrix(obj) if obj.transform else None
    if isinstance(obj, Mesh) and case.meshes[index].vertex_normals is not None:
        return _smooth_mesh(view, towards_eye(view, build(case, index, view, knobs)), film_rounding_px(case.scene.film))
    if isinstance(obj, Sphere):
        return _sphere(view, obj, segments, placed)
    if isinstance(obj, Cylinder):
        return _cylinder(view, obj, segments, placed)
    if isinstance(obj, Disc):
        scale = film_scale(view, placed, np.asarray(obj.center), obj.radius)
        return 0.0, 0.0, _chord_px(2 * math.pi / sectors(segments, obj.radius, scale), obj.radius * scale.large)
    return 0.0, 0.0, 0.0


def _pixels_per_metre(case: Case, view: View, index: int) -> float:
    """On the film, where the object is nearest to the eye."""
    points, around = _enclosure(case, index, case.scene.objects[index])
    placed = matrix(case.scene.objects[index])
    identity = np.eye(4)
    world = points @ placed[:3, :3].T + placed[:3, 3]
    return float(film_scale(view, identity, world, around * _largest_factor(placed)).large) if len(points) else 0.0


def _chord_px(step: float, radius_px: float) -> float:
    """How far the chord of an angle stays off its circle."""
    return radius_px * step**2 / 8


def _sphere(view: View, obj: Sphere, segments: int, placed: Floats | None) -> tuple[float, float, float]:
    axes, meridian, counts = sphere_division(view, obj.center, obj.radius, segments, placed)
    scale = sphere_scale(view, obj.center, obj.radius, placed)
    across = 2 * np.pi * np.sin(meridian.angles) / counts
    sees_back = cut_by_eye_plane(view, obj.center, obj.radius, placed) or meridian.rim == len(meridian.angles) - 1
    last = len(meridian.angles) - 1 if sees_back else meridian.rim
    normal, position = _facets(meridian, across, last, _rounding(view, obj.radius * scale.small))
    turn = 2 * np.pi * np.arange(64) / 64
    edge, inner = (
        np.asarray(obj.center)
        + obj.radius * (np.sin(a) * (np.cos(turn)[:, None] * axes[0] + np.sin(turn)[:, None] * axes[1]) + np.cos(a) * axes[2])
        for a in _rim_angles(meridian)
    )
    film = _film_distance(view, placed, edge, inner) + _chord_px(float(across[meridian.rim]), obj.radius * scale.large)
    return _with_gates(normal, position * obj.radius, film, obj.radius, scale, placed)


def _cylinder(view: View, obj: Cylinder, segments: int, placed: Floats | None) -> tuple[float, float, float]:
    axes, half = cylinder_division(view, obj.base, obj.top, obj.radius, segments, placed)
    scale = film_scale(view, placed, np.stack([obj.base, obj.top]), obj.radius)
    normal, position = _facets(half, np.zeros(len(half.angles)), len(half.angles) - 1, _rounding(view, obj.radius * scale.small))
    base, top = np.asarray(obj.base), np.asarray(obj.top)
    along = base + np.linspace(0, 1, 33)[:, None] * (top - base)
    film = 0.0
    for side in (1, -1):
        edge, inner = (along + obj.radius * (np.cos(a) * axes[0] + side * np.sin(a) * axes[1]) for a in _rim_angles(half))
        film = max(film, _film_distance(view, placed, edge, inner))
    film += _chord_px(float(np.max(np.diff(half.angles))), obj.radius * scale.large)
    # along the axis a ray goes on for as long as it is between facet and circle
    return _with_gates(normal, position * obj.radius * _slant(view, axes[2], placed, along), film, obj.radius, scale, placed)


def _with_gates(
    normal: float, position: float, film: float, radius: float, scale: Scale, placed: Floats | None
) -> tuple[float, float, float]:
    """Object space → world; and how far the terminator, N·L = 0, is displaced on the film.

    N turns by 1/radius per length, so an error of N moves the terminator by radius times as much.
    """
    film += normal * radius * scale.large
    return normal * scale.stretch, position * _largest_factor(placed), film


def _rounding(view: View, radius_px: float) -> float:
    """What rounding on the film does to a position on a round surface that is seen straight on, in radii."""
    return 8 * U * max(view.width, view.height) / radius_px


def _facets(division: Round, across: Floats, last: int, rounding: float) -> tuple[float, float]:
    """Largest error of the normal and of the position, unit radius, over the facets that the bounds cover: see `kit.round`."""
    k = np.arange(last)
    k = k[(k < division.rim - RIM_STRIPS) | (k >= division.rim + RIM_STRIPS)] if division.rim < len(division.angles) - 1 else k
    if len(k) == 0:
        return 0.0, 0.0
    sagitta = (np.diff(division.angles)[k] ** 2 + np.maximum(across[k], across[k + 1]) ** 2) / 8
    steepness = np.maximum(division.steepness[k], division.steepness[k + 1])
    slant = np.sqrt(1 + steepness**2)
    return float(np.max(sagitta * steepness + rounding * slant)), float(np.max((sagitta + rounding) * slant))


def _smooth_mesh(view: View, mesh: kit.Mesh, rounding_px: float) -> tuple[float, float, float]:
    """Corners displaced on the film take their normals with them: how fast do normals change on the film?"""
    x, y, depth = seen_from(view, mesh.points).T
    over = np.where(depth > 0, 1.0 if view.parallel else depth, np.nan)
    film = np.stack([x / over, y / over], axis=1)[mesh.triangles] * view.pixels_per_unit
    normals = (mesh.normals / np.linalg.norm(mesh.normals, axis=1, keepdims=True))[mesh.triangles]
    sides, turns = (np.linalg.norm(v - np.roll(v, 1, axis=1), axis=2).max(axis=1) for v in (film, normals))
    u, v = film[:, 1] - film[:, 0], film[:, 2] - film[:, 0]
    height = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / np.maximum(sides, 1e-300)
    steepest = np.nanmax(turns / np.maximum(height, SLIVER_PX), initial=0.0)
    return float(rounding_px * steepest), 0.0, SLIVER_PX / 2


def _rim_angles(division: Round) -> tuple[float, float]:
    if division.rim == len(division.angles) - 1:
        return float(division.angles[-1]), float(division.angles[-1])
    return float(division.angles[division.rim]), float(division.angles[max(division.rim - RIM_STRIPS, 0)])


def _film_distance(view: View, placed: Floats | None, edge: Floats, inner: Floats) -> float:
    """Largest distance on the film, pixels, from points near an edge to the edge, of those the film shows.

    edge, inner: (n, 3) in object space, points that belong together; `edge` runs along the edge.
    """
    films, shown = [], np.zeros(len(edge), dtype=bool)
    for points in (edge, inner):
        if placed is not None:
            points = points @ placed[:3, :3].T + placed[:3, 3]
        x, y, depth = seen_from(view, points - view.eye).T
        over = np.where(depth > 0, 1.0 if view.parallel else depth, np.nan)
        films.append(np.stack([x / over, y / over], axis=1))
        shown |= (depth > 0) & (abs(x) <= 1.1 * view.half_width * over) & (abs(y) <= 1.1 * view.half_height * over)
    along, across = np.gradient(films[0], axis=0), films[1] - films[0]
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = np.abs(along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0]) / np.linalg.norm(along, axis=1)
    distance = np.where(np.isfinite(distance), distance, np.linalg.norm(across, axis=1))[shown]
    return float(np.nanmax(distance, initial=0.0) * view.pixels_per_unit)


def _slant(view: View, axis: Floats, placed: Floats | None, along: Floats) -> float:
    """1 / sin of the smallest angle between a cylinder's axis and the rays that meet it, limited to 100."""
    linear, shift = (np.eye(3), np.zeros(3)) if placed is None else (placed[:3, :3], placed[:3, 3])
    inverse = np.linalg.inv(linear)
    rays = (inverse @ view.forward)[None] if view.parallel else along - inverse @ (view.eye - shift)
    cosine = np.max(np.abs(rays @ axis) / np.linalg.norm(rays, axis=1))
    return float(1 / math.sqrt(max(1 - min(cosine, 1.0) ** 2, 1e-4)))


def _largest_factor(placed: Floats | None) -> float:
    return 1.0 if placed is None else float(np.linalg.svd(placed[:3, :3], compute_uv=False)[0])


def reach_of(case: Case, index: int) -> float:
    """How far from the eye the points of an object are, metres; inf for a plane."""
    obj = case.scene.objects[index]
    points, around = _enclosure(case, index, obj)
    placed = matrix(obj)
    away = points @ placed[:3, :3].T + (placed[:3, 3] - np.asarray(case.scene.camera.eye))
    return float(np.max(np.linalg.norm(away, axis=1), initial=0.0)) + around * _largest_factor(placed)


def _enclosure(case: Case, index: int, obj: Any) -> tuple[Floats, float]:
    """Points such that the object lies within their convex hull widened by a length, in object space."""
    if isinstance(obj, Sphere | Disc):
        return np.array([obj.center]), obj.radius
    if isinstance(obj, Cylinder):
        return np.array([obj.base, obj.top]), obj.radius
    if isinstance(obj, Box):
        return np.stack(np.meshgrid(*zip(obj.min, obj.max, strict=True)), axis=-1).reshape(-1, 3), 0.0
    if isinstance(obj, Rectangle):
        corner, u, v = (np.asarray(x) for x in (obj.corner, obj.edge_u, obj.edge_v))
        return np.stack([corner, corner + u, corner + v, corner + u + v]), 0.0
    if isinstance(obj, Mesh):
        return case.meshes[index].vertices, 0.0
    return np.zeros((0, 3)), math.inf


def set_back_of(case: Case, knobs: VtkKnobs) -> dict[str, float]:
    """How far, in metres, coincident objects are drawn from where they are, per object index (as text); see `kit.depth.set_back`."""
    steps = set_backs(case)
    if not any(steps):
        return {}
    view = view_of(case.scene.camera, case.scene.film)
    meshes = [build(case, index, view, knobs) for index in range(len(steps))]
    moved = set_back(view, meshes, steps)
    return {
        str(index): float(np.max(np.linalg.norm(after.points - in_frame(view, before).points, axis=1), initial=0.0))
        for index, (before, after) in enumerate(zip(meshes, moved, strict=True))
        if steps[index]
    }


def horizon_of(case: Case) -> float:
    """Where a flat surface may be seen to its horizon: how far rounding on the film moves radiance there, as a share of the largest.

    At d pixels from the horizon depth is off by ε/d of itself, ε being the rounding on the film, so radiance by 2 ε/d at most (inverse
    square). Radiance falls off towards the horizon at least like d, where it depends on depth at all: 2 ε/D of the largest radiance is
    enough at every d, D being the film's reach from the horizon.
    """
    camera, film = case.scene.camera, case.scene.film
    if camera.projection != "perspective":
        return 0.0
    view, share = view_of(camera, film), 0.0
    x, y = view.half_width, view.half_height
    corners = view.forward + np.array([[x, y], [x, -y], [-x, y], [-x, -y]]) @ np.stack([view.right, view.up])
    for index, obj in enumerate(case.scene.objects):
        _, normals = flats(case, index, obj)
        for normal in normals @ np.linalg.inv(matrix(obj)[:3, :3]):
            side, slope = corners @ normal, np.hypot(normal @ view.right, normal @ view.up)
            if np.min(side) < 0 < np.max(side):
                reach_px = max(np.max(side), -np.min(side)) / slope * view.pixels_per_unit
                share = max(share, 2 * film_rounding_px(film) / reach_px)
    return float(share)
