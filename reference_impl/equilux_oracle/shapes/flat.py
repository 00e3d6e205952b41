"""Ray against the flat primitives: plane, disc, rectangle.

(o + t d)·n = 0, o measured from a point of the plane: t = −(o·n)/(d·n); no crossing where the ray runs along
the plane. The borders of disc and rectangle belong to them, and so does what lies beyond by no more than rounding: a ray through
the crease of two walls that share an edge meets one of them.
"""

from __future__ import annotations

import numpy as np

from equilux_oracle.doubledouble import DD, Array, Bools, cross, dot, vector
from equilux_oracle.doubledouble import direction as directed
from equilux_oracle.shapes.crossing import Meeting, Primitive, each_ray, vanishes
from equilux_scenes.model import Disc, Plane, Rectangle

BORDER = 2.0**-90
"""A border is met within this share of the numbers involved: some thousand times what double-double rounds, and nothing beside
the 2^-50 that decide ties."""


def plane(shape: Plane) -> Primitive:
    """The whole plane through `point`."""
    normal = directed(shape.normal)

    def meet(origin: DD, direction: DD) -> Meeting:
        hit, t = _cross_plane(origin, direction, normal)
        return _once(hit, t, normal)

    return Primitive(np.asarray(shape.point), np.inf, meet)


def disc(shape: Disc) -> Primitive:
    """|P − center| ≤ radius."""
    normal = directed(shape.normal)

    def meet(origin: DD, direction: DD) -> Meeting:
        hit, t = _cross_plane(origin, direction, normal)
        point = origin + direction * t
        beyond = dot(point, point) - DD(shape.radius) * shape.radius
        hit = hit & (beyond.hi <= BORDER * shape.radius * _reach(origin, direction, t))
        return _once(hit, t, normal)

    return Primitive(np.asarray(shape.center), shape.radius, meet)


def rectangle(shape: Rectangle) -> Primitive:
    """P = corner + a edge_u + b edge_v with 0 ≤ a, b ≤ 1; the edges are orthogonal, so a = (P − corner)·edge_u / |edge_u|²."""
    edges = vector(shape.edge_u), vector(shape.edge_v)
    normal = cross(*edges)

    def meet(origin: DD, direction: DD) -> Meeting:
        hit, t = _cross_plane(origin, direction, normal)
        point = origin + direction * t
        for edge in edges:
            along = dot(point, edge)
            slack = BORDER * np.sqrt(dot(edge, edge).hi) * _reach(origin, direction, t)
            hit = hit & (along.hi >= -slack) & ((along - dot(edge, edge)).hi <= slack)
        return _once(hit, t, normal)

    return Primitive(np.asarray(shape.corner), float(np.linalg.norm(shape.edge_u) + np.linalg.norm(shape.edge_v)), meet)


def _reach(origin: DD, direction: DD, t: DD) -> Array:
    """How large the numbers are of which the point of crossing is the sum: its rounding is relative to them."""
    largest: Array = np.max(np.abs(origin.hi), axis=0) + np.abs(t.hi) * np.max(np.abs(direction.hi), axis=0)
    return largest


def _cross_plane(origin: DD, direction: DD, normal: DD) -> tuple[Bools, DD]:
    towards = dot(direction, normal)
    crosses = ~vanishes(towards * towards, dot(direction, direction) * dot(normal, normal))
    return crosses, -(dot(origin, normal) / towards)


def _once(hit: Bools, t: DD, normal: DD) -> Meeting:
    return Meeting((t,), (np.broadcast_to(hit, t.hi.shape),), lambda t, last: each_ray(normal, len(last)))
