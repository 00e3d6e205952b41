"""Located errors: what every reader of this package reports, one unwrapped line each.

A line reads `where: what, got, allowed (hint)`, so that an editor can jump to it and a person need not look anything up.
"""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

_SHOWN_CHARACTERS = 60
_UNPRINTABLE = re.compile(r"[\x00-\x1f\x7f-\x9f\u2028\u2029\ud800-\udfff]")


@dataclass(frozen=True, order=True)
class SpecError:
    """One thing wrong with one place. `line` and `column` count from 1, columns in characters."""

    file: str
    line: int
    column: int
    message: str

    def __str__(self) -> str:
        return one_line(f"{self.file}:{self.line}:{self.column}: {self.message}")


class SpecErrors(ValueError):
    """Everything that is wrong with one or several files, in the order of the files and their lines."""

    def __init__(self, errors: Iterable[SpecError]) -> None:
        self.errors: tuple[SpecError, ...] = tuple(errors)
        super().__init__("\n".join(str(error) for error in self.errors))

    def __reduce__(self) -> tuple[Any, ...]:
        return (type(self), (self.errors,))


def one_line(text: str) -> str:
    """Line breaks and control characters escaped, so that an error stays on its line whatever the file holds."""
    return _UNPRINTABLE.sub(lambda match: match.group().encode("unicode_escape").decode("ascii"), text)


def shortened(text: str) -> str:
    """At most 60 characters of `text`, on one line."""
    line = one_line(text)
    return line if len(line) <= _SHOWN_CHARACTERS else line[: _SHOWN_CHARACTERS - 1] + "…"


def number_text(value: float) -> str:
    """Shortest decimal that reads back as the same double: `10`, `0.1`, `1e-05`."""
    if isinstance(value, int) and abs(value) < 10**16:
        return str(value)
    value = float(value)
    if not math.isfinite(value):
        return repr(value)
    return repr(value + 0.0).removesuffix(".0")


def nearest(word: str, known: Iterable[str]) -> str | None:
    """The known word most like `word`, if any is like it."""
    candidates = list(known)
    close = difflib.get_close_matches(word, candidates, n=1, cutoff=0.6)
    if close:
        return close[0]
    folded = {candidate.casefold(): candidate for candidate in candidates}
    return folded.get(word.casefold())


def hint(word: str, known: Iterable[str], *, otherwise: str = "") -> str:
    """` (did you mean 'x'?)`, or `otherwise` when nothing known is near."""
    found = nearest(word, known) if len(word) <= 200 else None
    return f" (did you mean '{found}'?)" if found is not None else otherwise
