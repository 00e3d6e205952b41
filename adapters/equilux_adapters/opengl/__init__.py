"""The fixed-function OpenGL API itself: light at the corners of triangles, into a 32-bit float framebuffer."""

from __future__ import annotations

import importlib.util
from collections.abc import Mapping, Sequence
from importlib import metadata
from pathlib import Path
from typing import ClassVar

from equilux.adapter import API_VERSION, Capability, Case, Knobs, Limits, Probe, Program, RawRender, Reading
from equilux.dialect import Declared
from equilux_adapters.opengl.capabilities import DIALECT, LACK_CAUSES
from equilux_adapters.opengl.knobs import OpenGLKnobs


class OpenGLAdapter:
    """See `equilux.adapter.Adapter`. Everything that needs NumPy or OpenGL is imported when it is called for."""

    name = "opengl"
    title = "OpenGL"
    api_version = API_VERSION
    Knobs: ClassVar[type[Knobs]] = OpenGLKnobs
    workers_per_core: ClassVar[float] = 1.0
    lack_causes: ClassVar[Mapping[str, str]] = LACK_CAUSES
    dialect: ClassVar[Sequence[Declared]] = DIALECT
    code_packages: ClassVar[tuple[str, ...]] = ("equilux_adapters._triangles",)

    def version(self) -> str:
        """The version of the binding; which OpenGL it found shows in the environment of a render."""
        return f"PyOpenGL {metadata.version('PyOpenGL')}"

    def probe(self) -> Probe:
        """Whether the binding is installed; whether there is an OpenGL shows when the first script runs."""
        if importlib.util.find_spec("OpenGL") is None:
            return Probe(False, "the Python package PyOpenGL is not installed (pip install 'equilux[opengl]')")
        return Probe(True, self.version())

    def capabilities(self) -> Mapping[str, Capability]:
        """Feature → capability."""
        from equilux_adapters.opengl.capabilities import CAPABILITIES

        return CAPABILITIES

    def translate(self, case: Case, knobs: OpenGLKnobs) -> Program:
        """Scene → stand-alone script."""
        from equilux_adapters.opengl.translate import translate

        return translate(case, knobs)

    def render(self, program: Program, program_dir: Path, workdir: Path, limits: Limits, knobs: OpenGLKnobs) -> RawRender:
        """Run the script in this process."""
        from equilux_adapters.opengl.render import render

        return render(program, program_dir, workdir, limits, knobs)

    def read(self, raw: RawRender, program: Program, knobs: OpenGLKnobs) -> Reading:
        """The image and its budget."""
        from equilux_adapters.opengl.read import read

        return read(raw, program, knobs)


ADAPTER = OpenGLAdapter()
