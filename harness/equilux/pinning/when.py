"""The shortest `when:` that selects given cases of a sweep and no others."""

from __future__ import annotations

import itertools
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from equilux_scenes.errors import number_text

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_-]*\Z")
LONGEST_TERM = 3
"""Comparisons in one conjunction beyond what it takes to name a single case."""
CONJUNCTIONS = 100_000
"""Conjunctions looked at, those of fewer comparisons first."""
COMBINATIONS = 4_000
"""Combinations of them looked at before the search is content with the greedy one."""


@dataclass(frozen=True)
class _Term:
    """A conjunction: the cases it selects, as bits; how many comparisons it takes; how plain it is (less is plainer)."""

    mask: int
    cost: int
    rank: int
    text: str


def shortest_when(cases: Sequence[Mapping[str, Any]], wanted: Sequence[bool], parameters: Sequence[float] = ()) -> str | None:
    """An expression of `axis operator number`, joined by and/or, that holds for exactly the wanted cases: as few comparisons as
    there can be, one by one listed where a search would take too long.

    cases: axis → value of each. parameters: numbers that a threshold is preferred to be where it could be any in a gap (a clamp's
    128 between the swept 100 and 1000). Returns "" when all cases are wanted, None when no expression can tell them apart (axes
    whose values are no numbers), or none is wanted.
    """
    if all(wanted):
        return ""
    goal = sum(1 << index for index, is_wanted in enumerate(wanted) if is_wanted)
    axes = {name: [case[name] for case in cases] for name in cases[0]} if cases else {}
    usable = {name: values for name, values in axes.items() if _expressible(name, values)}
    if not goal or not usable:
        return None
    terms = _conjunctions(usable, len(cases), goal, parameters)
    chosen = _cover(terms, goal)
    return " or ".join(term.text for term in chosen) if chosen is not None else None


def _expressible(name: str, values: Sequence[Any]) -> bool:
    numbers = all(isinstance(value, int | float) and not isinstance(value, bool) for value in values)
    return numbers and bool(_NAME.match(name)) and name not in ("and", "or")


# --- conjunctions -----------------------------------------------------------------------------------------------------


def _conjunctions(axes: Mapping[str, Sequence[float]], count: int, goal: int, parameters: Sequence[float]) -> list[_Term]:
    """Conjunctions that select some wanted case and no other, one for each set of cases: the plainest of the shortest."""
    constraints = [_constraints(name, values, parameters) for name, values in axes.items()]
    everything = _Term((1 << count) - 1, 0, 0, "")
    # by_cost[cost][i]: those of that many comparisons on the first i axes; by cost, so that a search cut off has the short ones
    by_cost: list[list[list[_Term]]] = [[[everything]] * (len(axes) + 1)]
    useful: dict[int, _Term] = {}
    seen = {everything.mask}
    for cost in range(1, max(len(axes), LONGEST_TERM) + 1):
        level: list[list[_Term]] = [[]]
        for axis, of_axis in enumerate(constraints):
            grown: dict[int, _Term] = {}
            for constraint in of_axis:
                for term in by_cost[cost - constraint.cost][axis] if constraint.cost <= cost else ():
                    mask = term.mask & constraint.mask
                    if mask & goal and mask not in seen:
                        _keep_plainer(grown, _both(term, constraint, mask))
            level.append([*level[axis], *grown.values()])
            if len(seen) + len(level[-1]) > CONJUNCTIONS:
                break
        level += [level[-1]] * (len(axes) + 1 - len(level))
        for term in level[-1]:
            seen.add(term.mask)
            if not term.mask & ~goal:
                _keep_plainer(useful, term)
        by_cost.append(level)
        if len(seen) > CONJUNCTIONS:
            break
    for term in _single_cases(axes, count):  # always there, however the search ended
        if term.mask & goal and not term.mask & ~goal:
            _keep_plainer(useful, term)
    return list(useful.values())


def _both(term: _Term, constraint: _Term, mask: int) -> _Term:
    text = f"{term.text} and {constraint.text}" if term.text else constraint.text
    return _Term(mask, term.cost + constraint.cost, term.rank + constraint.rank, text)


def _keep_plainer(known: dict[int, _Term], term: _Term) -> None:
    other = known.get(term.mask)
    if other is None or (term.cost, term.rank, len(term.text)) < (other.cost, other.rank, len(other.text)):
        known[term.mask] = term


def _single_cases(axes: Mapping[str, Sequence[float]], count: int) -> list[_Term]:
    """Every case by its values; several that only other axes tell apart have one mask."""
    masks: dict[tuple[float, ...], int] = {}
    for index in range(count):
        key = tuple(values[index] for values in axes.values())
        masks[key] = masks.get(key, 0) | 1 << index
    return [
        _Term(
            mask, len(axes), 2 * len(axes), " and ".join(f"{name} == {number_text(x)}" for name, x in zip(axes, key, strict=True))
        )
        for key, mask in masks.items()
    ]


def _constraints(name: str, values: Sequence[float], parameters: Sequence[float]) -> list[_Term]:
    """What can be asked of one axis: above, below, between, equal, unequal."""

    def mask(holds: Any) -> int:
        return sum(1 << index for index, value in enumerate(values) if holds(value))

    steps = sorted(set(values))
    gaps = list(itertools.pairwise(steps))
    above = [(high, _threshold(low, high, low, parameters)) for low, high in gaps]
    below = [(low, _threshold(low, high, high, parameters)) for low, high in gaps]
    out = [_Term(mask(lambda v, m=least: v >= m), 1, rank, f"{name} > {text}") for least, (rank, text) in above]
    out += [_Term(mask(lambda v, m=most: v <= m), 1, rank, f"{name} < {text}") for most, (rank, text) in below]
    if len(steps) > 1:
        out += [_Term(mask(lambda v, s=step: v == s), 1, 2, f"{name} == {number_text(step)}") for step in steps]
        out += [_Term(mask(lambda v, s=step: v != s), 1, 3, f"{name} != {number_text(step)}") for step in steps]
    out += [
        _Term(mask(lambda v, m=least, n=most: m <= v <= n), 2, a + b, f"{name} > {text} and {name} < {other}")
        for least, (a, text) in above
        for most, (b, other) in below
        if least < most
    ]
    return out


def _threshold(low: float, high: float, otherwise: float, parameters: Sequence[float]) -> tuple[int, str]:
    """A number in a gap: a parameter of the cause where one lies there, else the end of the gap that is on the other side."""
    inside = [value for value in parameters if low <= value <= high]
    if inside and otherwise == low and inside[0] < high:
        return 0, number_text(inside[0])
    if inside and otherwise == high and inside[0] > low:
        return 0, number_text(inside[0])
    return 1, number_text(otherwise)


# --- the fewest of them that cover ------------------------------------------------------------------------------------


def _cover(terms: Sequence[_Term], goal: int) -> list[_Term] | None:
    """The terms with the fewest comparisons that together select all wanted cases: exactly for small problems, else greedily."""
    terms = sorted(terms, key=lambda term: (term.cost, term.rank, -term.mask.bit_count(), term.text))
    greedy = _greedy(terms, goal)
    if greedy is None:
        return None
    useful, tries = _undominated(terms), [0]
    for budget in range(1, sum(map(_weight, greedy))):
        exact = _exactly(useful, goal, budget, tries)
        if exact is not None:
            return _in_order(exact)
    return _in_order(greedy)


def _weight(term: _Term) -> int:
    """Comparisons count, and of equally many the fewest terms: `a > 1 and a < 9` before `a == 2 or a == 3`."""
    return 8 * term.cost + 1


def _in_order(terms: Sequence[_Term]) -> list[_Term]:
    """As the cases are ordered."""
    return sorted(terms, key=lambda term: term.mask & -term.mask)


def _undominated(terms: Sequence[_Term]) -> list[_Term]:
    """Terms that no other one selects more than, at no higher cost."""
    if len(terms) > 500:
        return list(terms)
    kept: list[_Term] = []
    for term in sorted(terms, key=lambda term: (term.cost, -term.mask.bit_count(), term.rank)):
        if not any(term.mask & ~other.mask == 0 and other.cost <= term.cost for other in kept):
            kept.append(term)
    return kept


def _exactly(terms: Sequence[_Term], left: int, budget: int, tries: list[int]) -> list[_Term] | None:
    """A cover of weight at most `budget`: the first case that is left must be in one of the terms."""
    if not left:
        return []
    if budget < 9:  # the weight of one comparison
        return None
    tries[0] += 1
    if tries[0] > COMBINATIONS:
        return None
    first = left & -left
    for term in terms:
        if _weight(term) <= budget and term.mask & first:
            rest = _exactly(terms, left & ~term.mask, budget - _weight(term), tries)
            if rest is not None:
                return [term, *rest]
    return None


def _greedy(terms: Sequence[_Term], goal: int) -> list[_Term] | None:
    chosen: list[_Term] = []
    while goal:
        best = max(terms, key=lambda term: ((term.mask & goal).bit_count() / _weight(term), -term.rank), default=None)
        if best is None or not best.mask & goal:
            return None
        chosen.append(best)
        goal &= ~best.mask
    return chosen
