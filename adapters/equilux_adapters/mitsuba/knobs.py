"""What can be traded for speed."""

from __future__ import annotations

from pydantic import Field

from equilux.adapter import Knobs


class MitsubaKnobs(Knobs):
    """Settings of the Mitsuba adapter."""

    samples: int = Field(
        default=64,
        ge=1,
        le=1 << 16,
        description="Stratified samples per pixel and repeat; rounded up so that they share out evenly among the lights.",
        json_schema_extra={"faster": "smaller", "steps": [1, 4, 16, 64, 256]},
    )
    repeats: int = Field(
        default=32,
        ge=2,
        le=1 << 12,
        description="Independent repeats, whose scatter is the stated uncertainty. Fewer than 32 cannot be judged by.",
        json_schema_extra={"faster": "smaller", "steps": [32, 64, 128]},
    )
