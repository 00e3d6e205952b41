"""Causes in sentences."""

from __future__ import annotations

from collections.abc import Mapping

from equilux.diagnose.scales import recognised as name_of
from equilux_scenes.causes import CAUSES
from equilux_tracer.causes import Applied, Rule, Vector

TOLD = 0.5
"""A correlation below says nothing worth a word."""


def sentence(rule: Rule, applied: Applied) -> str:
    """What the renderer does, with the parameter: 'radiance is multiplied by a constant: k = 3.14159 (π)'."""
    text = rule.summary or CAUSES.get(applied.cause, applied.cause)
    parameter = _parameter(rule, applied)
    reading = rule.readings.get(applied.reading, applied.reading) if applied.reading else ""
    return text + (f": {parameter}" if parameter else "") + (f" ({reading})" if reading else "")


def _parameter(rule: Rule, applied: Applied) -> str:
    if applied.parameter is None:
        return ""
    kind = rule.parameter
    name = ", ".join(kind.names) if isinstance(kind, Vector) else kind.name if kind is not None else "parameter"
    unit = f" {kind.unit}" if kind is not None and kind.unit else ""
    values = applied.parameter if isinstance(applied.parameter, tuple) else (applied.parameter,)
    shown = ", ".join(f"{value:.7g}" if isinstance(value, float) else str(value) for value in values)
    known = recognised(applied)
    return f"{name} = {shown}{unit}" + (f" ({known})" if known and known != shown else "")


def recognised(applied: Applied) -> str | None:
    """The name of the parameter's value, where it has one: "π", "255/256"."""
    return name_of(applied.parameter) if isinstance(applied.parameter, float) else None


def formula(rule: Rule, applied: Applied) -> tuple[str, str]:
    """What the model says, what the renderer does instead (of a reading: its own words)."""
    before, after = rule.formula
    reading = rule.readings.get(applied.reading, "") if applied.reading else ""
    return (before, reading or after)


def of_unexplained(left: int, diverging: int, terms: Mapping[str, float]) -> str:
    """What is left, and what it goes with."""
    text = f"{left} of {diverging} diverging pixels are not accounted for"
    strongest = next(iter(terms.items()), None)
    if strongest is not None and abs(strongest[1]) >= TOLD:
        text += f"; the remaining difference follows the term {strongest[0]} (correlation {strongest[1]:+.2f})"
    return text
