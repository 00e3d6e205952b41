"""What of a light comes through the objects between it and a point.

Crossings strictly between the point and the light count, a directional light being at infinity, the point's own object included
and the point itself not. An object with t = 0 lets nothing through; each crossing of one with t > 0 multiplies the light, band by
band, by t k_trans, or does nothing where transparent objects cast no shadows. The way to the light is straight.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from equilux_oracle.camera import Rays
from equilux_oracle.doubledouble import DD, Array, Bools
from equilux_oracle.visibility import TIE, Body
from equilux_scenes.model import Scene

Indices = npt.NDArray[np.int64]

ROUNDINGS = 4.0
"""Of one object's factor, in u: t k_trans once, its square once more for both factors, the product with the rest."""


def share_per_crossing(scene: Scene) -> Array:
    """What one crossing of each object leaves of the light, bands (3, k)."""
    shares = []
    for shape in scene.objects:
        material = scene.materials[shape.material]
        ignored = material.transparency > 0 and scene.transparent_shadows == "ignore"
        shares.append(np.ones(3) if ignored else material.transparency * np.asarray(material.transmission))
    return np.stack(shares, axis=1)


def let_through(
    objects: list[Body],
    shares: Array,
    point: DD,
    to_light: DD,
    eye_distance: float,
    left: Indices | None = None,
    *,
    finite: bool,
) -> tuple[Array, Array, Bools]:
    """τ (3, n) at points relative to the eye, a bound on its relative error in u, and where it hangs on how coincidence is
    defined, (n,) each.

    to_light: vectors to the light, which is at their ends if `finite`, else at infinity. left: the objects that the points are
    on.
    """
    count = point.hi.shape[1]
    tau, error, undecided = np.ones((3, count)), np.zeros(count), np.zeros(count, dtype=bool)
    length = np.sqrt(np.sum(to_light.hi**2, axis=0))
    coordinates = eye_distance + np.sqrt(np.sum(point.hi**2, axis=0))
    start = TIE * coordinates / length
    end = 1.0 - TIE * (coordinates + length) / length if finite else np.full(count, np.inf)
    rays = Rays(point, to_light, count)
    open_ways = np.arange(count)
    # Opaque objects first: what they stop needs no further question.
    for index in np.argsort(np.any(shares > 0.0, axis=0), kind="stable"):
        share = shares[:, index]
        if np.all(share == 1.0):
            continue
        near = open_ways[objects[index].passes(rays[open_ways], start[open_ways], end[open_ways])]
        if len(near) == 0:
            continue
        meeting = objects[index].meet(rays[near])
        number = meeting.number_between(start[near], end[near])
        own = np.zeros(len(near), dtype=bool) if left is None else left[near] == index
        undecided[near] |= meeting.close_to(start[near], own)
        tau[:, near] *= share[:, np.newaxis] ** number
        error[near] += ROUNDINGS * (number > 0.0)
        open_ways = open_ways[np.any(tau[:, open_ways] > 0.0, axis=0)]
    return tau, error, undecided
