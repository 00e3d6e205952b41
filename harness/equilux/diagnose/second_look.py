"""Numbers that the sample could not tell from the right ones, fitted again with the pixels that the proof failed on.

Of a shadow's foot a sample may hold no pixel between the blockers that two lengths miss, and then either explains it as well; the
whole picture decides, and says where to look.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from equilux.diagnose.evidence import Pixels, enlarged
from equilux.diagnose.fit import fitted
from equilux.diagnose.proof import Court, Proof
from equilux.diagnose.trials import Bench, Trial

PROOFS, ROUNDS = 4, 4
"""Failed proofs that are looked at again, and how often each."""
PIXELS = 60
"""Pixels that are added in a round, at most."""
PROMISING = 0.5
"""A failed proof is worth a second look if it accounts for this share of the diverging pixels."""


def looked_at_again(bench: Bench, court: Court, failed: Sequence[Proof]) -> list[Proof]:
    """Proofs that hold, of the same causes with other numbers."""
    worth = [proof for proof in failed if proof.explained >= PROMISING and _numbered(bench, proof)]
    found = (_looked_at_again(bench, court, proof) for proof in worth[:PROOFS])
    return [proof for proof in found if proof is not None]


def _looked_at_again(bench: Bench, court: Court, proof: Proof) -> Proof | None:
    for _ in range(ROUNDS):
        pixels = np.union1d(bench.sample.pixels, _against(proof))
        if len(pixels) == len(bench.sample.pixels) or bench.out_of_time:
            return None
        sample = enlarged(bench.sample, pixels, court.side, court.truth, court.scored, bench.model)
        bench = replace(bench, sample=sample, _exact={}, _seen={}, _trials={}, _conditional={})
        trial = bench.trial(proof.causes)
        for index in _numbered(bench, proof):
            other = fitted(bench, proof.causes if trial is None else trial.causes, index)
            trial = min((one for one in (trial, other) if one is not None), key=_by_badness, default=None)
        again = court.proof(trial.causes) if trial is not None else None
        if again is None or again.causes == proof.causes:
            return None
        if again.holds:
            return again
        proof = again
    return None


def _by_badness(trial: Trial) -> tuple[int, float]:
    return trial.badness


def _numbered(bench: Bench, proof: Proof) -> list[int]:
    """Which of the causes have a parameter that was found, not listed."""
    causes = enumerate(proof.causes)
    return [i for i, applied in causes if applied.parameter is not None and not isinstance(applied.parameter, str)]


def _against(proof: Proof) -> Pixels:
    """Row-major indices of pixels that the causes do not account for, spread over the picture."""
    left = np.flatnonzero(proof.left.reshape(-1))
    return np.asarray(left[:: max(1, -(-len(left) // PIXELS))])
