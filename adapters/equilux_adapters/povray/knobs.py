"""The speed/accuracy settings of the POV-Ray adapter."""

from __future__ import annotations

from pydantic import Field

from equilux.adapter import Knobs


class PovrayKnobs(Knobs):
    """POV-Ray writes 16-bit integers, so range and precision are bought with exposures, one POV-Ray process each."""

    exposures: int = Field(
        default=12, ge=1, le=16, json_schema_extra={"faster": "smaller", "steps": [1, 2, 4, 8, 12]},
        description="most exposures merged into one image; the brightest part is always unclipped, the dark end gives way",
    )
    relative_precision: float = Field(
        default=1e-4, ge=2e-5, le=0.1, json_schema_extra={"faster": "larger", "steps": [1e-2, 1e-3, 1e-4, 2e-5]},
        description="relative error by quantisation, from `darkest` upwards",
    )
    darkest: float = Field(
        default=1e-3, gt=0, le=1e6, json_schema_extra={"faster": "larger", "steps": [0.1, 1e-3, 1e-5]},
        description="radiance, W/(m² sr), down to which `relative_precision` holds; lowered where all is darker",
    )
    fade_ratio: float = Field(
        default=1e-5, ge=1e-7, le=1e-1, json_schema_extra={"faster": "larger", "steps": [1e-2, 1e-3, 1e-5]},
        description="fade_distance of a pure inverse-square or inverse-linear light, as a fraction of its nearest lit distance",
    )
    threads: int = Field(
        default=1, ge=1, le=64, json_schema_extra={"faster": "larger"}, description="render threads of each POV-Ray process",
    )
