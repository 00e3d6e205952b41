"""The process in which one adapter lives; forked from the nursery.

It translates, renders and reads one case after another. Whatever the adapter does to it (prints, exceptions, `sys.exit`, death)
stays here: stdout and stderr go to the job's log, and messages go over two private pipes that the adapter's own children never
inherit.
"""

from __future__ import annotations

import ctypes
import hashlib
import json
import math
import os
import pickle
import resource
import signal
import sys
import time
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict
from importlib.metadata import EntryPoint
from pathlib import Path, PurePosixPath
from typing import Any, TypeVar

import numpy as np

from equilux import budget_file, wire
from equilux.adapter import (
    Adapter,
    Program,
    RawRender,
    Reading,
    RendererCrashed,
    RendererFailed,
    RendererTimedOut,
    Unsupported,
)
from equilux.job import BUDGET_FILE, IMAGE_FILE, LOG_FILE, PROGRAM_FOLDER, WORK_FOLDER, Job, Outcome
from equilux.registry import GROUP, load

PR_SET_CHILD_SUBREAPER = 36
TRACEBACK_LINES = 12

T = TypeVar("T")


class BadDelivery(Exception):
    """The adapter returned something that the protocol does not allow. The message says what, and what was expected."""


def main(name: str, entry_point: str, requests: int, replies: int) -> None:
    """Serve jobs until the engine closes the request pipe. The first message says where the engine is: environment,
    search path, working folder."""
    for fd in (requests, replies):
        os.set_inheritable(fd, False)
    _settle_process()
    surroundings = json.loads(wire.receive(requests))
    os.environ.clear()
    os.environ.update(surroundings["environment"])
    os.chdir(surroundings["folder"])
    sys.path.extend(entry for entry in surroundings["path"] if entry not in sys.path)
    adapter = _load(name, entry_point, replies)
    if adapter is None:
        return
    _reply(replies, {"ready": name})
    while True:
        try:
            request = wire.receive(requests)
        except wire.Closed:
            return
        job: Job = pickle.loads(request)
        _redirect_output(job.folder / LOG_FILE)
        _reply(replies, {"accepted": job.number})
        outcome = perform(adapter, job)
        _flush_output()
        _reply(replies, {"done": job.number, "outcome": asdict(outcome)})


def _settle_process() -> None:
    """Leave no core files, and adopt orphaned grandchildren so that the engine sees (and ends) them as ours."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if sys.platform == "linux":
        ctypes.CDLL(None, use_errno=True).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def _load(name: str, value: str, replies: int) -> Adapter | None:
    """The adapter; None after having told the engine why there is none."""
    loaded = load(EntryPoint(name=name, value=value, group=GROUP))
    if loaded.adapter is None:
        _reply(replies, {"unusable": loaded.error})
    return loaded.adapter


def _reply(replies: int, message: dict[str, Any]) -> None:
    wire.send(replies, json.dumps(message).encode())


def _redirect_output(log: Path) -> None:
    """Send everything that is printed from here on, by Python, C and children alike, to the job's log."""
    _flush_output()
    fd = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o644)
    os.dup2(fd, 1)
    os.dup2(fd, 2)
    os.close(fd)


def _flush_output() -> None:
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError, AttributeError):
            continue  # an adapter may have closed or replaced it; its output is its own affair
    ctypes.CDLL(None).fflush(None)


def perform(adapter: Adapter, job: Job) -> Outcome:
    """Translate, write the program, render, read, check, save. Every way in which that can go wrong is an outcome."""
    outcome = Outcome("failed")
    try:
        _perform(adapter, job, outcome)
        outcome.status = "ok"
    except Unsupported as problem:
        outcome.status, outcome.reason = "unsupported", str(problem.reason)
        outcome.missing_features = [str(feature) for feature in problem.missing_features]
    except RendererTimedOut as problem:
        outcome.status, outcome.reason = "timeout", str(problem)
    except RendererCrashed as problem:
        outcome.status, outcome.reason, outcome.signal = "crashed", str(problem), int(problem.signal)
    except (RendererFailed, BadDelivery, budget_file.MalformedBudget) as problem:
        outcome.reason = str(problem)
    except BaseException as problem:  # SystemExit and KeyboardInterrupt of an adapter are its failures, not ours
        outcome.reason = f"the adapter raised {' '.join(traceback.format_exception_only(problem)[-1].split())}"
        sys.stderr.write("".join("".join(traceback.format_exception(problem)).splitlines(keepends=True)[-TRACEBACK_LINES:]))
    return outcome


def _perform(adapter: Adapter, job: Job, outcome: Outcome) -> None:
    knobs = adapter.Knobs.model_validate(job.knobs)
    program_folder, work_folder = job.folder / PROGRAM_FOLDER, job.folder / WORK_FOLDER
    work_folder.mkdir()

    with _timed(outcome, "translate"):
        program = _expect_type(adapter.translate(job.case, knobs), Program, "translate()")
    _write_program(program_folder, program.files)
    if program.entry not in program.files:
        raise BadDelivery(
            f"translate() names the entry {program.entry!r}, which is not among its files: "
            f"{', '.join(map(str, program.files)) or 'none'}"
        )
    outcome.program = describe_program(program_folder, program.entry)

    with _timed(outcome, "render"):
        raw = _expect_type(adapter.render(program, program_folder, work_folder, job.limits, knobs), RawRender, "render()")
    outcome.seconds |= {"start": 0.0} | _checked_seconds(raw.seconds)
    outcome.environment = {str(key): str(value) for key, value in raw.environment.items()}
    _write_program(program_folder, raw.program_files)
    outcome.program = describe_program(program_folder, program.entry)

    with _timed(outcome, "read"):
        reading = _expect_type(adapter.read(raw, program, knobs), Reading, "read()")
    film = job.case.scene.film
    image = checked_image(reading.image, (film.height, film.width, 3))
    budget_file.save(budget_file.check(reading.budget, image.shape), job.folder / BUDGET_FILE)
    np.save(job.folder / IMAGE_FILE, image, allow_pickle=False)


@contextmanager
def _timed(outcome: Outcome, phase: str) -> Iterator[None]:
    """Note the wall and the CPU time of a phase. CPU: of this process, all its threads, and its children that have ended, which
    is not wall time: a renderer may sleep, or use several cores."""
    wall, cpu = time.perf_counter(), _cpu_seconds()
    yield
    outcome.seconds[phase] = time.perf_counter() - wall
    outcome.cpu_seconds[phase] = _cpu_seconds() - cpu


def _cpu_seconds() -> float:
    """User and system time of this process and of the children that it has waited for, and theirs in turn."""
    usages = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


def _checked_seconds(given: Mapping[str, float]) -> dict[str, float]:
    seconds = {str(phase): float(value) for phase, value in given.items()}
    for phase, value in seconds.items():
        if not (math.isfinite(value) and value >= 0):
            raise BadDelivery(f"render() says that '{phase}' took {value} s, expected a finite number of at least 0")
    return seconds


def _expect_type(got: object, expected: type[T], who: str) -> T:
    if not isinstance(got, expected):
        raise BadDelivery(f"{who} returned {type(got).__name__}, expected equilux.adapter.{expected.__name__}")
    return got


def checked_image(image: object, shape: tuple[int, int, int]) -> np.ndarray[Any, Any]:
    """The image as native-endian contiguous float32 or float64 of this shape. Raises BadDelivery naming what was expected."""
    expected = f"expected float32 or float64 of shape {shape}"
    if not isinstance(image, np.ndarray):
        raise BadDelivery(f"read() returned an image of type {type(image).__name__}, {expected}")
    if image.dtype.newbyteorder("=") not in (np.dtype(np.float32), np.dtype(np.float64)) or image.shape != shape:
        exchanged = image.shape == (shape[1], shape[0], shape[2]) != shape
        hint = ": rows and columns are exchanged (row 0 on top, then row by row)" if exchanged else ""
        raise BadDelivery(f"read() returned an image of {image.dtype} and shape {image.shape}, {expected}{hint}")
    return np.ascontiguousarray(image, dtype=image.dtype.newbyteorder("="))


def _write_program(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write the files of a program below its folder, and nowhere else."""
    folder.mkdir(exist_ok=True)
    for name, content in files.items():
        path = PurePosixPath(name)
        if path.is_absolute() or ".." in path.parts or not path.parts or "\0" in name:
            raise BadDelivery(f"the program names the file {name!r}, expected a path inside the program's folder")
        if not isinstance(content, bytes):
            raise BadDelivery(f"the program's file {name!r} is {type(content).__name__}, expected bytes")
        target = folder / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content)


def describe_program(folder: Path, entry: str) -> dict[str, Any]:
    """Entry, files and one hash over all names and contents, in order of name."""
    sha = hashlib.sha256()
    names = sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())
    for name in names:
        content = (folder / name).read_bytes()
        sha.update(f"{len(name.encode())} {len(content)} ".encode() + name.encode() + content)
    return {"entry": entry, "sha256": sha.hexdigest(), "files": names}
