"""Telling how far a push is: a bar on a terminal, a line per finished axis elsewhere. What fails is a result, not a message."""

from __future__ import annotations

import sys
import threading
from collections import Counter
from typing import IO

from equilux.extremes.push import Push
from equilux.progress import Progress, Silent, Terminal


class PerAxis(Silent):
    """One line per axis, when its last picture is there."""

    def __init__(self, stream: IO[str], push: Push) -> None:
        self._stream = stream
        self._axis_of = {case.name: axis for (axis, _, _), case in push.cases.items()}
        self._left = Counter(self._axis_of[render.case.name] for render in push.plan.renders)
        self._total = Counter(self._left)
        self._lock = threading.Lock()

    def render_done(self, case: str, adapter: str, status: str) -> None:
        axis = self._axis_of[case]
        with self._lock:
            self._left[axis] -= 1
            done = sum(not left for left in self._left.values())
            if self._left[axis] == 0:
                self._stream.write(f"[{done}/{len(self._left)}] {axis}: {self._total[axis]} pictures\n")
                self._stream.flush()


class Bar(Terminal):
    """The bar alone."""

    def note(self, line: str) -> None:
        pass


def suitable(push: Push, stream: IO[str] | None = None) -> Progress:
    stream = sys.stderr if stream is None else stream
    return Bar(stream) if stream.isatty() else PerAxis(stream, push)
