"""The fixed-function OpenGL API as a laboratory."""

from __future__ import annotations

import importlib.metadata
import importlib.util
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

from equilux.adapter import API_VERSION, Capability, Limits, Probe, Program, RawRender, Reading, RendererFailed
from equilux.adapter import Knobs as BaseKnobs
from equilux_scenes.case import Case

__all__ = ["ADAPTER", "OpenGLAdapter"]


class OpenGLAdapter:
    """Not yet able to render anything."""

    name = "opengl"
    api_version = API_VERSION
    Knobs: ClassVar[type[BaseKnobs]] = BaseKnobs
    workers_per_core: ClassVar[float] = 1.0
    lack_causes: ClassVar[Mapping[str, str]] = {}

    def version(self) -> str:
        return f"PyOpenGL {importlib.metadata.version('PyOpenGL')}"

    def probe(self) -> Probe:
        found = importlib.util.find_spec("OpenGL") is not None
        return Probe(found, "the package PyOpenGL" if found else "the package PyOpenGL is not installed (equilux[opengl])")

    def capabilities(self) -> Mapping[str, Capability]:
        return {}

    def translate(self, case: Case, knobs: Any) -> Program:
        raise NotImplementedError

    def render(self, program: Program, program_dir: Path, workdir: Path, limits: Limits, knobs: Any) -> RawRender:
        raise RendererFailed("not implemented")

    def read(self, raw: RawRender, program: Program, knobs: Any) -> Reading:
        raise RendererFailed("not implemented")


ADAPTER = OpenGLAdapter()
