"""The whole measurement: which pictures are made, and what they say."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from equilux import budget_file, machine
from equilux.adapter import Case, Limits
from equilux.dialect import Declared
from equilux.job import BUDGET_FILE, IMAGE_FILE
from equilux.plan import RUN, PlannedRender, Selection, make_plan
from equilux.pool import Laboratory
from equilux.registry import Entry
from equilux.tradeoff.answers import answers
from equilux.tradeoff.error import Judge
from equilux.tradeoff.features import Feature, features
from equilux.tradeoff.front import mark_fronts
from equilux.tradeoff.measure import TOTAL, Measurement, Shot, Taken, measure
from equilux.tradeoff.presets import derive
from equilux.tradeoff.record import (
    CaseTrade,
    Clock,
    Cost,
    Error,
    FeatureCost,
    Made,
    Measured,
    RendererTrade,
    StartUp,
    Times,
    Tradeoff,
)
from equilux.tradeoff.settings import GRID_LIMIT, Setting, Sweep, sweep_of
from equilux.tradeoff.spread import spread
from equilux.trust import TRUTHS

REPEATS = 5
LEFT_OUT = "left out"
ERRORS = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
"""The accuracies that a measurement answers for where nobody asks."""
TIMES = (0.01, 0.1, 1.0)
"""Likewise, seconds per picture."""


@dataclass(frozen=True)
class Question:
    """What is to be measured. entries: the adapters; one that is the closed form itself has nothing to trade, and is left out.
    errors, times: the bounds that are asked for. with_features: also what each feature costs."""

    cases: Sequence[Case]
    entries: Sequence[Entry]
    repeats: int = REPEATS
    grid_limit: int = GRID_LIMIT
    clock: Clock = "wall"
    errors: Sequence[float] = ERRORS
    times: Sequence[float] = TIMES
    with_features: bool = True
    cases_per_renderer: int | None = None
    """On how many cases a renderer is measured at most: the first that it can do. None: on all."""
    limits: Limits = field(default_factory=Limits)
    command: Sequence[str] = ()


def tradeoff(question: Question, scratch: Path, tell: Callable[[str], None] = lambda _line: None) -> Tradeoff:
    """Measure. scratch: an existing folder that the caller removes. Failures of renderers are data."""
    started, clock = datetime.now(UTC), time.monotonic()
    work = _Work(question)
    tell(f"{len(work.shots)} pictures, {question.repeats} times each")
    measurement = measure(
        work.shots, work.laboratories(), repeats=question.repeats, scratch=scratch, limits=question.limits, tell=tell
    )  # fmt: skip
    tell("comparing with the truth")
    cases = [work.case_trade(case, measurement) for case in question.cases]
    for case in cases:
        mark_fronts(case, question.clock)
    made = Made(
        equilux=machine.version_of_equilux(),
        command=list(question.command),
        started=started.isoformat(timespec="seconds"),
        seconds=time.monotonic() - clock,
        machine=machine.describe_machine(),
        libraries=machine.library_versions(),
        versions={entry.name: entry.version for entry in work.entries},
        repeats=question.repeats,
        clock=question.clock,
        grid_limit=question.grid_limit,
    )
    found = Tradeoff(
        made=made,
        start_up=_start_up(measurement),
        cases=cases,
        answers=answers(cases, question.clock, errors=question.errors, times=question.times),
        features=[work.feature_cost(feature, measurement) for feature in work.features],
    )
    found.presets = derive(found)
    return found


class _Work:
    """What one measurement consists of."""

    def __init__(self, question: Question) -> None:
        self._question = question
        self.entries = [entry for entry in question.entries if entry.name != TRUTHS[0]]
        self.features: list[Feature] = features() if question.with_features else []
        self._sweeps: dict[str, Sweep] = {
            entry.name: sweep_of(entry.adapter.Knobs, grid_limit=question.grid_limit)
            for entry in self.entries
            if entry.adapter is not None
        }
        of_features = {case.name: case for each in self.features for case in (each.absent, each.present)}
        planned = make_plan([*question.cases, *of_features.values()], Selection(tuple(self.entries)), {}).renders
        in_order = iter(planned)
        self._planned: dict[tuple[str, str], PlannedRender] = {}
        self._planned_features: dict[tuple[str, str], PlannedRender] = {}
        for _ in question.cases:
            for entry in self.entries:
                render = next(in_order)
                self._planned[render.case.name, entry.name] = render
        self._leave_out()
        for render in in_order:
            self._planned_features[render.case.name, render.adapter] = render
        self.shots = [
            Shot(render.case, render.adapter, setting.knobs)
            for render in self._planned.values()
            if render.action == RUN
            for setting in self._sweeps[render.adapter].settings
        ]
        self.shots += [self._feature_shot(render) for render in self._planned_features.values() if render.action == RUN]

    def _leave_out(self) -> None:
        """Keep the first cases of each renderer, as many as are asked for."""
        most = self._question.cases_per_renderer
        taken: Counter[str] = Counter()
        for place, render in self._planned.items():
            if render.action == RUN and most is not None and taken[render.adapter] >= most:
                reason = f"measured on {most} other cases; name the scene to measure it here"
                self._planned[place] = replace(render, action=LEFT_OUT, reason=reason)
            taken[render.adapter] += render.action == RUN

    def laboratories(self) -> list[Laboratory]:
        wanted = {shot.adapter for shot in self.shots}
        return [
            Laboratory(entry.name, entry.entry_point.value, float(entry.adapter.workers_per_core))
            for entry in self.entries
            if entry.name in wanted and entry.adapter is not None
        ]

    def _feature_shot(self, render: PlannedRender) -> Shot:
        """With default knobs."""
        return Shot(render.case, render.adapter, {})

    def case_trade(self, case: Case, measurement: Measurement) -> CaseTrade:
        from equilux.diagnosing import known_rules

        judge = Judge(case, {entry.name: self._dialect(case, entry) for entry in self.entries}, known_rules())
        film = case.scene.film
        return CaseTrade(
            case=case.name,
            scene=case.scene_name,
            about=case.scene.about,
            model=case.scene.model,
            requires=list(case.requires),
            width=film.width,
            height=film.height,
            truth="oracle" if judge.truth.adapter == TRUTHS[0] else "reference",
            largest_radiance=judge.largest,
            renderers={
                entry.name: self._renderer_trade(self._planned[case.name, entry.name], judge, measurement)
                for entry in self.entries
            },
        )

    def _dialect(self, case: Case, entry: Entry) -> tuple[Declared, ...]:
        """What an adapter declares that concerns a case: its dialect, and what stands for a feature that it lacks and that the
        case excuses."""
        dialect = tuple(getattr(entry.adapter, "dialect", ()))
        return (*dialect, *(Declared(cause) for cause in self._planned[case.name, entry.name].excused))

    def _renderer_trade(self, render: PlannedRender, judge: Judge, measurement: Measurement) -> RendererTrade:
        if render.action != RUN:
            return RendererTrade(status=_status(render.action), reason=render.reason)
        sweep = self._sweeps[render.adapter]
        settings = []
        for setting in sweep.settings:
            taken = measurement.taken[Shot(render.case, render.adapter, setting.knobs).key]
            settings.append(_measured(setting, taken, render.adapter, judge))
        if all(setting.status != "ok" for setting in settings):
            return RendererTrade(status=_status(settings[0].status), reason=settings[0].reason, settings=settings)
        return RendererTrade(status="measured", sweep=sweep.kind, combinations=sweep.combinations, settings=settings)

    def feature_cost(self, feature: Feature, measurement: Measurement) -> FeatureCost:
        costs = {}
        for entry in self.entries:
            renders = [self._planned_features[case.name, entry.name] for case in (feature.absent, feature.present)]
            costs[entry.name] = _cost(renders, measurement)
        return FeatureCost(
            feature=feature.id, words=feature.words, with_case=feature.present.name, without_case=feature.absent.name,
            renderers=costs,
        )  # fmt: skip


def _status(status: str) -> Any:
    return status if status in ("unsupported", "missing", LEFT_OUT) else "failed"


def _measured(setting: Setting, taken: Taken, adapter: str, judge: Judge) -> Measured:
    """One setting, its worst picture counted."""
    out = Measured(
        label=setting.label, knobs=dict(setting.knobs), default=setting.is_default, status=taken.status, reason=taken.reason,
        most_accurate_knobs=setting.most_accurate_knobs, pictures=len(taken.pictures),
    )  # fmt: skip
    if taken.status != "ok":
        return out
    out.times = Times(wall=_by_phase(taken.wall), cpu=_by_phase(taken.cpu))
    sides = []
    try:
        for folder in taken.pictures.values():
            image = np.load(folder / IMAGE_FILE, allow_pickle=False)
            sides.append(judge.side(adapter, image, budget_file.check(budget_file.load(folder / BUDGET_FILE), image.shape)))
    except (budget_file.MalformedBudget, ValueError, OSError) as problem:
        out.status, out.reason = "failed", str(problem)
        return out
    out.error = _worst([judge.error(side) for side in sides])
    to_dialect = _worst([error for side in sides if (error := judge.error_to_dialect(side)) is not None])
    if to_dialect is not None and _is_better(to_dialect, out.error):
        out.error_to_dialect, out.dialect = to_dialect, judge.dialect(adapter)
    claims = [judge.claimed(side) for side in sides]
    out.claimed = max((claim for claim in claims if claim is not None), default=None) if None not in claims else None
    counted = out.error_to_dialect or out.error
    is_own_truth = adapter == judge.truth.adapter
    out.accuracy = out.claimed if is_own_truth else counted.max_rel if counted is not None else None
    return out


def _worst(errors: Sequence[Error]) -> Error | None:
    """That of the worst picture; one without a number is worse than any."""
    return max(errors, key=lambda error: (error.max_rel is None, error.max_rel or 0.0), default=None)


def _is_better(to_dialect: Error, to_model: Error | None) -> bool:
    """Whether a picture is nearer to what is declared than to the model: what is declared does not show in every picture."""
    if to_dialect.max_rel is None:
        return False
    return to_model is None or to_model.max_rel is None or to_dialect.max_rel < to_model.max_rel


def _by_phase(samples: Sequence[Mapping[str, float]]) -> dict[str, Any]:
    phases = dict.fromkeys(phase for sample in samples for phase in sample)
    return {phase: spread([sample.get(phase, 0.0) for sample in samples]) for phase in phases}


def _start_up(measurement: Measurement) -> dict[str, StartUp]:
    out = {}
    for name, started in measurement.started.items():
        pairs = list(zip(started.first, started.second, strict=False))
        if pairs:
            out[name] = StartUp(
                wall=spread([first[0] - second[0] for first, second in pairs]),
                cpu=spread([first[1] - second[1] for first, second in pairs]),
                small_picture_wall=spread([second[0] for _, second in pairs]),
                small_picture_cpu=spread([second[1] for _, second in pairs]),
            )
    return out


def _cost(renders: Sequence[PlannedRender], measurement: Measurement) -> Cost:
    """A feature's cost, from the renders without it and with it."""
    for render in renders:
        if render.action != RUN:
            return Cost(status=_status(render.action), reason=render.reason)
    without, present = (measurement.taken[Shot(render.case, render.adapter, {}).key] for render in renders)
    for taken in (without, present):
        if taken.status != "ok":
            return Cost(status=_status(taken.status), reason=taken.reason)
    out: dict[str, Any] = {}
    for clock in ("wall", "cpu"):
        before = [sample[TOTAL] for sample in getattr(without, clock)]
        after = [sample[TOTAL] for sample in getattr(present, clock)]
        out |= {
            f"without_{clock}": spread(before),
            f"with_{clock}": spread(after),
            f"extra_{clock}": spread([b - a for a, b in zip(before, after, strict=True)]),
        }
    return Cost(status="measured", **out)
