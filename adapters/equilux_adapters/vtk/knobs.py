"""What can be traded for speed."""

from __future__ import annotations

from equilux.adapter import Knobs
from pydantic import Field


class VtkKnobs(Knobs):
    """Settings of the VTK adapter."""

    tessellation: int = Field(
        default=192,
        ge=8,
        le=4096,
        description=(
            "Facets around a circle that is seen at 45°; fewer where it is seen straight on, more where it is seen at a grazing angle. "
            "Spheres, cylinders and discs are tessellated, everything else is exact. The normal is off by (2π/n)²/8 at most, save on "
            "objects of a few pixels."
        ),
        json_schema_extra={"faster": "smaller"},
    )
