"""What a measurement gives back, and how repeated timings are taken and summed up."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Measured:
    """One measurement.

    name: of its module in `bench`, and of its entry in build/bench.json. ratios: go to the record's `ratios`, under names
    that are unique over all measurements. numbers: everything behind them that JSON can hold, raw timings included, in
    seconds. lines: what is printed, one by one.
    """

    name: str
    ratios: Mapping[str, float] = field(default_factory=dict)
    numbers: Mapping[str, Any] = field(default_factory=dict)
    lines: Sequence[str] = ()


@dataclass(frozen=True)
class Seconds:
    """One repetition: wall is the clock's, cpu that of all threads of this process."""

    wall: float
    cpu: float


def timed(work: Callable[[], object]) -> Seconds:
    """Run `work` once and take its time."""
    wall, cpu = time.perf_counter(), time.process_time()
    work()
    return Seconds(time.perf_counter() - wall, time.process_time() - cpu)


def interleaved(contenders: Mapping[str, Callable[[], Seconds]], repeats: int) -> dict[str, list[Seconds]]:
    """Every contender once per round, so that whatever else the machine does meets all of them alike."""
    times: dict[str, list[Seconds]] = {name: [] for name in contenders}
    for _ in range(repeats):
        for name, run in contenders.items():
            times[name].append(run())
    return times


def ratio(over: Sequence[float], under: Sequence[float]) -> dict[str, float]:
    """over/under of interleaved repeats. best: of the two minima, what is least disturbed by other work on the machine;
    median, low and high: of the quotients round by round."""
    rounds = [a / b for a, b in zip(over, under, strict=True)]
    return {"best": min(over) / min(under), "median": statistics.median(rounds), "low": min(rounds), "high": max(rounds)}
