"""VTK's OpenGL back end: scan conversion with Phong lighting per pixel, through a 32-bit float framebuffer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import metadata
from pathlib import Path
from typing import ClassVar

from equilux.adapter import API_VERSION, Capability, Case, Knobs, Limits, Probe, Program, RawRender, Reading
from equilux.dialect import Declared
from equilux_adapters.vtk.capabilities import DIALECT, LACK_CAUSES
from equilux_adapters.vtk.knobs import VtkKnobs


class VtkAdapter:
    """See `equilux.adapter.Adapter`. Everything that needs NumPy or VTK is imported when it is called for."""

    name = "vtk"
    title = "VTK"
    api_version = API_VERSION
    Knobs: ClassVar[type[Knobs]] = VtkKnobs
    workers_per_core: ClassVar[float] = 1.0
    lack_causes: ClassVar[Mapping[str, str]] = LACK_CAUSES
    dialect: ClassVar[Sequence[Declared]] = DIALECT
    code_packages: ClassVar[tuple[str, ...]] = ("equilux_adapters._triangles",)

    def version(self) -> str:
        """The version of the installed package, e.g. `9.7.2`."""
        return metadata.version("vtk")

    def probe(self) -> Probe:
        """Whether the package is installed; whether OpenGL works shows when the first script runs."""
        try:
            return Probe(True, f"vtk {self.version()}")
        except metadata.PackageNotFoundError:
            return Probe(False, "the Python package vtk is not installed (pip install 'equilux[vtk]')")

    def capabilities(self) -> Mapping[str, Capability]:
        """Feature → capability."""
        from equilux_adapters.vtk.capabilities import CAPABILITIES

        return CAPABILITIES

    def translate(self, case: Case, knobs: VtkKnobs) -> Program:
        """Scene → stand-alone script."""
        from equilux_adapters.vtk.translate import translate

        return translate(case, knobs)

    def render(self, program: Program, program_dir: Path, workdir: Path, limits: Limits, knobs: VtkKnobs) -> RawRender:
        """Run the script in this process."""
        from equilux_adapters.vtk.render import render

        return render(program, program_dir, workdir, limits, knobs)

    def read(self, raw: RawRender, program: Program, knobs: VtkKnobs) -> Reading:
        """The image and its budget."""
        from equilux_adapters.vtk.read import read

        return read(raw, program, knobs)


ADAPTER = VtkAdapter()
