"""The folder of a measurement: taken only where it is absent, empty, or an earlier measurement's."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from equilux.complaint import BadUsage
from equilux.tree import SCRATCH_PREFIX, read_json

FILE = "tradeoff.json"


def check_usable(root: Path) -> None:
    """Raise BadUsage, touching nothing, unless the folder is absent, empty, or an earlier measurement's."""
    if not root.exists():
        return
    if not root.is_dir():
        raise BadUsage(f"--out: '{root}' is a file, expected a folder")
    held = sorted(entry.name for entry in root.iterdir() if not entry.name.startswith(SCRATCH_PREFIX))
    before = read_json(root / FILE) or {}
    if held and not str(before.get("schema", "")).startswith("equilux/tradeoff/"):
        shown = ", ".join(f"'{name}'" for name in held[:3]) + (f" and {len(held) - 3} more" if len(held) > 3 else "")
        raise BadUsage(
            f"--out: '{root}' holds {shown} and is no measurement of 'equilux tradeoff'; give an empty folder or a new one"
        )


@contextmanager
def scratch_in(root: Path) -> Iterator[Path]:
    """A folder for pictures, in `root`, gone afterwards: renderers may write where the results lie. Raises BadUsage."""
    try:
        root.mkdir(parents=True, exist_ok=True)
        folder = Path(tempfile.mkdtemp(dir=root.absolute(), prefix=SCRATCH_PREFIX))
    except OSError as problem:
        raise BadUsage(f"--out: '{root}' cannot be written: {problem.strerror}") from problem
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
