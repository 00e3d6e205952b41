"""What POV-Ray and Mitsuba take for one picture, through their own adapters: start-up, scene and all, and without them."""

from __future__ import annotations

import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from bench.measured import Seconds
from equilux.adapter import Limits
from equilux_adapters.mitsuba import ADAPTER as MITSUBA
from equilux_adapters.mitsuba.knobs import MitsubaKnobs
from equilux_adapters.povray import ADAPTER as POVRAY
from equilux_adapters.povray.knobs import PovrayKnobs
from equilux_scenes.case import Case

LIMITS = Limits(timeout_s=600.0)


class PeerPicture:
    """A case translated once, drawn as often as asked for. Raises Unsupported, RendererFailed."""

    def __init__(self, folder: Path, case: Case) -> None:
        self.folder = folder
        self.case = case

    def _write(self, files: dict[str, bytes]) -> None:
        self.folder.mkdir(parents=True, exist_ok=True)
        for name, content in files.items():
            (self.folder / name).write_bytes(content)


class PovrayPicture(PeerPicture):
    """One exposure on one thread. cpu: that of the POV-Ray process."""

    def __init__(self, folder: Path, case: Case) -> None:
        super().__init__(folder, case)
        self.knobs = PovrayKnobs(exposures=1, threads=1)
        self.program = POVRAY.translate(case, self.knobs)
        self._write(dict(self.program.files))

    def draw(self) -> Seconds:
        """Everything the process does: reading the scene, drawing it, writing the file."""
        before = _of_children()
        with TemporaryDirectory() as work:
            raw = POVRAY.render(self.program, self.folder, Path(work), LIMITS, self.knobs)
        return Seconds(raw.seconds["render"], _of_children() - before)


class MitsubaPicture(PeerPicture):
    """Variant llvm_ad_rgb, direct integrator, one sample per pixel, in this process."""

    def __init__(self, folder: Path, case: Case) -> None:
        super().__init__(folder, case)
        self.knobs = MitsubaKnobs()
        self.program = MITSUBA.translate(case, self.knobs)
        self._write(dict(self.program.files))

    def draw(self) -> Seconds:
        """Loading the scene and drawing it, without the import and the compilation of kernels. cpu: of all threads, with both."""
        before = _of_self()
        with TemporaryDirectory() as work:
            raw = MITSUBA.render(self.program, self.folder, Path(work), LIMITS, self.knobs)
        return Seconds(raw.seconds["render"], _of_self() - before)


@contextmanager
def folder() -> Iterator[Path]:
    """Where programs lie while they are measured."""
    with TemporaryDirectory() as name:
        yield Path(name)


def absent(name: str) -> str:
    """Why a renderer cannot be measured here; empty if it can."""
    probe = POVRAY.probe() if name == "povray" else MITSUBA.probe()
    return "" if probe.found else probe.detail


def _of_children() -> float:
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def _of_self() -> float:
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime
