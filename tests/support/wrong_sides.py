"""Where interpolated normals of a transparent mesh send a ray to the wrong side of the face it meets."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from equilux_scenes.case import Case
from support.plain_phong import rays
from support.plain_raytraced import OWN_CROSSING, _dot, _nearest, _size, _unit


def wrong_sides(case: Case, film_xy: npt.ArrayLike) -> npt.NDArray[np.bool_]:
    """(n, 2) pixels → (n,): whether on any path from there N faces away from the viewer, the mirrored ray goes into the face, or
    the refracted one does not go through it. Nothing but object 0 mirrors or lets light through.
    """
    origin, direction = rays(case, np.asarray(film_xy, dtype=float).reshape(-1, 2))
    direction = _unit(direction)
    owner, found, start = np.arange(len(origin)), np.zeros(len(origin), dtype=bool), 0.0
    ior = case.scene.materials[case.scene.objects[0].material].ior
    for _ in range(case.scene.recursion_limit + 1):
        hits = _nearest(case, origin, direction, start)
        start = OWN_CROSSING * _size(case)
        at = np.flatnonzero(hits.object_id == 0)
        d, own = direction[at], owner[at]
        outside = _dot(hits.geometric[at], d) < 0
        face = _unit(np.where(outside, hits.geometric[at], -hits.geometric[at]))
        normal = _unit(np.where(_dot(hits.shading[at], face) < 0, -hits.shading[at], hits.shading[at]))
        eta, cosine = np.where(outside, 1 / ior, ior), -_dot(normal, d)
        rest = 1 - eta**2 * (1 - cosine**2)
        total = rest[:, 0] < 0
        mirrored = d + 2 * cosine * normal
        refracted = eta * d + (eta * cosine - np.sqrt(np.maximum(rest, 0))) * normal
        wrong = (cosine < 0) | (_dot(mirrored, face) <= 0) | (~total[:, None] & (_dot(refracted, face) >= 0))
        found[own[wrong[:, 0]]] = True
        point = origin[at] + hits.t[at, None] * d
        origin = np.concatenate([point, point[~total]])
        direction = np.concatenate([mirrored, refracted[~total]])
        owner = np.concatenate([own, own[~total]])
    return found


