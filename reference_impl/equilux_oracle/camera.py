"""Camera rays, in double-double and relative to the eye.

With f = unit(target − eye), r = unit(f × up), u = r × f, a film position (x, y) in pixels, (0.5, 0.5) being the centre of the
top left pixel, has the film coordinates

    X = (2x/W − 1)(W/H) s,    Y = (1 − 2y/H) s,    s = tan(fov_y/2) or height_m/2

Perspective: every ray starts at the eye and runs along f + X r + Y u. Orthographic: the ray starts at eye + X r + Y u and runs
along f. Directions are not normalised: a ray's parameter t counts depth along f, and is the same in world and object space.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equilux_oracle.constants import tan_half_angle
from equilux_oracle.doubledouble import DD, Array, Index, cross, direction, unit, vector
from equilux_scenes.model import Film, OrthographicCamera, PerspectiveCamera


@dataclass(frozen=True)
class Rays:
    """n rays: point(t) = eye + offset + t · direction. Each vector is (3, n), or (3, 1) where all rays share it."""

    offset: DD
    direction: DD
    count: int

    def __getitem__(self, index: Index) -> Rays:
        chosen = np.arange(self.count)[index]
        return Rays(_pick(self.offset, chosen), _pick(self.direction, chosen), len(chosen))


def _pick(v: DD, chosen: Index) -> DD:
    return v if v.hi.shape[1] == 1 else v[:, chosen]


def film_rays(camera: PerspectiveCamera | OrthographicCamera, film: Film, film_xy: Array) -> Rays:
    """Rays through film positions (n, 2) in pixels."""
    right, up, forward = camera_frame(camera)
    half = tan_half_angle(camera.fov_y_deg) if isinstance(camera, PerspectiveCamera) else DD(camera.height_m) * 0.5
    w, h = float(film.width), float(film.height)
    across = (DD(film_xy[:, 0]) * 2.0 - w) / h * half
    upward = (h - DD(film_xy[:, 1]) * 2.0) / h * half
    on_film = right * across + up * upward
    if isinstance(camera, PerspectiveCamera):
        return Rays(vector((0.0, 0.0, 0.0)), on_film + forward, len(film_xy))
    return Rays(on_film, forward, len(film_xy))


def camera_frame(camera: PerspectiveCamera | OrthographicCamera) -> tuple[DD, DD, DD]:
    """right, up, forward: unit vectors (3, 1), right = forward × up."""
    forward = unit(vector(camera.target) - vector(camera.eye))
    right = unit(cross(forward, direction(camera.up)))
    return right, cross(right, forward), forward
