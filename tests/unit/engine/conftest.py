from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from support.engine import LABORATORIES
from support.laboratories.fake_laboratories import STATE


@pytest.fixture(autouse=True)
def state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Makes the fake laboratories importable, here and in workers. Returns the folder where they leave marks."""
    folder = tmp_path / "state"
    folder.mkdir()
    monkeypatch.setenv(STATE, str(folder))
    monkeypatch.syspath_prepend(LABORATORIES)
    yield folder


def renders_made(state: Path, adapter: str) -> int:
    """How often the fake renderer ran."""
    marks = state / f"{adapter}.renders"
    return len(marks.read_text()) if marks.exists() else 0
