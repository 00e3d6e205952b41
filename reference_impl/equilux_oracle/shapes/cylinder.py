"""Ray against a cylinder: a tube about its axis, cut by two planes, with or without caps."""

from __future__ import annotations

import numpy as np

from equilux_oracle.doubledouble import DD, Bools, dot, vector, where
from equilux_oracle.shapes.box import slab
from equilux_oracle.shapes.crossing import Meeting, Primitive, vanishes
from equilux_scenes.model import Cylinder

_FAR = 1e300


def cylinder(shape: Cylinder) -> Primitive:
    """Origins measured from the base, axis a = top − base.

    Across the axis (d_⊥ = d − (d·a/a·a) a, o_⊥ likewise) the tube is a circle, met as a sphere is; along it, the ray is between
    the end planes where 0 ≤ (o + t d)·a ≤ a·a. Capped, the solid is where both hold: entry and exit of the intersection of two
    intervals. Uncapped, either crossing of the tube counts whose point lies between the end planes, the nearer first.
    """
    axis = vector(shape.top) - vector(shape.base)
    axis2 = dot(axis, axis)
    squared_radius = DD(shape.radius) * shape.radius

    def meet(origin: DD, direction: DD) -> Meeting:
        o_across, d_across = _across(origin, axis, axis2), _across(direction, axis, axis2)
        parallel = vanishes(dot(d_across, d_across), dot(direction, direction))
        inside, near, far = _tube(o_across, d_across, parallel, squared_radius)
        o_along, d_along = dot(origin, axis), dot(direction, axis)
        if not shape.capped:
            between = [inside & _between(t, o_along, d_along, axis2) for t in (near, far)]
            return Meeting((near, far), (between[0], between[1]), lambda t, last: o_across + d_across * t)
        start, end = slab(o_along, d_along, axis2, len(inside))
        enters_tube, leaves_tube = near >= start, far <= end
        entry, exit_ = where(enters_tube, near, start), where(leaves_tube, far, end)
        meets = inside & (entry <= exit_)

        def normal(t: DD, last: Bools) -> DD:
            on_tube = np.where(last, leaves_tube, enters_tube)
            cap = axis * np.where(last == (d_along.hi > 0.0), 1.0, -1.0)
            return where(on_tube, o_across + d_across * t, cap)

        return Meeting((entry, exit_), (meets, meets), normal)

    reach = float(np.linalg.norm(axis.hi)) + shape.radius
    return Primitive(np.asarray(shape.base), reach, meet, 1.0 / shape.radius)


def _across(v: DD, axis: DD, axis2: DD) -> DD:
    return v - axis * (dot(v, axis) / axis2)


def _tube(o: DD, d: DD, parallel: Bools, squared_radius: DD) -> tuple[Bools, DD, DD]:
    """Whether the ray meets the endless tube, and where it is inside: everywhere or nowhere for a ray along the axis."""
    dd = dot(d, d)
    middle = -(dot(o, d) / dd)
    foot = o + d * middle
    within = squared_radius - dot(foot, foot)
    half = (within / dd).sqrt()
    near, far = middle - half, middle + half
    count = np.broadcast_shapes(o.hi.shape, d.hi.shape)[1]
    along = np.broadcast_to(parallel, (count,))
    inside = np.where(along, (squared_radius - dot(o, o)).hi >= 0.0, within.hi >= 0.0)
    end = DD(np.full(count, _FAR))
    return inside, where(along, -end, near), where(along, end, far)


def _between(t: DD, o_along: DD, d_along: DD, axis2: DD) -> Bools:
    """Whether the tube's crossing lies between the end planes; not for a ray along the axis."""
    crosses = np.abs(t.hi) < _FAR
    along = o_along + d_along * where(crosses, t, DD(-1.0))
    return crosses & (along.hi >= 0.0) & (along <= axis2)
