"""The public adapter protocol: all that a renderer's plug-in is, and all that it may rely on.

An adapter is any object with the attributes of `Adapter`, registered in the entry-point group `equilux.adapters`. The engine
calls `translate`, `render` and `read` in a worker process of its own (its own process group), so that a hang, a crash or garbage
is charged to one case and never to the run.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar, Literal, Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt
from pydantic import BaseModel, ConfigDict

from equilux.budget import Bound, Budget, Geometric, Sampled
from equilux_scenes.case import Case

API_VERSION = 1

Image = npt.NDArray[np.floating]

__all__ = [
    "API_VERSION",
    "Adapter",
    "Bound",
    "Budget",
    "Capability",
    "Case",
    "Geometric",
    "Image",
    "Knobs",
    "Limits",
    "Probe",
    "Program",
    "RawRender",
    "Reading",
    "RendererCrashed",
    "RendererFailed",
    "RendererTimedOut",
    "Sampled",
    "Unsupported",
]


@dataclass(frozen=True)
class Probe:
    """Whether the renderer can be run here; `detail` says where it was found, or why it was not."""

    found: bool
    detail: str


@dataclass(frozen=True)
class Capability:
    """How well one feature is expressed: exactly, approximately (the note says how far off), or not at all."""

    level: Literal["exact", "approximate", "none"]
    note: str = ""


class Knobs(BaseModel):
    """Base of an adapter's knobs: settings that trade speed for accuracy.

    Give each field a default, a range (`Field(ge=…, le=…)`), a description, and
    `json_schema_extra={"faster": "smaller" | "larger" | [values, fastest first], "steps": [values worth trying]}`: the steps
    fastest first too, the default among them. A knob without steps leaves the picture as it is.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


@dataclass(frozen=True)
class Program:
    """What an adapter hands to its renderer: files by path relative to the program's folder, and which of them is the entry.

    `data` (JSON-serialisable) is carried along to `render` and `read`: what they must know and the files do not say.
    """

    files: Mapping[str, bytes]
    entry: str
    data: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Limits:
    """What a render may use. The engine enforces both on the whole process group; an adapter may use them to stop early."""

    timeout_s: float = 120.0
    memory_bytes: int = 8 << 30


@dataclass(frozen=True)
class RawRender:
    """What came out of the renderer, before anything interprets it.

    files: raw output files by name. seconds: wall time by phase: "start" (start-up, import) and "render". program_files: what was
    decided only while rendering (the command lines of the exposures) and belongs to the saved program. data: JSON-serialisable.
    environment: what the picture may depend on beyond the version (GL renderer string, threads).
    """

    files: Mapping[str, Path]
    seconds: Mapping[str, float] = field(default_factory=dict)
    program_files: Mapping[str, bytes] = field(default_factory=dict)
    data: Mapping[str, Any] = field(default_factory=dict)
    environment: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Reading:
    """Linear radiance, W/(m²·sr), (h, w, 3), float32 or float64, row 0 on top; and its stated uncertainty."""

    image: Image
    budget: Budget


class Unsupported(Exception):
    """Raised by `translate`: the case needs something that the renderer cannot express. Names every missing feature."""

    def __init__(self, missing_features: list[str], reason: str) -> None:
        super().__init__(reason)
        self.missing_features = missing_features
        self.reason = reason


class RendererFailed(Exception):
    """Raised by `render` or `read`: the renderer ran and did not deliver. The message says what it did say."""


class RendererCrashed(RendererFailed):
    """Raised by `render`: the renderer's own process was ended by a signal."""

    def __init__(self, message: str, signal: int) -> None:
        super().__init__(message)
        self.signal = signal


class RendererTimedOut(RendererFailed):
    """Raised by `render`: the renderer's own process ran past `limits.timeout_s` and was ended."""


@runtime_checkable
class Adapter(Protocol):
    """One renderer. Instances are stateless as far as the engine can tell; long-lived renderer state belongs to the worker
    process.

    Optional, because most need it not:

    `code_packages`, a tuple of names of packages outside the adapter's own that have a part in its pictures. When a file of the
    adapter's package, or of one of these, changes, no render made before is reused.

    `dialect`, a sequence of `equilux.dialect.Declared`: what this renderer always does otherwise than the model says
    (`Declared("exponent-clamped", 128)`). A departure that it reproduces is reported as a difference of models, any other one as
    a bug. What `lack_causes` names is declared by that.
    """

    name: str
    api_version: int
    Knobs: ClassVar[type[Knobs]]
    workers_per_core: ClassVar[float]
    """How many renders to run at once per core: 1 for a renderer that computes, more for one that mostly waits."""
    lack_causes: ClassVar[Mapping[str, str]]
    """Feature → cause id: what it looks like when this renderer renders without the feature (`occlusion` →
    `occlusion-ignored`)."""

    def version(self) -> str:
        """The renderer's version and build. Cheap: package metadata, no import."""
        ...

    def probe(self) -> Probe:
        """Is the renderer installed? Cheap, never raises."""
        ...

    def capabilities(self) -> Mapping[str, Capability]:
        """Feature → capability; a feature not listed is `none`."""
        ...

    def translate(self, case: Case, knobs: Any) -> Program:
        """Scene → program. Pure: needs no renderer. Raises Unsupported."""
        ...

    def render(self, program: Program, program_dir: Path, workdir: Path, limits: Limits, knobs: Any) -> RawRender:
        """Run the program, already written under `program_dir`; write only under `workdir`. Raises RendererFailed."""
        ...

    def read(self, raw: RawRender, program: Program, knobs: Any) -> Reading:
        """Raw files → linear radiance with its budget. Raises RendererFailed."""
        ...
