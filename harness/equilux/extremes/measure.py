"""From a results tree to curves: every picture's error, uncertainty, outcome and symptom."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np
import numpy.typing as npt

from equilux.adapter import Case
from equilux.casework import MAPS_FILE, saved_picture
from equilux.compare import DIVERGE, INVALID
from equilux.extremes import breakdown, symptom
from equilux.extremes.axis import Axis, shown
from equilux.extremes.breakdown import Outcome
from equilux.extremes.push import Lane, Push
from equilux.extremes.record import AxisRecord, Curve, Point, SymptomRecord, Turn
from equilux.planes import read_planes
from equilux.results import CaseRecord, PairRecord, RenderRecord, Results
from equilux.tree import read_json
from equilux.trust import truth_among
from equilux.uncertainty import Uncertainty

FAILED = ("failed", "crashed", "timeout")
DELIVERED = ("ok", "invalid")
KINDS = ("nan", "+inf", "-inf", "negative")
BLIND = 1.0
"""Stated uncertainty over the largest radiance; a picture half of whose bright pixels reach it is called blind."""
BRIGHT = 0.5
"""Of the largest radiance: what the picture is about."""
COARSE, COARSER = 1e-3, 10.0
"""A picture whose error is more than this share of the largest radiance, and so many times that at the benign value, is coarse,
however much uncertainty is stated."""


def measured(push: Push, results: Results, root: Path) -> list[AxisRecord]:
    """All axes of a finished push. root: the results tree."""
    records = {record.case: record for record in results.cases}
    return [
        AxisRecord(
            name=axis.name,
            title=axis.title,
            unit=axis.unit,
            about=axis.about,
            watch=axis.watch,
            benign=axis.benign,
            values=list(axis.values),
            curves=[_curve(lane, push, records, root) for lane in push.lanes if lane.axis.name == axis.name],
        )
        for axis in push.axes
    ]


def _curve(lane: Lane, push: Push, records: Mapping[str, CaseRecord], root: Path) -> Curve:
    if lane.model is None:
        return Curve(adapter=lane.adapter, model=None, reason=lane.reason)
    points = [_point(lane, value, push, records, root) for value in lane.axis.values]
    return Curve(adapter=lane.adapter, model=lane.model, points=points, turns=turns(lane.axis, points))


def turns(axis: Axis, points: Sequence[Point]) -> list[Turn]:
    """The directions of a curve, each with its breakdown point and what breaks there."""
    outcomes = [point.outcome for point in points]
    out = []
    for direction, order in breakdown.outward(len(points), axis.values.index(axis.benign)).items():
        found = breakdown.breakdown(outcomes, order)
        coarse = _first_coarse(points, order, found.first)
        ends = [index for index in order if index in (coarse, found.blind, found.refused)]

        def value(index: int | None) -> float | None:
            return None if index is None else points[index].value

        out.append(
            Turn(
                direction="down" if direction == "down" else "up",
                reached=points[order[-1]].value,
                breakdown=value(found.first),
                last_good=value(found.last_good if coarse is None else _last_good(points, order[: order.index(coarse)])),
                bumps=[points[index].value for index in found.bumps],
                gives_up=value(ends[0] if ends else None),
                coarse=value(coarse),
                blind=value(found.blind),
                refused=value(found.refused),
                what="" if found.first is None else _what(points[found.first]),
            )
        )
    return out


def _last_good(points: Sequence[Point], ahead: Sequence[int]) -> int | None:
    """The last picture of these that is inside."""
    return next((index for index in reversed(ahead) if points[index].outcome in breakdown.HOLDS), None)


def _first_coarse(points: Sequence[Point], order: Sequence[int], broken: int | None) -> int | None:
    """The first picture before the breakdown that is coarse."""
    limit = max(COARSE, COARSER * (points[order[0]].error or 0.0))
    before = order if broken is None else order[: order.index(broken)]
    return next((index for index in before if (points[index].error or 0.0) > limit), None)


def _what(point: Point) -> str:
    """What breaks at a broken point, in words."""
    if point.symptom is not None:
        return point.symptom.words
    said = {"failed": "delivers no picture", "crashed": "crashes", "timeout": "does not finish in time"}
    text = said.get(point.status or "", "departs from the truth")
    return f"{text}: {point.reason}" if point.reason else text


def _point(lane: Lane, value: float, push: Push, records: Mapping[str, CaseRecord], root: Path) -> Point:
    axis, model = lane.axis, str(lane.model)
    case = push.cases.get((axis.name, model, value))
    if case is None:
        end = axis.ends.get(model, value)
        return Point(value=value, case=None, outcome="refused", reason=f"model {model} ends at {shown(end)}")
    record = records.get(case.name)
    render = record.renders.get(lane.adapter) if record is not None else None
    if record is None or render is None:  # the run was stopped
        return Point(value=value, case=case.name, outcome="unjudged", reason="not rendered")
    truth = truth_among(name for name, each in record.renders.items() if each.status in DELIVERED and name != lane.adapter)
    if lane.adapter == "oracle":
        truth = None
    pair = next((each for each in record.pairs if (each.a, each.b) == (lane.adapter, truth)), None)
    if render.status not in DELIVERED or pair is None or truth is None:
        return Point(
            value=value, case=case.name, outcome=_without_pair(render), status=render.status, reason=_short(render.reason),
        )  # fmt: skip
    return _compared(case, value, render, pair, root / "cases" / case.name)


def _without_pair(render: RenderRecord) -> Outcome:
    if render.status in FAILED:
        return "failed"
    return {"unsupported": "refused", "missing": "missing"}.get(render.status, "unjudged")  # type: ignore[return-value]


def _short(reason: str | None) -> str | None:
    """The first line of a reason, and no more than a line of it."""
    if reason is None:
        return None
    line = next(iter(reason.strip().splitlines()), "")
    return line if len(line) <= 200 else line[:199] + "…"


def _compared(case: Case, value: float, render: RenderRecord, pair: PairRecord, folder: Path) -> Point:
    """A picture beside its truth."""
    a, b = saved_picture(folder / pair.a), saved_picture(folder / pair.b)
    classes = _classes(folder, pair, b.shape[:2])
    largest = _largest(b)
    bound = _bound(folder / pair.a, a)
    wrong = (classes == DIVERGE) | (classes == INVALID)
    found = symptom.symptom(a, b, wrong, np.asarray(case.scene.background, np.float64)) if pair.verdict == "diverge" else None
    bright = b.max(axis=2) >= BRIGHT * largest
    blind = bool(bright.any()) and float((bound.max(axis=2)[bright] >= BLIND * largest).mean()) > 0.5
    outcome: Outcome = (
        "outside" if pair.verdict == "diverge" else "unjudged" if pair.verdict != "agree" else "blind" if blind else "inside"
    )
    facts = (read_json(folder / pair.a / "render.json") or {}).get("image") or {}
    return Point(
        value=value,
        case=case.name,
        outcome=outcome,
        status=render.status,
        reason=_short(render.reason or pair.reason),
        truth=pair.b,
        error=_ratio(pair.max_abs, largest),
        uncertainty=_ratio(float(bound.max()), largest),
        en_max=pair.en_max,
        diverging=pair.diverge,
        edge=pair.edge,
        invalid={kind: facts[kind] for kind in KINDS if facts.get(kind)},
        symptom=_record(found),
    )


def _classes(folder: Path, pair: PairRecord, shape: tuple[int, ...]) -> npt.NDArray[np.uint8]:
    """The class of every pixel; all diverge where the pictures could not be laid over each other."""
    try:
        return read_planes(folder / "pairs" / f"{pair.a}--{pair.b}.exr")["class"].astype(np.uint8)
    except OSError:
        return np.full(shape, DIVERGE, np.uint8)


def _largest(image: npt.NDArray[Any]) -> float:
    """Largest finite radiance, W/(m²·sr)."""
    return float(np.abs(image[np.isfinite(image)].astype(np.float64)).max(initial=0.0))


def _bound(folder: Path, image: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
    """What the render states of each value, hard bounds only, W/(m²·sr)."""
    record = read_json(folder / "render.json") or {}
    stated = Uncertainty.from_json(record["uncertainty"], folder / MAPS_FILE)
    return stated.bound(np.where(np.isfinite(image), image, 0.0))


def _ratio(part: float | None, whole: float) -> float | None:
    """part / whole; None where that is no number."""
    if part is None or whole == 0:
        return None
    ratio = part / whole
    return ratio if np.isfinite(ratio) else None


def _record(found: symptom.Symptom | None) -> SymptomRecord | None:
    if found is None:
        return None
    return SymptomRecord(
        kind=found.kind,
        pixels=found.pixels,
        of=found.of,
        counts=cast(dict[str, int], found.counts),
        factor=found.factor,
        ceiling=found.ceiling,
        words=found.words,
    )
