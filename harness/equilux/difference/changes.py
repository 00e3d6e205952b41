"""One thing that changed between two runs."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, Literal

Kind = Literal[
    "run", "case", "status", "judgement", "finding", "cause", "picture", "expectation", "uncertainty", "time"
]  # fmt: skip
IMPORTANCE: tuple[Kind, ...] = (
    "status", "judgement", "finding", "cause", "picture", "case", "expectation", "uncertainty", "time", "run",
)  # fmt: skip

MARKED_FACTOR = 2.0
"""Beyond this factor an uncertainty or a time has changed markedly."""
MARKED_SECONDS = 0.5
"""A time must change by this much, too: below it is the machine's mood."""
SAME_PARAMETER = 1e-3
"""Fitted parameters of a cause that differ by less, relatively, are the same parameter."""


@dataclass(frozen=True)
class Change:
    """what: the change in words, the same words for the same change on another case. matters: whether it alone makes the exit
    code 1. detail: this case's own numbers. amount: how large it is among its like, to show the largest first."""

    kind: Kind
    what: str
    matters: bool = True
    case: str | None = None
    adapter: str | None = None
    before: Any = None
    after: Any = None
    detail: str = ""
    amount: float = 0.0

    def to_json(self) -> dict[str, Any]:
        return {key: value for key, value in asdict(self).items() if key != "amount"}


def arrow(before: Any, after: Any) -> str:
    """ "128 → 256"."""
    return f"{before} → {after}"
