"""Flat faces and meshes are drawn as they are, but rounding on the film shifts what is interpolated over them: the more, the more
edge-on they are seen and the faster normals turn."""

from __future__ import annotations

import numpy as np

from equilux.adapter import Case
from equilux_adapters._triangles.bounds import Bounds, Floats, on_film, rounding_px, view_of
from equilux_adapters._triangles.clip import in_frame
from equilux_adapters._triangles.coincident import flats
from equilux_adapters._triangles.facing import towards_eye
from equilux_adapters._triangles.view import Mesh, View
from equilux_scenes.transforms import matrix

SLIVER_PX = 1 / 16
"""Faces and triangles that are thinner on the film are left to the film position: the edge of one is never farther than half of
this from a pixel that shows it."""


def of_faces(view: View, mesh: Mesh, reach_m: float) -> Bounds:
    """Bounds on the position on flat faces, of which nothing farther than `reach_m` matters (see `budget`).

    A shift by ε on the film moves the point that is seen by ε (metres per pixel) / cos i; in perspective, at depth w on a plane
    that passes the eye at distance h, that is ε w² / (h · pixels per unit).
    """
    seen = in_frame(view, towards_eye(view, mesh))
    if len(seen.triangles) == 0:
        return Bounds()
    corners = seen.points[seen.triangles]
    film, depth = on_film(view, corners)
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = across / np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-300)
    _, face = np.unique(np.round(normals, 9), axis=0, return_inverse=True)
    thickness = np.zeros(len(corners))
    np.maximum.at(thickness, face.reshape(-1), _thickness(film))
    thick = thickness[face.reshape(-1)] >= SLIVER_PX
    if view.parallel:
        metres = 1 / np.maximum(np.abs(normals @ view.forward), 1e-300)
    else:
        metres = np.minimum(depth.max(axis=1), reach_m) ** 2 / np.maximum(np.abs(np.sum(normals * corners[:, 0], axis=1)), 1e-300)
    shift = rounding_px(view) / view.pixels_per_unit * np.max(metres, initial=0.0, where=thick)
    return Bounds(position_m=float(shift), film_px=0.0 if thick.all() else SLIVER_PX / 2)


def of_smooth_mesh(view: View, mesh: Mesh) -> Bounds:
    """Bounds on interpolated normals: how fast do they change on the film?"""
    seen = towards_eye(view, mesh)
    film, _ = on_film(view, seen.points[seen.triangles])
    normals = (seen.normals / np.linalg.norm(seen.normals, axis=1, keepdims=True))[seen.triangles]
    turns = np.linalg.norm(normals - np.roll(normals, 1, axis=1), axis=2).max(axis=1)
    steepest = np.nanmax(turns / np.maximum(_thickness(film), SLIVER_PX), initial=0.0)
    return Bounds(normal=float(rounding_px(view) * steepest), film_px=SLIVER_PX / 2)


def _thickness(film: Floats) -> Floats:
    """(m,) the smallest height of triangles (m, 3, 2), pixels."""
    longest = np.linalg.norm(film - np.roll(film, 1, axis=1), axis=2).max(axis=1)
    u, v = film[:, 1] - film[:, 0], film[:, 2] - film[:, 0]
    height: Floats = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / np.maximum(longest, 1e-300)
    return height


def horizon_of(case: Case) -> float:
    """Where a flat surface may be seen to its horizon: how far rounding on the film moves radiance, as a share of the largest.

    At d pixels from the horizon depth is off by ε/d of itself, ε being the rounding on the film, so radiance by 2 ε/d at most
    (inverse square). Radiance falls off towards the horizon at least like d, where it depends on depth at all: 2 ε/D of the
    largest radiance is enough at every d, D being the film's reach from the horizon.
    """
    camera, film = case.scene.camera, case.scene.film
    if camera.projection != "perspective":
        return 0.0
    view, share = view_of(camera, film), 0.0
    x, y = view.half_width, view.half_height
    corners = view.forward + np.array([[x, y], [x, -y], [-x, y], [-x, -y]]) @ np.stack([view.right, view.up])
    for index, obj in enumerate(case.scene.objects):
        _, normals = flats(case, index, obj)
        sides = corners @ (normals @ np.linalg.inv(matrix(obj)[:3, :3])).T
        slopes = np.hypot(*(normals @ np.linalg.inv(matrix(obj)[:3, :3]) @ np.stack([view.right, view.up], axis=1)).T)
        seen = (sides.min(axis=0, initial=np.inf) < 0) & (sides.max(axis=0, initial=-np.inf) > 0)
        reach_px = np.abs(sides).max(axis=0)[seen] / slopes[seen] * view.pixels_per_unit
        share = max(share, float(np.max(2 * rounding_px(view) / reach_px, initial=0.0)))
    return share
