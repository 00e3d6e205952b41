"""`equilux diff`: what changed between two runs."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from equilux.cli import inputs

SCHEMA = "equilux/diff/1"


def diff(run_a: Path, run_b: Path, /, *, json: Annotated[bool, Parameter(negative="")] = False) -> int:
    """Say what changed between two runs, in words: versions, cases, statuses, judgements, causes, pictures, expectations,
    uncertainties, times. The same change on many cases is one sentence, the most important first.

    Exit code: 0 nothing that matters changed, 1 something did, 2 bad usage. What matters: a case, an adapter or an expectation
    that is in one run alone, a scene, a status, a judgement, a finding or a cause that changed (fitted parameters: by more than
    0.1 %), a picture that changed beyond what both renders state together, and a stated uncertainty that changed by more than a
    factor of 2. What does not, and is told: versions, machine, knobs and command; pictures that changed within their uncertainty;
    rendering times that changed by more than a factor of 2 and 0.5 s.

    Parameters
    ----------
    run_a
        Folder of the earlier results tree.
    run_b
        Folder of the later one.
    json
        Print the machine form: every change by itself.
    """
    from equilux.difference.compare import compare_runs
    from equilux.difference.pictures import compare_pictures
    from equilux.difference.words import tell
    from equilux.readrun import read_run

    a, b = read_run(run_a), read_run(run_b)
    for read in (a, b):
        if read.ignored:
            sys.stderr.write(f"{read.root}: unknown to this version of equilux and left out: {', '.join(read.ignored)}\n")
    changes = [*compare_runs(a.results, b.results, a.manifest, b.manifest), *compare_pictures(a, b)]
    matters = any(change.matters for change in changes)
    text = tell(a.results, b.results, changes, (str(run_a), str(run_b)))
    if json:
        runs = {name: {"path": str(read.root), **read.results.run.model_dump(mode="json")} for name, read in (("a", a), ("b", b))}
        listed = [change.to_json() for change in changes]
        inputs.print_json({"schema": SCHEMA, **runs, "matters": matters, "changes": listed, "text": text})
    else:
        sys.stdout.write("".join(f"{line}\n" for line in text))
    return int(matters)
