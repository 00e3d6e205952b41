"""What came of a push, as text: one line per axis and renderer."""

from __future__ import annotations

import numpy as np

from equilux.extremes.axis import shown
from equilux.extremes.record import AxisRecord, Curve, Turn

LONG = 1e6
"""From here on numbers are written with an exponent."""


def line_of(axis: AxisRecord, curve: Curve) -> str:
    """What one renderer does on one axis, in a line."""
    if curve.model is None:
        return f"cannot: {curve.reason}"
    if all(point.outcome == "missing" for point in curve.points):
        return "not installed here"
    if all(point.outcome == "unjudged" for point in curve.points):
        return "is the truth here" if curve.adapter in ("oracle", "reference") else "could not be judged"
    return "; ".join(turn_words(axis, turn) for turn in curve.turns)


def turn_words(axis: AxisRecord, turn: Turn) -> str:
    """One direction: 'holds to 1e-18 m', or 'breaks at 1e-06 m (last good 1e-05): vanishes …'."""
    notes = []
    if turn.coarse is not None:
        notes.append(f"off by more than 0.1 %, as it states, from {with_unit(turn.coarse, axis.unit)} on")
    notes += [f"states nothing from {with_unit(turn.blind, axis.unit)} on"] if turn.blind is not None else []
    notes += [f"refused from {with_unit(turn.refused, axis.unit)} on"] if turn.refused is not None else []
    if turn.breakdown is None:
        end = turn.reached if not notes else turn.last_good
        text = f"holds to {with_unit(end, axis.unit)}" if end is not None else "never measured"
        return ", ".join([text, *notes])
    good = f" (last good {brief(turn.last_good)})" if turn.last_good is not None else " (never good)"
    text = f"breaks at {with_unit(turn.breakdown, axis.unit)}{good}"
    text = ", ".join([text, *notes])
    text += f": {turn.what}" if turn.what else ""
    named = [cause.id + (f" [{_parameter(cause.parameter)}]" if cause.parameter is not None else "") for cause in turn.causes]
    if named:
        text += f" [{', '.join(named)}{', as declared' if turn.finding == 'model-difference' else ''}]"
    if turn.bumps:
        text += f"; good again at {', '.join(brief(value) for value in turn.bumps)}"
    return text


def brief(value: float) -> str:
    """As `shown`, with an exponent where there would be many zeros: 1000, 1e10."""
    if abs(value) < LONG:
        return shown(value)
    return np.format_float_scientific(value, trim="-", exp_digits=1).replace("e+", "e")


def with_unit(value: float | None, unit: str) -> str:
    if value is None:
        return "–"
    return brief(value) + ("" if not unit else unit if unit == "°" else f" {unit}")


def _parameter(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)
