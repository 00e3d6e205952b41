"""From a finding to what is reported."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from equilux.compare import DIVERGE, RenderedImage
from equilux.diagnose import words
from equilux.diagnose.diagnosis import Alternative, Diagnosis, Found
from equilux.diagnose.proof import Proof
from equilux.diagnose.regions import Regions
from equilux.diagnose.unexplained import correlations
from equilux_tracer.causes import Applied

if TYPE_CHECKING:
    from equilux.diagnose.finding import Finding
    from equilux.diagnose.search import Search

Mask = npt.NDArray[np.bool_]


def reported(search: Search, finding: Finding | None, side: RenderedImage) -> Diagnosis:
    """The diagnosis, all but what it took."""
    court, bench = search.court, search.bench
    before = court.scored.planes["class"]
    diverging = before == DIVERGE
    regions = Regions(bench)
    causes: list[Found] = []
    left: Mask = diverging
    if finding is not None:
        shares = [_lost(finding.proof, without) for without in finding.without]
        for applied, (share, mask) in zip(finding.proof.causes, shares, strict=True):
            causes.append(_found(search, finding, applied, share, regions.region(mask), side))
        causes.sort(key=lambda cause: -(cause.explained or 0.0))
        left = finding.proof.left
    if left.any():
        causes.append(_unexplained(search, finding, left, regions, side))
    return Diagnosis(
        adapter=side.adapter,
        diverging=int(diverging.sum()),
        explained=finding.proof.explained if finding is not None else 0.0,
        broken=finding.proof.broken if finding is not None else 0,
        causes=tuple(causes),
        dialect=None if search.dialect_agrees is None else ("agree" if search.dialect_agrees else "diverge"),
    )


def _lost(proof: Proof, without: Proof | None) -> tuple[float, Mask]:
    """Share of the diverging pixels, and which, that are no longer explained when a cause is left out."""
    lost = proof.mended if without is None else proof.mended & ~without.mended
    return int(lost.sum()) / proof.diverging, np.asarray(lost)


def _found(search: Search, finding: Finding, applied: Applied, share: float, region: object, side: RenderedImage) -> Found:
    rule = search.bench.rules[applied.cause]
    return Found.model_validate(
        {
            "id": applied.cause, "parameter": applied.parameter, "reading": applied.reading, "explained": share,
            "residual_max_abs": finding.proof.residual_max_abs, "side": side.adapter, "words": words.sentence(rule, applied),
            "formula": words.formula(rule, applied), "recognised": words.recognised(applied), "suspects": rule.suspects,
            "declared": search.preference.declares(applied), "region": region, "alternatives": _alternatives(finding, applied),
        }
    )  # fmt: skip


def _alternatives(finding: Finding, applied: Applied) -> tuple[Alternative, ...]:
    """Causes that may stand in the place of this one: of other sets that explain as much and share the rest."""
    out: dict[tuple[str, str], Alternative] = {}
    ids = [other.cause for other in finding.proof.causes]
    place = finding.proof.causes.index(applied)
    for causes in finding.others:
        new = [other for other in causes if other.cause not in ids]
        gone = [index for index, id_ in enumerate(ids) if id_ not in {other.cause for other in causes}]
        if place in gone and gone.index(place) < len(new):
            other = new[gone.index(place)]
        else:
            other = next((o for o in causes if o.cause == applied.cause and _differs(o, applied)), applied)
            if other == applied:
                continue
        alternative = Alternative(id=other.cause, parameter=other.parameter, reading=other.reading)
        out.setdefault((other.cause, str(other.parameter)), alternative)
    return tuple(out.values())


def _differs(one: Applied, other: Applied) -> bool:
    """Another light, another order of bands; not another fit or reading of the same."""
    return isinstance(one.parameter, str) and one.parameter != other.parameter


def _unexplained(search: Search, finding: Finding | None, left: Mask, regions: Regions, side: RenderedImage) -> Found:
    diverging = int((search.court.scored.planes["class"] == DIVERGE).sum())
    stays = left & (search.court.scored.planes["class"] == DIVERGE)
    terms = correlations(search.bench, side, finding.proof if finding is not None else None, left)
    untried = words.of_refusals(search.bench.refused)
    if search.bench.out_of_time:
        untried.append(f"the search ended after {search.bench.time_limit_s:g} s, before every hypothesis was tried")
    return Found(
        id="unexplained", explained=int(stays.sum()) / diverging, side=side.adapter,
        residual_max_abs=finding.proof.residual_max_abs if finding is not None else search.court.scored.json["max_abs"],
        words=words.of_unexplained(int(left.sum()), diverging, terms, untried), region=regions.region(left), terms=terms,
    )  # fmt: skip
