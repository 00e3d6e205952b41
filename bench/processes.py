"""What a command and everything it starts cost: wall, CPU, peak memory, and how much of the time the cores had nothing to do."""

from __future__ import annotations

import os
import subprocess
import threading
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import psutil

from equilux.process_tree import Tree

LOOK_S = 0.1


@dataclass(frozen=True)
class Cost:
    """wall_s, cpu_s: of the whole process tree. peak_bytes: the most that was resident in the tree at a look, shared pages
    counted once per process. starved: share of looks at which fewer threads of the tree could run than there are cores; on a
    busy machine it tells what the wall cannot."""

    wall_s: float
    cpu_s: float
    peak_bytes: int
    starved: float
    status: int
    output: str


@dataclass
class _Looks:
    """One thread that looks at a process tree from time to time."""

    root: int
    cores: int
    peak_bytes: int = 0
    looks: int = 0
    starved: int = 0
    _over: threading.Event = field(default_factory=threading.Event)

    def look_until_over(self) -> None:
        while not self._over.wait(LOOK_S):
            try:
                root = psutil.Process(self.root)
                tree = [root, *root.children(recursive=True)]
            except psutil.Error:
                return
            self.looks += 1
            self.starved += sum(_ready_threads(process.pid) for process in tree) < self.cores
            self.peak_bytes = max(self.peak_bytes, sum(_resident(process) for process in tree))

    def end(self) -> None:
        self._over.set()


def run(
    command: Sequence[str], environment: Mapping[str, str] | None = None, *, cores: int = 1, limit_s: float | None = None
) -> Cost:
    """Run a command to its end. Raises OSError where it cannot be started, TimeoutError where it took longer than limit_s: then
    it is ended, and all that it started."""
    before = os.times()
    started = time.perf_counter()
    process = subprocess.Popen(
        command, env={**os.environ, **(environment or {})}, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    looks = _Looks(process.pid, cores)
    watcher = threading.Thread(target=looks.look_until_over, daemon=True)
    watcher.start()
    try:
        output, _ = process.communicate(timeout=limit_s)  # its CPU time and that of all it waited for is ours from here on
    except subprocess.TimeoutExpired:
        looks.end()
        Tree(process.pid).kill()
        process.communicate()
        raise TimeoutError(f"longer than {limit_s:g} s") from None
    wall = time.perf_counter() - started
    looks.end()
    watcher.join()
    after = os.times()
    cpu = after.children_user + after.children_system - before.children_user - before.children_system
    return Cost(wall, cpu, looks.peak_bytes, looks.starved / max(looks.looks, 1), process.returncode, output)


def _ready_threads(pid: int) -> int:
    """Threads of a process that run or could run (Linux; elsewhere none is known)."""
    ready = 0
    try:
        for thread in Path(f"/proc/{pid}/task").iterdir():
            ready += (thread / "stat").read_text(encoding="utf-8", errors="replace").rpartition(")")[2].split()[0] in "RD"
    except OSError:
        pass  # it ended meanwhile
    return ready


def _resident(process: psutil.Process) -> int:
    try:
        return int(process.memory_info().rss)
    except psutil.Error:
        return 0
