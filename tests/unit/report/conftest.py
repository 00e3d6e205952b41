"""One fake results tree for the tests that only read it."""

from __future__ import annotations

from pathlib import Path

import pytest

from browser.fake_causes import write_diagnosed_tree
from browser.fake_tree import write_tree


@pytest.fixture(scope="session")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_tree(tmp_path_factory.mktemp("report") / "run")


@pytest.fixture(scope="session")
def diagnosed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One whose divergences have causes."""
    return write_diagnosed_tree(tmp_path_factory.mktemp("diagnosed") / "run")
