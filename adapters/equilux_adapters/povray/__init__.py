"""POV-Ray as a laboratory: scene description language in, 16-bit exposures out. What it does differently is in QUIRKS.md."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import ClassVar

from equilux.adapter import API_VERSION, Capability, Case, Limits, Probe, Program, RawRender, Reading
from equilux.dialect import Declared
from equilux_adapters.povray.capabilities import CAPABILITIES, DIALECT
from equilux_adapters.povray.knobs import PovrayKnobs

__all__ = ["ADAPTER", "PovrayAdapter"]


class PovrayAdapter:
    """POV-Ray 3.7, the command-line program."""

    name = "povray"
    title = "POV-Ray"
    api_version = API_VERSION
    Knobs: ClassVar[type[PovrayKnobs]] = PovrayKnobs
    workers_per_core: ClassVar[float] = 4.0  # a process takes 0.7 s and computes for 0.05 s of it (Q25)
    lack_causes: ClassVar[Mapping[str, str]] = {}
    dialect: ClassVar[Sequence[Declared]] = DIALECT
    code_packages: ClassVar[tuple[str, ...]] = ("equilux_adapters._bounds",)

    def version(self) -> str:
        """POV-Ray's own version, "absent" when it is not installed. Asked once per executable."""
        found = shutil.which("povray")
        return _version(found, Path(found).stat().st_mtime_ns) if found else "absent"

    def probe(self) -> Probe:
        found = shutil.which("povray")
        if found is None:
            return Probe(False, "no program 'povray' on PATH (Debian, Ubuntu: package povray)")
        return Probe(True, f"{found}, {self.version()}")

    def capabilities(self) -> Mapping[str, Capability]:
        return CAPABILITIES

    def translate(self, case: Case, knobs: PovrayKnobs) -> Program:
        from equilux_adapters.povray.translate import program

        return program(case, knobs)

    def render(self, program: Program, program_dir: Path, workdir: Path, limits: Limits, knobs: PovrayKnobs) -> RawRender:
        from equilux_adapters.povray.render import render

        return render(program, program_dir, workdir, limits, knobs)

    def read(self, raw: RawRender, program: Program, knobs: PovrayKnobs) -> Reading:
        from equilux_adapters.povray.read import read

        return read(raw, program, knobs)


@lru_cache(maxsize=8)
def _version(executable: str, changed_ns: int) -> str:
    try:
        said = subprocess.run([executable, "--version"], capture_output=True, text=True, errors="replace", timeout=10)
    except (OSError, subprocess.TimeoutExpired) as problem:
        return f"unknown ({problem})"
    found = re.search(r"POV-Ray (\d[\w.+-]*)", said.stdout + said.stderr)
    return found.group(1) if found else "unknown"


ADAPTER = PovrayAdapter()
