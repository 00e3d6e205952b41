"""What the outputs for a CI are made from: the results, where files lie, and what was asked for."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from equilux.adapter import Case
from equilux.readrun import ReadRun
from equilux.results import Results


@dataclass(frozen=True)
class RunView:
    """tree: the results tree. named: adapters that were asked for by name. sources: scene → its spec file. errors: faults of the
    engine itself.
    """

    results: Results
    tree: Path
    named: frozenset[str] = frozenset()
    sources: Mapping[str, Path] = field(default_factory=dict)
    errors: tuple[str, ...] = ()

    @property
    def read(self) -> ReadRun:
        """The tree as `equilux explain` reads it, with paths as a reader types them."""
        return ReadRun(Path(shown(self.tree)), self.results, {})


def shown(path: Path) -> str:
    """A path as a reader types it: from the working folder where it lies below it."""
    here = Path.cwd()
    absolute = path.absolute()
    return (absolute.relative_to(here) if absolute.is_relative_to(here) else absolute).as_posix()


def sources_of(cases: Iterable[Case]) -> dict[str, Path]:
    """Scene → spec file, of the cases that came from files."""
    return {case.scene_name: case.source for case in cases if case.source is not None}
