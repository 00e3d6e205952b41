"""Pairs of peers: how much of their divergence the causes account for that were proven of each against the truth."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import permutations

import numpy as np
import numpy.typing as npt

from equilux.compare import DIVERGE, INVALID, PairResult, RenderedImage
from equilux.diagnose.catalogue import all_rules
from equilux.diagnose.diagnosis import Diagnosis, Found
from equilux.diagnose.proof import Court, Proof, Restate
from equilux.diagnose.regions import Regions
from equilux.diagnose.trials import Causes, Workshop, changes_film, changes_values, ordered
from equilux_scenes.case import Case
from equilux_tracer import Tracer
from equilux_tracer.causes import Applied, Rule

Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class PeerExplanation:
    """explained: share of the pair's diverging pixels at which both renders are accounted for: by their causes, or because they
    agree with the truth. causes: of both, each with the share lost without it; last `unexplained` where anything is left.
    """

    explained: float
    causes: tuple[Found, ...]


@dataclass(frozen=True, eq=False)
class _Account:
    """within: (h, w), the render is accounted for. without: the same, cause by cause, when that one is left out."""

    within: Mask
    causes: tuple[Found, ...] = ()
    without: tuple[Mask, ...] = ()


class Accounts:
    """Of one case: what each render's diagnosis accounts for, pixel by pixel. A render costs as many pictures as it has causes,
    and is done once for all its pairs.
    """

    def __init__(self, case: Case, truth: RenderedImage, rules: Mapping[str, Rule] | None = None) -> None:
        self._truth = truth
        self._workshop = Workshop(case=case, rules=all_rules() if rules is None else rules, model=Tracer(case))
        self._accounts: dict[str, _Account] = {}

    def add(
        self, side: RenderedImage, scored: PairResult, diagnosis: Diagnosis | None, *, restate: Restate | None = None
    ) -> None:
        """scored: the comparison of `side` with the truth. diagnosis: None where they agree. restate: as for `diagnose`."""
        classes = scored.planes.get("class")
        if classes is None:
            return
        agrees = (classes != DIVERGE) & (classes != INVALID)
        proven = diagnosis.proven if diagnosis is not None else ()
        court = Court(self._workshop, side, self._truth, scored, restate)
        proof = self._reproduced(court, tuple(Applied(f.id, _parameter(f), f.reading) for f in proven))
        if proof is None:
            self._accounts[side.adapter] = _Account(agrees)
            return
        by_id = {(found.id, found.reading, str(_parameter(found))): found for found in proven}
        causes, without = [], []
        for applied in proof.causes:
            rest = tuple(other for other in proof.causes if other != applied)
            left = court.proof(rest) if rest else None
            causes.append(by_id[applied.cause, applied.reading, str(applied.parameter)])
            without.append(agrees if left is None else left.within)
        self._accounts[side.adapter] = _Account(proof.within, tuple(causes), tuple(without))

    def explain(self, a: str, b: str, classes: npt.NDArray[np.uint8]) -> PeerExplanation | None:
        """Of the pair a–b with these classes, (h, w); None where no pixel diverges or a render was not added."""
        diverging = np.asarray(classes == DIVERGE)
        total = int(diverging.sum())
        if not total or a not in self._accounts or b not in self._accounts:
            return None
        of_a, of_b = self._accounts[a], self._accounts[b]
        explained = diverging & of_a.within & of_b.within
        causes = []
        regions = Regions(self._workshop)
        for adapter, account, other in ((a, of_a, of_b), (b, of_b, of_a)):
            for found, without in zip(account.causes, account.without, strict=True):
                lost = np.asarray(explained & ~(without & other.within))
                update = {"explained": int(lost.sum()) / total, "side": adapter, "region": regions.region(lost)}
                causes.append(found.model_copy(update=update))
        causes.sort(key=lambda found: -(found.explained or 0.0))
        left = np.asarray(diverging & ~explained)
        share = int(explained.sum()) / total
        if left.any():
            text = f"{int(left.sum())} of {total} diverging pixels are not accounted for by what was proven of either side"
            causes.append(Found(id="unexplained", explained=1 - share, words=text, region=regions.region(left)))
        return PeerExplanation(share, tuple(causes))

    def _reproduced(self, court: Court, causes: Causes) -> Proof | None:
        """The proof once more. A diagnosis lists causes by what they explain, not as they were applied: of those of the picture
        the order that explains most.
        """
        if not causes:
            return None
        rules = self._workshop.rules
        if any(applied.cause not in rules for applied in causes):
            return None
        of_picture = [a for a in causes if changes_film(rules[a.cause]) or changes_values(rules[a.cause])]
        orders = permutations(causes) if len(of_picture) > 1 else [ordered(causes, rules)]
        proofs = [proof for order in orders if (proof := court.proof(tuple(order))) is not None]
        return max(proofs, key=lambda proof: proof.explained, default=None)


def _parameter(found: Found) -> float | int | str | tuple[float, ...] | None:
    """JSON has lists where a cause has tuples."""
    parameter: float | int | str | tuple[float, ...] | None
    parameter = tuple(found.parameter) if isinstance(found.parameter, list) else found.parameter
    return parameter
