"""What a proven set leaves over, looked at by itself: a further cause may concern so few pixels that the first sample hardly saw
them.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from equilux.diagnose.bounds import PairBounds
from equilux.diagnose.evidence import gather
from equilux.diagnose.finding import MOST_CAUSES, Finding
from equilux.diagnose.fit import fitted
from equilux.diagnose.hypotheses import every_hypothesis
from equilux.diagnose.proof import Proof
from equilux.diagnose.trials import Bench, ordered

if TYPE_CHECKING:
    from equilux.diagnose.search import Search

FEWEST = 4
"""Pixels that must be left: of fewer any cause with a number could take some along."""
SHARE = 0.5
"""Of what is left, a further cause must account for this much."""


def extended(search: Search, finding: Finding) -> Finding:
    """The finding with further causes, as long as they account for what it leaves over and take nothing away."""
    proof = finding.proof
    while len(proof.causes) < MOST_CAUSES and int(proof.left.sum()) >= FEWEST and not search.bench.out_of_time:
        further = _with_one_more(search, proof)
        if further is None:
            break
        proof = further
    return finding if proof is finding.proof else search.finding(proof, [])


def _with_one_more(search: Search, proof: Proof) -> Proof | None:
    court, bench = search.court, search.bench
    under = replace(court.truth, image=proof.picture)
    sample = gather(bench.case, court.side, under, proof.scored, bench.model)
    if sample is None:
        return None
    bounds = PairBounds.of(court.side, court.truth)
    here = Bench(
        case=bench.case, rules=bench.rules, model=bench.model, refused=bench.refused, sample=sample, bounds=bounds,
        time_limit_s=bench.time_left_s,
    )  # fmt: skip
    ids = {applied.cause for applied in proof.causes}
    wrong = int(sample.diverging.sum())
    worth = []
    for hypothesis in every_hypothesis(here, search.preference):
        if here.out_of_time:
            break
        if hypothesis.cause in ids:
            continue
        causes = ordered((*proof.causes, hypothesis), bench.rules)
        is_open = hypothesis.parameter is None and bench.rules[hypothesis.cause].parameter is not None
        trial = fitted(here, causes, causes.index(hypothesis)) if is_open else here.trial(causes)
        if trial is not None and trial.missed + trial.broken <= (1 - SHARE) * wrong:
            worth.append(trial)
    bench.tried += here.tried
    left = int(proof.left.sum())
    for trial in sorted(worth, key=lambda trial: (trial.badness[0], search.preference.of_all(trial.causes), trial.distance))[:3]:
        further = court.proof(trial.causes)
        if further is None or int(further.left.sum()) > (1 - SHARE) * left:
            continue
        if _says_something(search, proof, further) or _says_all(search, proof, further):
            return further
    return None


def _says_all(search: Search, proof: Proof, further: Proof) -> bool:
    """Whether a cause that has no number to be fitted leaves nothing over: a background that is missing shows one value."""
    more = [applied for applied in further.causes if applied not in proof.causes]
    return not further.left.any() and not any(isinstance(applied.parameter, float | tuple) for applied in more)


def _says_something(search: Search, proof: Proof, further: Proof) -> bool:
    """Whether several different values are accounted for: one value is hit by many rules. Unless it is not black and nothing is
    left: that says a clamp.
    """
    won = further.within & ~proof.within
    values = np.unique(search.court.side.image[won], axis=0)
    return len(values) >= FEWEST or (bool(values.any()) and not further.left.any())
