"""Content-addressed reuse: what was computed once from the same inputs by the same code is not computed again.

An entry is a folder named by the hash of everything that determines its content, holding files and their own hashes. It appears
by one rename, so any number of runs may share a store; a damaged entry counts as absent and is replaced.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import tempfile
import time
from collections.abc import Callable, Iterable
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

FORMAT = "1"
ENTRY = "entry.json"
MAX_BYTES = 4 << 30
STALE_TEMPORARY_S = 24 * 3600.0


def default_root() -> Path:
    """`$EQUILUX_CACHE`, else the user's cache folder."""
    if given := os.environ.get("EQUILUX_CACHE"):
        return Path(given)
    from platformdirs import user_cache_path

    return user_cache_path("equilux")


def key(**parts: Any) -> str:
    """Hash of everything that determines an entry."""
    return hashlib.sha256(json.dumps({"format": FORMAT, **parts}, sort_keys=True, default=str).encode()).hexdigest()


class Store:
    """Entries by kind and key under one folder. A store that cannot be written (read-only home) simply remembers nothing."""

    def __init__(self, root: Path, max_bytes: int = MAX_BYTES) -> None:
        self.root = root
        self.max_bytes = max_bytes
        self.written = 0

    def fetch(self, kind: str, key: str, into: Path) -> bool:
        """Copy the entry's files into a folder. False when there is no sound entry; `into` may then hold some files."""
        folder = self._folder(kind, key)
        try:
            hashes = json.loads((folder / ENTRY).read_bytes())["files"]
            for name, expected in hashes.items():
                content = (folder / name).read_bytes()
                if hashlib.sha256(content).hexdigest() != expected:
                    raise ValueError(f"{name} is damaged")
                target = into / name
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_bytes(content)
            os.utime(folder)  # pruning goes by last use
        except FileNotFoundError:
            return False
        except (OSError, ValueError, KeyError, TypeError, AttributeError):
            shutil.rmtree(folder, ignore_errors=True)
            return False
        return True

    def holds(self, kind: str, key: str) -> bool:
        """Whether there is an entry; whether it is sound, `fetch` finds out."""
        return (self._folder(kind, key) / ENTRY).is_file()

    def put(self, kind: str, key: str, fill: Callable[[Path], None]) -> None:
        """Add an entry; `fill` writes its files into a folder. Failing to write is no error: it is only not remembered."""
        folder = self._folder(kind, key)
        try:
            folder.parent.mkdir(parents=True, exist_ok=True)
            waiting = self.root / "incoming"
            waiting.mkdir(exist_ok=True)
            temporary = Path(tempfile.mkdtemp(dir=waiting))
        except OSError:
            return
        try:
            fill(temporary)
            files = {
                path.relative_to(temporary).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
                for path in sorted(temporary.rglob("*"))
                if path.is_file()
            }
            (temporary / ENTRY).write_text(json.dumps({"files": files}))
            os.rename(temporary, folder)
            self.written += 1
        except OSError:
            shutil.rmtree(temporary, ignore_errors=True)  # another run was first, or the disk is full

    def prune(self) -> None:
        """Bring the store under its size by dropping what was used longest ago, and what dead runs left half-written."""
        entries = [(entry.stat().st_mtime, _size(entry), entry) for entry in self._entries()]
        excess = sum(size for _, size, _ in entries) - self.max_bytes
        for _, size, entry in sorted(entries, key=lambda item: item[0]):
            if excess <= 0:
                break
            shutil.rmtree(entry, ignore_errors=True)
            excess -= size
        for left in (self.root / "incoming").glob("*"):
            try:
                if time.time() - left.stat().st_mtime > STALE_TEMPORARY_S:
                    shutil.rmtree(left, ignore_errors=True)
            except FileNotFoundError:
                continue

    def _folder(self, kind: str, key: str) -> Path:
        return self.root / kind / key[:2] / key

    def _entries(self) -> Iterable[Path]:
        for entry in self.root.glob("*/??/*"):
            if entry.is_dir() and entry.parent.parent.name != "incoming":
                yield entry


def _size(folder: Path) -> int:
    total = 0
    for path in folder.rglob("*"):
        try:
            total += path.stat().st_size if path.is_file() else 0
        except FileNotFoundError:
            continue
    return total


@lru_cache(maxsize=64)
def code_fingerprint(*modules: str) -> str:
    """Hash of all files of these modules or packages: a changed source file means that nothing made by the old one is reused."""
    sha = hashlib.sha256()
    for module in modules:
        for name, path in sorted(_files_of(module)):
            sha.update(f"{module} {name} ".encode() + hashlib.sha256(path.read_bytes()).digest())
    return sha.hexdigest()


def _files_of(module: str) -> list[tuple[str, Path]]:
    try:
        spec = find_spec(module)
    except (ImportError, ValueError):
        return []
    if spec is None:
        return []
    if spec.submodule_search_locations is None:
        return [("", Path(spec.origin))] if spec.origin is not None and Path(spec.origin).is_file() else []
    return [
        (path.relative_to(folder).as_posix(), path)
        for folder in map(Path, spec.submodule_search_locations)
        for path in folder.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts and path.suffix not in (".md", ".pyi")
    ]
