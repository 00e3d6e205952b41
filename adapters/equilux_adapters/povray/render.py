"""Run POV-Ray: one process per exposure, those of a wave side by side, because each sleeps most of its time (Q25)."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from equilux.adapter import Limits, Program, RawRender, RendererCrashed, RendererFailed, RendererTimedOut
from equilux_adapters.povray.exposures import Plan, factor
from equilux_adapters.povray.float_files import FloatPlan, read_floats
from equilux_adapters.povray.knobs import PovrayKnobs
from equilux_adapters.povray.png import read_codes
from equilux_adapters.povray.translate import SETTINGS_FILE

EXECUTABLE = "povray"
SUFFIXES = {"png16": "png", "exr": "exr", "hdr": "hdr"}
POLL_S = 0.005
MESSAGE_LINES = 12
CHATTER = ("==== ", "Parsing ", "Rendered ", "POV-Ray finished")  # headings and progress
EXPERIMENTAL = "This rendering uses the following experimental feature(s):"
BACKSIDE = " backside illumination. The design and implementation of these features is"


@dataclass(frozen=True)
class Exposure:
    """One run of POV-Ray: radiances up to full_scale fill the range of the file."""

    full_scale: float
    name: str
    more: tuple[str, ...] = ()

    @property
    def arguments(self) -> list[str]:
        return [f"Output_File_Name={self.name}", f"Declare=Exposure={factor(self.full_scale)}", *self.more]


def render(program: Program, program_dir: Path, workdir: Path, limits: Limits, knobs: PovrayKnobs) -> RawRender:
    """All exposures the picture asks for. Raises RendererFailed, RendererCrashed or RendererTimedOut."""
    started = time.monotonic()
    executable = shutil.which(EXECUTABLE)
    if executable is None:
        raise RendererFailed(f"no program '{EXECUTABLE}' on PATH")
    for name in program.files:
        # POV-Ray may read and write below its working directory, wherever the run's folder is (Q26)
        shutil.copyfile(program_dir / name, workdir / name)
    run = _Runs(executable, program, workdir, started + limits.timeout_s, knobs)
    chosen = run.exposures("exposure")
    seconds = {"render": time.monotonic() - started}
    centres: list[Exposure] = []
    if knobs.antialias:
        # how far a mean over a pixel is from the radiance at its centre cannot be told from the mean (Q46)
        centres = run.exposures("centres", "Antialias=Off")
        seconds["centres"] = time.monotonic() - started - seconds["render"]
    return RawRender(
        files={exposure.name: workdir / exposure.name for exposure in (*chosen, *centres)},
        seconds=seconds,
        program_files={"command.txt": _commands((*chosen, *centres)).encode()},
        data={
            "full_scales": {exposure.name: exposure.full_scale for exposure in chosen},
            "centres": {exposure.name: exposure.full_scale for exposure in centres},
            "rendered": run.count,
        },
        environment={"threads": str(knobs.threads)},
    )


@dataclass
class _Runs:
    """One program's runs of POV-Ray. count: how many there were."""

    executable: str
    program: Program
    workdir: Path
    deadline: float
    knobs: PovrayKnobs
    count: int = 0

    def exposures(self, stem: str, *more: str) -> list[Exposure]:
        """All exposures that the picture asks for; those to merge are returned. more: settings beyond the program's."""
        plan = self._plan()
        done: list[Exposure] = []
        while scales := plan.next_wave():
            names = [f"{stem}-{len(done) + i}.{SUFFIXES[self.knobs.channel]}" for i in range(len(scales))]
            wave = [Exposure(scale, name, more) for scale, name in zip(scales, names, strict=True)]
            _run_all(self.executable, wave, self.workdir, self.deadline)
            for exposure in wave:
                self._look(plan, exposure)
            done += wave
        self.count += len(done)
        chosen = plan.chosen()
        return [exposure for exposure in done if exposure.full_scale in chosen]

    def _plan(self) -> Plan | FloatPlan:
        knobs = self.knobs
        if knobs.channel == "png16":
            return Plan(knobs.exposures, knobs.relative_precision, knobs.darkest, self.program.data["ceiling"])
        return FloatPlan(knobs.channel)

    def _look(self, plan: Plan | FloatPlan, exposure: Exposure) -> None:
        path, width, height = self.workdir / exposure.name, self.program.data["width"], self.program.data["height"]
        if isinstance(plan, Plan):
            plan.looked[exposure.full_scale] = read_codes(path, width, height)
        else:
            plan.looked[exposure.full_scale] = read_floats(path, width, height)


def _commands(exposures: Sequence[Exposure]) -> str:
    lines = ["# run here; each image is radiance × Exposure, linear; merged per band: the brightest that is not clipped"]
    lines += [f"POVINI={SETTINGS_FILE} {EXECUTABLE} {' '.join(exposure.arguments)}" for exposure in exposures]
    return "\n".join(lines) + "\n"


def _run_all(executable: str, wave: Sequence[Exposure], workdir: Path, deadline: float) -> None:
    """Run a wave side by side; whatever happens, no process outlives the call."""
    running: dict[Exposure, subprocess.Popen[bytes]] = {}
    with ExitStack() as stack:
        for exposure in wave:
            process = stack.enter_context(_start(executable, exposure, workdir))
            stack.callback(process.kill)
            running[exposure] = process
        while any(process.poll() is None for process in running.values()):
            if time.monotonic() > deadline:
                raise RendererTimedOut(f"POV-Ray still ran at the limit; it said: {_short(spoken_of(workdir, wave[0]))}")
            if any(process.poll() not in (None, 0) for process in running.values()):
                break
            time.sleep(POLL_S)
        for exposure, process in running.items():
            if process.poll() is not None:
                if process.returncode > 0 and _lost_its_reason(spoken_of(workdir, exposure)):
                    _run_once_more(executable, exposure, workdir, deadline)
                _check(exposure, process.returncode, workdir)


def _start(executable: str, exposure: Exposure, workdir: Path) -> subprocess.Popen[bytes]:
    command = [executable, *exposure.arguments]
    with open(_log(workdir, exposure), "wb") as log:
        try:
            environment = _environment(workdir)
            return subprocess.Popen(command, cwd=workdir, env=environment, stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        except OSError as problem:
            raise RendererFailed(f"{executable} cannot be run: {problem.strerror}") from problem


def _environment(workdir: Path) -> Mapping[str, str]:
    """Nothing of the user's: neither povray.ini nor a stricter povray.conf, nor a language (Q23)."""
    kept = {key: value for key, value in os.environ.items() if key in ("PATH", "LD_LIBRARY_PATH", "TMPDIR")}
    return {**kept, "HOME": str(workdir), "LC_ALL": "C", "POVINI": SETTINGS_FILE}


def _log(workdir: Path, exposure: Exposure) -> Path:
    return workdir / f"{exposure.name}.log"


def _run_once_more(executable: str, exposure: Exposure, workdir: Path, deadline: float) -> None:
    """Why a scene is not understood may get lost (Q29). POV-Ray stumbles over the same place again, and says so."""
    with _start(executable, exposure, workdir) as process:
        try:
            process.wait(max(deadline - time.monotonic(), 0.0))
        except subprocess.TimeoutExpired:
            process.kill()


def spoken_of(workdir: Path, exposure: Exposure) -> list[str]:
    """What POV-Ray said of this exposure beyond its banner."""
    return spoken(_log(workdir, exposure).read_text(errors="replace"))


def _lost_its_reason(said: Sequence[str]) -> bool:
    return any(line.startswith("Fatal error in parser") for line in said) and not any("Error:" in line for line in said)


def _check(exposure: Exposure, status: int, workdir: Path) -> None:
    said = spoken_of(workdir, exposure)
    if said:
        # the engine keeps what its worker says
        print(f"povray, {exposure.name}:", *said, sep="\n", file=sys.stderr)
    if status < 0:
        raise RendererCrashed(f"POV-Ray was ended by signal {-status}; it said: {_short(said)}", -status)
    if status > 0:
        raise RendererFailed(f"POV-Ray ended with status {status}: {_short(said)}")


def spoken(log: str) -> list[str]:
    """What POV-Ray said beyond its banner: the lines below the heading of its first phase, or all if it never came so far."""
    lines = [line.rstrip() for line in log.splitlines() if line.strip() and "user configuration file" not in line]
    lines = _without_notice(lines)
    phases = [i for i, line in enumerate(lines) if line.startswith("==== ")]
    return [line for line in lines[phases[0] :] if not line.startswith(CHATTER)] if phases else lines


def _without_notice(lines: list[str]) -> list[str]:
    """POV-Ray calls `diffuse` with two numbers experimental, in four lines for every picture (Q41)."""
    start = next((i for i, line in enumerate(lines) if EXPERIMENTAL in line), None)
    if start is None or lines[start + 1 : start + 2] != [BACKSIDE]:
        return lines
    return lines[:start] + lines[start + 4 :]


def _short(said: Sequence[str]) -> str:
    return "\n".join(said[:MESSAGE_LINES]) or "nothing"
