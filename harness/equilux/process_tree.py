"""Everything a worker has started: how much memory it holds, and how it is ended.

A worker leads its own session and adopts orphans, so its tree is its descendants; members that moved to a session of their own
are found by descent, members orphaned by the worker's own death by its process group and by having been seen before.
"""

from __future__ import annotations

import contextlib
import os
import signal
import threading
import time
from collections.abc import Callable, Iterable

import psutil

POLL_S = 0.05
SHARE_OF_A_CORE = 0.1
"""Looking must not cost more than this share of a core, however many processes there are."""


class Tree:
    """The processes of one worker, as last seen."""

    def __init__(self, root: int) -> None:
        self.root = root
        self.members: dict[int, psutil.Process] = {}
        self.resident_bytes = 0

    def kill(self) -> None:
        """SIGKILL to all of them: the group at once, then whoever is outside it."""
        outsiders = {process.pid: process for process in descendants(self.root)} | self.members
        with contextlib.suppress(psutil.Error):
            outsiders[self.root] = psutil.Process(self.root)
        with contextlib.suppress(ProcessLookupError, PermissionError):  # the group is already gone; outsiders may not be
            os.killpg(self.root, signal.SIGKILL)
        for process in outsiders.values():
            try:
                process.kill()  # psutil checks the start time: a recycled pid is left alone
            except psutil.Error:
                continue


def descendants(pid: int) -> list[psutil.Process]:
    try:
        found: list[psutil.Process] = psutil.Process(pid).children(recursive=True)
        return found
    except psutil.Error:
        return []


class Watch:
    """One thread that looks at the trees of all workers and tells whoever exceeds its limit."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._watched: dict[int, tuple[Tree, int, Callable[[int], None]]] = {}
        self._wake = threading.Event()
        self._ended = False
        self._thread = threading.Thread(target=self._look_again_and_again, name="equilux-memory", daemon=True)
        self._thread.start()

    def add(self, tree: Tree, limit_bytes: int, exceeded: Callable[[int], None]) -> None:
        """Watch a tree; `exceeded` is called once, from the watching thread, with the bytes seen."""
        with self._lock:
            self._watched[tree.root] = (tree, limit_bytes, exceeded)
        self._wake.set()

    def remove(self, tree: Tree) -> None:
        with self._lock:
            self._watched.pop(tree.root, None)

    def close(self) -> None:
        self._ended = True
        self._wake.set()
        self._thread.join()

    def _look_again_and_again(self) -> None:
        while not self._ended:
            started = time.perf_counter()
            with self._lock:
                watched = dict(self._watched)
            if not watched:
                self._wake.wait()
                self._wake.clear()
                continue
            self._look(watched)
            time.sleep(max(POLL_S, (time.perf_counter() - started) / SHARE_OF_A_CORE))

    def _look(self, watched: dict[int, tuple[Tree, int, Callable[[int], None]]]) -> None:
        """One scan of the process table for all trees together."""
        parents = {process.pid: process for process in descendants(os.getpid())}
        roots = _roots(parents.values(), set(watched))
        for root, (tree, limit, exceeded) in watched.items():
            tree.members = {pid: parents[pid] for pid, its_root in roots.items() if its_root == root}
            tree.resident_bytes = sum(_resident(process) for process in tree.members.values())
            if tree.resident_bytes > limit:
                self.remove(tree)
                exceeded(tree.resident_bytes)


def _roots(processes: Iterable[psutil.Process], roots: set[int]) -> dict[int, int]:
    """Process id → the watched root it descends from (the root itself included)."""
    parent: dict[int, int] = {}
    for process in processes:
        try:
            parent[process.pid] = process.ppid()
        except psutil.Error:
            continue
    found: dict[int, int] = {}
    for pid in parent:
        ancestor = pid
        while ancestor not in roots and ancestor in parent:
            ancestor = parent[ancestor]
        if ancestor in roots:
            found[pid] = ancestor
    return found


def _resident(process: psutil.Process) -> int:
    try:
        return int(process.memory_info().rss)
    except psutil.Error:
        return 0
