"""Which settings of an adapter's knobs are measured."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from equilux.adapter import Knobs
from equilux.knobs import steps_of

GRID_LIMIT = 12
"""Up to so many combinations of all steps, all are measured; beyond, the sweep through the default (`Sweep.kind`)."""


@dataclass(frozen=True)
class Setting:
    """Values of the knobs that trade. changed: those that are not the default. most_accurate_knobs: all that are turned
    together are at their last steps, and the others at their defaults."""

    knobs: Mapping[str, Any]
    changed: Mapping[str, Any] = field(default_factory=dict)
    most_accurate_knobs: bool = False

    @property
    def label(self) -> str:
        return ", ".join(f"{knob} {shown(value)}" for knob, value in self.changed.items()) or "default"

    @property
    def is_default(self) -> bool:
        return not self.changed


@dataclass(frozen=True)
class Sweep:
    """The settings of one adapter, the default first. kind: "grid": all combinations of all steps; "through the default": each
    knob alone, and all together from their fastest steps to their most accurate ones. combinations: how many a grid would be."""

    settings: tuple[Setting, ...]
    kind: str
    combinations: int


def sweep_of(model: type[Knobs], *, grid_limit: int = GRID_LIMIT) -> Sweep:
    """The settings to measure. Raises ValueError for a step that the knob itself refuses: the adapter contradicts itself."""
    steps = steps_of(model)
    default = model().model_dump(mode="json")
    combinations = math.prod(len(values) for values in steps.values())
    is_grid = combinations <= grid_limit
    wanted = _grid(steps) if is_grid else _through_default(steps, default)
    last = default | {knob: values[-1] for knob, values in _joined(steps, default).items()}
    found: dict[str, Setting] = {}
    for changes in ({}, *wanted):
        values = model.model_validate(changes).model_dump(mode="json")
        knobs = {knob: values[knob] for knob in steps}
        changed = {knob: value for knob, value in knobs.items() if value != default[knob]}
        is_last = bool(steps) and all(value == last[knob] for knob, value in knobs.items())
        found.setdefault(json.dumps(changed, sort_keys=True), Setting(knobs, changed, is_last))
    return Sweep(tuple(found.values()), "grid" if is_grid else "through the default", combinations)


def _grid(steps: Mapping[str, Sequence[Any]]) -> Iterator[dict[str, Any]]:
    for values in itertools.product(*steps.values()):
        yield dict(zip(steps, values, strict=True))


def _through_default(steps: Mapping[str, Sequence[Any]], default: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Each knob through its steps, the others at their defaults; then all at once, at the same share of the way."""
    for knob, values in steps.items():
        for value in values:
            yield {knob: value}
    joined = _joined(steps, default)
    most = max((len(values) for values in joined.values()), default=0)
    for place in range(most):
        share = place / (most - 1) if most > 1 else 0.0
        yield {knob: values[round(share * (len(values) - 1))] for knob, values in joined.items()}


def _joined(steps: Mapping[str, Sequence[Any]], default: Mapping[str, Any]) -> dict[str, Sequence[Any]]:
    """The knobs that are turned together. One whose default is its fastest step already is left at it: what lies beyond need not
    be more accurate at all (antialiasing leaves the radiance at a pixel's centre)."""
    return {knob: values for knob, values in steps.items() if len(values) > 1 and values[0] != default[knob]}


def shown(value: Any) -> str:
    """A knob's value as it is typed after --set."""
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:g}" if isinstance(value, float) else str(value)
