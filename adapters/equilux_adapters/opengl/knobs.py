"""What can be traded for speed."""

from __future__ import annotations

from pydantic import Field

from equilux.adapter import Knobs


class OpenGLKnobs(Knobs):
    """Settings of the OpenGL adapter. Light is evaluated at corners only: how small triangles are is how accurate it is."""

    triangle_px: float = Field(
        default=1.0,
        ge=0.05,
        le=1000,
        description="longest side of a triangle on the film, pixels; the interpolation's error goes with its square",
        json_schema_extra={"faster": "larger", "steps": [16.0, 8.0, 4.0, 2.0, 1.0, 0.5]},
    )
    tessellation: int = Field(
        default=256,
        ge=8,
        le=2048,
        description="at least so many facets around a sphere or a cylinder; likewise for every bend of a smooth mesh by 360°",
        json_schema_extra={"faster": "smaller", "steps": [32, 64, 128, 256, 512]},
    )
