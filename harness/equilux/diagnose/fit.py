"""Parameters of causes, fitted on the sample by a robust objective: most pixels within uncertainty, then least Σ log(1 + |E_n|).

From a start near enough, each step solves the linearised problem in the sense of least absolute deviations, so that pixels
with other faults do not pull at the result; where the picture does not depend smoothly on the parameter, golden section.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from equilux.diagnose import scales
from equilux.diagnose.bounds import Floats
from equilux.diagnose.trials import Bench, Causes, Trial
from equilux.diagnose.usual import usual
from equilux_tracer.causes import Applied, Continuous, Vector

STEPS = 12
"""Steps of a refinement at most; a smooth parameter has converged after four to six."""
GOLDEN = (math.sqrt(5) - 1) / 2
UNBOUNDED = 1e9
"""Limit of a component of a vector, in its unit."""
PROMISING = 0.99
"""A fit is pursued only if it brings the picture nearer than the other causes alone do, by at least this much."""
ROUND_WITHIN = 0.02
"""A fitted value is taken for a rounder one only if they differ by less than this: further off, a wide uncertainty would turn
any value into a round one."""


@dataclass(frozen=True)
class Knob:
    """One number to be fitted: of which cause, which part of a tuple, and where it may lie."""

    cause: int
    part: int | None
    within: Continuous | Vector

    @property
    def is_log(self) -> bool:
        return isinstance(self.within, Continuous) and self.within.scale == "log"

    @property
    def low(self) -> float:
        return self.within.low if isinstance(self.within, Continuous) else -UNBOUNDED

    @property
    def high(self) -> float:
        return self.within.high if isinstance(self.within, Continuous) else UNBOUNDED

    def inner(self, value: float) -> float:
        return math.log(max(value, 1e-300)) if self.is_log else value

    def outer(self, inner: float) -> float:
        value = math.exp(min(inner, 700)) if self.is_log else inner
        return min(max(value, self.low), self.high)

    @property
    def extent(self) -> float:
        """How far apart two values may be; what steps are measured by."""
        if isinstance(self.within, Vector):
            return 100 * self.within.step
        return self.inner(self.high) - self.inner(self.low)


def knobs_of(causes: Causes, bench: Bench, fixed: Sequence[int] = ()) -> list[Knob]:
    """The numbers of these causes; `fixed`: indices of those that stay as they are."""
    found = []
    for index, applied in enumerate(causes):
        within = bench.rules[applied.cause].parameter
        if index in fixed or not isinstance(within, Continuous | Vector) or applied.parameter is None:
            continue
        if isinstance(applied.parameter, tuple):
            found += [Knob(index, part, within) for part in range(len(applied.parameter))]
        elif isinstance(applied.parameter, float):
            found.append(Knob(index, None, within))
    return found


def value_of(causes: Causes, knob: Knob) -> float:
    parameter = causes[knob.cause].parameter
    return _number(parameter[knob.part] if isinstance(parameter, tuple) and knob.part is not None else parameter)


def _number(value: object) -> float:
    assert isinstance(value, float | int), value
    return float(value)


def with_value(causes: Causes, knob: Knob, value: float) -> Causes:
    applied = causes[knob.cause]
    parameter = applied.parameter
    if isinstance(parameter, tuple):
        parts = [value if part == knob.part else _number(old) for part, old in enumerate(parameter)]
        changed = replace(applied, parameter=tuple(parts))
    else:
        changed = replace(applied, parameter=value)
    return (*causes[: knob.cause], changed, *causes[knob.cause + 1 :])


# --- starting values --------------------------------------------------------------------------------------------------


def started(bench: Bench, causes: Causes, free: int) -> list[Trial]:
    """Trials at the starting values that the rule proposes for cause `free`, the others as they are; least distance first."""
    others = causes[:free] + causes[free + 1 :]
    evidence = bench.evidence_under(others, picture_too=bench.moves_pixels(causes[free]))
    if evidence is None:
        return []
    rule = bench.rules[causes[free].cause]
    try:
        with np.errstate(all="ignore"):
            values = list(rule.estimates(causes[free], evidence))
    except Exception as problem:
        bench.refused[causes] = f"estimates: {type(problem).__name__}: {problem}"
        return []
    if isinstance(rule.parameter, Vector):
        values += _about_neutral(causes[free], rule.parameter)
    values = [*usual(causes[free]), *values]  # first, since of values that make the same picture the first is taken
    if causes[free].parameter is not None:
        values.insert(0, causes[free])
    trials: list[Trial | None] = []
    for value in dict.fromkeys(values):
        if trials and bench.out_of_time:
            break
        trials.append(bench.passing_trial((*causes[:free], value, *causes[free + 1 :])))
    return sorted((trial for trial in trials if trial is not None), key=lambda trial: trial.distance)


def fitted(bench: Bench, causes: Causes, free: int, trials: Sequence[Trial] | None = None) -> Trial | None:
    """Cause `free` fitted with the others as they are: the best starting values refined, then rounded where that explains as
    much. trials: what `started` gave, where it was asked before.
    """
    trials = started(bench, causes, free) if trials is None else trials
    if not trials:
        return None
    starts = {trial.causes: trial for trial in (*trials[:2], min(trials, key=lambda trial: trial.badness))}
    fixed = [index for index in range(len(causes)) if index != free]
    refined = []
    for start in starts.values():
        knobs = knobs_of(start.causes, bench, fixed)
        refined.append(refine(bench, start, knobs) if knobs else start)
    best = min(refined, key=lambda trial: trial.badness)
    knobs = knobs_of(best.causes, bench, fixed)
    others = bench.trial(causes[:free] + causes[free + 1 :])
    if others is not None and best.distance > PROMISING * others.distance and best.missed >= others.missed:
        return best
    if len(knobs) == 1 and best.missed:
        best = min((best, _golden(bench, best, knobs[0], trials)), key=lambda trial: trial.badness)
    return rounded(bench, best, knobs)


def _about_neutral(hypothesis: Applied, kind: Vector) -> list[Applied]:
    """Two steps to every side of where nothing is changed: where another fault misleads the rule's own estimate."""
    if kind.neutral is None:
        return []
    steps = product((-2, 0, 2), repeat=len(kind.neutral))
    moved = (tuple(at + n * kind.step for at, n in zip(kind.neutral, many, strict=True)) for many in steps if any(many))
    return [replace(hypothesis, parameter=parameter) for parameter in moved]


# --- refinement -------------------------------------------------------------------------------------------------------


def refine(bench: Bench, trial: Trial, knobs: Sequence[Knob]) -> Trial:
    """Steps of the linearised problem while they help."""
    best = trial
    for _ in range(STEPS):
        if bench.out_of_time:
            return best
        slopes = _slopes(bench, best, knobs)
        if slopes is None or not slopes.any():
            return best
        proposals = [_moved(best, knobs, step) for step in _steps(bench, best, slopes)]
        tried = [found for found in map(bench.passing_trial, dict.fromkeys(proposals)) if found is not None]
        better = min(tried, key=lambda found: found.distance, default=best)
        if better.distance >= best.distance * (1 - 1e-9):
            return min((best, *tried), key=lambda found: found.badness)
        converged = better.distance > best.distance * (1 - 1e-4)
        best = better
        if converged:
            return best
    return best


def _slopes(bench: Bench, trial: Trial, knobs: Sequence[Knob]) -> Floats | None:
    """(values, knobs): how the radiances of the sample follow the inner coordinate of each knob."""
    columns = []
    for knob in knobs:
        here = knob.inner(value_of(trial.causes, knob))
        step = 1e-6 * max(abs(here) if not knob.is_log else 1.0, 1e-3 * knob.extent)
        if knob.outer(here + step) <= value_of(trial.causes, knob):
            step = -step
        beside = bench.passing_trial(with_value(trial.causes, knob, knob.outer(here + step)))
        if beside is None:
            return None
        columns.append(((beside.radiance - trial.radiance) / step).reshape(-1))
    return np.nan_to_num(np.stack(columns, axis=-1), posinf=0.0, neginf=0.0)


def _steps(bench: Bench, trial: Trial, slopes: Floats) -> list[Floats]:
    """Steps to try: the joint one of least absolute deviations; and, knob by knob, the weighted median and the mode of the steps
    that single values ask for.
    """
    missing = (bench.sample.evidence.measured - trial.radiance).reshape(-1)
    bound = trial.bound.reshape(-1)
    a, r = slopes / bound[:, None], missing / bound
    usable = np.isfinite(r) & np.isfinite(a).all(axis=1) & a.any(axis=1)
    a, r = a[usable], r[usable]
    if not len(r):
        return []
    out = []
    if slopes.shape[1] > 1:
        out += _least_absolute(a, r)
    for column in range(slopes.shape[1]):
        for step in _asked_for(a[:, column], r):
            vector = np.zeros(slopes.shape[1])
            vector[column] = step
            out.append(vector)
    return out


def _least_absolute(a: Floats, r: Floats) -> list[Floats]:
    """Iteratively reweighted least squares, from all rows alike and from those that are nearly right already."""
    found = []
    for first in (np.ones(len(r)), 1 / (1 + np.abs(r))):
        weights: Floats = first
        step: Floats = np.zeros(a.shape[1])
        for _ in range(30):
            step = np.asarray(np.linalg.lstsq(a * weights[:, None], r * weights, rcond=1e-12)[0])
            weights = np.asarray(1 / np.sqrt(np.maximum(np.abs(r - a @ step), 1e-3)))
        found.append(step)
    return found


def _asked_for(slope: Floats, missing: Floats) -> list[float]:
    """The weighted median of missing/slope (what least absolute deviations say), and the middle of its densest half of the
    halves."""
    concerned = np.abs(slope) > 1e-6 * np.abs(slope).max()
    if not concerned.any():
        return []
    steps, weights = missing[concerned] / slope[concerned], np.abs(slope[concerned])
    order = np.argsort(steps, kind="stable")
    steps, weights = steps[order], np.minimum(weights[order], 1e6)
    total = np.cumsum(weights)
    median = float(steps[np.searchsorted(total, total[-1] / 2)])
    return [median, _mode(steps)]


def _mode(values: Floats) -> float:
    """Half-sample mode (Robertson and Cryer) of sorted values."""
    while len(values) > 3:
        half = (len(values) + 1) // 2
        widths = values[half - 1 :] - values[: len(values) - half + 1]
        start = int(np.argmin(widths))
        values = values[start : start + half]
    return float(np.mean(values))


def _moved(trial: Trial, knobs: Sequence[Knob], step: Floats) -> Causes:
    causes = trial.causes
    for knob, by in zip(knobs, step, strict=True):
        limited = float(np.clip(by, -0.5 * knob.extent, 0.5 * knob.extent))
        causes = with_value(causes, knob, knob.outer(knob.inner(value_of(causes, knob)) + limited))
    return causes


def _golden(bench: Bench, best: Trial, knob: Knob, trials: Sequence[Trial]) -> Trial:
    """Between the starting values on both sides of the best one; for parameters with steps."""
    here = knob.inner(value_of(best.causes, knob))
    known = sorted({knob.inner(value_of(trial.causes, knob)) for trial in trials})
    low = max((value for value in known if value < here), default=knob.inner(knob.low))
    high = min((value for value in known if value > here), default=knob.inner(knob.high))

    def at(inner: float) -> Trial | None:
        return bench.passing_trial(with_value(best.causes, knob, knob.outer(inner)))

    left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    at_left, at_right = at(left), at(right)
    for _ in range(24):
        if at_left is None or at_right is None or bench.out_of_time:
            return best
        best = min((best, at_left, at_right), key=lambda trial: trial.badness)
        if at_left.badness <= at_right.badness:
            high, right, at_right = right, left, at_left
            left = high - GOLDEN * (high - low)
            at_left = at(left)
        else:
            low, left, at_left = left, right, at_right
            right = low + GOLDEN * (high - low)
            at_right = at(right)
    return best


# --- round values -----------------------------------------------------------------------------------------------------


def rounded(bench: Bench, trial: Trial, knobs: Sequence[Knob], *, exactly: bool = False) -> Trial:
    """The same with rounder numbers, or named ones, where they explain as much. exactly: judged as a proof will judge."""
    for knob in knobs:
        value = value_of(trial.causes, knob)
        reach = ROUND_WITHIN * abs(value)
        for candidate, name in scales.candidates(value, value - reach, value + reach):
            if not knob.low <= candidate <= knob.high:
                continue
            if candidate == value or bench.out_of_time:
                break
            tried = bench.passing_trial(with_value(trial.causes, knob, candidate))
            if tried is None:
                continue
            pair = (bench.exact(tried), bench.exact(trial)) if exactly else (tried, trial)
            if _as_good(*pair, has_name=name is not None):
                trial = tried
                break
    return trial


def _as_good(tried: Trial, best: Trial, *, has_name: bool) -> bool:
    """No pixel worse off, and hardly farther away over all: with a parameter that is far from the true one the distance grows
    long before pixels leave their uncertainty. A value with a name is believed more readily than one of few digits.
    """
    longer, beyond = (1.5, 0.1) if has_name else (1.05, 0.02)
    return tried.badness[0] <= best.badness[0] and tried.distance <= longer * best.distance + beyond * len(best.error)
