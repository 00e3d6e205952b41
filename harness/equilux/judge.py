"""From verdicts and proven causes to an exit code: which divergences were expected, which expectations still hold, which renders
failed.

Judgement is cheap and always made afresh; only statistics and diagnoses are reused.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from equilux.adapter import Case
from equilux.diagnose.diagnosis import Diagnosis, Found
from equilux.trust import truth_among
from equilux_scenes.causes import CAUSES
from equilux_scenes.model import Expectation

DELIVERED = ("ok", "invalid")
"""Statuses of renders that brought a picture."""
FAILED = ("timeout", "crashed", "failed")
"""Statuses that end a run with exit code 3. `invalid` is not among them: its picture is compared, and diverges. `missing` is,
where the renderer was asked for by name."""

JUDGEMENTS = ("agree", "diverge_expected", "diverge_unexpected", "improved", "not_comparable")
UNEXPLAINED = "unexplained"


@dataclass
class JudgedCase:
    """A pair's judgement by (a, b); the expectations that had a say, and of each whether it held: True where its cause was found,
    False where it is gone, None where nothing could be said."""

    judged: dict[tuple[str, str], str] = field(default_factory=dict)
    expectations_used: list[Expectation] = field(default_factory=list)
    held: list[bool | None] = field(default_factory=list)


def judge_case(
    case: Case, statuses: Mapping[str, str], pairs: Iterable[Mapping[str, Any]], diagnoses: Mapping[str, Diagnosis] | None = None,
    *, excused: Mapping[str, Collection[str]] | None = None, ruled: Collection[str] = frozenset(CAUSES),
) -> JudgedCase:  # fmt: skip
    """Judge all pairs of a case.

    Against the truth (oracle, else reference), a divergence is expected where expectations of the scene name every proven cause,
    or one that the scene cannot tell from it, and nothing is left unexplained. An expected `unexplained`, or an expected cause of
    a third party that has no rule, covers what is left. An expectation is gone, and its pair `improved`, where the pair agrees,
    or diverges by other expected causes alone. Pixels that are no radiance at all (NaN, infinite, negative) are never expected:
    no cause stands for them. A divergence between two peers is expected where the scene pins one of them and what that one does
    against the truth is expected too.

    diagnoses: by adapter, of the renders that diverge from the truth. None where nothing was diagnosed: then the presence of a
    divergence is all that is judged; so it is for a render whose diagnosis failed, which ends the run with an error of its own.
    excused: by adapter, the expected causes that stand for features it lacks. They let it
    render the case at all, so they are not gone where the lack happens not to show among its other causes. ruled: the causes
    that have a rule, so that a diagnosis can find them.
    """
    pairs = list(pairs)
    truth = truth_among(name for name, status in statuses.items() if status in DELIVERED)
    pinned: dict[str, list[str]] = {}
    for expectation in case.expectations:
        pinned.setdefault(expectation.adapter, []).append(expectation.cause)
    result = JudgedCase()
    held: dict[tuple[str, str], bool | None] = {}
    for pair in pairs:
        if pair["b"] == truth and pair["verdict"] != "not-comparable":
            name, expected = pair["a"], pinned.get(pair["a"], [])
            failed = diagnoses is not None and name not in diagnoses and pair["verdict"] == "diverge" and pair["diverge"]
            found = None if diagnoses is None or failed else _Findings(pair, diagnoses.get(name), expected, ruled)
            result.judged[name, pair["b"]] = _against_truth(pair, found, expected, (excused or {}).get(name, ()), held)
    unexpected = {a for (a, _), judgement in result.judged.items() if judgement == "diverge_unexpected"}
    compared: set[str] = set()
    for pair in pairs:
        a, b = pair["a"], pair["b"]
        if pair["verdict"] == "not-comparable":
            result.judged[a, b] = "not_comparable"
            continue
        compared |= {a, b}
        if b == truth:
            continue
        covering = {a, b} & set(pinned) - (unexpected if diagnoses is not None else set())
        foreseen = bool(covering) and not pair["invalid"]
        result.judged[a, b] = "agree" if pair["verdict"] == "agree" else "diverge_expected" if foreseen else "diverge_unexpected"
    result.expectations_used = [expectation for expectation in case.expectations if expectation.adapter in compared]
    result.held = [held.get((used.adapter, used.cause)) for used in result.expectations_used]
    return result


class _Findings:
    """What was found of one render against the truth, held against what is expected of it."""

    def __init__(
        self, pair: Mapping[str, Any], diagnosis: Diagnosis | None, expected: Sequence[str], ruled: Collection[str]
    ) -> None:
        causes = diagnosis.causes if diagnosis is not None else ()
        self._proven = [cause for cause in causes if cause.id != UNEXPLAINED]
        # A picture of another size, or a blank one within a wide budget, has no diverging pixel and no proven cause.
        self._left = pair["verdict"] == "diverge" and (not self._proven or any(cause.id == UNEXPLAINED for cause in causes))
        self._covering = {cause for cause in expected if cause == UNEXPLAINED or cause not in ruled}
        self._expected = set(expected)

    @property
    def all_expected(self) -> bool:
        named = all(_names(cause) & self._expected for cause in self._proven)
        return named and (not self._left or bool(self._covering))

    def has(self, cause: str) -> bool:
        if cause in self._covering:
            return self._left
        return any(cause in _names(found) for found in self._proven)


def _names(found: Found) -> set[str]:
    """The cause and those that the scene cannot tell from it."""
    return {found.id, *(other.id for other in found.alternatives)}


def _against_truth(
    pair: Mapping[str, Any], found: _Findings | None, expected: Sequence[str], excused: Collection[str],
    held: dict[tuple[str, str], bool | None],
) -> str:  # fmt: skip
    """The judgement of a pair with the truth; notes in `held` which of the expectations of its adapter do."""
    name = pair["a"]
    diverges = pair["verdict"] == "diverge"
    for cause in expected:
        held[name, cause] = diverges if found is None or not diverges else found.has(cause)
        if diverges and not held[name, cause] and cause in excused:
            held[name, cause] = None
    if not diverges:
        return "improved" if expected else "agree"
    if not expected or pair["invalid"] or not (found is None or found.all_expected):
        return "diverge_unexpected"
    return "improved" if any(held[name, cause] is False for cause in expected) else "diverge_expected"


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
