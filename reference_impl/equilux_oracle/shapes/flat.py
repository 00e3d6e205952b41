"""Ray against the flat primitives: plane, disc, rectangle.

(o + t d)·n = 0, o measured from a point of the plane: t = −(o·n)/(d·n); no crossing where the ray runs along
the plane. The borders of disc and rectangle belong to them.
"""

from __future__ import annotations

import numpy as np

from equilux_oracle.doubledouble import DD, Bools, cross, dot, vector
from equilux_oracle.doubledouble import direction as directed
from equilux_oracle.shapes.crossing import Meeting, Primitive, each_ray, vanishes
from equilux_scenes.model import Disc, Plane, Rectangle


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
        hit = hit & (dot(point, point) <= DD(shape.radius) * shape.radius)
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
            hit = hit & (along.hi >= 0.0) & (along <= dot(edge, edge))
        return _once(hit, t, normal)

    return Primitive(np.asarray(shape.corner), float(np.linalg.norm(shape.edge_u) + np.linalg.norm(shape.edge_v)), meet)


def _cross_plane(origin: DD, direction: DD, normal: DD) -> tuple[Bools, DD]:
    towards = dot(direction, normal)
    crosses = ~vanishes(towards * towards, dot(direction, direction) * dot(normal, normal))
    return crosses, -(dot(origin, normal) / towards)


def _once(hit: Bools, t: DD, normal: DD) -> Meeting:
    return Meeting((t,), (np.broadcast_to(hit, t.hi.shape),), lambda t, last: each_ray(normal, len(last)))
