"""`run --accuracy E`: which setting of a renderer's knobs is used on which case, and whether it is accurate enough there.

A setting is judged by what the renderer itself states on that very picture, not by what it once did on another scene: the
settings of its ladder are tried, cheapest first, until the stated uncertainty is at most E of the largest radiance.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from equilux.claim import claimed
from equilux.results import AccuracyRecord, CaseRecord
from equilux.trust import TRUTHS

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from equilux.adapter import Case, Knobs
    from equilux.plan import Plan
    from equilux.registry import Entry
    from equilux.uncertainty import Uncertainty

NOT_YET = "not accurate enough"
"""In the place of a render's status: a more accurate setting is to be tried."""


@dataclass(frozen=True)
class Demand:
    """What accuracy is asked of a picture. tried: settings that were tried so far, this one included. last: there is none beyond,
    or, for the reason `ended`, none can be tried."""

    error: float
    tried: int
    last: bool
    ended: str | None = None

    def judged(
        self, image: npt.NDArray[np.floating], stated: Uncertainty, knobs: Mapping[str, Any]
    ) -> AccuracyRecord:
        """What the picture claims, held against what is asked."""
        claim = claimed(image, stated)
        met = claim.relative is not None and claim.relative <= self.error
        reason = None if met else claim.reason or self.ended or "its most accurate setting claims no better"
        return AccuracyRecord(
            asked=self.error, claimed=claim.relative, met=met, knobs=dict(knobs), tried=self.tried, reason=reason
        )  # fmt: skip


@dataclass(frozen=True)
class Ladders:
    """The accuracy that is asked of a run, and by adapter the knobs that are tried for it, cheapest first."""

    error: float
    rungs: Mapping[str, Sequence[Mapping[str, Any]]]

    def identity(self) -> dict[str, Any]:
        return {"error": self.error, "rungs": {name: [dict(rung) for rung in rungs] for name, rungs in self.rungs.items()}}


@dataclass
class Climb:
    """How far the renders of one run have come on their ladders. Each render is handled by one thread at a time."""

    ladders: Ladders | None
    truths: Mapping[str, str]
    """Case → the adapter that will be its truth. It keeps its own knobs: nothing is judged against less than the best."""
    _rung: dict[tuple[str, str], int] = field(default_factory=dict)

    @classmethod
    def of(cls, plan: Plan) -> Climb:
        if plan.ladders is None:
            return cls(None, {})
        planned = {(render.case.name, render.adapter) for render in plan.renders if render.action == "run"}
        closed, traced = TRUTHS
        truths = {}
        for case in plan.cases:
            if (case.name, closed) in planned and _has_closed_form(case):
                truths[case.name] = closed
            elif (case.name, traced) in planned:
                truths[case.name] = traced
        return cls(plan.ladders, truths)

    def concerns(self, case: str, adapter: str) -> bool:
        return self.ladders is not None and adapter in self.ladders.rungs and self.truths.get(case) != adapter

    def knobs(self, case: str, adapter: str) -> Mapping[str, Any] | None:
        """What is tried now; None for a render that no accuracy is asked of."""
        if self.ladders is None or not self.concerns(case, adapter):
            return None
        return self.ladders.rungs[adapter][self._rung.get((case, adapter), 0)]

    def demand(self, case: str, adapter: str, ended: str | None = None) -> Demand | None:
        """What is asked of the picture that is made now. ended: why nothing beyond it can be tried, where that is so."""
        if self.ladders is None or not self.concerns(case, adapter):
            return None
        rung = self._rung.get((case, adapter), 0)
        last = ended is not None or rung + 1 == len(self.ladders.rungs[adapter])
        return Demand(self.ladders.error, rung + 1, last, ended)

    def up(self, case: str, adapter: str) -> None:
        """Go on to the next setting."""
        self._rung[case, adapter] = self._rung.get((case, adapter), 0) + 1

    def down(self, case: str, adapter: str) -> bool:
        """Go back to the one before. False where there is none."""
        before = self._rung.get((case, adapter), 0) - 1
        if before < 0:
            return False
        self._rung[case, adapter] = before
        return True


def _has_closed_form(case: Case) -> bool:
    """Whether the oracle will deliver: what it lacks for a case is not always a feature of it."""
    import equilux_oracle

    return not equilux_oracle.supports(case)


@dataclass(frozen=True)
class Kept:
    """A claim held against the truth. error: max |ΔL| / max |L_true| over the pixels that are no edges; by_dialect: against the
    reference under the causes that the adapter declares and that were proven. None where the pair could not be compared."""

    case: str
    adapter: str
    asked: float
    claimed: float
    error: float | None
    by_dialect: bool = False

    @property
    def holds(self) -> bool | None:
        return None if self.error is None else self.error <= self.asked


def ladders_of(error: float, entries: Iterable[Entry], knobs: Mapping[str, Knobs]) -> Ladders:
    """What is tried for an accuracy. knobs: by adapter; what the user has set of them, no rung changes. Raises BadUsage."""
    from equilux.tradeoff.presets import ladder_of

    rungs = {}
    for entry in entries:
        if entry.name in knobs:
            base = knobs[entry.name].model_dump(mode="json")
            fixed = {knob: base[knob] for knob in knobs[entry.name].model_fields_set}
            rungs[entry.name] = ladder_of(entry, fixed, base)
    return Ladders(error, rungs)


def kept(cases: Iterable[CaseRecord]) -> list[Kept]:
    """Every claim of a run that says it meets what was asked, with what was measured."""
    found = []
    for case in cases:
        truth = next((name for name in TRUTHS if name in case.renders and case.renders[name].largest is not None), None)
        largest = case.renders[truth].largest if truth is not None else None
        for name, render in case.renders.items():
            accuracy = render.accuracy
            if accuracy is None or not accuracy.met or accuracy.claimed is None:
                continue
            pair = next((pair for pair in case.pairs if (pair.a, pair.b) == (name, truth)), None)
            error, by_dialect = None, False
            if pair is not None and pair.max_abs is not None and largest:
                error = pair.max_abs / largest
                declared = render.standing is not None and render.standing.finding == "model-difference"
                left = [cause.residual_max_abs for cause in pair.causes if cause.residual_max_abs is not None]
                if error > accuracy.asked and declared and left:
                    error, by_dialect = max(left) / largest, True
            found.append(Kept(case.case, name, accuracy.asked, accuracy.claimed, error, by_dialect))
    return found
