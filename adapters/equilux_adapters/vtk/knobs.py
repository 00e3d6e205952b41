"""What can be traded for speed."""

from __future__ import annotations

from typing import Literal

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
            "grazing angle. The normal is off by some (2π/n)²/8, but where less than a pixel is at stake. Below some 96 the "
            "rims of discs and cylinders are off by more than the tenth of a pixel that a comparison excuses."
        ),
        json_schema_extra={"faster": "smaller", "steps": [16, 32, 64, 128, 192, 512]},
    )
    target: Literal["uint8", "float16", "float32"] = Field(
        default="float32",
        description=(
            "What the frame holds: eight bits or half floats, exposed by a power of two so that nothing is clipped, or single "
            "precision."
        ),
        json_schema_extra={"faster": ["uint8", "float16", "float32"], "steps": ["uint8", "float16", "float32"]},
    )
    samples: int = Field(
        default=0,
        ge=0,
        le=16,
        description=(
            "Samples per pixel (multisampling), 0: its centre. A mean over a pixel is not the radiance at its centre: by how "
            "much is found by a picture of the centres, and stated. Mesa's software has 4 at most."
        ),
        json_schema_extra={"faster": "smaller", "steps": [0, 2, 4]},
    )
    interpolation: Literal["gouraud", "phong"] = Field(
        default="phong",
        description="What VTK is told to interpolate: radiance or normals. Its OpenGL back end lights every pixel either way.",
        json_schema_extra={"faster": ["gouraud", "phong"], "steps": ["gouraud", "phong"]},
    )
