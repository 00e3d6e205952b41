"""The program handed to a renderer, as far as a page can show it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from equilux_report.facts import mapping, text
from equilux_report.tree import Render

INLINE_BYTES = 64_000
"""The start of a longer text file is shown; the whole is in the tree."""
INLINE_FILES = 24


@dataclass(frozen=True)
class ProgramFile:
    """One file of a program. `shown` is None for a binary file (and for the 25th text file and those after it)."""

    name: str
    size: int
    shown: str | None
    is_whole: bool
    is_entry: bool


def program_files(render: Render) -> list[ProgramFile]:
    """Entry first, then by name."""
    folder = render.folder / "program"
    entry = text(mapping(render.facts, "program"), "entry")
    paths = sorted(
        (path for path in folder.rglob("*") if path.is_file()),
        key=lambda path: (_name(path, folder) != entry, _name(path, folder)),
    )
    return [_file(path, _name(path, folder), entry, inline=index < INLINE_FILES) for index, path in enumerate(paths)]


def _name(path: Path, folder: Path) -> str:
    return path.relative_to(folder).as_posix()


def _file(path: Path, name: str, entry: str, *, inline: bool) -> ProgramFile:
    size = path.stat().st_size
    shown = _text(path) if inline else None
    return ProgramFile(name, size, shown, shown is not None and size <= INLINE_BYTES, name == entry)


def _text(path: Path) -> str | None:
    """The start of a text file, None for a binary one."""
    with path.open("rb") as stream:
        start = stream.read(INLINE_BYTES)
    if b"\0" in start:
        return None
    for cut in range(4):  # the cut may have split one UTF-8 sequence
        try:
            return start[: len(start) - cut].decode("utf-8")
        except UnicodeDecodeError:
            continue
    return None
