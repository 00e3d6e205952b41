from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from equilux.cli import run_command
from support.engine import LABORATORIES, write_scene


@dataclass(frozen=True)
class Said:
    """What a command answered."""

    code: int
    out: str
    err: str


Command = Callable[..., Said]


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty working folder, a cache of its own, and the fake laboratories installed beside the real ones."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("EQUILUX_CACHE", str(tmp_path / ".cache"))
    monkeypatch.setenv("PYTHONPATH", str(LABORATORIES))
    monkeypatch.syspath_prepend(LABORATORIES)
    return tmp_path


@pytest.fixture
def equilux(capfd: pytest.CaptureFixture[str]) -> Command:
    """Runs a command in this process: quick, and stdout and stderr are those a user would see."""

    def call(*arguments: object) -> Said:
        capfd.readouterr()
        code = run_command([str(argument) for argument in arguments])
        return Said(code, *capfd.readouterr())

    return call


@pytest.fixture
def shell() -> Command:
    """Runs a command as a user's shell does."""

    def call(*arguments: object) -> Said:
        command = [sys.executable, "-m", "equilux", *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, text=True, env=os.environ, timeout=120)
        return Said(done.returncode, done.stdout, done.stderr)

    return call


@pytest.fixture
def tiny(tmp_path: Path) -> Path:
    """A scene file whose truths are the real oracle and the real reference."""
    return write_scene(tmp_path / "tiny.scene.yaml")

