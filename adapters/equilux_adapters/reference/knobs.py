"""What may be set about the tracer."""

from __future__ import annotations

from pydantic import Field

from equilux.adapter import Knobs


class ReferenceKnobs(Knobs):
    """The picture does not depend on any of them."""

    threads: int = Field(
        default=0, ge=0, le=1024, description="threads per render; 0: one per core", json_schema_extra={"faster": "larger"}
    )
