"""Which render is believed over which: the order every pair, expectation and report goes by.

The oracle is a closed form, the reference an independent double-precision evaluation of the lighting model; every other adapter
is a laboratory under test. No other part of the engine knows an adapter by its name.
"""

from __future__ import annotations

from collections.abc import Iterable

TRUTHS = ("oracle", "reference")
"""The adapters that may stand for the truth, the more trusted first."""


def trust_rank(adapter: str) -> tuple[int, str]:
    """Sorts the more trusted adapter first: oracle, reference, then alphabetically."""
    return (TRUTHS.index(adapter) if adapter in TRUTHS else len(TRUTHS), adapter)


def ordered_pair(one: str, other: str) -> tuple[str, str]:
    """(a, b) with b the more trusted side."""
    trusted, judged = sorted((one, other), key=trust_rank)
    return judged, trusted


def truth_among(adapters: Iterable[str]) -> str | None:
    """The adapter that stands for the truth among those that delivered a picture: the oracle, else the reference, else none."""
    delivered = set(adapters)
    return next((name for name in TRUTHS if name in delivered), None)
