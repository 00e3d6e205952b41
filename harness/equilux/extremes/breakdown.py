"""Where a curve leaves its uncertainty: the breakdown point outward from the benign value, and what comes after it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

Outcome = Literal["inside", "blind", "outside", "failed", "refused", "missing", "unjudged"]
OUTCOMES: tuple[Outcome, ...] = ("inside", "blind", "outside", "failed", "refused", "missing", "unjudged")
"""Of one picture. inside: within the stated uncertainty of the truth. blind: the same, but the uncertainty is larger than the
whole picture, so that this says nothing. outside: beyond it, or not a number. failed: no picture (failed, crashed, out of time).
refused: the adapter says that it cannot. missing: the renderer is not there. unjudged: there is no truth."""

BROKEN: tuple[Outcome, ...] = ("outside", "failed")
HOLDS: tuple[Outcome, ...] = ("inside",)


@dataclass(frozen=True)
class Breakdown:
    """One direction of a curve, as indices into its values.

    first: the first that is broken; None if none is. last_good: the last before it that is inside. bumps: those behind it that
    are inside again, before the last broken one: the curve is not monotonic. blind, refused: the first where the adapter gives up
    with a word, if it does so before it breaks.
    """

    first: int | None
    last_good: int | None
    bumps: tuple[int, ...]
    blind: int | None
    refused: int | None


def breakdown(outcomes: Sequence[Outcome], order: Sequence[int]) -> Breakdown:
    """order: indices into `outcomes`, outward, the benign value first."""
    first = next((index for index in order if outcomes[index] in BROKEN), None)
    before = list(order) if first is None else list(order[: order.index(first)])
    good = [index for index in before if outcomes[index] in HOLDS]
    return Breakdown(
        first,
        good[-1] if good else None,
        _bumps(outcomes, order, first),
        next((index for index in before if outcomes[index] == "blind"), None),
        next((index for index in before if outcomes[index] == "refused"), None),
    )


def _bumps(outcomes: Sequence[Outcome], order: Sequence[int], first: int | None) -> tuple[int, ...]:
    if first is None:
        return ()
    behind = order[order.index(first) :]
    last = max(place for place, index in enumerate(behind) if outcomes[index] in BROKEN)
    return tuple(index for place, index in enumerate(behind) if place < last and outcomes[index] in HOLDS)


def outward(count: int, benign: int) -> dict[str, list[int]]:
    """The directions of an axis with `count` values: "down" and "up", each from the benign index outward; one that goes nowhere
    is left out."""
    ways = {"down": list(range(benign, -1, -1)), "up": list(range(benign, count))}
    return {name: order for name, order in ways.items() if len(order) > 1}
