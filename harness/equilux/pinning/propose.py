"""From a run to edited spec files: texts, a patch, and what could not be pinned."""

from __future__ import annotations

import difflib
import os
import sysconfig
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from equilux.complaint import BadUsage
from equilux.pinning.decide import decide
from equilux.pinning.edit import CannotEdit, Changes, edited
from equilux.results import CaseRecord, Results
from equilux.wholefile import whole_file
from equilux_scenes.errors import SpecErrors
from equilux_scenes.limits import Limits
from equilux_scenes.loader import SceneFile, load_scene_text
from equilux_scenes.model import Expectation

PATCH_FILE = "expectations.patch"


@dataclass(frozen=True)
class FileEdit:
    """One spec file: its text before and after. words: the changes. fixed: why it must not be written, or None."""

    path: Path
    before: str
    after: str
    words: tuple[str, ...]
    fixed: str | None = None


@dataclass(frozen=True)
class Proposal:
    """edits: by file. impossible: what cannot be pinned, and why. base: the folder that the patch's paths start from."""

    edits: tuple[FileEdit, ...]
    impossible: tuple[str, ...]
    base: Path

    def patch(self) -> str:
        """A unified diff for `patch -p1` or `git apply`, run in `base`."""
        return "".join(_diff(edit, edit.path.relative_to(self.base).as_posix()) for edit in self.edits)


def propose(results: Results, files: Iterable[Path], limits: Limits | None = None) -> Proposal:
    """The edit that makes the judgement of this run pass. files: the spec files that it was made from. Writes nothing."""
    limits = limits or Limits()
    records = {case.case: case for case in results.cases}
    edits: list[FileEdit] = []
    impossible: list[str] = []
    for path in sorted({file.resolve() for file in files}):
        edit, complaints = _of_file(path, records, limits)
        impossible += complaints
        if edit is not None:
            edits.append(edit)
    return Proposal(tuple(edits), tuple(impossible), _base([edit.path for edit in edits]))


def _of_file(path: Path, records: Mapping[str, CaseRecord], limits: Limits) -> tuple[FileEdit | None, Sequence[str]]:
    try:
        text = path.read_bytes().decode()
        scene = load_scene_text(text, str(path), path.parent, limits)
    except (OSError, UnicodeDecodeError, SpecErrors) as problem:
        return None, [f"{path}: cannot be read any more: {' '.join(str(problem).split())[:200]}"]
    if stale := _stale(scene, records):
        return None, [f"{path}: changed since it was run ({stale}): run it again"]
    decision = decide(scene.cases, scene.scene.expect, records)
    if not decision.changes:
        return None, decision.impossible
    try:
        after = edited(text, decision.changes, limits)
        _check(scene, after, decision.changes, limits)
    except (CannotEdit, SpecErrors) as problem:
        by_hand = "; ".join(decision.words)
        why = f"{path}: its `expect` is laid out in a way that is not edited here ({problem}); by hand: {by_hand}"
        return None, [*decision.impossible, why]
    return FileEdit(path, text, after, decision.words, _fixed(path)), decision.impossible


def _stale(scene: SceneFile, records: Mapping[str, CaseRecord]) -> str | None:
    """What of the spec is not what was run."""
    expect = {(item.adapter, item.cause, item.when) for item in scene.scene.expect}
    names = {case.name for case in scene.cases}
    for record in records.values():
        if record.scene == scene.scene.name:
            if record.case not in names:
                return f"it has no case {record.case}"
            for used in record.expect:
                if (used.adapter, used.cause, used.when) not in expect:
                    return f"it does not expect {used.cause} of {used.adapter}"
    return None


def _check(scene: SceneFile, after: str, changes: Changes, limits: Limits) -> None:
    """Read the edited text again: it must be the same scene, with the expectations that were decided. Raises CannotEdit."""
    new = load_scene_text(after, str(scene.path), scene.cases[0].folder, limits)
    kept = [
        Expectation(adapter=item.adapter, cause=item.cause, when=changes.whens.get(index, item.when))
        for index, item in enumerate(scene.scene.expect)
        if index not in changes.removed
    ]
    kept += [Expectation(adapter=pin.adapter, cause=pin.cause, when=pin.when) for pin in changes.added]
    if list(new.scene.expect) != kept:
        raise CannotEdit("the edited text would expect something else")
    nothing: dict[str, tuple[Expectation, ...]] = {"expect": ()}
    if new.scene.model_copy(update=nothing) != scene.scene.model_copy(update=nothing):
        raise CannotEdit("the edited text would be another scene")


def _fixed(path: Path) -> str | None:
    """Why a file must not be written: it belongs to an installed package, or cannot be."""
    installed = {Path(sysconfig.get_path(name)).resolve() for name in ("purelib", "platlib")}
    if any(path.is_relative_to(folder) for folder in installed) or {"site-packages", "dist-packages"} & set(path.parts):
        return "it belongs to an installed package"
    return None if os.access(path, os.W_OK) and os.access(path.parent, os.W_OK) else "it is not writable"


def _base(paths: Sequence[Path]) -> Path:
    """The working folder, or, where the files lie elsewhere, what they have in common."""
    here = Path.cwd().resolve()
    if all(path.is_relative_to(here) for path in paths):
        return here
    return Path(os.path.commonpath([path.parent for path in paths]))


def _diff(edit: FileEdit, name: str) -> str:
    out = []
    for line in difflib.unified_diff(_split(edit.before), _split(edit.after), f"a/{name}", f"b/{name}"):
        out.append(line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n")
    return "".join(out)


def _split(text: str) -> list[str]:
    """Lines as `patch` counts them: only \\n ends one."""
    parts = text.split("\n")
    lines = [f"{part}\n" for part in parts[:-1]]
    return [*lines, parts[-1]] if parts[-1] else lines


def write(edits: Iterable[FileEdit]) -> None:
    """Write the edited files, each whole or not at all. Raises BadUsage for a file that was changed meanwhile, before any is
    written, and OSError."""
    edits = tuple(edits)
    changed = [edit.path for edit in edits if edit.path.read_bytes().decode(errors="replace") != edit.before]
    if changed:
        raise BadUsage(*(f"{path}: changed meanwhile; nothing was written" for path in changed))
    for edit in edits:
        mode = edit.path.stat().st_mode & 0o7777
        with whole_file(edit.path) as temporary:
            temporary.write_bytes(edit.after.encode())
        edit.path.chmod(mode)
