"""Telling the user how far a run is: a moving line on a terminal, one plain line per finished case elsewhere. Always on
stderr."""

from __future__ import annotations

import sys
from typing import IO, TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from rich.progress import Progress as RichProgress
    from rich.progress import TaskID


class Progress(Protocol):
    """What a run tells while it runs. Called from several threads."""

    def begin(self, renders: int, cases: int) -> None: ...
    def render_done(self, case: str, adapter: str, status: str) -> None: ...
    def case_done(self, line: str) -> None: ...
    def note(self, line: str) -> None: ...
    def end(self) -> None: ...


class Silent:
    """Tells nothing."""

    def begin(self, renders: int, cases: int) -> None:
        pass

    def render_done(self, case: str, adapter: str, status: str) -> None:
        pass

    def case_done(self, line: str) -> None:
        pass

    def note(self, line: str) -> None:
        pass

    def end(self) -> None:
        pass


class Plain(Silent):
    """One line per finished case; never coloured, never wrapped."""

    def __init__(self, stream: IO[str]) -> None:
        self._stream = stream
        self._cases = 0
        self._done = 0

    def begin(self, renders: int, cases: int) -> None:
        self._cases = cases

    def case_done(self, line: str) -> None:
        self._done += 1
        self.note(f"[{self._done}/{self._cases}] {line}")

    def note(self, line: str) -> None:
        self._stream.write(line + "\n")
        self._stream.flush()


class Terminal(Silent):
    """A bar that says what was finished last, and a line for whatever went wrong."""

    def __init__(self, stream: IO[str]) -> None:
        self._stream = stream
        self._bar: RichProgress | None = None
        self._task: TaskID | None = None

    def begin(self, renders: int, cases: int) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

        self._bar = Progress(
            TextColumn("rendering"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TextColumn("{task.description}", markup=False),
            console=Console(file=self._stream),
            transient=True,
        )
        self._task = self._bar.add_task("", total=renders)
        self._bar.start()

    def render_done(self, case: str, adapter: str, status: str) -> None:
        if self._bar is not None and self._task is not None:
            self._bar.update(self._task, advance=1, description=f"{case} {adapter}")

    def note(self, line: str) -> None:
        if self._bar is not None:
            self._bar.console.print(line, markup=False, highlight=False, soft_wrap=True)
        else:
            self._stream.write(line + "\n")

    def end(self) -> None:
        if self._bar is not None:
            self._bar.stop()


def suitable(stream: IO[str] | None = None) -> Progress:
    """A moving bar on a terminal, plain lines elsewhere."""
    stream = sys.stderr if stream is None else stream
    return Terminal(stream) if stream.isatty() else Plain(stream)
