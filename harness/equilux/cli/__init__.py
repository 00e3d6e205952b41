"""The command line. One file per command; heavy imports are inside the commands, so that `--help` answers at once."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from typing import Any

import cyclopts

from equilux.cli import adapters, brdf, dialects, diff, explain, extremes, report, run, scenes, score, tradeoff
from equilux.complaint import BadUsage

BAD_USAGE = 2
WITH_HELP = ("run", "report", "explain", "diff", "score", "tradeoff", "extremes", "scenes", "adapters")
"""Commands whose own help a complaint points to."""


def version() -> str:
    from equilux.machine import version_of_equilux

    return version_of_equilux()


def build() -> cyclopts.App:
    """The command tree."""
    app = cyclopts.App(
        name="equilux",
        version=version,
        help="Interlaboratory comparison for renderers: one scene, many renderers, one per-pixel radiance report.",
    )
    app.command(run.run)
    app.command(report.report)
    app.command(explain.explain)
    app.command(diff.diff)
    app.command(score.score)
    app.command(extremes.extremes)
    app.command(dialects.dialects)
    app.command(tradeoff.tradeoff)
    app.command(brdf.brdf)
    app.command(scenes.build())
    app.command(adapters.build())
    return app


def main(arguments: Sequence[str] | None = None) -> None:
    """Run one command and exit with its code."""
    sys.exit(run_command(sys.argv[1:] if arguments is None else arguments))


def run_command(arguments: Sequence[str]) -> int:
    """Run one command. Returns its exit code; complaints go to stderr, one unwrapped line each."""
    app = build()
    try:
        command, bound, _ = app.parse_args(list(arguments), exit_on_error=False, print_error=False)
        return _called(command, bound)
    except cyclopts.CycloptsError as problem:
        return _complain([_one_line(problem, arguments)])
    except BadUsage as problem:
        return _complain(problem.lines)
    except KeyboardInterrupt:
        return 130
    except BrokenPipeError:  # the reader of our output (`| head`) has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        return 0


def _called(command: Callable[..., Any], bound: Any) -> int:
    code = command(*bound.args, **bound.kwargs)
    sys.stdout.flush()
    return code if isinstance(code, int) else 0


def _complain(lines: Sequence[str]) -> int:
    for line in lines:
        sys.stderr.write(line + "\n")
    return BAD_USAGE


def _one_line(problem: cyclopts.CycloptsError, arguments: Sequence[str]) -> str:
    """What is wrong with a command line, on one line, with where to read more."""
    text = " ".join(str(problem).split())
    chain = [word for word in arguments if word in WITH_HELP][:1]
    return f"equilux: {text} (see: {' '.join(['equilux', *chain, '--help'])})"
