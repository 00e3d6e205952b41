"""`equilux report`: build the HTML report from a results tree alone."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from equilux.cli.inputs import shown
from equilux.complaint import BadUsage


def report(
    run: Path,
    /,
    *,
    single_file: Annotated[bool, Parameter(negative="")] = False,
    out: Path | None = None,
    case_filter: str | None = None,
) -> int:
    """Build the HTML report of a run from its results tree alone.

    Parameters
    ----------
    run
        Folder of the results tree.
    single_file
        One page that holds everything, to be mailed around.
    out
        Folder for the report; none: RUN/report.
    case_filter
        Only the cases of this name; * and ? are wild.
    """
    from equilux.tree import is_results_tree

    if not is_results_tree(run):
        raise BadUsage(f"'{run}' is no results tree: it has no run.json of equilux (the folder given to 'equilux run --out')")
    if case_filter is not None:
        from equilux.plan import matching_names

        matching_names(sorted(folder.name for folder in (run / "cases").glob("*/")), case_filter)
    from equilux_report import build

    try:
        page = build(run, out=out, single_file=single_file, case_filter=case_filter)
    except OSError as problem:
        raise BadUsage(f"the report cannot be written: {problem}") from problem
    sys.stdout.write(f"{shown(page)}\n")
    return 0
