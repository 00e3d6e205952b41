"""A proven set of causes."""

from __future__ import annotations

from dataclasses import dataclass

from equilux.diagnose.proof import Proof
from equilux.diagnose.trials import Causes

MOST_CAUSES = 3
"""In one set: with more, numbers to be fitted explain anything."""


@dataclass(eq=False)
class Finding:
    """A proven set of causes. without: the proof with each left out (None: nothing is left). others: further sets of as many
    causes that explain as much.
    """

    proof: Proof
    without: tuple[Proof | None, ...]
    others: tuple[Causes, ...] = ()
