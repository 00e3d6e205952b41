"""Two questions to a measurement: the cheapest setting that is accurate enough, and the most accurate one that is fast enough."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from equilux.tradeoff.front import Point, points_of
from equilux.tradeoff.record import Answer, CaseTrade, Clock

ANY = "any"


def cheapest(points: Sequence[Point], error: float) -> Point | None:
    """The fastest setting whose accuracy is at most `error`; of equally fast ones the more accurate."""
    meeting = [point for point in points if point.accuracy <= error]
    return min(meeting, key=lambda point: (point.seconds, point.accuracy), default=None)


def most_accurate(points: Sequence[Point], seconds: float) -> Point | None:
    """The most accurate setting that takes at most `seconds` per picture; of equally accurate ones the faster."""
    meeting = [point for point in points if point.seconds <= seconds]
    return min(meeting, key=lambda point: (point.accuracy, point.seconds), default=None)


def answers(
    cases: Sequence[CaseTrade], clock: Clock, *, errors: Sequence[float] = (), times: Sequence[float] = ()
) -> list[Answer]:
    """Both questions for every bound: of each renderer, and of all together where there are several."""
    found = []
    for case in cases:
        measured = [name for name, trade in case.renderers.items() if trade.status == "measured"]
        asked = [(name, points_of(case, clock, [name])) for name in measured]
        if len(measured) > 1:
            asked.append((ANY, points_of(case, clock)))
        for name, points in asked:
            found += [_answer(case.case, "error", bound, name, cheapest(points, bound)) for bound in errors]
            found += [_answer(case.case, "time", bound, name, most_accurate(points, bound)) for bound in times]
    return found


def _answer(case: str, question: Literal["error", "time"], bound: float, renderer: str, point: Point | None) -> Answer:
    if point is None:
        return Answer(case=case, question=question, bound=bound, renderer=renderer, found=None)
    return Answer(
        case=case, question=question, bound=bound, renderer=renderer, found=point.renderer, label=point.setting.label,
        knobs=point.setting.knobs, accuracy=point.accuracy, seconds=point.seconds,
    )  # fmt: skip
