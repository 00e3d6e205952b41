"""What the engine made of some scenes in one go, as one process leaves it for the others."""

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

NOTE = ".in"


@dataclass(frozen=True)
class Part:
    """results: of these scenes' cases alone. errors: faults of the engine itself. manifest: run.json. sources: scene → spec file.
    places: scene → its place in the session.
    """

    results: Results
    errors: tuple[str, ...] = ()
    manifest: dict[str, Any] = field(default_factory=dict)
    sources: dict[str, Path] = field(default_factory=dict)
    places: dict[str, int] = field(default_factory=dict)

    @classmethod
    def of(cls, finished: Finished, tree: Path, places: dict[str, int], cases: Iterable[Case]) -> Part:
        return cls(finished.results, finished.errors, read_json(tree / "run.json") or {}, sources_of(cases), places)

    def record(self, case: str) -> CaseRecord | None:
        return next((record for record in self.results.cases if record.case == case), None)


def file_name(scene: str) -> str:
    """Names of scenes are names of files already, but for their length."""
    return hashlib.sha256(scene.encode()).hexdigest()[:24]


def write_part(folder: Path, part: Part) -> None:
    """The part under the name of its first scene, and a note under that of each other one, which says where to look."""
    first, *others = part.places
    content = {
        "results": part.results.model_dump(mode="json"),
        "errors": list(part.errors),
        "manifest": part.manifest,
        "sources": {name: str(path) for name, path in part.sources.items()},
        "places": part.places,
    }
    write_json(folder / f"{file_name(first)}.json", content)
    for scene in others:
        write_json(folder / f"{file_name(scene)}{NOTE}", first)


def read_part(folder: Path, scene: str) -> Part | None:
    """None where no process has left it yet."""
    noted = read_json(folder / f"{file_name(scene)}{NOTE}")
    return _read(folder / f"{file_name(scene if noted is None else str(noted))}.json")


def is_left(folder: Path, scene: str) -> bool:
    """Whether a process has left the scene's part: cheaper than to read it."""
    return any((folder / f"{file_name(scene)}{suffix}").exists() for suffix in (".json", NOTE))


def read_parts(folder: Path) -> list[Part]:
    """All of a session, in the order of their first scenes."""
    found = [part for path in folder.glob("*.json") if (part := _read(path)) is not None]
    return sorted(found, key=lambda part: min(part.places.values()))


def _read(path: Path) -> Part | None:
    content = read_json(path)
    if content is None:
        return None
    return Part(
        Results.model_validate(content["results"]),
        tuple(content["errors"]),
        content["manifest"],
        {name: Path(source) for name, source in content["sources"].items()},
        content["places"],
    )
