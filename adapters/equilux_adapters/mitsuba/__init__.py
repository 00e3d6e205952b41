"""Mitsuba 3: a physically based renderer, the laboratory for the reflection equation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import metadata
from pathlib import Path
from typing import ClassVar

from equilux.adapter import API_VERSION, Capability, Case, Knobs, Limits, Probe, Program, RawRender, Reading
from equilux.dialect import Declared
from equilux_adapters.mitsuba.capabilities import DIALECT
from equilux_adapters.mitsuba.knobs import MitsubaKnobs

__all__ = ["ADAPTER", "MitsubaAdapter"]


class MitsubaAdapter:
    """See `equilux.adapter.Adapter`. Everything that needs NumPy or Mitsuba is imported when it is called for."""

    name = "mitsuba"
    title = "Mitsuba"
    api_version = API_VERSION
    Knobs: ClassVar[type[Knobs]] = MitsubaKnobs
    workers_per_core: ClassVar[float] = 1.0
    lack_causes: ClassVar[Mapping[str, str]] = {}
    dialect: ClassVar[Sequence[Declared]] = DIALECT

    def version(self) -> str:
        """The versions of the installed packages, e.g. `3.9.1, drjit 1.5.0`."""
        return f"{metadata.version('mitsuba')}, drjit {metadata.version('drjit')}"

    def probe(self) -> Probe:
        """Whether the packages are installed and LLVM lies where it usually does; nothing is loaded."""
        from equilux_adapters.mitsuba.library import ENVIRONMENT, OLDEST, find_llvm

        try:
            version = self.version()
        except metadata.PackageNotFoundError:
            return Probe(False, "the Python package mitsuba is not installed (pip install 'equilux[mitsuba]')")
        llvm = find_llvm()
        if llvm is None:
            return Probe(False, f"no libLLVM of version {OLDEST} or newer (Debian: libllvm19; {ENVIRONMENT} says where)")
        return Probe(True, f"mitsuba {version}, {llvm}")

    def capabilities(self) -> Mapping[str, Capability]:
        """Feature → capability."""
        from equilux_adapters.mitsuba.capabilities import CAPABILITIES

        return CAPABILITIES

    def translate(self, case: Case, knobs: MitsubaKnobs) -> Program:
        """Scene → stand-alone script."""
        from equilux_adapters.mitsuba.translate import translate

        return translate(case, knobs)

    def render(self, program: Program, program_dir: Path, workdir: Path, limits: Limits, knobs: MitsubaKnobs) -> RawRender:
        """Run the script in this process."""
        from equilux_adapters.mitsuba.render import render

        return render(program, program_dir, workdir, limits, knobs)

    def read(self, raw: RawRender, program: Program, knobs: MitsubaKnobs) -> Reading:
        """The picture and its budget."""
        from equilux_adapters.mitsuba.read import read

        return read(raw, program, knobs)


ADAPTER = MitsubaAdapter()
