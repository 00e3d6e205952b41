"""One fake results tree for the tests that only read it."""

from __future__ import annotations

from pathlib import Path

import pytest

from browser.fake_tree import write_tree


@pytest.fixture(scope="session")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_tree(tmp_path_factory.mktemp("report") / "run")
