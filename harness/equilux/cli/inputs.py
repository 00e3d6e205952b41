"""What several commands take: scenes, limits, adapters; read and checked in one way."""

from __future__ import annotations

import dataclasses
import json
import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from equilux.complaint import BadUsage

if TYPE_CHECKING:
    from equilux_scenes.errors import SpecErrors
    from equilux_scenes.loader import SceneFile


def load(paths: Sequence[Path], limits: Sequence[str], *, as_json: bool = False) -> list[SceneFile]:
    """The scenes at these paths, or the shipped corpus when there are none. Raises BadUsage with every error of every file.

    With `as_json` the errors are printed to stdout as a JSON list too.
    """
    from equilux_scenes.errors import SpecErrors
    from equilux_scenes.limits import Limits
    from equilux_scenes.loader import corpus_folder, load_scenes

    try:
        bounds = Limits.from_options(limits)
    except ValueError as problem:
        raise BadUsage(str(problem)) from problem
    absent = [path for path in paths if not path.exists()]
    if absent:
        raise BadUsage(*(f"no such file or folder: '{path}'" for path in absent))
    try:
        loaded = load_scenes(list(paths) or [corpus_folder()], bounds)
    except SpecErrors as problem:
        if as_json:
            print_json(error_list(problem))
        raise BadUsage(*(str(error) for error in problem.errors)) from problem
    if not loaded:
        raise BadUsage(f"no scene found: no file named *.scene.yaml in {', '.join(repr(str(path)) for path in paths)}")
    for scene in loaded:
        for warning in scene.warnings:
            sys.stderr.write(f"{warning}\n")
    return loaded


def error_list(problem: SpecErrors) -> list[dict[str, Any]]:
    return [dataclasses.asdict(error) for error in problem.errors]


def print_json(content: Any) -> None:
    """The machine form, on stdout."""
    json.dump(content, sys.stdout, indent=1, ensure_ascii=False, allow_nan=False)
    sys.stdout.write("\n")


def split_names(option: str, text: str | None) -> list[str] | None:
    """`a,b,c` → names; None stays None. Raises BadUsage for an empty name."""
    if text is None:
        return None
    names = [name.strip() for name in text.split(",")]
    if "" in names:
        raise BadUsage(f"{option}: got '{text}', expected names separated by single commas")
    return names


def shown(path: Path) -> Path:
    """A path as a user reads it: from the working folder where it lies below it."""
    here = Path.cwd()
    return path.relative_to(here) if path.is_absolute() and path.is_relative_to(here) else path


def at_least_one(option: str, value: int) -> int:
    if value < 1:
        raise BadUsage(f"{option}: got {value}, expected an integer of at least 1")
    return value


def above_zero(option: str, value: float, unit: str) -> float:
    if not (math.isfinite(value) and value > 0):
        raise BadUsage(f"{option}: got {value:g}, expected a number of {unit} above 0")
    return value


def not_below_zero(option: str, value: float) -> float:
    if not (math.isfinite(value) and value >= 0):
        raise BadUsage(f"{option}: got {value:g}, expected a number of at least 0")
    return value


def table(rows: Sequence[Sequence[str]], right: frozenset[int] = frozenset()) -> str:
    """Rows as aligned columns, two spaces apart, never wrapped; the columns in `right` are aligned right."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = [
        "  ".join(
            cell.rjust(width) if column in right else cell.ljust(width)
            for column, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]
    return "\n".join(lines) + "\n"
