"""The Pareto front: the settings that no other one beats in both time and accuracy."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from equilux.tradeoff.record import CaseTrade, Clock, Measured


@dataclass(frozen=True)
class Point:
    """A setting as time (seconds per picture, median) and accuracy (max |ΔL| / max |L|)."""

    renderer: str
    setting: Measured
    seconds: float
    accuracy: float


def points_of(case: CaseTrade, clock: Clock, renderers: Iterable[str] | None = None) -> list[Point]:
    """The settings that were measured and whose accuracy is known, in order of time."""
    names = case.renderers if renderers is None else [name for name in renderers if name in case.renderers]
    found = [
        Point(name, setting, seconds, setting.accuracy)
        for name in names
        for setting in case.renderers[name].settings
        if setting.accuracy is not None and (seconds := seconds_of(setting, clock)) is not None
    ]
    return sorted(found, key=lambda point: (point.seconds, point.accuracy))


def seconds_of(setting: Measured, clock: Clock) -> float | None:
    """Median seconds of a whole picture; None where none was made."""
    return None if setting.times is None else getattr(setting.times, clock)["total"].median


def front(points: Sequence[Point]) -> list[Point]:
    """Those that no other point equals in one of time and accuracy and beats in the other, or beats in both; of equal ones the
    first. In order of time."""
    found: list[Point] = []
    for point in sorted(points, key=lambda point: (point.seconds, point.accuracy)):
        if not found or point.accuracy < found[-1].accuracy:
            found.append(point)
    return found


def mark_fronts(case: CaseTrade, clock: Clock) -> None:
    """Note in the settings of a case which are on the front of their renderer, and which on that of all together."""
    for name in case.renderers:
        for point in front(points_of(case, clock, [name])):
            point.setting.front = True
    for point in front(points_of(case, clock)):
        point.setting.front_of_all = True
