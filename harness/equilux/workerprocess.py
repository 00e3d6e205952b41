"""The engine's end of a worker: start it, hand it one job at a time, and turn every way of not answering into an outcome."""

from __future__ import annotations

import json
import os
import pickle
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from equilux import wire
from equilux.job import LOG_FILE, Job, Outcome
from equilux.process_tree import Tree, Watch
from equilux.workerstart import START_TIMEOUT_S, CannotStart, shared_nursery

GRACE_S = 2.0
TIMEOUT_MARGIN_S = 1.0
"""An adapter that watches the limit itself gets this much longer, so that it can say what it waited for."""
TAIL_BYTES = 4000


class WorkerUnusable(Exception):
    """The worker did not come up, or died idle. The message says why; no case is to blame."""


class WorkerProcess:
    """One worker of one adapter. Not thread-safe, except `kill`."""

    def __init__(self, adapter: str, entry_point: str, watch: Watch, log: Path) -> None:
        """Start the process; it loads the adapter while the caller goes on. Raises WorkerUnusable.

        entry_point: where the adapter is, `module:object`. log: takes what is printed before the first job.
        """
        self.adapter = adapter
        self._watch = watch
        self._log = log
        self._over: str | None = None  # why we ended it, when we did
        self._ready = False
        request_read, self._requests = os.pipe()
        self._replies, reply_write = os.pipe()
        try:
            self._process = shared_nursery().start(adapter, entry_point, request_read, reply_write, log)
        except (CannotStart, OSError) as problem:
            os.close(self._requests)
            os.close(self._replies)
            raise WorkerUnusable(f"the worker of '{adapter}' cannot be started: {problem}") from problem
        finally:
            os.close(request_read)
            os.close(reply_write)
        self.tree = Tree(self._process.pid)
        for fd in (self._requests, self._replies):
            os.set_blocking(fd, False)

    @property
    def alive(self) -> bool:
        return self._process.alive

    def wait_ready(self) -> None:
        """Wait until the adapter is loaded. Raises WorkerUnusable."""
        if self._ready:
            return
        deadline = time.monotonic() + START_TIMEOUT_S
        try:
            surroundings = {"path": sys.path, "environment": dict(os.environ), "folder": os.getcwd()}
            wire.send(self._requests, json.dumps(surroundings).encode(), deadline)
            answer = self._receive(deadline)
        except wire.TookTooLong as problem:
            raise WorkerUnusable(
                f"the worker of '{self.adapter}' was not ready within {START_TIMEOUT_S:g} s{self._said()}"
            ) from problem
        except wire.Garbage as problem:
            raise WorkerUnusable(f"the worker of '{self.adapter}' sent garbage while starting: {problem}") from problem
        except wire.Closed as problem:
            raise WorkerUnusable(
                f"the worker of '{self.adapter}' ended while starting ({self._ending()[1]}){self._said()}"
            ) from problem
        if "ready" not in answer:
            raise WorkerUnusable(str(answer.get("unusable", f"the worker of '{self.adapter}' answered {answer!r}")))
        self._ready = True

    def perform(self, job: Job) -> Outcome:
        """Run one job to its end. Raises WorkerUnusable when the worker died before it had the job."""
        self.wait_ready()
        started = time.monotonic()
        deadline = started + job.limits.timeout_s + TIMEOUT_MARGIN_S
        self._watch.add(self.tree, job.limits.memory_bytes, lambda seen: self._exceeded(seen, job.limits.memory_bytes))
        accepted = False
        try:
            wire.send(self._requests, pickle.dumps(job, protocol=pickle.HIGHEST_PROTOCOL), deadline)
            self._expect(self._receive(deadline), "accepted", job.number)
            accepted = True
            answer = self._expect(self._receive(deadline), "done", job.number)
            outcome = _outcome(answer["outcome"])
        except wire.TookTooLong:
            self._put_down()
            outcome = Outcome("timeout", f"no picture within {job.limits.timeout_s:g} s; its process group was ended")
        except wire.Garbage as problem:
            self._put_down()
            outcome = Outcome("failed", f"the worker wrote garbage instead of a reply: {problem}")
        except wire.Closed as problem:
            if not accepted and self._over is None:
                raise WorkerUnusable(
                    f"the worker of '{self.adapter}' died before it took a job ({self._ending()[1]}){self._said()}"
                ) from problem
            outcome = self._died()
        finally:
            self._watch.remove(self.tree)
        return replace(outcome, stderr_tail=tail(job.folder / LOG_FILE))

    def close(self) -> None:
        """End the worker: politely when it is idle, then for good, with everything it started."""
        for fd in (self._requests, self._replies):
            os.close(fd)
        self._process.wait(GRACE_S)
        self._put_down()
        self._process.release()

    def kill(self, why: str | None = None) -> None:
        """End the worker and everything it started, at once. May be called from any thread."""
        self._over = self._over or why
        self.tree.kill()

    def _put_down(self) -> None:
        self.kill()
        self._process.wait()

    def _receive(self, deadline: float) -> dict[str, Any]:
        payload = wire.receive(self._replies, deadline, wire.MAX_REPLY)
        try:
            message = json.loads(payload)
        except (ValueError, RecursionError) as problem:
            raise wire.Garbage(f"not JSON: {payload[:60]!r}") from problem
        if not isinstance(message, dict):
            raise wire.Garbage(f"not a JSON object: {payload[:60]!r}")
        return message

    def _expect(self, message: dict[str, Any], key: str, number: int) -> dict[str, Any]:
        if message.get(key) != number:
            raise wire.Garbage(f"expected '{key}' of job {number}, got {str(message)[:100]}")
        return message

    def _exceeded(self, seen: int, limit: int) -> None:
        self.kill(
            f"the memory limit: {seen / 2**20:.0f} MiB resident, the limit is {limit / 2**20:.0f} MiB; "
            "its process group was ended"
        )

    def _ending(self) -> tuple[int, str]:
        """Exit status of the ended worker, and the same in words."""
        if not self._process.wait(GRACE_S):
            self._put_down()  # it closed its pipe and lives on: as good as dead to us
            return 0, "it closed its reply pipe"
        code = self._process.status
        if code is None:
            return 0, "the nursery is gone, and with it the knowledge of how"
        return code, (f"signal {-code}, {signal_name(-code)}" if code < 0 else f"exit status {code}")

    def _died(self) -> Outcome:
        code, words = self._ending()
        self.tree.kill()
        if self._over is not None:
            return Outcome("crashed", self._over, signal=9)
        if code < 0:
            return Outcome("crashed", f"the worker was ended by {words}", signal=-code)
        return Outcome("failed", f"the worker ended without a reply ({words})")

    def _said(self) -> str:
        """The last line the worker printed, for a message."""
        lines = tail(self._log).strip().splitlines()
        return f": {lines[-1]}" if lines else ""


def signal_name(number: int) -> str:
    import signal

    try:
        return signal.Signals(number).name
    except ValueError:
        return "unknown"


def tail(log: Path) -> str:
    """The last few kilobytes of a log, whatever bytes it holds; empty when there is none."""
    try:
        with log.open("rb") as stream:
            stream.seek(0, os.SEEK_END)
            stream.seek(max(0, stream.tell() - TAIL_BYTES))
            return stream.read().decode(errors="replace")
    except OSError:
        return ""


_OUTCOME = TypeAdapter(Outcome)


def _outcome(data: Any) -> Outcome:
    """The outcome a worker stated. Raises Garbage when it is not one."""
    try:
        outcome: Outcome = _OUTCOME.validate_python(data)
    except ValidationError as problem:
        raise wire.Garbage(f"not an outcome: {problem.errors()[0]['msg']} in {str(data)[:100]}") from problem
    if outcome.status not in ("ok", "unsupported", "timeout", "crashed", "failed"):
        raise wire.Garbage(f"not an outcome: the status is {outcome.status[:100]!r}")
    return outcome
