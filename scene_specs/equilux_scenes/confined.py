"""Opening files that a spec names or is: regular files of bounded size, and never outside the scene's own folder."""

from __future__ import annotations

import os
import stat
from pathlib import Path


class CannotRead(OSError):
    """Why a file is not read; `limit` is the size that it has where that is more than allowed."""

    def __init__(self, why: str, size: int | None = None) -> None:
        super().__init__(why)
        self.why = why
        self.size = size


def inside(folder: Path, name: str) -> Path:
    """The file called `name` in `folder` or below it. Raises CannotRead for absolute names, `..`, and links that lead outside."""
    if not name or "\0" in name or "\\" in name:
        raise CannotRead("not a file name (folders are separated by '/')")
    if Path(name).is_absolute() or ".." in Path(name).parts:
        raise CannotRead("outside the scene's folder")
    try:
        path = (folder / name).resolve()
        base = folder.resolve()
    except (OSError, RuntimeError):  # a loop of symbolic links
        raise CannotRead("a symbolic link that leads nowhere") from None
    if not path.is_relative_to(base):
        raise CannotRead("a symbolic link that leads outside the scene's folder")
    return path


def read_bytes(path: Path, limit: int) -> bytes:
    """The content of a regular file of at most `limit` bytes. Raises CannotRead; never blocks on a pipe or device."""
    try:
        # without O_NONBLOCK, opening a pipe that nobody writes to would wait forever
        descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0))
    except OSError as error:
        raise CannotRead(_why(error)) from None
    try:
        _check(os.fstat(descriptor), limit)
        with os.fdopen(descriptor, "rb", closefd=False) as file:
            content = file.read(limit + 1)
    except CannotRead:
        raise
    except OSError as error:
        raise CannotRead(_why(error)) from None
    finally:
        os.close(descriptor)
    if len(content) > limit:  # it grew meanwhile
        raise CannotRead("too large", size=len(content))
    return content


def _check(status: os.stat_result, limit: int) -> None:
    if stat.S_ISDIR(status.st_mode):
        raise CannotRead("a folder")
    if not stat.S_ISREG(status.st_mode):
        raise CannotRead("not a regular file")
    if status.st_size > limit:
        raise CannotRead("too large", size=status.st_size)


def _why(error: OSError) -> str:
    known = {FileNotFoundError: "no such file", PermissionError: "no permission to read it", IsADirectoryError: "a folder"}
    return known.get(type(error), (error.strerror or "cannot be opened").lower())
