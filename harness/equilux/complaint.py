"""Errors that end a command with exit code 2: one clear line each, saying what, got, allowed and, where there is one, a hint."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class BadUsage(Exception):
    """The command cannot be carried out as given. `lines` is what the user reads, one complaint per line."""

    def __init__(self, *lines: str) -> None:
        super().__init__("\n".join(lines))
        self.lines = lines


def nearest(got: str, known: Iterable[str]) -> str:
    """` (did you mean 'x'?)` when something known looks like what was given, else nothing."""
    close = difflib.get_close_matches(got, list(known), n=1, cutoff=0.6)
    return f" (did you mean '{close[0]}'?)" if close else ""
