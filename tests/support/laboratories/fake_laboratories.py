"""Adapters that misbehave in every way the engine must survive, and a few that behave. No renderer behind any of them.

The picture of the well-behaved ones is a ramp that depends on the film alone (`ramp`), so that whoever plays the truth agrees
with them.
"""

from __future__ import annotations

import contextlib
import ctypes
import fcntl
import io
import os
import signal
import struct
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from pydantic import Field

from equilux.adapter import (
    API_VERSION,
    Bound,
    Budget,
    Capability,
    Case,
    Knobs,
    Limits,
    Probe,
    Program,
    RawRender,
    Reading,
    RendererCrashed,
    RendererFailed,
    RendererTimedOut,
    Unsupported,
)
from equilux_scenes.features import FEATURES

STATE = "EQUILUX_FAKE_STATE"
"""Environment variable: a folder in which fakes leave marks between processes."""
EXACT = Budget((Bound("storage", "half a unit in the last place of float32", rel=2.0**-24, abs=2.0**-150),))


def ramp(width: int, height: int, dtype: Any = np.float32) -> np.ndarray:
    """(h, w, 3): 0.5 and up, different in every pixel and band, exact in float32."""
    count = np.arange(width * height * 3, dtype=np.float64).reshape(height, width, 3)
    return (0.5 + count / 4096).astype(dtype)


class FakeKnobs(Knobs):
    level: int = Field(default=1, ge=0, le=9, description="the picture is brighter by level − 1", json_schema_extra={"faster": 1})


class Fake:
    """Does what a laboratory does; `render_hook` and `read_hook` are where it goes wrong."""

    api_version = API_VERSION
    Knobs: ClassVar[type[Knobs]] = FakeKnobs
    workers_per_core: ClassVar[float] = 8.0
    lack_causes: ClassVar[Mapping[str, str]] = {"material.specular": "highlight-missing"}

    def __init__(
        self,
        name: str,
        read: Callable[[np.ndarray], Any] | None = None,
        render: Callable[[Path, Limits], None] | None = None,
        lacks: tuple[str, ...] = (),
        found: bool = True,
    ) -> None:
        self.name = name
        self._read, self._render, self._lacks, self._found = read, render, lacks, found

    def version(self) -> str:
        return f"fake {os.environ.get('EQUILUX_FAKE_VERSION', '1.0')}"

    def probe(self) -> Probe:
        return Probe(self._found, "part of the tests" if self._found else "no such program: fake-renderer")

    def capabilities(self) -> Mapping[str, Capability]:
        return {feature: Capability("exact") for feature in FEATURES if feature not in self._lacks}

    def translate(self, case: Case, knobs: Any) -> Program:
        text = f"ramp {case.scene.film.width} {case.scene.film.height} {knobs.level}\n"
        return Program({"scene.txt": text.encode(), "lib/colours.txt": b"none\n"}, "scene.txt")

    def render(self, program: Program, program_dir: Path, workdir: Path, limits: Limits, knobs: Any) -> RawRender:
        if self._render is not None:
            self._render(workdir, limits)
        if state := os.environ.get(STATE):
            with open(Path(state) / f"{self.name}.renders", "a") as marks:
                marks.write("x")
        return RawRender({"out": workdir / "out"}, {"start": 0.0, "render": 0.001}, environment={"fake": "yes"})

    def read(self, raw: RawRender, program: Program, knobs: Any) -> Any:
        _, width, height, level = program.files["scene.txt"].split()
        image = ramp(int(width), int(height)) + np.float32(int(level) - 1)
        return Reading(image, EXACT) if self._read is None else self._read(image)


# --- pictures that are wrong --------------------------------------------------------------------------------------------


def spoiled(value: float) -> Callable[[np.ndarray], Reading]:
    def read(image: np.ndarray) -> Reading:
        image[1, 2, 1] = value
        return Reading(image, EXACT)

    return read


def _brighter(image: np.ndarray) -> Reading:
    return Reading(image * np.float32(1.01), EXACT)


def _double(image: np.ndarray) -> Reading:
    return Reading(image.astype(np.float64), Budget())


# --- renderers that go wrong --------------------------------------------------------------------------------------------


def _hang(workdir: Path, limits: Limits) -> None:
    time.sleep(600)


def _spawn_and_hang(workdir: Path, limits: Limits) -> None:
    """Leaves three children: one in the group, one in a session of its own, one orphaned in a session of its own."""
    children = [subprocess.Popen(["sleep", "600"]), subprocess.Popen(["sleep", "600"], start_new_session=True)]
    leave_an_orphan = "setsid sleep 600 >/dev/null 2>&1 & echo $!"
    orphan = subprocess.run(["sh", "-c", leave_an_orphan], capture_output=True, check=True, text=True)
    pids = [child.pid for child in children] + [int(orphan.stdout)]
    (Path(os.environ[STATE]) / "children").write_text(" ".join(map(str, pids)))
    time.sleep(600)


def _segfault(workdir: Path, limits: Limits) -> None:
    print("about to read address 0", file=sys.stderr)
    ctypes.string_at(0)


def _die_once(workdir: Path, limits: Limits) -> None:
    mark = Path(os.environ[STATE]) / "died-once"
    if not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)


def _eat_memory(workdir: Path, limits: Limits) -> None:
    """In a grandchild: what the worker itself holds is not the point."""
    code = "import time\nheld = []\nwhile True:\n    held.append(bytearray(b'x') * (16 << 20))\n    time.sleep(0.01)\n"
    subprocess.run([sys.executable, "-c", code], check=False)


def _reply_pipe() -> int:
    """The worker's private pipe to the engine: the one pipe that can be written, beside stdout and stderr."""
    for fd in sorted(int(name) for name in os.listdir("/proc/self/fd"))[3:]:
        with contextlib.suppress(OSError):
            is_pipe = os.readlink(f"/proc/self/fd/{fd}").startswith("pipe:")
            if is_pipe and fcntl.fcntl(fd, fcntl.F_GETFL) & os.O_ACCMODE == os.O_WRONLY:
                return fd
    raise RuntimeError("no pipe")


def _write_garbage(workdir: Path, limits: Limits) -> None:
    os.write(_reply_pipe(), b"\x00\xff garbage, and more of it")
    time.sleep(600)


def _write_huge_reply(workdir: Path, limits: Limits) -> None:
    os.write(_reply_pipe(), struct.pack("<4sI", b"EQX1", 0xFFFFFFFF) + b"x" * 4096)
    time.sleep(600)


def _write_wrong_json(workdir: Path, limits: Limits) -> None:
    payload = b'{"done": -1, "outcome": {"status": "ok"}}'
    os.write(_reply_pipe(), struct.pack("<4sI", b"EQX1", len(payload)) + payload)
    time.sleep(600)


def _close_pipe(workdir: Path, limits: Limits) -> None:
    os.close(_reply_pipe())
    time.sleep(600)


def _exit_silently(workdir: Path, limits: Limits) -> None:
    os._exit(0)


def _print_a_lot(workdir: Path, limits: Limits) -> None:
    print("EQX1 on stdout")
    os.write(1, b"\xff\xfe raw bytes on stdout\n" * 1000)
    ctypes.CDLL(None).puts(b"C says hello")
    subprocess.run(["sh", "-c", "echo a child says hello >&2"], check=True)


def _raise(workdir: Path, limits: Limits) -> None:
    raise ZeroDivisionError("the renderer divided by zero")


def _exit(workdir: Path, limits: Limits) -> None:
    sys.exit("the adapter wants to leave")


def _fail(workdir: Path, limits: Limits) -> None:
    raise RendererFailed("parse error in line 3")


def _its_own_crash(workdir: Path, limits: Limits) -> None:
    raise RendererCrashed("fake-renderer was ended by SIGABRT", signal.SIGABRT)


def _its_own_timeout(workdir: Path, limits: Limits) -> None:
    raise RendererTimedOut(f"fake-renderer took more than {limits.timeout_s:g} s")


def _die_idle(workdir: Path, limits: Limits) -> None:
    """Ends the worker a moment after it has delivered, when it is idle."""
    subprocess.Popen(["sh", "-c", f"sleep 0.3; kill -9 {os.getpid()}"])


class _Untranslatable(Fake):
    def translate(self, case: Case, knobs: Any) -> Program:
        raise Unsupported(["light.point"], "point lights beyond 3 m")


class _Escaping(Fake):
    def translate(self, case: Case, knobs: Any) -> Program:
        return Program({"../../escaped.txt": b"here I am"}, "../../escaped.txt")


class _NoProgram(Fake):
    def translate(self, case: Case, knobs: Any) -> Any:
        return None


class _Timeless(Fake):
    def render(self, program: Program, program_dir: Path, workdir: Path, limits: Limits, knobs: Any) -> RawRender:
        return RawRender({}, {"render": float("nan")})


class TunableKnobs(Knobs):
    quality: int = Field(
        default=2, ge=0, le=4, description="decimal digits that are right",
        json_schema_extra={"faster": "smaller", "steps": [1, 2, 3]},
    )
    colour: str = Field(default="plain", description="not traded: it has no steps")


class Tunable(Fake):
    """The true picture, too bright by 10^-quality, and says so: what a knob that trades speed for accuracy does."""

    Knobs: ClassVar[type[Knobs]] = TunableKnobs

    def translate(self, case: Case, knobs: Any) -> Program:
        import equilux_oracle

        stream = io.BytesIO()
        np.save(stream, equilux_oracle.radiance_with_bound(case)[0])
        return Program({"scene.txt": f"quality {knobs.quality}\n".encode(), "true.npy": stream.getvalue()}, "scene.txt")

    def render(self, program: Program, program_dir: Path, workdir: Path, limits: Limits, knobs: Any) -> RawRender:
        if knobs.quality > 3:
            raise RendererFailed("no such quality on this machine")
        return super().render(program, program_dir, workdir, limits, knobs)

    def read(self, raw: RawRender, program: Program, knobs: Any) -> Any:
        error = 10.0**-knobs.quality
        image = np.load(io.BytesIO(program.files["true.npy"])) * (1 + error)
        return Reading(image, Budget((Bound("tuned", "by its knob", rel=error),)))


class _CannotTell(Fake):
    def version(self) -> str:
        raise RuntimeError("no version")

    def probe(self) -> Probe:
        raise OSError("no idea")

    def capabilities(self) -> Mapping[str, Capability]:
        raise KeyError("which?")


ADAPTERS: dict[str, Fake] = {
    fake.name: fake
    for fake in (
        # the truths, and laboratories that agree with them or do not
        Fake("oracle", read=_double, lacks=("shape.mesh",)),
        Fake("reference", read=_double),
        Fake("good"),
        Fake("talkative", render=_print_a_lot),
        Fake("bright", read=_brighter),
        Fake("matte", lacks=("material.specular",)),
        Fake("absent", found=False),
        Fake("slow", render=lambda workdir, limits: time.sleep(0.5)),
        # pictures that never pass
        Fake("nan", read=spoiled(float("nan"))),
        Fake("infinite", read=spoiled(float("inf"))),
        Fake("negative", read=spoiled(-1.0)),
        Fake("blank", read=lambda image: Reading(image * 0, EXACT)),
        Fake("truncated", read=lambda image: Reading(image[:-1], EXACT)),
        Fake("transposed", read=lambda image: Reading(image.transpose(1, 0, 2), EXACT)),
        Fake("integers", read=lambda image: Reading((image * 100).astype(np.uint8), EXACT)),
        Fake("listed", read=lambda image: Reading(image.tolist(), EXACT)),
        Fake("bare", read=lambda image: image),
        Fake("boundless", read=lambda image: Reading(image, Budget((Bound("b", "no bound", abs=float("inf")),)))),
        Fake("budgetless", read=lambda image: Reading(image, None)),  # type: ignore[arg-type]
        # renderers that do not deliver
        Fake("hanging", render=_hang),
        Fake("breeding", render=_spawn_and_hang),
        Fake("segfaulting", render=_segfault),
        Fake("dying-once", render=_die_once),
        Fake("dying-idle", render=_die_idle),
        Fake("hungry", render=_eat_memory),
        Fake("garbling", render=_write_garbage),
        Fake("shouting", render=_write_huge_reply),
        Fake("lying", render=_write_wrong_json),
        Fake("closing", render=_close_pipe),
        Fake("leaving", render=_exit_silently),
        Fake("raising", render=_raise),
        Fake("exiting", render=_exit),
        Fake("failing", render=_fail),
        Fake("crashing", render=_its_own_crash),
        Fake("timing-out", render=_its_own_timeout),
        _Untranslatable("untranslatable"),
        _Escaping("escaping"),
        _NoProgram("programless"),
        _Timeless("timeless"),
        _CannotTell("speechless"),
        Tunable("tunable"),
    )
}


def __getattr__(name: str) -> Any:
    """`fake_laboratories:dying_once` is the adapter `dying-once`."""
    adapter = ADAPTERS.get(name.replace("_", "-"))
    if adapter is None:
        raise AttributeError(name)
    return adapter
