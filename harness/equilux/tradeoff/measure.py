"""Rendering the same pictures again and again, and noting what each took.

Round by round, renderer by renderer, each in a fresh worker and alone on the machine: what disturbs the machine for a while
disturbs all settings alike, and no setting profits from what an earlier round left in a worker. Nothing is reused.
"""

from __future__ import annotations

import hashlib
import json
import shutil
import tempfile
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import psutil

from equilux.adapter import Case, Limits
from equilux.identity import case_digest
from equilux.job import BUDGET_FILE, IMAGE_FILE, LOG_FILE, PROGRAM_FOLDER, WORK_FOLDER, Job, Outcome
from equilux.pool import Laboratory
from equilux.process_tree import Watch
from equilux.workerprocess import WorkerProcess, WorkerUnusable

TOTAL = "total"
SMALL_FILM = (8, 6)
"""Of the picture that shows what every picture costs however small it is."""


@dataclass(frozen=True)
class Shot:
    """One picture that is measured."""

    case: Case
    adapter: str
    knobs: Mapping[str, Any]

    @property
    def key(self) -> str:
        """Equal for shots that are the same picture, so that it is made once per round whoever asks for it."""
        return json.dumps([case_digest(self.case), self.adapter, dict(self.knobs)], sort_keys=True)


@dataclass
class Taken:
    """What came of one shot, over all rounds. wall, cpu: seconds by phase, one entry per round. pictures: folders with image and
    budget, one for each different picture. The first failure is kept, and the shot is not tried again."""

    status: str = "ok"
    reason: str | None = None
    wall: list[dict[str, float]] = field(default_factory=list)
    cpu: list[dict[str, float]] = field(default_factory=list)
    pictures: dict[str, Path] = field(default_factory=dict)


@dataclass
class Started:
    """Seconds of each round: the first small picture of a worker, from the fork on, and the second; wall and CPU."""

    first: list[tuple[float, float]] = field(default_factory=list)
    second: list[tuple[float, float]] = field(default_factory=list)


@dataclass
class Measurement:
    """By key of the shot, and by adapter."""

    taken: dict[str, Taken] = field(default_factory=dict)
    started: dict[str, Started] = field(default_factory=dict)


def measure(
    shots: Sequence[Shot], laboratories: Sequence[Laboratory], *, repeats: int, scratch: Path, limits: Limits,
    tell: Callable[[str], None] = lambda _line: None,
) -> Measurement:  # fmt: skip
    """Make every shot `repeats` times. scratch: an existing folder; the pictures stay in it. Failures are data."""
    wanted = {shot.key: shot for shot in shots}
    found = Measurement({key: Taken() for key in wanted})
    watch = Watch()
    try:
        for number in range(repeats):
            turned = _turned(laboratories, number)
            for place, laboratory in enumerate(turned):
                mine = [shot for shot in wanted.values() if shot.adapter == laboratory.name]
                tell(f"round {number + 1} of {repeats}, {place + 1} of {len(turned)}: {laboratory.name}, {len(mine)} pictures")
                _Round(laboratory, found, scratch, limits, watch).make(_turned(mine, number * len(mine) // max(repeats, 1)))
    finally:
        watch.close()
    return found


def _turned(items: Sequence[Any], by: int) -> list[Any]:
    """Another one goes first in every round."""
    by %= max(len(items), 1)
    return [*items[by:], *items[:by]]


@dataclass
class _Round:
    """One renderer's turn in one round."""

    laboratory: Laboratory
    found: Measurement
    scratch: Path
    limits: Limits
    watch: Watch
    _worker: WorkerProcess | None = None
    _number: int = 0

    def make(self, shots: Iterable[Shot]) -> None:
        try:
            for index, shot in enumerate(shots):
                if index == 0:
                    self._start_up(shot)
                taken = self.found.taken[shot.key]
                if taken.status == "ok":
                    self._take(shot, taken)
        finally:
            self._end_worker()

    def _start_up(self, shot: Shot) -> None:
        """A small picture in the fresh worker, and once more. Where it fails, the shots themselves will say why."""
        width, height = SMALL_FILM
        scene = shot.case.scene
        film = scene.film.model_copy(update={"width": width, "height": height})
        small = replace(shot, case=replace(shot.case, scene=scene.model_copy(update={"film": film})), knobs={})
        seen = self.found.started.setdefault(self.laboratory.name, Started())
        for into in (seen.first, seen.second):
            before = time.perf_counter(), self._cpu()
            folder, outcome = self._perform(small)
            after = time.perf_counter(), self._cpu()
            shutil.rmtree(folder, ignore_errors=True)
            if outcome.status != "ok":
                return
            into.append((after[0] - before[0], after[1] - before[1]))

    def _take(self, shot: Shot, taken: Taken) -> None:
        folder, outcome = self._perform(shot)
        if outcome.status != "ok":
            taken.status, taken.reason = outcome.status, outcome.reason
            shutil.rmtree(folder, ignore_errors=True)
            self._end_worker()  # the next picture must not suffer from this one
            return
        taken.wall.append(outcome.seconds | {TOTAL: sum(outcome.seconds.values())})
        taken.cpu.append(outcome.cpu_seconds | {TOTAL: sum(outcome.cpu_seconds.values())})
        self._keep(folder, taken)

    def _keep(self, folder: Path, taken: Taken) -> None:
        """Keep image and budget where they are new."""
        sha = hashlib.sha256()
        for name in (IMAGE_FILE, BUDGET_FILE):
            sha.update((folder / name).read_bytes())
        if sha.hexdigest() in taken.pictures:
            shutil.rmtree(folder, ignore_errors=True)
            return
        for name in (PROGRAM_FOLDER, WORK_FOLDER):
            shutil.rmtree(folder / name, ignore_errors=True)
        (folder / LOG_FILE).unlink(missing_ok=True)
        taken.pictures[sha.hexdigest()] = folder

    def _perform(self, shot: Shot) -> tuple[Path, Outcome]:
        """One picture, in this round's worker; in a new one where there is none."""
        self._number += 1
        folder = Path(tempfile.mkdtemp(dir=self.scratch, prefix="shot-"))
        try:
            if self._worker is None or not self._worker.alive:
                self._end_worker()
                log = self.scratch / f"worker-{self.laboratory.name}.log"
                self._worker = WorkerProcess(self.laboratory.name, self.laboratory.entry_point, self.watch, log)
            job = Job(self._number, shot.case, dict(shot.knobs), folder, self.limits)
            return folder, self._worker.perform(job)
        except WorkerUnusable as problem:
            self._end_worker()
            return folder, Outcome("failed", str(problem))

    def _cpu(self) -> float:
        """CPU seconds of the worker since its fork, with the children that it has waited for."""
        if self._worker is None or not self._worker.alive:
            return 0.0
        try:
            times = psutil.Process(self._worker.tree.root).cpu_times()
        except psutil.Error:
            return 0.0
        return float(times.user + times.system + times.children_user + times.children_system)

    def _end_worker(self) -> None:
        if self._worker is not None:
            self._worker.close()
            self._worker = None
