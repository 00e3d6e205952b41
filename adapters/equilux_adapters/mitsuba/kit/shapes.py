"""Placing Mitsuba's unit shapes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mitsuba as mi

Triple = tuple[float, float, float]


def placed(x: Triple, y: Triple, z: Triple, origin: Triple) -> Any:
    """The transform that takes the unit axes to x, y, z and the origin to `origin`."""
    return mi.ScalarTransform4f([[*row] for row in zip(x, y, z, origin, strict=True)] + [[0, 0, 0, 1]])


def turned(x: Triple, y: Triple, z: Triple, origin: Triple, radius: float) -> Any:
    """Likewise for orthonormal axes and a radius across z; in steps, whose inverse keeps its digits however large the radius."""
    rotated = placed(x, y, z, (0, 0, 0))
    return mi.ScalarTransform4f().translate(origin) @ rotated @ mi.ScalarTransform4f().scale([radius, radius, 1])


def beside(name: str) -> str:
    """A file in this script's folder."""
    return str(Path(__file__).with_name(name))
