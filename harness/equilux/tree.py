"""The results tree (contracts §3): where everything lies, and how it gets there whole or not at all."""

from __future__ import annotations

import fcntl
import json
import os
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from equilux.complaint import BadUsage

RUN_SCHEMA = "equilux/run/1"
OURS = (
    "run.json", "results.json", "junit.xml", "summary.md", "expectations.patch", "cases", "report", "extremes.json", "extremes",
    "inputs.json",
)  # fmt: skip
"""What a results tree consists of; nothing else in the folder is ever touched."""
INPUTS_FILE = "inputs.json"
SCRATCH_PREFIX = ".scratch-"


def read_json(path: Path) -> dict[str, Any] | None:
    """The JSON object in a file; None where there is no file or something else in it."""
    try:
        content = json.loads(path.read_bytes())
    except (OSError, ValueError):
        return None
    return content if isinstance(content, dict) else None


class Tree:
    """A results tree that this process, and no other, is writing. Close it to let others."""

    def __init__(self, root: Path, lock: int, *, continued: bool) -> None:
        self.root = root
        self.continued = continued
        self._lock = lock
        self.scratch = Path(tempfile.mkdtemp(dir=root, prefix=SCRATCH_PREFIX))

    @classmethod
    def open(cls, root: Path, identity: Mapping[str, Any], *, keep: bool = True) -> Tree:
        """Make the folder ready to be written.

        An absent or empty folder is taken; a results tree of the same identity (scenes, adapters, versions, knobs) is continued
        when `keep`; any other results tree is emptied of what is ours. Raises BadUsage, touching nothing, for a folder that
        holds anything else, and for one that another run is writing.
        """
        check_usable(root)
        root = root.absolute()  # renderers are run in folders of their own
        try:
            root.mkdir(parents=True, exist_ok=True)
            lock = _lock(root)
        except OSError as problem:
            raise BadUsage(f"--out: '{root}' cannot be written: {problem.strerror}") from problem
        for left in root.glob(f"{SCRATCH_PREFIX}*"):
            shutil.rmtree(left, ignore_errors=True)  # of a run that was killed: we hold the lock, so nobody uses it
        before = read_json(root / "run.json")
        continued = keep and before is not None and before.get("identity") == json.loads(json.dumps(identity))
        if not continued:
            _empty(root)
        try:
            return cls(root, lock, continued=continued)
        except OSError as problem:
            raise BadUsage(f"--out: '{root}' cannot be written: {problem.strerror}") from problem

    def close(self) -> None:
        shutil.rmtree(self.scratch, ignore_errors=True)
        os.close(self._lock)

    def __enter__(self) -> Tree:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def case_folder(self, case: str) -> Path:
        return self.root / "cases" / case

    def render_folder(self, case: str, adapter: str) -> Path:
        return self.case_folder(case) / adapter

    def pairs_folder(self, case: str) -> Path:
        folder = self.case_folder(case) / "pairs"
        folder.mkdir(parents=True, exist_ok=True)
        return folder

    def stage(self) -> Path:
        """A fresh folder on the tree's file system, to be filled and then installed."""
        return Path(tempfile.mkdtemp(dir=self.scratch, prefix="stage-"))

    def install_render(self, staged: Path, case: str, adapter: str) -> Path:
        """Move a finished render's folder into its place, over whatever was there."""
        target = self.render_folder(case, adapter)
        target.parent.mkdir(parents=True, exist_ok=True)
        staged.chmod(0o755)
        if target.exists():
            os.replace(target, self.scratch / f"old-{staged.name}")
        os.replace(staged, target)
        return target

    def drop_pairs(self, case: str, adapter: str) -> None:
        """Remove the pairs of a render that is about to be replaced or has failed."""
        folder = self.case_folder(case) / "pairs"
        for path in folder.glob("*--*.*"):
            if adapter in path.name.rpartition(".")[0].split("--"):
                path.unlink(missing_ok=True)


def is_results_tree(root: Path) -> bool:
    manifest = read_json(root / "run.json")
    return manifest is not None and str(manifest.get("schema", "")).startswith("equilux/run/")


def check_usable(root: Path) -> None:
    """Raise BadUsage, touching nothing, unless the folder is absent, empty, or a results tree."""
    if not root.exists():
        return
    if not root.is_dir():
        raise BadUsage(f"--out: '{root}' is a file, expected a folder")
    held = sorted(entry.name for entry in root.iterdir() if not entry.name.startswith(SCRATCH_PREFIX))
    if held and not is_results_tree(root):
        shown = ", ".join(f"'{name}'" for name in held[:3]) + (f" and {len(held) - 3} more" if len(held) > 3 else "")
        raise BadUsage(
            f"--out: '{root}' holds {shown} and is no results tree; give an empty folder, a new one, or an earlier run's"
        )


def _lock(root: Path) -> int:
    """An exclusive lock on the folder itself, gone with the process however that ends."""
    fd = os.open(root, os.O_RDONLY | os.O_DIRECTORY)
    try:
        fcntl.flock(fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(fd)
        raise BadUsage(f"--out: another run is writing to '{root}'; wait for it or give another folder") from None
    return fd


def _empty(root: Path) -> None:
    for name in OURS:
        path = root / name
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        else:
            path.unlink(missing_ok=True)
