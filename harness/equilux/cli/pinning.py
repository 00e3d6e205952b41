"""`equilux run --update-expectations`: shows the edit of the spec files that a run asks for, and writes it when told to."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from equilux.cli.inputs import shown
from equilux.complaint import BadUsage

if TYPE_CHECKING:
    from equilux.pinning.propose import FileEdit, Proposal
    from equilux.results import Results

OPTION = "--update-expectations"


def check_allowed(*, update: bool, yes: bool, plan: bool, diagnose: bool) -> None:
    """Raises BadUsage before anything is rendered: in CI nobody looks at what is about to be expected."""
    if not update:
        if yes:
            raise BadUsage(f"--yes: got without {OPTION}, allowed only with it")
        return
    for name in ("CI", "GITHUB_ACTIONS"):
        value = os.environ.get(name, "")
        if value.lower() not in ("", "0", "false"):
            raise BadUsage(
                f"{OPTION}: got {name}={value} in the environment, allowed only outside CI: run it where someone reads it"
            )
    if plan:
        raise BadUsage(f"{OPTION}: got with --plan, which judges nothing, allowed one of them")
    if not diagnose:
        raise BadUsage(f"{OPTION}: got with --no-diagnose, which finds no cause to pin, allowed one of them")


def forget(out: Path) -> None:
    """A patch that an earlier run proposed says nothing of this one."""
    from equilux.pinning.propose import PATCH_FILE

    (out / PATCH_FILE).unlink(missing_ok=True)


def update_expectations(
    results: Results, sources: Iterable[Path | None], out: Path, limit: Sequence[str], *, yes: bool, as_json: bool
) -> None:
    """Print the diff (to stderr where stdout holds JSON), keep it as a patch in the results tree, and write the files where that
    is confirmed: by --yes, or by an answer on a terminal."""
    from equilux.pinning.propose import PATCH_FILE, propose, write
    from equilux.wholefile import whole_file
    from equilux_scenes.limits import Limits

    say = sys.stderr if as_json else sys.stdout
    proposal = propose(results, [path for path in sources if path is not None], Limits.from_options(limit))
    patch = out / PATCH_FILE
    if not proposal.edits:
        say.write(
            "expectations: nothing to change\n" if not proposal.impossible else "expectations: nothing that can be pinned\n"
        )
    else:
        with whole_file(patch) as temporary:
            temporary.write_bytes(proposal.patch().encode())
        say.write(proposal.patch())
        _tell(proposal, patch, say.write)
    for line in proposal.impossible:
        sys.stderr.write(f"cannot be pinned: {line}\n")
    say.flush()
    writable = [edit for edit in proposal.edits if edit.fixed is None]
    if writable and (yes or (not as_json and _confirmed(writable))):
        try:
            write(writable)
        except OSError as problem:
            raise BadUsage(f"{OPTION}: {problem}; what was proposed is in '{shown(patch)}'") from problem
        say.write(f"written: {', '.join(str(shown(edit.path)) for edit in writable)}; run again to judge by it\n")


def _tell(proposal: Proposal, patch: Path, say: object) -> None:
    assert callable(say)
    for edit in proposal.edits:
        for words in edit.words:
            say(f"{shown(edit.path)}: {words}\n")
        if edit.fixed is not None:
            say(f"{shown(edit.path)}: only proposed, {edit.fixed}\n")
    folder = "" if proposal.base == Path.cwd().resolve() else f" -d '{proposal.base}'"
    say(f"proposed: {shown(patch)} (apply it with --yes, or with: patch -p1{folder} < '{shown(patch)}')\n")


def _confirmed(edits: Sequence[FileEdit]) -> bool:
    """Ask, where somebody can answer."""
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        return False
    files = "this file" if len(edits) == 1 else f"these {len(edits)} files"
    sys.stdout.write(f"write {files}? [y/N] ")
    sys.stdout.flush()
    return sys.stdin.readline().strip().lower() in ("y", "yes")
