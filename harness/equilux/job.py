"""One render as data: what the engine asks of a worker, and what a worker answers."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import ConfigDict

from equilux.adapter import Case, Limits

IMAGE_FILE = "image.npy"
BUDGET_FILE = "budget.npz"
LOG_FILE = "worker.log"
PROGRAM_FOLDER = "program"
WORK_FOLDER = "work"


@dataclass(frozen=True)
class Job:
    """Render `case`. Everything is written under `folder`, which is the job's own and fresh: see the file names above."""

    number: int
    case: Case
    knobs: dict[str, Any]
    folder: Path
    limits: Limits


@dataclass
class Outcome:
    """What became of a job. `status` is one of contracts §3, except `invalid`, which only the finished picture shows."""

    __pydantic_config__ = ConfigDict(extra="forbid", allow_inf_nan=False)  # a worker's word is checked

    status: str
    reason: str | None = None
    missing_features: list[str] = field(default_factory=list)
    signal: int | None = None
    attempts: int = 1
    seconds: dict[str, float] = field(default_factory=dict)
    cpu_seconds: dict[str, float] = field(default_factory=dict)
    environment: dict[str, str] = field(default_factory=dict)
    program: dict[str, Any] | None = None
    stderr_tail: str = ""
