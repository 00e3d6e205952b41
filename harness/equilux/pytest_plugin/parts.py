"""What the engine made of one scene, as one process leaves it for the others."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from equilux.adapter import Case
from equilux.ci import sources_of
from equilux.results import CaseRecord, Results
from equilux.run import Finished
from equilux.tree import read_json
from equilux.wholefile import write_json


@dataclass(frozen=True)
class Part:
    """results: of the scene's cases alone. errors: faults of the engine itself. manifest: run.json. sources: scene → spec file.
    order: place of the scene in the session.
    """

    results: Results
    errors: tuple[str, ...] = ()
    manifest: dict[str, Any] = field(default_factory=dict)
    sources: dict[str, Path] = field(default_factory=dict)
    order: int = 0

    @classmethod
    def of(cls, finished: Finished, tree: Path, order: int, cases: Iterable[Case]) -> Part:
        return cls(finished.results, finished.errors, read_json(tree / "run.json") or {}, sources_of(cases), order)

    def record(self, case: str) -> CaseRecord | None:
        return next((record for record in self.results.cases if record.case == case), None)


def file_name(scene: str) -> str:
    """Names of scenes are names of files already, but for their length."""
    return hashlib.sha256(scene.encode()).hexdigest()[:24]


def write_part(folder: Path, scene: str, part: Part) -> None:
    content = {
        "results": part.results.model_dump(mode="json"),
        "errors": list(part.errors),
        "manifest": part.manifest,
        "sources": {name: str(path) for name, path in part.sources.items()},
        "order": part.order,
    }
    write_json(folder / f"{file_name(scene)}.json", content)


def read_part(folder: Path, scene: str) -> Part | None:
    """None where no process has left it yet."""
    return _read(folder / f"{file_name(scene)}.json")


def read_parts(folder: Path) -> list[Part]:
    """All of a session, in the order of its scenes."""
    found = [part for path in folder.glob("*.json") if (part := _read(path)) is not None]
    return sorted(found, key=lambda part: part.order)


def _read(path: Path) -> Part | None:
    content = read_json(path)
    if content is None:
        return None
    return Part(
        Results.model_validate(content["results"]),
        tuple(content["errors"]),
        content["manifest"],
        {name: Path(source) for name, source in content["sources"].items()},
        content["order"],
    )
