"""The verdict of a pair, from its counts: no percentage is forgiven."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

Verdict = Literal["agree", "diverge", "not-comparable"]

Kinds = Mapping[str, Mapping[str, int]]
"""Side ("a", "b") → kind of invalid value → number of pixels."""

CONSTANT = "is constant where the truth is not"


@dataclass(frozen=True)
class Judgement:
    """A verdict, and why it is not `agree`."""

    verdict: Verdict
    reason: str | None = None


def of_counts(diverge: int, invalid: int, pixels: int, kinds: Kinds, names: Mapping[str, str]) -> Judgement:
    """Any diverging or invalid pixel makes the pair diverge. kinds: "a" and "b" → kind → pixels; names: the adapters."""
    parts = []
    if invalid:
        parts.append(f"{invalid} of {pixels} pixels are invalid ({_kinds_text(kinds, names)})")
    if diverge:
        parts.append(f"{diverge} of {pixels} pixels diverge")
    return Judgement("diverge", "; ".join(parts)) if parts else Judgement("agree")


def of_obstacle(obstacle: str, invalid: int, pixels: int, kinds: Kinds, names: Mapping[str, str]) -> Judgement:
    """A pair whose uncertainty cannot be told is not comparable; pixels that are no radiances at all make it diverge even so."""
    if invalid:
        return Judgement("diverge", f"{invalid} of {pixels} pixels are invalid ({_kinds_text(kinds, names)}); {obstacle}")
    return Judgement("not-comparable", obstacle)


def _kinds_text(kinds: Kinds, names: Mapping[str, str]) -> str:
    return ", ".join(
        f"{names[side]}: {count} {'negative beyond its own uncertainty' if kind == 'negative' else kind}"
        for side in ("a", "b")
        for kind, count in kinds[side].items()
        if count
    )


def is_constant(image: npt.NDArray[np.floating]) -> bool:
    """Whether all pixels of (h, w, 3) are the same."""
    first = image[0, 0]
    return not (image[0] != first).any() and not (image != first).any()


def varies(truth: npt.NDArray[np.floating], bound: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
    """(3,): whether the truth varies by more than it may itself be wrong: the ranges [L − B, L + B] of its pixels have
    nothing in common.
    """
    low = (truth - bound).max(axis=(0, 1))
    high = (truth + bound).min(axis=(0, 1))
    return np.asarray(low > high)


def hides_variation(image: npt.NDArray[np.floating], own_bound: npt.NDArray[np.float64], varying: npt.NDArray[np.bool_]) -> bool:
    """Whether a constant image is constant *wrongly* although all its pixels agree with a truth that varies.

    A picture whose level stands clear of its own uncertainty has measured that level, and the variation may lie below its
    resolution. One whose level cannot be told from black has measured nothing: a blank image must never pass, however large
    the bounds.
    """
    level, bound = np.abs(image[0, 0].astype(np.float64)), own_bound[0, 0]
    return bool((varying & (level <= bound)).any())
