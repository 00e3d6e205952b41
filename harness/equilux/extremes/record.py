"""`extremes.json`, schema `equilux/extremes/1`: typed, so that what is written is what is documented.

`python -m equilux.extremes.record` prints the JSON Schema that lies beside this file as `extremes.schema.json`.
"""

from __future__ import annotations

import json
from typing import Any, Literal

from pydantic import Field

from equilux.diagnose.diagnosis import Found
from equilux.extremes.breakdown import Outcome
from equilux.extremes.symptom import Kind
from equilux.results import Count, Finding, Record, RunRecord

SCHEMA: Literal["equilux/extremes/1"] = "equilux/extremes/1"


class SymptomRecord(Record):
    """What breaks. kind: the main symptom; counts: pixels by kind of symptom, of which a pixel may show several."""

    kind: Kind
    pixels: Count = Field(description="wrong pixels")
    of: Count = Field(description="pixels of the film")
    counts: dict[str, Count]
    factor: float | None = Field(default=None, description="of 'scaled'")
    ceiling: float | None = Field(default=None, description="of 'saturates', W/(m²·sr)")
    words: str


class Point(Record):
    """One picture: a renderer at one value."""

    value: float
    case: str | None = Field(description="its folder below cases/; null where the model has no scene for the value")
    outcome: Outcome
    status: str | None = Field(default=None, description="of the render, as in results.json")
    reason: str | None = None
    truth: str | None = Field(default=None, description="the adapter that it was held against")
    error: float | None = Field(
        default=None, description="max |L - L_true| / max |L_true| over pixels that are neither edge nor invalid"
    )
    uncertainty: float | None = Field(default=None, description="the largest stated uncertainty of a pixel / max |L_true|")
    en_max: float | None = Field(default=None, description="largest |E_n| of those pixels; null where it is infinite")
    diverging: Count = 0
    edge: Count = 0
    invalid: dict[str, Count] = Field(default={}, description="pixels that are no radiance, by kind: nan, +inf, -inf, negative")
    symptom: SymptomRecord | None = None


class Turn(Record):
    """One direction of a curve, outward from the benign value."""

    direction: Literal["down", "up"]
    reached: float = Field(description="the outermost value that was pushed to")
    breakdown: float | None = Field(description="the first value outside uncertainty, or without a picture; null: none")
    last_good: float | None = Field(description="the last value before it, and before `coarse`, that is inside")
    bumps: list[float] = Field(
        default=[], description="values behind the breakdown that are inside again before others that are not"
    )
    gives_up: float | None = Field(default=None, description="the first value of `coarse`, `blind` and `refused`, outward")
    coarse: float | None = Field(
        default=None,
        description="the first value whose picture is off by more than 1e-3 of the largest radiance, and by ten times as much as "
        "at the benign value, although within what is stated",
    )
    blind: float | None = Field(default=None, description="the first value at which it states no more than that it knows nothing")
    refused: float | None = Field(default=None, description="the first value that the adapter refuses")
    what: str = Field(default="", description="what breaks, in words")
    causes: list[Found] = Field(default=[], description="the diagnosis of the first broken picture, where it is one")
    finding: Finding | None = Field(default=None, description="how that picture stands to the model and to the declared dialect")


class Curve(Record):
    """One renderer on one axis. model: what its scenes were written in; null where it can express none of them (`reason`)."""

    adapter: str
    model: str | None
    reason: str = ""
    points: list[Point] = Field(default_factory=list)
    turns: list[Turn] = Field(default_factory=list)


class AxisRecord(Record):
    """One quantity that was pushed. values: along the axis; scenes/<case>.scene.yaml is what was rendered."""

    name: str
    title: str
    unit: str
    about: str
    watch: str
    benign: float
    values: list[float]
    curves: list[Curve]


class AdapterRecord(Record):
    title: str
    version: str
    knobs: dict[str, Any] = Field(default_factory=dict)


class Extremes(Record):
    """All that a push found, as it stands in `extremes.json`."""

    schema_: Literal["equilux/extremes/1"] = Field(default=SCHEMA, alias="schema")
    run: RunRecord
    adapters: dict[str, AdapterRecord]
    axes: list[AxisRecord]


def json_schema() -> dict[str, Any]:
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": SCHEMA,
        **{
            key: value for key, value in Extremes.model_json_schema(by_alias=True, mode="serialization").items() if key != "title"
        },
    }


if __name__ == "__main__":
    print(json.dumps(json_schema(), indent=1, ensure_ascii=False))
