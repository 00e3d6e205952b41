"""Measurements that nobody made: numbers that a reader can check by eye."""

from __future__ import annotations

from typing import Any

from equilux.tradeoff.front import mark_fronts
from equilux.tradeoff.record import CaseTrade, Made, Measured, RendererTrade, Spread, Times, Tradeoff


def about(seconds: float, within: float = 0.0) -> Spread:
    """A median, and an interval that reaches a share of it to both sides."""
    low, high = (1 - within) * seconds, (1 + within) * seconds
    return Spread(median=seconds, low=low, high=high, confidence=0.9375, samples=5)


def setting(
    label: str, seconds: float, accuracy: float | None, *, claimed: float | None = None, cpu: float | None = None,
    knobs: dict[str, Any] | None = None, within: float = 0.0, **more: Any,
) -> Measured:  # fmt: skip
    times = Times(wall={"total": about(seconds, within)}, cpu={"total": about(seconds if cpu is None else cpu, within)})
    return Measured(
        label=label, knobs=knobs or {"n": label}, status="ok", times=times, accuracy=accuracy, claimed=claimed or accuracy, **more
    )  # fmt: skip


def failed(label: str) -> Measured:
    return Measured(label=label, knobs={"n": label}, status="crashed", reason="ended by SIGSEGV")


def case(name: str = "ball", **renderers: list[Measured]) -> CaseTrade:
    trades = {
        each: RendererTrade(status="measured", sweep="grid", settings=[setting.model_copy() for setting in settings])
        for each, settings in renderers.items()
    }
    found = CaseTrade(
        case=name, scene=name, about="made up", model="phong", requires=[], width=8, height=6, truth="oracle",
        largest_radiance=1.0, renderers=trades,
    )  # fmt: skip
    mark_fronts(found, "wall")
    return found


def measurement(*cases: CaseTrade) -> Tradeoff:
    made = Made(
        equilux="0.1.0", command=["equilux", "tradeoff"], started="2026-01-01T00:00:00+00:00", seconds=1.0,
        machine={"processor": "made up", "cores": 2}, libraries={}, versions={"quick": "1", "slow": "2"}, repeats=5, clock="wall",
        grid_limit=12,
    )  # fmt: skip
    return Tradeoff(made=made, cases=list(cases))
