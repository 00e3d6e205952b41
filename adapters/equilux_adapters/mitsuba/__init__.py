"""Mitsuba 3 as the physical laboratory."""

from __future__ import annotations

import importlib.metadata
import importlib.util
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

from equilux.adapter import API_VERSION, Capability, Limits, Probe, Program, RawRender, Reading, RendererFailed
from equilux.adapter import Knobs as BaseKnobs
from equilux_scenes.case import Case

__all__ = ["ADAPTER", "MitsubaAdapter"]


class MitsubaAdapter:
    """Not yet able to render anything."""

    name = "mitsuba"
    api_version = API_VERSION
    Knobs: ClassVar[type[BaseKnobs]] = BaseKnobs
    workers_per_core: ClassVar[float] = 1.0
    lack_causes: ClassVar[Mapping[str, str]] = {}

    def version(self) -> str:
        return f"mitsuba {importlib.metadata.version('mitsuba')}"

    def probe(self) -> Probe:
        found = importlib.util.find_spec("mitsuba") is not None
        return Probe(found, "the package mitsuba" if found else "the package mitsuba is not installed (equilux[mitsuba])")

    def capabilities(self) -> Mapping[str, Capability]:
        return {}

    def translate(self, case: Case, knobs: Any) -> Program:
        raise NotImplementedError

    def render(self, program: Program, program_dir: Path, workdir: Path, limits: Limits, knobs: Any) -> RawRender:
        raise RendererFailed("not implemented")

    def read(self, raw: RawRender, program: Program, knobs: Any) -> Reading:
        raise RendererFailed("not implemented")


ADAPTER = MitsubaAdapter()
