"""Reading values out of JSON that another program wrote: of the right type, or None. A report never fails over one bad field."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

Facts = Mapping[str, Any]


def mapping(facts: Facts, key: str) -> Facts:
    """A sub-object; empty where it is absent or something else."""
    value = facts.get(key)
    return value if isinstance(value, Mapping) else {}


def items(facts: Facts, key: str) -> list[Any]:
    """A list; empty where it is absent or something else."""
    value = facts.get(key)
    return list(value) if isinstance(value, list | tuple) else []


def objects(facts: Facts, key: str) -> list[Facts]:
    """The sub-objects in a list."""
    return [item for item in items(facts, key) if isinstance(item, Mapping)]


def text(facts: Facts, key: str) -> str:
    """A string; empty where it is absent."""
    value = facts.get(key)
    return value if isinstance(value, str) else ""


def number(facts: Facts, key: str) -> float | None:
    """A finite number, or None."""
    value = facts.get(key)
    if isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value):
        return float(value)
    return None


def count(facts: Facts, key: str) -> int:
    """A count; 0 where it is absent."""
    value = number(facts, key)
    return 0 if value is None else int(value)


def numbers(facts: Facts, key: str) -> list[float]:
    """The finite numbers in a list; empty if any entry is something else (a list with holes cannot be lined up with another)."""
    values = items(facts, key)
    good = [
        float(value)
        for value in values
        if isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
    ]
    return good if len(good) == len(values) else []
