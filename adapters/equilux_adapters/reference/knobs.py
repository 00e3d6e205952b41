"""What may be set about the tracer."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from equilux.adapter import Knobs

Bounces = Annotated[int, Field(ge=0, le=1 << 16)]


class ReferenceKnobs(Knobs):
    """What they change of the picture is within its stated uncertainty."""

    threads: int = Field(
        default=0, ge=0, le=1024, description="threads per render; 0: one per core", json_schema_extra={"faster": "larger"}
    )
    precision: Literal["exact", "refined", "float"] = Field(
        default="exact",
        description="exact: double, and double-double where rounding could tip a decision. refined: packets in single precision "
        "find what each pixel sees, the rest is exact. float: packets in single precision throughout. The last two: models phong "
        "and raytraced only",
        json_schema_extra={"faster": ["float", "refined", "exact"], "steps": ["float", "refined", "exact"]},
    )
    error_target: float = Field(
        default=1e-6,
        ge=1e-10,
        le=0.1,
        description="model reflection-equation: error of each emitter's integral, as a share of what it would add if nothing "
        "stood in between",
        json_schema_extra={"faster": "larger", "steps": [1e-2, 1e-3, 1e-4, 1e-6, 1e-8]},
    )
    tessellation: int = Field(
        default=0,
        ge=0,
        le=4096,
        description="0: spheres, cylinders and discs are what they are. Else models phong and opengl have facets instead, as "
        "many around a circle that is seen at 45°, more where it is seen at a grazing angle; other models are refused. Exact "
        "shapes are faster, too: a ball at 256×192 takes half the time of 64 facets",
        json_schema_extra={"faster": [0, 96, 192, 512], "steps": [0, 96, 192, 512]},
    )
    recursion_depth: Bounces | Literal["scene"] = Field(
        default="scene",
        description="reflections and refractions that are followed where the scene's recursion_limit asks for more; what the "
        "others would bring is bounded by the weights of mirrors and glass",
        json_schema_extra={"faster": "smaller", "steps": [0, 1, 2, 4, 8, "scene"]},
    )
