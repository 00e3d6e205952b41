"""Hypotheses rendered on the sample, and what they leave unexplained there."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from equilux import edges
from equilux.diagnose.bounds import ERROR_CHANNELS, TINY, Floats, PairBounds, Tilts, error_of
from equilux.diagnose.evidence import MODEL_CHANNELS, Sample
from equilux_scenes.case import Case
from equilux_tracer import Tracer
from equilux_tracer.causes import Applied, ChangedTracer, Evidence, Rule
from equilux_tracer.shading_rules import MODEL_RULES

Causes = tuple[Applied, ...]

CLOCK = 6
"""Times as long as it may work, a diagnosis may take by the clock: the machine may be busy with others."""
KEPT_TRACERS = 48
"""Tracers of changed scenes that are kept for what changes their picture."""
QUICK_S = 20e-6
"""Below this much per position the sample is evaluated by one thread."""
KEPT_PICTURES = 1000
"""Samples of changed scenes that are kept; some 20 kB each."""


@dataclass(frozen=True)
class Trial:
    """One hypothesis on the sample.

    radiance: (n, 3) of the changed reference; bound: B there; error: (n,) largest |E_n| of the bands. missed: diverging pixels
    that stay so; broken: agreeing ones that no longer do; distance: Σ log(1 + |E_n|), which still has a slope where no pixel
    agrees, and which no single pixel dominates.
    """

    causes: Causes
    radiance: Floats
    bound: Floats
    error: Floats
    missed: int
    broken: int
    distance: float

    @property
    def badness(self) -> tuple[int, float]:
        """The robust objective: pixels with |E_n| > 1, then the distance."""
        return (self.missed + self.broken, self.distance)

    @property
    def explains(self) -> npt.NDArray[np.bool_]:
        return np.asarray(self.error <= 1)


@dataclass(kw_only=True)
class Workshop:
    """Changed references of one case, and what they are made with."""

    case: Case
    rules: Mapping[str, Rule]
    model: Tracer
    refused: dict[Causes, str] = field(default_factory=dict)
    """Hypotheses that cannot be rendered, and why."""
    _tracers: dict[Causes, Tracer] = field(default_factory=dict)
    _concerned: dict[Applied, bool] = field(default_factory=dict)

    def changed(self, causes: Causes) -> ChangedTracer:
        """The reference under these causes. Raises what a rule or the tracer raises where it cannot be done."""
        of_scene = self._of_scene(causes)
        if not of_scene:
            return ChangedTracer(self.case, causes, self.rules, tracer=self.model)
        known = self._tracers.get(of_scene)
        changed = ChangedTracer(self.case, causes, self.rules, tracer=known)
        if known is None:
            if len(self._tracers) >= KEPT_TRACERS:
                del self._tracers[next(iter(self._tracers))]
            self._tracers[of_scene] = changed.of_scene
        return changed

    @contextmanager
    def working(self, positions: int) -> Iterator[None]:
        """Around an evaluation, which may use other threads. Their work counts where time is limited."""
        yield

    def _of_scene(self, causes: Causes) -> Causes:
        return tuple(applied for applied in causes if self._concerns_scene(applied))

    def _concerns_scene(self, applied: Applied) -> bool:
        """Rules that can change scene and picture do one or the other, by reading."""
        rule = self.rules[applied.cause]
        if not changes_scene(rule) or not (changes_film(rule) or changes_values(rule)):
            return changes_scene(rule)
        if applied not in self._concerned:
            untouched = rule.change_case(self.case, applied) is self.case
            self._concerned[applied] = not (untouched and rule.change_shading(MODEL_RULES, applied) == MODEL_RULES)
        return self._concerned[applied]


@dataclass(kw_only=True)
class Bench(Workshop):
    """Everything that is needed to try hypotheses on one sample, and what was found out so far."""

    sample: Sample
    bounds: PairBounds
    time_limit_s: float = float("inf")
    """After so many seconds of its own thread's work nothing new is tried: a busy machine must not change what is found. `CLOCK`
    times as long by the clock is the limit in any case."""
    _started: tuple[float, float] = field(default_factory=lambda: (time.thread_time(), time.monotonic()))
    tried: int = 0
    others_s: float = 0.0
    """What other threads have worked for this one."""
    tilts: Tilts | None = None
    """Geometric uncertainty: what it does to the radiance is another question under other causes."""
    film_delta_px: float = edges.MINIMUM_DELTA_PX
    _exact: dict[Causes, Trial] = field(default_factory=dict)
    _seen: dict[tuple[Causes, Causes], tuple[Floats, Floats]] = field(default_factory=dict)
    _trials: dict[Causes, Trial | None] = field(default_factory=dict)
    _conditional: dict[tuple[Causes, bool], Evidence] = field(default_factory=dict)

    @property
    def time_left_s(self) -> float:
        return max(0.0, self.time_limit_s - self._worked_s)

    @property
    def _worked_s(self) -> float:
        return time.thread_time() - self._started[0] + self.others_s

    @contextmanager
    def working(self, positions: int) -> Iterator[None]:
        started, cost = time.thread_time(), self.sample.seconds_per_position
        yield
        if cost >= QUICK_S:
            self.others_s += max(0.0, cost * positions - (time.thread_time() - started))

    @property
    def out_of_time(self) -> bool:
        return self._worked_s > self.time_limit_s or time.monotonic() - self._started[1] > CLOCK * self.time_limit_s

    def trial(self, causes: Causes) -> Trial | None:
        """None where the hypothesis cannot be rendered."""
        if causes not in self._trials:
            self._trials[causes] = self._tried(causes)
        return self._trials[causes]

    def exact(self, trial: Trial) -> Trial:
        """The trial judged as a proof will judge it: geometric uncertainty restated, edges excused. Slower by far."""
        if trial.causes not in self._exact:
            try:
                changed = self.changed(trial.causes)
                own = self._restated(changed)
                bound = np.maximum(trial.bound - self.bounds.own[self.sample.pixels] + own, TINY)
                error = (np.abs(self.sample.evidence.measured - trial.radiance) / bound).max(axis=1)
                self._exact[trial.causes] = self._excused(self._counted(trial.causes, trial.radiance, bound, error), changed)
            except Exception as problem:
                self.refused[trial.causes] = f"{type(problem).__name__}: {problem}"
                self._exact[trial.causes] = trial
        return self._exact[trial.causes]

    def _restated(self, changed: ChangedTracer) -> Floats:
        """(n, 3): the renderer's own share of B if it were this tracer."""
        own = self.bounds.own[self.sample.pixels]
        if self.tilts is None:
            return own
        film_xy = self.sample.film_xy
        before = self.model.sensitivity(self.tilts.normal, self.tilts.position_m, film_xy=film_xy)
        looked_at = changed.looked_at(film_xy)
        moved = changed.of_scene.sensitivity(self.tilts.normal, self.tilts.position_m, film_xy=looked_at)
        _, after = shown_with_error(changed, changed.of_scene.evaluate(looked_at)["radiance"], moved, film_xy)
        return np.maximum(own - before, 0) + after

    def _excused(self, trial: Trial, changed: ChangedTracer) -> Trial:
        wrong = np.flatnonzero(trial.error > 1)
        if not len(wrong):
            return trial
        evidence = self.sample.evidence
        is_edge = edges.edge_pixels(
            self.sample.pixels[wrong], self.case.scene.film.width, evidence.measured[wrong], trial.radiance[wrong],
            trial.bound[wrong], self.film_delta_px, changed,
        )  # fmt: skip
        error = trial.error.copy()
        error[wrong[is_edge]] = 0.0
        return self._counted(trial.causes, trial.radiance, trial.bound, error)

    def passing_trial(self, causes: Causes) -> Trial | None:
        """The same for a step of a fit, which need not be remembered."""
        known = self._trials.get(causes)
        return known if known is not None else self._tried(causes)

    def moves_pixels(self, applied: Applied) -> bool:
        return changes_film(self.rules[applied.cause])

    def evidence_under(self, causes: Causes, *, picture_too: bool = False) -> Evidence | None:
        """The evidence with these causes as part of the model: what is left for another one to account for. picture_too: the
        whole picture as well. None where they cannot be rendered.
        """
        if not causes:
            return self.sample.evidence
        key = (causes, picture_too)
        if key not in self._conditional:
            try:
                changed = self.changed(causes)
                channels = changed.evaluate(self.sample.film_xy, MODEL_CHANNELS)
                truth = changed.render()["radiance"] if picture_too else self.sample.evidence.truth
            except Exception as problem:
                self.refused[causes] = f"{type(problem).__name__}: {problem}"
                return None
            if len(self._conditional) >= KEPT_TRACERS:
                del self._conditional[next(iter(self._conditional))]
            self._conditional[key] = replace(self.sample.evidence, case=changed.changed_case, model=channels, truth=truth)
        return self._conditional[key]

    def _tried(self, causes: Causes) -> Trial | None:
        self.tried += 1
        try:
            with np.errstate(all="ignore"):
                radiance, error = self._shown(causes)
        except Exception as problem:  # a rule of anybody's, on a scene that it cannot be applied to
            self.refused[causes] = f"{type(problem).__name__}: {problem}"
            return None
        return self.scored(causes, radiance, error)

    def scored(self, causes: Causes, radiance: Floats, error: Floats) -> Trial:
        """A trial from what the hypothesis shows at the sample's pixels."""
        measured = self.sample.evidence.measured
        with np.errstate(all="ignore"):
            bound = self.bounds.at(self.sample.pixels, radiance, error)
            normalised = np.nan_to_num(np.abs(measured - radiance) / bound, nan=1e300, posinf=1e300).max(axis=1)
        return self._counted(causes, radiance, bound, normalised)

    def _counted(self, causes: Causes, radiance: Floats, bound: Floats, error: Floats) -> Trial:
        wrong = error > 1
        missed = int((wrong & self.sample.diverging).sum())
        return Trial(causes, radiance, bound, error, missed, int(wrong.sum()) - missed, float(np.log1p(error).sum()))

    @property
    def _threads(self) -> int:
        """One for what takes a millisecond: starting others would take as long."""
        return 1 if self.sample.seconds_per_position < QUICK_S else 0

    def _shown(self, causes: Causes) -> tuple[Floats, Floats]:
        key = (self._of_scene(causes), tuple(applied for applied in causes if _changes(self.rules[applied.cause], "change_film")))
        changed = self.changed(causes)
        film_xy = self.sample.film_xy
        if key not in self._seen:
            if len(self._seen) >= KEPT_PICTURES:
                del self._seen[next(iter(self._seen))]
            with self.working(len(film_xy)):
                looked_at = changed.looked_at(film_xy)
                found = changed.of_scene.evaluate(looked_at, ("radiance", *ERROR_CHANNELS), threads=self._threads)
            self._seen[key] = found["radiance"], error_of(found)
        radiance, error = self._seen[key]
        if not any(_changes(self.rules[applied.cause], "change_radiance") for applied in causes):
            return radiance, error
        return shown_with_error(changed, radiance, error, film_xy)


def shown_with_error(changed: ChangedTracer, radiance: Floats, error: Floats, film_xy: Floats) -> tuple[Floats, Floats]:
    """What a picture's own rules make of radiances and of their errors."""
    here = changed.shown(radiance, film_xy)
    up, down = changed.shown(radiance + error, film_xy), changed.shown(np.maximum(radiance - error, 0), film_xy)
    return here, np.maximum(np.abs(up - here), np.abs(down - here))


def _changes(rule: Rule, *methods: str) -> bool:
    return any(getattr(type(rule), method) is not getattr(Rule, method) for method in methods)


def changes_scene(rule: Rule) -> bool:
    """Whether it changes what there is to be seen, or how it is lit."""
    return _changes(rule, "change_case", "change_shading")


def changes_film(rule: Rule) -> bool:
    """Whether it changes where a pixel looks."""
    return _changes(rule, "change_film")


def changes_values(rule: Rule) -> bool:
    """Whether it changes how a pixel's value is written down."""
    return _changes(rule, "change_radiance")


def ordered(causes: Sequence[Applied], rules: Mapping[str, Rule]) -> Causes:
    """In the catalogue's order, except that what changes pixels' values comes last: the order in which a picture is made."""
    place = {cause: index for index, cause in enumerate(rules)}
    return tuple(sorted(causes, key=lambda a: (changes_values(rules[a.cause]), place[a.cause], a.reading, str(a.parameter))))
