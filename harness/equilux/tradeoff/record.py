"""`tradeoff.json`, schema `equilux/tradeoff/1`: typed, so that what is written is what is documented.

`python -m equilux.tradeoff.record` prints the JSON Schema that lies beside this file as `tradeoff.schema.json`.
"""

from __future__ import annotations

import json
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

SCHEMA: Literal["equilux/tradeoff/1"] = "equilux/tradeoff/1"
Clock = Literal["wall", "cpu"]


class Record(BaseModel):
    """Base: no unknown keys, no NaN, no infinity."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, serialize_by_alias=True, populate_by_name=True)


class Spread(Record):
    """A median, and the interval [low, high] that holds the true one with this confidence, whatever the distribution; seconds
    where nothing else is said."""

    median: float
    low: float
    high: float
    confidence: float
    samples: int


class Times(Record):
    """Seconds by phase of one picture in a worker that has rendered before: translate, start, render, read, and total. start is
    what a renderer's set-up takes again for every picture; CPU time counts it within render."""

    wall: dict[str, Spread]
    cpu: dict[str, Spread]


class StartUp(Record):
    """What is paid once per worker: its first picture, from the fork on, less a later one of the same; and what every picture
    costs however small it is: a later one of 8 × 6 pixels, with default knobs."""

    wall: Spread
    cpu: Spread
    small_picture_wall: Spread
    small_picture_cpu: Spread


class Error(Record):
    """How far a picture is from what it is held against, over the pixels that are not edges. max_rel: max |ΔL| / max |L|, the
    accuracy; max_abs, rms: W/(m²·sr). not_numbers: pixels that are NaN, infinite or negative, by kind; never averaged."""

    against: str
    max_rel: float | None
    max_abs: float | None
    rms: float | None
    pixels: int
    edge: int
    beyond: int = Field(description="pixels that are off by more than the stated uncertainty")
    not_numbers: dict[str, int] = {}


class Measured(Record):
    """One setting of one renderer on one case.

    knobs: of those that are swept. error: against the truth. error_to_dialect: against the reference under the rules that the
    adapter declares and that change this picture (`dialect`): what the setting is accountable for. claimed: the largest
    uncertainty that the renderer states here, over the largest radiance; null where it says that none can be stated. accuracy:
    what fronts and answers go by: error_to_dialect where there is one, else error; for a truth of its own, `claimed`.
    """

    label: str
    knobs: dict[str, Any]
    default: bool = False
    most_accurate_knobs: bool = Field(default=False, description="every knob that buys accuracy is at its last step")
    status: str
    reason: str | None = None
    times: Times | None = None
    error: Error | None = None
    dialect: list[str] = []
    error_to_dialect: Error | None = None
    claimed: float | None = None
    accuracy: float | None = None
    pictures: int = Field(default=0, description="different pictures among the repeats: 1 where the renderer is deterministic")
    front: bool = Field(default=False, description="no other setting of this renderer is both as fast and as accurate")
    front_of_all: bool = Field(default=False, description="nor one of any other renderer")


class RendererTrade(Record):
    """All settings of one renderer on one case."""

    status: Literal["measured", "unsupported", "missing", "failed", "left out"]
    reason: str | None = None
    sweep: str = ""
    combinations: int = 0
    settings: list[Measured] = []


class CaseTrade(Record):
    """One case. truth: what errors are measured against, "oracle" (closed form) or "reference" (the tracer in its exact mode)."""

    case: str
    scene: str
    about: str
    model: str
    requires: list[str]
    width: int
    height: int
    truth: Literal["oracle", "reference"]
    largest_radiance: float
    renderers: dict[str, RendererTrade]


class Cost(Record):
    """The same scene with a feature and without it. extra: of the paired differences, round by round."""

    status: Literal["measured", "unsupported", "missing", "failed"]
    reason: str | None = None
    without_wall: Spread | None = None
    with_wall: Spread | None = None
    extra_wall: Spread | None = None
    without_cpu: Spread | None = None
    with_cpu: Spread | None = None
    extra_cpu: Spread | None = None


class FeatureCost(Record):
    """What one feature costs each renderer, with its default knobs."""

    feature: str
    words: str
    with_case: str
    without_case: str
    renderers: dict[str, Cost]


class Answer(Record):
    """The setting that answers a question on one case; null where none does. question: "cheapest with error ≤ E", or "most
    accurate within T". renderer: the one that was asked of, or "any"."""

    case: str
    question: Literal["error", "time"]
    bound: float
    renderer: str
    found: str | None = Field(description="the renderer whose setting it is")
    label: str | None = None
    knobs: dict[str, Any] = {}
    accuracy: float | None = None
    seconds: float | None = None


class Preset(Record):
    """A setting derived from the measurement. accuracy, seconds: the worst of the measured cases, by case below."""

    knobs: dict[str, Any]
    label: str
    rule: str
    accuracy: float | None
    seconds: float | None
    cases: dict[str, tuple[float | None, float | None]] = Field(description="accuracy and seconds by case")


class Rung(Record):
    """One setting of a ladder: what `run --accuracy` tries, cheapest first. claimed: the stated uncertainty by case."""

    knobs: dict[str, Any]
    label: str
    seconds: float
    claimed: dict[str, float | None]


class AdapterPresets(Record):
    version: str
    presets: dict[str, Preset] = {}
    ladder: list[Rung] = []


class Presets(Record):
    """`presets.json`, schema `equilux/presets/1`: what `run --preset` and `run --accuracy` go by."""

    schema_: Literal["equilux/presets/1"] = Field(default="equilux/presets/1", alias="schema")
    equilux: str = ""
    measured: str = Field(default="", description="when")
    processor: str = ""
    cores: int = 0
    adapters: dict[str, AdapterPresets] = {}


class Made(Record):
    """With what and how the measurement was made."""

    equilux: str
    command: list[str]
    started: str
    seconds: float
    machine: dict[str, Any]
    libraries: dict[str, str]
    versions: dict[str, str] = Field(description="renderer versions by adapter")
    repeats: int
    clock: Clock = Field(description="which time fronts and answers go by")
    grid_limit: int


class Tradeoff(Record):
    """All that a measurement of the trade found, as it stands in `tradeoff.json`."""

    schema_: Literal["equilux/tradeoff/1"] = Field(default=SCHEMA, alias="schema")
    made: Made
    start_up: dict[str, StartUp] = {}
    cases: list[CaseTrade]
    answers: list[Answer] = []
    features: list[FeatureCost] = []
    presets: Presets = Presets()


def json_schema() -> dict[str, Any]:
    schema = Tradeoff.model_json_schema(by_alias=True, mode="serialization")
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema, "title": SCHEMA}


if __name__ == "__main__":
    print(json.dumps(json_schema(), indent=1, ensure_ascii=False))
