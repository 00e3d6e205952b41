"""From verdicts to an exit code: which divergences were expected, which expectations still hold, which renders failed.

Judgement is cheap and always made afresh; only statistics are reused.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from equilux.adapter import Case
from equilux.trust import truth_among
from equilux_scenes.model import Expectation

DELIVERED = ("ok", "invalid")
"""Statuses of renders that brought a picture."""
FAILED = ("timeout", "crashed", "failed")
"""Statuses that end a run with exit code 3. `invalid` is not among them: its picture is compared, and diverges. `missing` is,
where the renderer was asked for by name."""

JUDGEMENTS = ("agree", "diverge_expected", "diverge_unexpected", "improved", "not_comparable")


@dataclass
class JudgedCase:
    """A pair's judgement by (a, b), and the expectations that had a say."""

    judged: dict[tuple[str, str], str] = field(default_factory=dict)
    expectations_used: list[Expectation] = field(default_factory=list)


def judge_case(case: Case, statuses: Mapping[str, str], pairs: Iterable[Mapping[str, Any]]) -> JudgedCase:
    """Judge all pairs of a case.

    An expectation makes a divergence of every pair containing its adapter expected; whether it still holds is judged against the
    truth only (oracle, else reference): an agreement there is `improved`. It is used when its adapter delivered a picture that
    was compared. Until causes are diagnosed, the presence of a divergence is all that is judged, not that it is the named one.
    Pixels that are not a radiance at all (NaN, infinite, negative) are never expected: no cause stands for them.
    """
    truth = truth_among(name for name, status in statuses.items() if status in DELIVERED)
    pinned = {expectation.adapter for expectation in case.expectations}
    result = JudgedCase()
    compared: set[str] = set()
    for pair in pairs:
        a, b, verdict = pair["a"], pair["b"], pair["verdict"]
        if verdict == "not-comparable":
            result.judged[a, b] = "not_comparable"
            continue
        compared |= {a, b}
        if verdict == "agree":
            vanished = b == truth and a in pinned
            result.judged[a, b] = "improved" if vanished else "agree"
        else:
            expected = bool({a, b} & pinned) and not pair["invalid"]
            result.judged[a, b] = "diverge_expected" if expected else "diverge_unexpected"
    result.expectations_used = [expectation for expectation in case.expectations if expectation.adapter in compared]
    return result


def exit_code(statuses: Iterable[tuple[str, str]], pairs: Sequence[tuple[str, str, str]], named: frozenset[str]) -> int:
    """Exit code of a run that was carried out (contracts §2).

    statuses: (adapter, status) of every render. pairs: (a, b, judgement) of every pair. named: adapters asked for by name. 3
    when a renderer failed, else 4 when nothing was scored, else 1 when a divergence was unexpected or a pinned one is gone, else
    0. Where adapters were named, only pairs with one of them count as scored: that the truths agree with each other says nothing
    of what was asked.
    """
    if any(status in FAILED or (status == "missing" and adapter in named) for adapter, status in statuses):
        return 3
    if not any(judgement != "not_comparable" and (not named or a in named or b in named) for a, b, judgement in pairs):
        return 4
    return 1 if any(judgement in ("diverge_unexpected", "improved") for _, _, judgement in pairs) else 0
