"""What every bound on displacements is made of: the script's view, what rounding does on its film, and three numbers per
object."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from equilux_adapters._triangles.view import View, look_at, seen_from
from equilux_scenes.model import Camera, Film

Floats = npt.NDArray[np.float64]

U = 2.0**-24
"""Half a unit in the last place of single precision."""


class Bounds(NamedTuple):
    """Of one object: on the unit normal, on the position (metres), and on the place of its edges on the film (pixels)."""

    normal: float = 0.0
    position_m: float = 0.0
    film_px: float = 0.0


def view_of(camera: Camera, film: Film) -> View:
    """The view that the script sets up."""
    axes = look_at(camera.eye, camera.target, camera.up)
    if camera.projection == "perspective":
        return View(**axes, half_height=math.tan(math.radians(camera.fov_y_deg) / 2), width=film.width, height=film.height)
    return View(**axes, half_height=camera.height_m / 2, width=film.width, height=film.height, parallel=True)


def rounding_px(view: View) -> float:
    """How far rounding displaces a corner on the film, and with it what is interpolated: 8 u of the film's size.

    One u each for the corner's coordinates, for the matrix, for their product and for the way from the middle of the film to
    pixels; and four for interpolating by planes that start in a corner of the film.
    """
    return 8 * U * max(view.width, view.height)


def on_film(view: View, points: Floats) -> tuple[Floats, Floats]:
    """Points relative to the eye, (…, 3) → film positions from its middle, (…, 2), pixels, and depths (…). NaN behind the eye
    of a perspective view.
    """
    x, y, depth = seen_from(view, points.reshape(-1, 3)).T
    over = np.ones_like(depth) if view.parallel else np.where(depth > 0, depth, np.nan)
    film = np.stack([x / over, y / over], axis=1) * view.pixels_per_unit
    return film.reshape(*points.shape[:-1], 2), depth.reshape(points.shape[:-1])


def largest_factor(placed: Floats | None) -> float:
    """By how much a transform lengthens at most."""
    return 1.0 if placed is None else float(np.linalg.svd(placed[:3, :3], compute_uv=False)[0])
