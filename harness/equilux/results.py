"""`results.json`, schema `equilux/results/1`: typed, so that what is written is what is documented.

`python -m equilux.results` prints the JSON Schema that lies beside this file as `results.schema.json`.
"""

from __future__ import annotations

import json
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from equilux.diagnose.diagnosis import Found

SCHEMA: Literal["equilux/results/1"] = "equilux/results/1"

Status = Literal["ok", "unsupported", "missing", "timeout", "crashed", "failed", "invalid"]
STATUSES: tuple[Status, ...] = ("ok", "unsupported", "missing", "timeout", "crashed", "failed", "invalid")
Count = Annotated[int, Field(ge=0)]
Radiance = tuple[float | None, float | None, float | None]


class Record(BaseModel):
    """Base: no unknown keys, no NaN, no infinity."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, serialize_by_alias=True, populate_by_name=True)


class PerPixel(Record):
    """What the part of an uncertainty that varies per pixel comes to, over pixels and bands, W/(m²·sr)."""

    max: float | None
    median: float | None


class StatedUncertainty(Record):
    """|error| ≤ abs + rel |L| + what varies per pixel (uncertainty.exr), W/(m²·sr); the full budget is in render.json."""

    abs: float
    rel: float
    per_pixel: PerPixel | None = None


class Luminance(Record):
    """Of a picture, cd/m², over the pixels whose three bands are finite."""

    min: float
    mean: float
    max: float


class Photometry(Record):
    """How the bands of a case weigh in luminance: L_v = Σ weight · band."""

    k_m: float = Field(description="lm/W")
    k_m_text: str
    bands: str
    luminance_weights: tuple[float, float, float] = Field(description="lm/W, of the three bands")
    lights: dict[str, str] = Field(default={}, description="how lights were given that were not given by bands")


class AccuracyRecord(Record):
    """What accuracy was asked of a render, and what it claims: its largest stated uncertainty over its largest radiance, on every
    pixel that is no edge. knobs: by which setting; tried: how many were tried until then."""

    asked: float
    claimed: float | None = Field(description="null where nothing can be claimed, for `reason`")
    met: bool
    knobs: dict[str, Any]
    tried: Count
    reason: str | None = None


class RenderRecord(Record):
    """What became of one render."""

    status: Status
    reason: str | None = None
    missing_features: list[str] = []
    signal: int | None = None
    attempts: Count = 0
    version: str = ""
    seconds: dict[str, float] = Field(default={}, description="wall time by phase: start, render, read, translate")
    cpu_seconds: dict[str, float] = Field(
        default={}, description="CPU time by phase, of all threads and child processes; start is within render"
    )
    uncertainty: StatedUncertainty | None = None
    accuracy: AccuracyRecord | None = Field(default=None, description="of a run with --accuracy")
    largest: float | None = Field(default=None, description="largest |radiance| of the picture, W/(m²·sr)")
    luminance: Luminance | None = None
    standing: Standing | None = None
    reused: bool = False


class Worst(Record):
    """The pixel with the largest normalised error (`worst`), or the first invalid one where no pixel diverges otherwise; or with
    the largest difference (`farthest`).

    A band that is not a finite number is null.
    """

    x: Count
    y: Count
    a: Radiance
    b: Radiance


Finding = Literal["as-modelled", "model-difference", "implementation-bug", "translation-bug", "unexplained"]


class Standing(Record):
    """A render judged three ways: against the truth, against what its adapter declares that it does, against its peers.

    Each is "agree" or "diverge", or null where there is nothing to hold it against. finding: as-modelled: agrees with the truth.
    model-difference: departs from the scene's model, exactly as declared. implementation-bug: departs from what it declares, by
    causes of the renderer's own. translation-bug: departs by causes of the translation to it. unexplained: departs, and no named
    cause accounts for it.
    """

    truth: Literal["agree", "diverge"] | None = None
    dialect: Literal["agree", "diverge"] | None = None
    peers: dict[str, Literal["agree", "diverge"]] = {}
    finding: Finding
    reason: str = ""


class PairRecord(Record):
    """Two renders of one case, compared; b is the more trusted side. Statistics are null where nothing could be measured."""

    a: str
    b: str
    verdict: Literal["agree", "diverge", "not-comparable"]
    expected: bool = Field(description="the pair diverges, and an expectation of the scene names one of its sides")
    judged: Literal["agree", "diverge_expected", "diverge_unexpected", "improved", "not_comparable"]
    reason: str | None = None
    pixels: Count
    agree: Count
    diverge: Count
    edge: Count
    invalid: Count
    max_abs: float | None
    max_rel: float | None
    rms: float | None
    bias: float | None
    p50: float | None
    p95: float | None
    p99: float | None
    edge_max_abs: float | None
    en_max: float | None = Field(default=None, description="largest |E_n| over pixels that are neither edge nor invalid")
    flip: float | None = None
    worst: Worst | None = None
    farthest: Worst | None = Field(
        default=None, description="the pixel where |a − b| is max_abs: where uncertainties are small another one than `worst`"
    )
    explained: float | None = None
    causes: list[Found] = []

    @property
    def look_at(self) -> Worst | None:
        """The pixel to be shown where there is room for one."""
        return self.farthest or self.worst


class ExpectationRecord(Record):
    """An expectation of the scene that applies to this case and had a say."""

    adapter: str
    cause: str
    when: str | None = None
    held: bool | None = Field(default=None, description="whether the cause was found; null where no picture could be judged")


class CaseRecord(Record):
    """One case: its renders by adapter and its pairs."""

    case: str
    scene: str
    model: str
    about: str = ""
    scene_file: str | None = Field(default=None, description="relative to the folder the run was started in, or below the corpus")
    axes: dict[str, Any] = {}
    width: Annotated[int, Field(ge=1)]
    height: Annotated[int, Field(ge=1)]
    requires: list[str]
    photometry: Photometry | None = None
    expect: list[ExpectationRecord] = []
    renders: dict[str, RenderRecord]
    pairs: list[PairRecord]


class PairCounts(Record):
    agree: Count = 0
    diverge_expected: Count = 0
    diverge_unexpected: Count = 0
    improved: Count = 0
    not_comparable: Count = 0


class RenderCounts(Record):
    ok: Count = 0
    unsupported: Count = 0
    missing: Count = 0
    timeout: Count = 0
    crashed: Count = 0
    failed: Count = 0
    invalid: Count = 0


class Summary(Record):
    cases: Count
    pairs: PairCounts
    renders: RenderCounts
    expectations_used: Count
    reused: Count = Field(default=0, description="renders that were taken from an earlier run")
    exit_code: Count = 0


class RunRecord(Record):
    """What made the results. `run.json` says more."""

    equilux: str
    adapters: dict[str, str] = Field(description="renderer versions by adapter")
    command: list[str]
    started: str
    ended: str
    seconds: float
    interrupted: str | None = None


class Results(Record):
    """All that a run found, as it stands in `results.json`."""

    schema_: Literal["equilux/results/1"] = Field(default=SCHEMA, alias="schema")
    run: RunRecord
    cases: list[CaseRecord]
    summary: Summary


def json_schema() -> dict[str, Any]:
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": SCHEMA,
        **{key: value for key, value in Results.model_json_schema(by_alias=True, mode="serialization").items() if key != "title"},
    }


def summarise(cases: list[CaseRecord], exit_code: int) -> Summary:
    """Count what the cases hold."""
    pairs, renders = PairCounts(), RenderCounts()
    for case in cases:
        for pair in case.pairs:
            setattr(pairs, pair.judged, getattr(pairs, pair.judged) + 1)
        for render in case.renders.values():
            setattr(renders, render.status, getattr(renders, render.status) + 1)
    return Summary(
        cases=len(cases),
        pairs=pairs,
        renders=renders,
        expectations_used=sum(len(case.expect) for case in cases),
        reused=sum(render.reused for case in cases for render in case.renders.values()),
        exit_code=exit_code,
    )


if __name__ == "__main__":
    print(json.dumps(json_schema(), indent=1, ensure_ascii=False))
