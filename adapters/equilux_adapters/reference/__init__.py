"""The Embree tracer as a laboratory: a thin plug-in over `equilux_tracer`, the truth where a scene has no closed form."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import metadata, util
from pathlib import Path
from typing import ClassVar

from equilux.adapter import API_VERSION, Capability, Case, Knobs, Limits, Probe, Program, RawRender, Reading
from equilux_adapters.reference.knobs import ReferenceKnobs

__all__ = ["ADAPTER", "ReferenceAdapter"]


class ReferenceAdapter:
    """See `equilux.adapter.Adapter`. The tracer itself is imported when it is called for."""

    name = "reference"
    api_version = API_VERSION
    Knobs: ClassVar[type[Knobs]] = ReferenceKnobs
    workers_per_core: ClassVar[float] = 1.0
    lack_causes: ClassVar[Mapping[str, str]] = {}
    code_packages: ClassVar[tuple[str, ...]] = ("equilux_tracer", "equilux_adapters._bounds", "equilux_adapters._triangles")
    """Whose code has a part in the picture, besides this package's: a change there makes stored renders stale."""

    def version(self) -> str:
        """The version of the distribution that the tracer is part of, and its precision."""
        return f"equilux {metadata.version('equilux')}, exact"

    def probe(self) -> Probe:
        """Whether the extension was built; that it loads shows when it is first used."""
        found = util.find_spec("equilux_tracer") is not None and util.find_spec("equilux_tracer._tracer") is not None
        return Probe(found, "equilux_tracer._tracer" if found else "equilux_tracer._tracer is not built (make setup)")

    def capabilities(self) -> Mapping[str, Capability]:
        """Feature → capability: everything there is, exactly."""
        from equilux_adapters.reference.capabilities import CAPABILITIES

        return CAPABILITIES

    def translate(self, case: Case, knobs: ReferenceKnobs) -> Program:
        """Scene → the scene as JSON, and its meshes as arrays."""
        from equilux_adapters.reference.translate import translate

        return translate(case, knobs)

    def render(self, program: Program, program_dir: Path, workdir: Path, limits: Limits, knobs: ReferenceKnobs) -> RawRender:
        """Trace it in this process."""
        from equilux_adapters.reference.render import render

        return render(program, program_dir, workdir, knobs)

    def read(self, raw: RawRender, program: Program, knobs: ReferenceKnobs) -> Reading:
        """The image and its budget."""
        from equilux_adapters.reference.read import read

        return read(raw, program, knobs)


ADAPTER = ReferenceAdapter()
