"""build/bench.json: the machine, the ratios that are demanded, and every measurement with its raw timings."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from bench.machine import describe
from bench.measured import Measured
from equilux.wholefile import write_json

FORMAT = "equilux/bench/1"

DEMANDED: dict[str, tuple[str, float]] = {
    "float_vs_raw": ("at most", 1.4),
    "exact_vs_raw": ("at most", 6.0),
    "povray_vs_float": ("at least", 10.0),
    "mitsuba_vs_float": ("at least", 2.0),
    "suite_vs_bound": ("at most", 1.25),
    "warm_vs_cold": ("at most", 0.05),
    "compare_vs_oiio": ("at most", 1.0),
}
"""What each ratio is meant to be."""


def holds(name: str, value: float) -> bool:
    """Whether a ratio is what it is meant to be."""
    sense, limit = DEMANDED[name]
    return value <= limit if sense == "at most" else value >= limit


def write(path: Path, measured: Sequence[Measured]) -> None:
    """The record of these measurements; those of an earlier record that were not made again stay, each with its own machine."""
    kept = _earlier(path)
    machine = describe()
    for one in measured:
        kept[one.name] = {"machine": machine, "ratios": dict(one.ratios), **one.numbers}
    ratios = {name: value for entry in kept.values() for name, value in entry["ratios"].items()}
    record = {
        "format": FORMAT,
        "machine": machine,
        "ratios": ratios,
        "demanded": {name: _demand(name, value) for name, value in ratios.items() if name in DEMANDED},
        "measurements": kept,
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    write_json(path, record)


def _demand(name: str, value: float) -> dict[str, Any]:
    sense, limit = DEMANDED[name]
    return {"sense": sense, "limit": limit, "met": holds(name, value)}


def _earlier(path: Path) -> dict[str, Any]:
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    if not isinstance(record, dict) or record.get("format") != FORMAT:
        return {}
    return dict(record["measurements"])
