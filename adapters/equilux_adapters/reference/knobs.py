"""What may be set about the tracer."""

from __future__ import annotations

from pydantic import Field

from equilux.adapter import Knobs


class ReferenceKnobs(Knobs):
    """What they change of the picture is within its stated uncertainty."""

    threads: int = Field(
        default=0, ge=0, le=1024, description="threads per render; 0: one per core", json_schema_extra={"faster": "larger"}
    )
    error_target: float = Field(
        default=1e-6,
        ge=1e-10,
        le=0.1,
        description="model reflection-equation: error of each emitter's integral, as a share of what it would add if nothing "
        "stood in between",
        json_schema_extra={"faster": "larger", "steps": [1e-2, 1e-3, 1e-4, 1e-6, 1e-8]},
    )
