"""A run that would make again what its results tree already holds: known before a scene is read or a renderer started.

A run that ended well leaves `inputs.json`: what was asked, the hashes of every spec and mesh, of the code and of the adapters as
they are installed, and the state (size, time of change) of every file of the tree. Where all is as it was, the tree is the
answer.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

from equilux import diagnosing, machine
from equilux.adapter import Case, Knobs
from equilux.identity import adapter_identity, version_is_known
from equilux.registry import Entry
from equilux.results import Results, summarise
from equilux.reuse import code_fingerprint
from equilux.tree import INPUTS_FILE, SCRATCH_PREFIX, read_json
from equilux.wholefile import write_json
from equilux_scenes.loader import spec_paths
from equilux_scenes.model import Mesh

SCHEMA = "equilux/inputs/1"
CODE = ("equilux", "equilux_scenes", "equilux_tracer", "equilux_oracle", "equilux_report")
SETTLED = frozenset({"ok", "unsupported", "missing"})
"""What a render is that another try would not make otherwise."""


@dataclass(frozen=True)
class Inputs:
    """What a run is made from, besides the meshes that its scenes name.

    options: what the user chose of all that has a part in the results, as JSON. scenes: the files and folders that were given.
    entries, knobs: the adapters that take part, and their knobs by name.
    """

    options: Mapping[str, Any]
    scenes: Sequence[Path]
    entries: Sequence[Entry]
    knobs: Mapping[str, Knobs]

    def state(self) -> dict[str, Any]:
        """Of everything but the meshes, as JSON; None stands for a file that cannot be read."""
        causes = sorted({point.module for point in entry_points(group="equilux.causes")})
        adapters = {entry.name: adapter_identity(entry, self.knobs.get(entry.name)) for entry in self.entries}
        state = {
            "options": dict(self.options),
            "specs": {str(path.absolute()): _hash(path) for path in spec_paths(self.scenes)},
            "adapters": adapters,
            "code": code_fingerprint(*CODE, *causes),
            "libraries": machine.library_versions(),
        }
        return dict(json.loads(json.dumps(state, default=str)))


def earlier_results(out: Path, inputs: Mapping[str, Any]) -> Results | None:
    """What an earlier run left in `out`, where one from these inputs (`Inputs.state`) would make the same again; its renders are
    then marked as reused, in results.json too. None where anything differs, or cannot be read or written."""
    try:
        return _earlier_results(out, inputs)
    except (OSError, ValueError):
        return None  # whatever is wrong with the tree, a run that looks at all of it can tell


def _earlier_results(out: Path, inputs: Mapping[str, Any]) -> Results | None:
    record = read_json(out / INPUTS_FILE)
    if record is None or any(record.get(part) != now for part, now in (("schema", SCHEMA), ("inputs", inputs))):
        return None
    if record.get("tree") != _tree_state(out):
        return None
    meshes = record.get("meshes")
    if not isinstance(meshes, dict) or any(_hash(Path(path)) != earlier for path, earlier in meshes.items()):
        return None
    results = Results.model_validate_json((out / "results.json").read_bytes())
    delivered = [render for case in results.cases for render in case.renders.values() if render.status == "ok"]
    if not all(render.reused for render in delivered):
        for render in delivered:
            render.reused = True
        results.summary = summarise(results.cases, results.summary.exit_code)
        write_json(out / "results.json", results.model_dump(mode="json"))
        write_json(out / INPUTS_FILE, {**record, "tree": _tree_state(out)})
    return results


def remember(out: Path, inputs: Mapping[str, Any], cases: Iterable[Case], results: Results, diagnosis_limit_s: float) -> None:
    """Leave the record of a run that is complete; of one that another try might make otherwise, none is left.

    inputs: `Inputs.state()` from before the scenes were read. diagnosis_limit_s: that of each diagnosis.
    """
    (out / INPUTS_FILE).unlink(missing_ok=True)
    if not all(version_is_known(identity) for identity in inputs["adapters"].values()):
        return
    if not all(render.status in SETTLED for case in results.cases for render in case.renders.values()):
        return
    diagnoses = (diagnosing.load(path.parent) for path in (out / "cases").glob(f"*/*/{diagnosing.DIAGNOSIS_FILE}"))
    if any(found is None or diagnosing.may_find_more(found, diagnosis_limit_s) for found in diagnoses):
        return
    files = {
        case.folder / made.file
        for case in cases
        for made in case.scene.objects
        if isinstance(made, Mesh) and made.file is not None and case.folder is not None
    }
    meshes = {str(path.absolute()): _hash(path) for path in sorted(files)}
    if None in meshes.values():
        return
    with suppress(OSError):  # a full disk: the next run is made, that is all
        write_json(out / INPUTS_FILE, {"schema": SCHEMA, "inputs": dict(inputs), "meshes": meshes, "tree": _tree_state(out)})


def _hash(path: Path) -> str | None:
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError:
        return None


def _tree_state(out: Path) -> str:
    """Hash of name, size and time of change of every file, the record itself left out."""
    state = hashlib.sha256()
    for folder, folders, files in os.walk(out):
        folders[:] = sorted(name for name in folders if not name.startswith(SCRATCH_PREFIX))
        for name in sorted(files):
            path = os.path.join(folder, name)
            place = os.path.relpath(path, out)
            if place != INPUTS_FILE:
                found = os.lstat(path)
                state.update(f"{place}\0{found.st_size}\0{found.st_mtime_ns}\n".encode())
    return state.hexdigest()
