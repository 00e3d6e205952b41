"""Why the first broken picture of a turn is wrong: the ordinary diagnosis, on the results tree of a push."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from equilux.adapter import Case
from equilux.casework import CaseWork, Provenance
from equilux.diagnose.diagnosis import Diagnosis
from equilux.diagnosing import Method
from equilux.dialect import declared_dialect
from equilux.extremes.push import Push
from equilux.extremes.record import AxisRecord, Curve, Point, Turn
from equilux.results import Finding
from equilux.reuse import Store
from equilux.standing import standing_of
from equilux.tree import Tree, read_json

Asked = dict[str, dict[str, str]]
"""Case → adapter → the truth that it was held against."""
Answers = Mapping[tuple[str, str], tuple[Diagnosis, Finding | None]]
"""(case, adapter) → its diagnosis, and how the render stands."""


def with_causes(
    axes: Sequence[AxisRecord], push: Push, out: Path, store: Store | None, *, limit_s: float, jobs: int
) -> tuple[list[AxisRecord], list[str]]:
    """The axes with the causes of every first broken picture, and the engine's own faults.

    Pictures that hold NaN or Inf, and those that are missing, are not diagnosed: their status says what they are. limit_s: of one
    render. Raises BadUsage if another run is writing to the tree.
    """
    asked = _asked(axes)
    cases = {case.name: case for case in push.cases.values()}
    dialects = {entry.name: declared_dialect(entry.adapter) for entry in push.plan.entries if entry.adapter is not None}
    answers: dict[tuple[str, str], tuple[Diagnosis, Finding | None]] = {}
    errors: list[str] = []
    with Tree.open(out, push.plan.identity()) as tree, ThreadPoolExecutor(jobs, thread_name_prefix="equilux-diagnose") as workers:

        def work(name: str) -> None:
            found, faults = _diagnosed(cases[name], asked[name], tree, store, Method(dialects, limit_s))
            answers.update({(name, adapter): answer for adapter, answer in found.items()})
            errors.extend(faults)

        list(workers.map(work, asked))
    return [_told(axis, answers) for axis in axes], errors


def _asked(axes: Sequence[AxisRecord]) -> Asked:
    asked: Asked = {}
    for axis in axes:
        for curve in axis.curves:
            for turn in curve.turns:
                point = _broken_point(curve, turn)
                if point is not None and point.case and point.truth and point.status == "ok" and point.diverging:
                    asked.setdefault(point.case, {})[curve.adapter] = point.truth
    return asked


def _broken_point(curve: Curve, turn: Turn) -> Point | None:
    return next((point for point in curve.points if turn.breakdown is not None and point.value == turn.breakdown), None)


def _diagnosed(
    case: Case, asked: Mapping[str, str], tree: Tree, store: Store | None, method: Method
) -> tuple[dict[str, tuple[Diagnosis, Finding | None]], list[str]]:
    """Take up the renders of a case from the tree again, and diagnose those that are asked for."""
    work = CaseWork(case, tree, store)
    for name in dict.fromkeys((*asked, *asked.values())):
        record = read_json(tree.render_folder(case.name, name) / "render.json") or {}
        work.settle_earlier(Provenance(name, record.get("version", ""), record.get("knobs", {}), record.get("key")))
    work.diagnose(method)
    found: dict[str, tuple[Diagnosis, Finding | None]] = {}
    for name, diagnosis in (work.diagnoses or {}).items():
        if name in asked:
            standing = standing_of(name, asked[name], work.pairs.values(), diagnosis, was_diagnosed=True)
            found[name] = (diagnosis, standing.finding if standing is not None else None)
    work.forget_pictures()
    return found, work.errors


def _told(axis: AxisRecord, answers: Answers) -> AxisRecord:
    def turned(curve: Curve, turn: Turn) -> Turn:
        point = _broken_point(curve, turn)
        answer = answers.get((point.case or "", curve.adapter)) if point is not None else None
        if answer is None:
            return turn
        diagnosis, finding = answer
        return turn.model_copy(update={"causes": list(diagnosis.causes), "finding": finding})

    def curved(curve: Curve) -> Curve:
        return curve.model_copy(update={"turns": [turned(curve, turn) for turn in curve.turns]})

    return axis.model_copy(update={"curves": [curved(curve) for curve in axis.curves]})
