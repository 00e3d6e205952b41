"""The adapter object that the entry point names. Importing it must be cheap: the renderer is only looked for, not loaded."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import ClassVar

from equilux.adapter import API_VERSION, Capability, Case, Knobs, Limits, Probe, Program, RawRender, Reading
from equilux_ballcaster.capabilities import CAPABILITIES
from equilux_ballcaster.read import read
from equilux_ballcaster.render import render
from equilux_ballcaster.translate import translate


class BallcasterAdapter:
    """Ballcaster: spheres, point lights, Lambert's law."""

    name = "ballcaster"
    api_version = API_VERSION
    Knobs: ClassVar[type[Knobs]] = Knobs  # nothing to trade
    workers_per_core: ClassVar[float] = 1.0
    lack_causes: ClassVar[Mapping[str, str]] = {"material.specular": "highlight-missing"}

    def version(self) -> str:
        return "ballcaster 1.0.0"

    def probe(self) -> Probe:
        return Probe(found=True, detail=f"{sys.executable} -m equilux_ballcaster.ballcaster")

    def capabilities(self) -> Mapping[str, Capability]:
        return CAPABILITIES

    def translate(self, case: Case, knobs: Knobs) -> Program:
        return translate(case)

    def render(self, program: Program, program_dir: Path, workdir: Path, limits: Limits, knobs: Knobs) -> RawRender:
        return render(program, program_dir, workdir, limits)

    def read(self, raw: RawRender, program: Program, knobs: Knobs) -> Reading:
        return read(raw)


ADAPTER = BallcasterAdapter()
