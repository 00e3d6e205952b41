"""The axes that there are, a family per file. A new one is an `Axis` in its family's `AXES`."""

from __future__ import annotations

from equilux.extremes.axes import gap, light, material, space, transport, triangles
from equilux.extremes.axis import Axis, by_name

AXES: tuple[Axis, ...] = (*space.AXES, *gap.AXES, *triangles.AXES, *light.AXES, *material.AXES, *transport.AXES)
"""Every axis, in the order of reports."""

BY_NAME = by_name(AXES)
