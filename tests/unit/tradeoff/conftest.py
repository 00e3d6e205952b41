from __future__ import annotations

from pathlib import Path

import pytest

from support.engine import LABORATORIES


@pytest.fixture(autouse=True)
def laboratories(monkeypatch: pytest.MonkeyPatch) -> Path:
    """Makes the fake laboratories importable, here and in workers."""
    monkeypatch.syspath_prepend(LABORATORIES)
    return LABORATORIES
