"""Ray against an axis-aligned box: the intersection of three slabs."""

from __future__ import annotations

import numpy as np

from equilux_oracle.doubledouble import DD, Bools, where
from equilux_oracle.shapes.crossing import Meeting, Primitive
from equilux_scenes.model import Box

_FAR = 1e300  # an interval that ends nowhere; only ever compared


def box(shape: Box) -> Primitive:
    """Per axis, the ray is between the two faces for t in [near, far]; the box is where all three hold.

    The entry is the largest near, the exit the smallest far; the face that gave it gives the normal. Where two faces are met
    at the same t (an edge of the box), the earlier axis counts.
    """
    low = np.asarray(shape.min)
    size = DD(shape.max) - DD(shape.min)

    def meet(origin: DD, direction: DD) -> Meeting:
        shape_of = np.broadcast_shapes(origin.hi.shape, direction.hi.shape)
        near, far = DD(np.full(shape_of[1], -_FAR)), DD(np.full(shape_of[1], _FAR))
        near_axis, far_axis = np.zeros(shape_of[1], dtype=int), np.zeros(shape_of[1], dtype=int)
        for axis in range(3):
            a, b = slab(origin[axis], direction[axis], size[axis], shape_of[1])
            later, sooner = a > near, b < far
            near, far = where(later, a, near), where(sooner, b, far)
            near_axis, far_axis = np.where(later, axis, near_axis), np.where(sooner, axis, far_axis)
        meets = near <= far

        def normal(t: DD, last: Bools) -> DD:
            axis_hit, ray = np.where(last, far_axis, near_axis), np.arange(shape_of[1])
            along = np.broadcast_to(direction.hi, shape_of)[axis_hit, ray]
            outward = np.zeros(shape_of)
            outward[axis_hit, ray] = np.where((along > 0.0) == last, 1.0, -1.0)
            return DD(outward)

        return Meeting((near, far), (meets, meets), normal)

    return Primitive(low, float(np.linalg.norm(size.hi)), meet)


def slab(origin: DD, direction: DD, size: DD, count: int) -> tuple[DD, DD]:
    """Where origin + t direction lies in [0, size], as an interval of t.

    For a ray along the slab the interval is everything, or nothing (near > far).
    """
    a, b = -(origin / direction), (size - origin) / direction
    backward = direction.hi < 0.0
    near, far = where(backward, b, a), where(backward, a, b)
    along = np.broadcast_to(direction.hi == 0.0, (count,))
    within = np.broadcast_to((origin.hi >= 0.0) & (origin <= size), (count,))
    return _override(near, along, within, -_FAR), _override(far, along, within, _FAR)


def _override(t: DD, along: Bools, within: Bools, end: float) -> DD:
    value = np.where(within, end, -end)
    return DD(np.where(along, value, t.hi), np.where(along, 0.0, t.lo))
