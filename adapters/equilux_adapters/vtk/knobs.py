"""What can be traded for speed."""

from __future__ import annotations

from pydantic import Field

from equilux.adapter import Knobs


class VtkKnobs(Knobs):
    """Settings of the VTK adapter."""

    tessellation: int = Field(
        default=192,
        ge=8,
        le=4096,
        description=(
            "How finely round surfaces are tessellated: facets around a circle that is seen at 45°, more where it is seen at a "
            "grazing angle. The normal is off by some (2π/n)²/8, but where less than a pixel is at stake."
        ),
        json_schema_extra={"faster": "smaller", "steps": [16, 32, 64, 128, 192, 512, 1024]},
    )
