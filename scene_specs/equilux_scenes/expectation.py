"""When a pinned divergence is expected: a tiny grammar over sweep axes, parsed here and never evaluated as code.

when = term {"or" term};  term = comparison {"and" comparison};  comparison = axis ("<"|"<="|">"|">="|"=="|"!=") number
"""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from equilux_scenes.errors import shortened
from equilux_scenes.model import Expectation

_OPERATORS: dict[str, Callable[[float, float], bool]] = {
    "<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge, "==": operator.eq, "!=": operator.ne,
}  # fmt: skip
_TOKEN = re.compile(
    r"\s*(?:(?P<number>[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?)(?![A-Za-z0-9_.])"
    r"|(?P<word>[A-Za-z_][A-Za-z0-9_-]*)|(?P<operator><=|>=|==|!=|<|>)|(?P<other>\S))"
)
_ALLOWED = "AXIS < <= > >= == != NUMBER, joined by and, or"


class WhenError(ValueError):
    """A `when` that does not follow the grammar. `offset` is the place in the text, from 0."""

    def __init__(self, message: str, offset: int) -> None:
        super().__init__(message)
        self.offset = offset


@dataclass(frozen=True)
class Comparison:
    """`axis operator number`; `offset` is where the axis stands in the text."""

    axis: str
    operator: str
    number: float
    offset: int

    def holds(self, axes: Mapping[str, Any]) -> bool:
        return _OPERATORS[self.operator](axes[self.axis], self.number)


@dataclass(frozen=True)
class When:
    """A disjunction of conjunctions of comparisons."""

    terms: tuple[tuple[Comparison, ...], ...]

    @property
    def comparisons(self) -> tuple[Comparison, ...]:
        """Every comparison, in the order written."""
        return tuple(comparison for term in self.terms for comparison in term)

    def holds(self, axes: Mapping[str, Any]) -> bool:
        """Whether it holds at the given axis values. Raises KeyError for an axis that is not there."""
        return any(all(comparison.holds(axes) for comparison in term) for term in self.terms)


def applies(expectation: Expectation, axes: Mapping[str, Any]) -> bool:
    """Whether an expectation is about the case with these axis values."""
    return expectation.when is None or parse_when(expectation.when).holds(axes)


@lru_cache(maxsize=1024)
def parse_when(text: str) -> When:
    """Parse a `when`. Raises WhenError with what was found and what is allowed there."""
    tokens = _tokens(text)
    terms: list[tuple[Comparison, ...]] = []
    term: list[Comparison] = []
    while True:
        term.append(_comparison(tokens))
        kind, word, offset = tokens.pop()
        if kind == "end":
            return When((*terms, tuple(term)))
        if kind != "word" or word not in ("and", "or"):
            raise WhenError(f"got '{shortened(word)}', allowed 'and', 'or' or the end ({_ALLOWED})", offset)
        if word == "or":
            terms.append(tuple(term))
            term = []


def _tokens(text: str) -> list[tuple[str, str, int]]:
    """(kind, text, offset), last first, so that `pop` reads in order."""
    found = [("end", "", len(text))]
    for match in _TOKEN.finditer(text):
        kind = match.lastgroup or "other"
        found.append((kind, match[kind], match.start(kind)))
    return [found[0], *reversed(found[1:])]


def _comparison(tokens: list[tuple[str, str, int]]) -> Comparison:
    axis = _expect(tokens, "word", "the name of a sweep axis")
    if axis[1] in ("and", "or"):
        raise WhenError(f"got '{axis[1]}', allowed the name of a sweep axis ({_ALLOWED})", axis[2])
    compare = _expect(tokens, "operator", "one of < <= > >= == !=")
    number = _expect(tokens, "number", "a number")
    if not math.isfinite(float(number[1])):
        raise WhenError(f"got '{shortened(number[1])}', allowed a finite number ({_ALLOWED})", number[2])
    return Comparison(axis[1], compare[1], float(number[1]), axis[2])


def _expect(tokens: list[tuple[str, str, int]], kind: str, what: str) -> tuple[str, str, int]:
    token = tokens[-1]
    if token[0] != kind:
        got = f"'{shortened(token[1])}'" if token[0] != "end" else "the end"
        raise WhenError(f"got {got}, allowed {what} ({_ALLOWED})", token[2])
    return tokens.pop()
