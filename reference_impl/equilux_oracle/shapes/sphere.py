"""Ray against sphere."""

from __future__ import annotations

import numpy as np

from equilux_oracle.doubledouble import DD, Bools, dot
from equilux_oracle.shapes.crossing import Meeting, Primitive
from equilux_scenes.model import Sphere


def sphere(shape: Sphere) -> Primitive:
    """|o + t d|² = r², o measured from the centre.

    The foot of the centre's perpendicular is at t_m = −(o·d)/|d|², at distance h = |o + t_m d|; the crossings are at
    t_m ± √((r² − h²)/|d|²). That avoids the difference of squares b² − ac of the textbook, which cancels on small far spheres.
    The normal is the hit point itself.
    """
    radius = shape.radius

    def meet(origin: DD, direction: DD) -> Meeting:
        dd = dot(direction, direction)
        middle = -(dot(origin, direction) / dd)
        foot = origin + direction * middle
        inside = DD(radius) * radius - dot(foot, foot)
        half = (inside / dd).sqrt()
        meets = inside.hi >= 0.0

        def normal(t: DD, last: Bools) -> DD:
            return origin + direction * t

        return Meeting((middle - half, middle + half), (meets, meets), normal)

    return Primitive(np.asarray(shape.center), radius, meet, 1.0 / radius)
