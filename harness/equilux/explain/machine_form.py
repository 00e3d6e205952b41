"""What `equilux explain --json` prints."""

from __future__ import annotations

from typing import Any

from equilux.explain.causes import causes_of, departs, is_expected
from equilux.explain.gather import NoPair
from equilux.explain.pixel import PixelFacts
from equilux.explain.sentences import Told, explain_pair
from equilux.results import CaseRecord, PairRecord

SCHEMA = "equilux/explain/1"


def pair_json(case: CaseRecord, pair: PairRecord, told: Told, pixel: PixelFacts | None = None) -> dict[str, Any]:
    """The pair's record, its causes with what is expected of them, both standings, the worst pixel with the parts of B, and the
    text. pixel: another pixel that was asked for."""
    found = causes_of(case, pair, told.diagnoses)
    return {
        "schema": SCHEMA,
        "case": case.case,
        "scene_file": case.scene_file,
        **pair.model_dump(mode="json", exclude={"causes"}),
        "causes": [
            cause.model_dump(mode="json")
            | {"side": departs(cause, pair), "expected_by": is_expected(cause, departs(cause, pair), case)}
            for cause in found
        ],
        "standings": {
            name: standing.model_dump(mode="json")
            for name in (pair.a, pair.b)
            if name in case.renders and (standing := case.renders[name].standing) is not None
        },
        "worst_pixel": told.worst.to_json() if told.worst is not None else None,
        "pixel": pixel.to_json() if pixel is not None else None,
        "diagnoses": {name: diagnosis.model_dump(mode="json") for name, diagnosis in told.diagnoses.items()},
        "text": explain_pair(case, pair, told),
    }


def no_pair_json(none: NoPair) -> dict[str, Any]:
    return {
        "schema": SCHEMA,
        "case": none.case.case,
        "a": none.a,
        "b": none.b,
        "verdict": None,
        "renders": {name: none.case.renders[name].model_dump(mode="json") for name in (none.a, none.b)},
        "text": list(no_pair_lines(none)),
    }


def no_pair_lines(none: NoPair) -> list[str]:
    return [f"{none.case.case}: {none.a} and {none.b} were not compared", *none.why]
