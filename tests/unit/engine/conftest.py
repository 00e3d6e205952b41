from __future__ import annotations

from pathlib import Path

import pytest

from support.engine import LABORATORIES
from support.laboratories.fake_laboratories import STATE


@pytest.fixture(autouse=True)
def state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Makes the fake laboratories importable, here and in workers. Returns the folder where they leave marks."""
    folder = tmp_path / "state"
    folder.mkdir()
    monkeypatch.setenv(STATE, str(folder))
    monkeypatch.syspath_prepend(LABORATORIES)
    return folder
