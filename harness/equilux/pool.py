"""Running many jobs in workers: who goes next, which worker takes it, and what happens when it dies.

`capacity` cores are shared. A running job counts 1/workers_per_core of its adapter, and another is started as long as the cores
are not all taken; so a renderer that mostly sleeps runs many times over, and one that computes runs once per core. Among the
adapters that have work left, the one that holds the least goes next.
"""

from __future__ import annotations

import itertools
import os
import shutil
import threading
from collections import deque
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from queue import SimpleQueue
from typing import Any

from equilux.adapter import Case, Limits
from equilux.job import Job, Outcome
from equilux.process_tree import Watch
from equilux.workerprocess import WorkerProcess, WorkerUnusable

MAX_CONCURRENT = 64
STARTS_BEFORE_GIVING_UP = 2


@dataclass(frozen=True)
class Request:
    """One render that is wanted."""

    case: Case
    adapter: str
    knobs: Mapping[str, Any]
    limits: Limits


@dataclass(frozen=True)
class Laboratory:
    """What the pool must know of an adapter: where a worker finds it, and how many renders go at once per core."""

    name: str
    entry_point: str
    workers_per_core: float


@dataclass
class Lane:
    """One adapter's share of the pool: what waits, what runs, which workers idle."""

    laboratory: Laboratory
    share: float
    waiting: deque[Request] = field(default_factory=deque)
    load: float = 0.0
    idle: list[WorkerProcess] = field(default_factory=list)
    failed_starts: int = 0
    given_up: str | None = None


class Pool:
    """Workers for several adapters. Use as a context manager: leaving it ends every worker."""

    def __init__(self, capacity: float, laboratories: Iterable[Laboratory], scratch: Path) -> None:
        self._capacity = capacity
        self._lanes = {each.name: Lane(each, 1.0 / each.workers_per_core) for each in laboratories}
        self._scratch = scratch
        self._numbers = itertools.count(1)
        self._lock = threading.Lock()
        self._workers: set[WorkerProcess] = set()
        self._watch = Watch()
        self._threads = ThreadPoolExecutor(MAX_CONCURRENT, thread_name_prefix="equilux-render")
        self._finished: SimpleQueue[tuple[Request, Outcome, Path] | None] = SimpleQueue()
        self._stopped = False
        self._running = 0

    def __enter__(self) -> Pool:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()
        self._threads.shutdown(wait=True, cancel_futures=True)
        with self._lock:
            workers, self._workers = self._workers, set()
        for worker in workers:
            worker.kill()
        for worker in workers:
            worker.close()
        self._watch.close()

    def stop(self) -> None:
        """Start nothing more and end what runs. Safe in a signal handler: it takes no lock."""
        self._stopped = True
        self._finished.put(None)

    def run(self, requests: Iterable[Request], done: Callable[[Request, Outcome, Path], None]) -> None:
        """Run all requests; `done(request, outcome, folder)` is called in this thread as each ends. Returns early once stopped.

        `folder` holds what the job wrote (job.py names the files) and belongs to `done`.
        """
        for request in requests:
            self._lanes[request.adapter].waiting.append(request)
        while not self._stopped:
            self._start_what_fits()
            if not self._running:
                return
            finished = self._finished.get()
            if finished is None:
                break
            request, outcome, folder = finished
            lane = self._lanes[request.adapter]
            lane.load -= lane.share
            self._running -= 1
            done(request, outcome, folder)
        with self._lock:
            workers = list(self._workers)
        for worker in workers:
            worker.kill("the run was stopped")

    def _start_what_fits(self) -> None:
        while self._running < MAX_CONCURRENT and sum(lane.load for lane in self._lanes.values()) < self._capacity - 1e-9:
            ready = [lane for lane in self._lanes.values() if lane.waiting]
            if not ready:
                return
            lane = min(ready, key=lambda lane: (lane.load, lane.share))
            lane.load += lane.share
            self._running += 1
            self._threads.submit(self._render, lane.waiting.popleft(), lane)

    def _render(self, request: Request, lane: Lane) -> None:
        folder = self._fresh_folder()
        try:
            outcome, folder = self._attempt(request, lane, folder)
        except Exception as problem:  # the engine's own fault (a full disk): the case fails, the run goes on
            outcome = Outcome("failed", f"the engine could not run the job: {type(problem).__name__}: {problem}")
        self._finished.put((request, outcome, folder))

    def _attempt(self, request: Request, lane: Lane, folder: Path) -> tuple[Outcome, Path]:
        """One job, and once more in a fresh worker when its process died of it."""
        for attempt in (1, 2):
            if self._stopped:
                return Outcome("failed", "the run was stopped", attempts=attempt), folder
            try:
                outcome, worker = self._in_some_worker(request, lane, folder, fresh=attempt == 2)
            except WorkerUnusable as problem:
                return Outcome("failed", str(problem), attempts=attempt), folder
            outcome.attempts = attempt
            died = outcome.status == "crashed" or not worker.alive
            if worker.alive and outcome.status != "crashed" and not self._stopped:
                with self._lock:
                    lane.idle.append(worker)
            else:
                self._discard(worker)
            if not died or outcome.status == "timeout" or attempt == 2 or self._stopped:
                return outcome, folder
            shutil.rmtree(folder)
            folder = self._fresh_folder()
        raise AssertionError("unreachable: the second attempt returns")

    def _in_some_worker(self, request: Request, lane: Lane, folder: Path, *, fresh: bool) -> tuple[Outcome, WorkerProcess]:
        """Give the job to an idle worker, else a new one. A worker found dead while idle is replaced and charges no case."""
        while True:
            worker = self._take_worker(lane, fresh=fresh)
            job = Job(next(self._numbers), request.case, dict(request.knobs), folder, request.limits)
            try:
                worker.wait_ready()
                outcome = worker.perform(job)
                lane.failed_starts = 0
                return outcome, worker
            except WorkerUnusable as problem:
                self._discard(worker)
                lane.failed_starts += 1
                if self._stopped or lane.failed_starts >= STARTS_BEFORE_GIVING_UP:
                    lane.given_up = str(problem)
                    raise

    def _take_worker(self, lane: Lane, *, fresh: bool) -> WorkerProcess:
        if lane.given_up is not None:
            raise WorkerUnusable(lane.given_up)
        while not fresh:
            with self._lock:
                worker = lane.idle.pop() if lane.idle else None
            if worker is None:
                break
            if worker.alive:
                return worker
            self._discard(worker)  # it died while idle
        log = self._scratch / f"worker-{os.getpid()}-{next(self._numbers)}.log"
        worker = WorkerProcess(lane.laboratory.name, lane.laboratory.entry_point, self._watch, log)
        with self._lock:
            self._workers.add(worker)
        if self._stopped:  # stop() may have looked at the workers before this one was among them
            worker.kill("the run was stopped")
        return worker

    def _discard(self, worker: WorkerProcess) -> None:
        with self._lock:
            self._workers.discard(worker)
        worker.kill()
        worker.close()

    def _fresh_folder(self) -> Path:
        folder = self._scratch / f"job-{os.getpid()}-{next(self._numbers)}"
        folder.mkdir(parents=True)
        return folder
