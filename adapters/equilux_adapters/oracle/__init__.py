"""The closed form as a laboratory: plug-in over `equilux_oracle`, as any third party's would be."""

from __future__ import annotations

import importlib.metadata
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

from equilux.adapter import API_VERSION, Capability, Limits, Probe, Program, RawRender, Reading
from equilux.adapter import Knobs as BaseKnobs
from equilux_scenes.case import Case

__all__ = ["ADAPTER", "OracleAdapter"]


class Knobs(BaseKnobs):
    """None: a closed form has no speed to trade for accuracy."""


class OracleAdapter:
    """Evaluates a case's closed form, where it has one. The closed forms are imported when they are called for."""

    name = "oracle"
    api_version = API_VERSION
    Knobs: ClassVar[type[BaseKnobs]] = Knobs
    workers_per_core: ClassVar[float] = 1.0
    lack_causes: ClassVar[Mapping[str, str]] = {}
    code_packages: ClassVar[tuple[str, ...]] = ("equilux_oracle",)
    """Whose code has a part in the picture, besides this package's: a change there makes stored renders stale."""

    def version(self) -> str:
        return f"equilux {importlib.metadata.version('equilux')}"

    def probe(self) -> Probe:
        return Probe(True, "part of equilux")

    def capabilities(self) -> Mapping[str, Capability]:
        from equilux_adapters.oracle.capabilities import CAPABILITIES

        return CAPABILITIES

    def translate(self, case: Case, knobs: Any) -> Program:
        from equilux_adapters.oracle.translate import program_of

        return program_of(case)

    def render(self, program: Program, program_dir: Path, workdir: Path, limits: Limits, knobs: Any) -> RawRender:
        from equilux_adapters.oracle.render import evaluate

        return evaluate(program, program_dir, workdir)

    def read(self, raw: RawRender, program: Program, knobs: Any) -> Reading:
        from equilux_adapters.oracle.read import reading

        return reading(raw, program)


ADAPTER = OracleAdapter()
