"""Crossings of rays with each primitive: where they are, which come first, and which way the normal points."""

from __future__ import annotations

import numpy as np
import pytest

from equilux_oracle.doubledouble import DD
from equilux_oracle.shapes import primitive_of
from equilux_scenes.model import Box, Cylinder, Disc, Plane, Rectangle, Sphere

SPHERE = Sphere(kind="sphere", material="m", center=(0.0, 0.0, 0.0), radius=2.0)
BOX = Box(kind="box", material="m", min=(-1.0, -2.0, -3.0), max=(1.0, 2.0, 3.0))
OPEN = Cylinder(kind="cylinder", material="m", base=(0.0, 0.0, 0.0), top=(0.0, 0.0, 4.0), radius=1.0, capped=False)
CAPPED = OPEN.model_copy(update={"capped": True})
DISC = Disc(kind="disc", material="m", center=(0.0, 0.0, 1.0), normal=(0.0, 0.0, 5.0), radius=2.0)
CARD = Rectangle(kind="rectangle", material="m", corner=(0.0, 0.0, 1.0), edge_u=(2.0, 0.0, 0.0), edge_v=(0.0, 3.0, 0.0))
PLANE = Plane(kind="plane", material="m", point=(7.0, 7.0, 1.0), normal=(0.0, 0.0, 1.0))


def cross(shape, origin, direction):
    """Of one ray: t and the unit outward normal, or None."""
    primitive = primitive_of(shape)
    start, way = np.array(origin, float)[:, None] - primitive.anchor[:, None], np.array(direction, float)[:, None]
    with np.errstate(all="ignore"):  # what misses leaves behind is never looked at
        crossing = primitive.cross(DD(start), DD(way))
    if not crossing.hit[0]:
        return None
    normal = crossing.normal.hi[:, 0]
    return crossing.t.hi[0].item(), (normal / np.linalg.norm(normal)).round(15).tolist()


@pytest.mark.parametrize(
    ("shape", "origin", "direction", "t", "normal"),
    [
        (SPHERE, (0, 0, 5), (0, 0, -1), 3.0, [0, 0, 1]),
        (SPHERE, (0, 0, 5), (0, 0, -2), 1.5, [0, 0, 1]),
        (SPHERE, (0, 0, 0), (0, 1, 0), 2.0, [0, 1, 0]),  # from inside: the far side, still the outward normal
        (BOX, (5, 0, 0), (-1, 0, 0), 4.0, [1, 0, 0]),
        (BOX, (-5, 0, 0), (1, 0, 0), 4.0, [-1, 0, 0]),
        (BOX, (0, 5, 0), (0, -1, 0), 3.0, [0, 1, 0]),
        (BOX, (0, -5, 0), (0, 1, 0), 3.0, [0, -1, 0]),
        (BOX, (0, 0, 5), (0, 0, -1), 2.0, [0, 0, 1]),
        (BOX, (0, 0, -5), (0, 0, 1), 2.0, [0, 0, -1]),
        (BOX, (0, 0, 0), (0, 0, 1), 3.0, [0, 0, 1]),
        (BOX, (0, 0, 0), (0, -1, 0), 2.0, [0, -1, 0]),
        (BOX, (1, 0, 5), (0, 0, -1), 2.0, [0, 0, 1]),  # along a face, in its plane: the faces belong to the box
        (OPEN, (3, 0, 2), (-1, 0, 0), 2.0, [1, 0, 0]),
        (OPEN, (0, 0, 2), (-1, 0, 0), 1.0, [-1, 0, 0]),  # from inside
        (OPEN, (2.5, 0, 6), (-1, 0, -1), 3.5, [-1, 0, 0]),  # over the rim onto the inner wall
        (CAPPED, (2.5, 0, 6), (-1, 0, -1), 2.0, [0, 0, 1]),  # the cap is in the way, at (0.5, 0, 4)
        (CAPPED, (0, 0, 9), (0, 0, -1), 5.0, [0, 0, 1]),
        (CAPPED, (0, 0, -9), (0, 0, 1), 9.0, [0, 0, -1]),
        (CAPPED, (0, 0, 1), (0, 0, 1), 3.0, [0, 0, 1]),  # from inside
        (CAPPED, (0, 0, 1), (0, 0, -1), 1.0, [0, 0, -1]),
        (CAPPED, (0, 3, 2), (0, -1, 0), 2.0, [0, 1, 0]),
        (DISC, (0, 2, 5), (0, 0, -1), 4.0, [0, 0, 1]),  # its border belongs to it
        (CARD, (2, 3, 5), (0, 0, -1), 4.0, [0, 0, 1]),
        (CARD, (0, 0, -5), (0, 0, 1), 6.0, [0, 0, 1]),
        (PLANE, (0, 0, 5), (0, 0, -1), 4.0, [0, 0, 1]),
    ],
)
def test_the_first_crossing_is_at(shape, origin, direction, t, normal):
    assert cross(shape, origin, direction) == (t, normal)


@pytest.mark.parametrize(
    ("shape", "origin", "direction"),
    [
        (SPHERE, (0, 0, 5), (0, 0, 1)),
        (SPHERE, (2.0000001, 0, 5), (0, 0, -1)),
        (BOX, (5, 0, 0), (1, 0, 0)),
        (BOX, (1.0000001, 0, 5), (0, 0, -1)),
        (OPEN, (0, 0, 9), (0, 0, -1)),  # down the tube
        (OPEN, (0.5, 0.5, 9), (0, 0, -1)),
        (OPEN, (3, 0, 5), (-1, 0, 0)),
        (CAPPED, (3, 0, 5), (-1, 0, 0)),
        (CAPPED, (1.0000001, 0, 9), (0, 0, -1)),
        (DISC, (0, 2.0000001, 5), (0, 0, -1)),
        (DISC, (0, 0, 0), (0, 0, -1)),
        (DISC, (-9, 0, 1), (1, 0, 0)),  # edge-on
        (CARD, (2.0000001, 1, 5), (0, 0, -1)),
        (CARD, (1, -1e-7, 5), (0, 0, -1)),
        (PLANE, (0, 0, 5), (1, 0, 0)),
        (PLANE, (0, 0, 1), (1, 1, 0)),  # within it
    ],
)
def test_there_is_no_crossing(shape, origin, direction):
    assert cross(shape, origin, direction) is None


def tilted_pair():
    """A direction, and one upright to it, neither along a coordinate axis."""
    a = np.array([0.3, -0.5, 0.81])
    return a / np.linalg.norm(a), np.array([0.5, 0.3, 0.0])


def test_a_ray_along_a_tilted_axis_is_parallel_in_spite_of_rounding():
    axis, _ = tilted_pair()
    tube = {"kind": "cylinder", "material": "m", "base": (0.0, 0.0, 0.0), "top": tuple(3 * axis), "radius": 1.0}
    assert cross(Cylinder(**tube, capped=False), -5 * axis, 3 * axis) is None
    t, normal = cross(Cylinder(**tube, capped=True), -5 * axis, 3 * axis)
    assert abs(t - 5 / 3) < 1e-15, t
    assert np.allclose(normal, -axis, atol=1e-14), normal


def test_a_ray_along_a_tilted_plane_is_parallel_in_spite_of_rounding():
    _, along = tilted_pair()
    plane = Plane(kind="plane", material="m", point=(0.0, 0.0, 0.0), normal=(0.3, -0.5, 0.81))
    assert cross(plane, (0, 0, 1), along) is None
    assert cross(plane, (0, 0, -1), along) is None


@pytest.mark.parametrize("shape", [SPHERE, BOX, OPEN, CAPPED, DISC, CARD])
def test_hits_lie_on_the_surface_and_inside_the_bounding_sphere(shape):
    rng = np.random.default_rng(7)
    primitive = primitive_of(shape)
    origin = DD(rng.normal(size=(3, 500)) * 4)
    direction = DD(-origin.hi + rng.normal(size=(3, 500)))
    with np.errstate(all="ignore"):
        crossing = primitive.cross(origin, direction)
    assert 20 < crossing.hit.sum() < 500, f"{crossing.hit.sum()} of 500 rays hit"
    point = (origin + direction * crossing.t).hi[:, crossing.hit]
    assert np.linalg.norm(point, axis=0).max() <= primitive.bounding_radius * (1 + 1e-12)
    assert (crossing.t.hi[crossing.hit] > 0).all()
