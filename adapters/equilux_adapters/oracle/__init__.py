"""The closed form as a laboratory: plug-in over `equilux_oracle`, as any third party's would be."""

from __future__ import annotations

import importlib.metadata
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

from equilux.adapter import API_VERSION, Capability, Limits, Probe, Program, RawRender, Reading
from equilux.adapter import Knobs as BaseKnobs
from equilux_scenes.case import Case

from equilux_adapters.oracle.capabilities import CAPABILITIES
from equilux_adapters.oracle.read import reading
from equilux_adapters.oracle.render import evaluate
from equilux_adapters.oracle.translate import program_of

__all__ = ["ADAPTER", "OracleAdapter"]


class Knobs(BaseKnobs):
    """None: a closed form has no speed to trade for accuracy."""


class OracleAdapter:
    """Evaluates a case's closed form, where it has one."""

    name = "oracle"
    api_version = API_VERSION
    Knobs: ClassVar[type[BaseKnobs]] = Knobs
    workers_per_core: ClassVar[float] = 1.0
    lack_causes: ClassVar[Mapping[str, str]] = {}

    def version(self) -> str:
        return f"equilux {importlib.metadata.version('equilux')}"

    def probe(self) -> Probe:
        return Probe(True, "part of equilux")

    def capabilities(self) -> Mapping[str, Capability]:
        return CAPABILITIES

    def translate(self, case: Case, knobs: Any) -> Program:
        return program_of(case)

    def render(self, program: Program, program_dir: Path, workdir: Path, limits: Limits, knobs: Any) -> RawRender:
        return evaluate(program, program_dir, workdir)

    def read(self, raw: RawRender, program: Program, knobs: Any) -> Reading:
        return reading(raw)


ADAPTER = OracleAdapter()
