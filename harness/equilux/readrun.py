"""Reading a results tree back: its results, and what lies beside them. Nothing is written and nothing is rendered."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from equilux.complaint import BadUsage
from equilux.results import SCHEMA, Results
from equilux.tree import is_results_tree, read_json


@dataclass(frozen=True)
class ReadRun:
    """A finished run on disk. ignored: keys that this version of equilux does not know, as paths."""

    root: Path
    results: Results
    manifest: dict[str, Any]
    ignored: tuple[str, ...] = field(default=())

    def render_folder(self, case: str, adapter: str) -> Path:
        return self.root / "cases" / case / adapter

    def render_json(self, case: str, adapter: str) -> dict[str, Any]:
        """render.json; empty where there is none."""
        return read_json(self.render_folder(case, adapter) / "render.json") or {}

    def pair_file(self, case: str, a: str, b: str, suffix: str) -> Path:
        return self.root / "cases" / case / "pairs" / f"{a}--{b}.{suffix}"


def read_run(root: Path) -> ReadRun:
    """Read a results tree. Raises BadUsage for anything that is none, for a run that did not come to its end, and for results of
    another schema. Keys that a later version added are left out, and named in `ignored`."""
    if not root.exists():
        raise BadUsage(f"'{root}': no such folder, expected a results tree (the folder given to 'equilux run --out')")
    if not is_results_tree(root):
        what = "is a file" if root.is_file() else "is no results tree: it has no run.json of equilux"
        raise BadUsage(f"'{root}' {what}, expected the folder given to 'equilux run --out'{_inside(root)}")
    path = root / "results.json"
    try:
        content = json.loads(path.read_bytes())
    except FileNotFoundError:
        raise BadUsage(
            f"'{root}' holds no results.json: the run was interrupted or still goes on; run it again, it continues"
        ) from None
    except (OSError, ValueError) as problem:
        raise BadUsage(f"'{path}' cannot be read: {problem}") from problem
    schema = content.get("schema") if isinstance(content, dict) else None
    if schema != SCHEMA:
        raise BadUsage(f"'{path}': schema is {schema!r}, allowed '{SCHEMA}' (made by another version of equilux?)")
    results, ignored = _validated(path, content)
    return ReadRun(root, results, read_json(root / "run.json") or {}, ignored)


def _inside(root: Path) -> str:
    """A results tree right inside or right above is probably what was meant."""
    if root.is_dir():
        for near in (root.parent, root.parent.parent, *sorted(path for path in root.iterdir() if path.is_dir())[:50]):
            if is_results_tree(near):
                return f" (did you mean '{near}'?)"
    elif is_results_tree(root.parent):
        return f" (did you mean '{root.parent}'?)"
    return ""


def _validated(path: Path, content: dict[str, Any]) -> tuple[Results, tuple[str, ...]]:
    try:
        return Results.model_validate(content), ()
    except ValidationError as problem:
        unknown = [error["loc"] for error in problem.errors() if error["type"] == "extra_forbidden"]
        if len(unknown) < problem.error_count():
            first = next(error for error in problem.errors() if error["type"] != "extra_forbidden")
            where = ".".join(map(str, first["loc"]))
            raise BadUsage(f"'{path}' is not as equilux writes it: {where}: {first['msg']}") from problem
    for location in unknown:
        _remove(content, location)
    try:
        return Results.model_validate(content), tuple(dict.fromkeys(_pattern(location) for location in unknown))
    except ValidationError as problem:
        raise BadUsage(f"'{path}' is not as equilux writes it: {' '.join(str(problem).split())[:200]}") from problem


def _remove(content: Any, location: Sequence[int | str]) -> None:
    for key in location[:-1]:
        content = content[key]
    content.pop(location[-1], None)


def _pattern(location: Sequence[int | str]) -> str:
    return ".".join("*" if isinstance(key, int) else key for key in location)
