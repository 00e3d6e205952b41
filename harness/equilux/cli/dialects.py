"""`equilux dialects`: what each renderer's lighting model really is, from a results tree."""

from __future__ import annotations

import sys
from pathlib import Path

from equilux.cli.inputs import shown
from equilux.complaint import BadUsage


def dialects(run: Path, /, *, out: Path = Path("docs/dialects"), fit: bool = True) -> int:
    """Write what each renderer's dialect is: a page per adapter that declares one and took part, with the evidence of the run.

    Exit code: 0 the pages were written, 2 bad usage.

    Parameters
    ----------
    run
        Folder of the results tree.
    out
        Folder of the pages.
    fit
        Find the parameters anew, as if none were declared; needs the scenes as they were rendered.
    """
    from equilux.diagnosing import known_rules
    from equilux.dialect import declared_dialect
    from equilux.dialects.evidence import gathered, with_fits
    from equilux.dialects.page import page
    from equilux.readrun import read_run
    from equilux.registry import Registry
    from equilux.wholefile import whole_file

    read, rules = read_run(run), known_rules()
    for entry in Registry.discover().entries.values():
        dialect = declared_dialect(entry.adapter) if entry.name in read.results.run.adapters else ()
        if not dialect:
            continue
        try:
            evidence = gathered(read, entry.name, getattr(entry.adapter, "title", entry.name), dialect)
            if fit:
                with_fits(evidence, read, rules)
        except (OSError, ValueError, KeyError) as problem:
            why = " ".join(str(problem).split())
            raise BadUsage(f"'{run}': what it holds of {entry.name} cannot be read: {why}") from problem
        target = out / f"{entry.name}.md"
        try:
            out.mkdir(parents=True, exist_ok=True)
            with whole_file(target, suffix=".md") as temporary:
                temporary.write_text(page(evidence, rules), encoding="utf-8")
        except OSError as problem:
            raise BadUsage(f"--out: '{target}' cannot be written: {problem.strerror}") from problem
        sys.stdout.write(f"{shown(target)}\n")
    return 0
