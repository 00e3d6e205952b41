"""The engine's end of the nursery: starting workers, and knowing when they have ended."""

from __future__ import annotations

import atexit
import itertools
import json
import os
import socket
import subprocess
import sys
import tempfile
import threading
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

START_TIMEOUT_S = 60.0
"""For importing an adapter and its renderer's library on a busy machine; a render has its own limit."""


class CannotStart(Exception):
    """No worker can be started. The message says why."""


@dataclass(eq=False)
class Started:
    """A worker process as the engine knows it."""

    pid: int
    nursery: Nursery
    status: int | None = None
    """Exit status, negative for a signal; None while it runs, and when nobody saw its end."""
    _ended: threading.Event = field(default_factory=threading.Event)

    @property
    def alive(self) -> bool:
        return not self._ended.is_set()

    def wait(self, timeout_s: float | None = None) -> bool:
        """Wait for its end. False when it still runs after that time."""
        return self._ended.wait(timeout_s)

    def release(self) -> None:
        """Let go of its process id, once it has ended."""
        self.nursery.send({"release": self.pid})

    def note_end(self, status: int | None) -> None:
        self.status = status
        self._ended.set()


class Nursery:
    """One nursery process; any thread may start workers from it."""

    def __init__(self) -> None:
        self._control, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._said = tempfile.TemporaryFile()  # noqa: SIM115 - lives as long as the nursery
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", "equilux.nursery", str(theirs.fileno())],
            stdin=subprocess.DEVNULL, stdout=self._said, stderr=self._said, pass_fds=(theirs.fileno(),), start_new_session=True,
        )  # fmt: skip
        theirs.close()
        self._numbers = itertools.count(1)
        self._lock = threading.Lock()
        self._workers: dict[int, Started] = {}
        self._births: dict[int, tuple[threading.Event, list[Started]]] = {}
        self._gone = threading.Event()
        threading.Thread(target=self._listen, name="equilux-nursery", daemon=True).start()

    @property
    def alive(self) -> bool:
        return not self._gone.is_set()

    def start(self, adapter: str, entry_point: str, requests: int, replies: int, log: Path) -> Started:
        """Start a worker that reads jobs from one descriptor and answers on another. Raises CannotStart."""
        number = next(self._numbers)
        born = threading.Event(), list[Started]()
        with self._lock:
            self._births[number] = born
        message = {"start": number, "adapter": adapter, "entry_point": entry_point}
        output = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o644)
        try:
            socket.send_fds(self._control, [json.dumps(message).encode()], [requests, replies, output])
        except OSError as problem:
            raise CannotStart(f"workers cannot be started: {problem}{self._last_words()}") from problem
        finally:
            os.close(output)
        born[0].wait(START_TIMEOUT_S)
        if not born[1]:
            raise CannotStart(f"no worker was started within {START_TIMEOUT_S:g} s{self._last_words()}")
        return born[1][0]

    def send(self, message: dict[str, Any]) -> None:
        """Tell the nursery something; one that is gone need not know."""
        if self.alive:
            try:
                self._control.send(json.dumps(message).encode())
            except OSError:
                self._gone.set()

    def close(self) -> None:
        """End the nursery, and with it every worker that is left."""
        with suppress(OSError):  # gone already
            self._control.shutdown(socket.SHUT_RDWR)  # closing alone tells nobody while a thread of ours still listens
        self._control.close()
        try:
            self._process.wait(5)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def _listen(self) -> None:
        while True:
            try:
                packet = self._control.recv(1 << 16)
            except OSError:
                packet = b""
            if not packet:
                break
            message = json.loads(packet)
            with self._lock:
                if "started" in message:
                    event, box = self._births.pop(message["started"])
                    self._workers[message["pid"]] = started = Started(message["pid"], self)
                    box.append(started)
                    event.set()
                elif "ended" in message:
                    self._workers.pop(message["ended"]).note_end(message["status"])
        self._lose_everything()

    def _lose_everything(self) -> None:
        """The nursery is gone: nobody will ever say how its workers ended."""
        with self._lock:
            self._gone.set()
            for worker in self._workers.values():
                worker.note_end(None)
            for event, _ in self._births.values():
                event.set()
            self._workers.clear()
            self._births.clear()

    def _last_words(self) -> str:
        self._said.seek(0)
        lines = self._said.read().decode(errors="replace").strip().splitlines()
        return f": {lines[-1]}" if lines else ""


_shared: Nursery | None = None
_shared_lock = threading.Lock()


def shared_nursery() -> Nursery:
    """The one nursery of this process, started on first use and again when it has died."""
    global _shared
    with _shared_lock:
        if _shared is None or not _shared.alive:
            if _shared is None:
                atexit.register(_close_shared)
            _shared = Nursery()
        return _shared


def _close_shared() -> None:
    if _shared is not None:
        _shared.close()
