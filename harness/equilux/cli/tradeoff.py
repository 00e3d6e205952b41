"""`equilux tradeoff`: what each setting of each renderer costs, and how accurate it is."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from equilux.cli import inputs
from equilux.cli.inputs import shown
from equilux.complaint import BadUsage

if TYPE_CHECKING:
    from equilux.tradeoff.record import Tradeoff
    from equilux.tradeoff.trade import Question

Flag = Annotated[bool, Parameter(negative="")]

DEFAULT_SCENES = (
    "lights/clay-ball", "reflection-equation/soft-shadow", "raytraced/mirror-sphere", "opengl/opengl-half-vector",
)  # fmt: skip
"""Of the corpus: one of each model."""
DEFAULT_CASES_PER_RENDERER = 3
"""A renderer is measured on the first so many of them that it can do; only the reference can do all."""


def tradeoff(
    *scenes: Path,
    adapter: str | None = None,
    error: float | None = None,
    time: float | None = None,
    clock: Literal["wall", "cpu"] = "wall",
    out: Path = Path("equilux-tradeoff"),
    repeats: int | None = None,
    grid: int | None = None,
    features: bool = True,
    case_filter: str | None = None,
    timeout: float = 120.0,
    presets: Path | None = None,
    page: Path | None = None,
    html: bool = True,
    limit: Annotated[tuple[str, ...], Parameter(name="--limit", negative="")] = (),
    json: Flag = False,
) -> int:
    """Measure what accuracy costs: every setting of every renderer's knobs, its error against the truth and its time by phase.

    Writes OUT/tradeoff.json, OUT/*.svg and OUT/report/tradeoff.html. Exit code: 0 measured; 1 what --error or --time asks for is
    met by no setting of any renderer on some case; 2 bad usage or a bad spec; 3 a renderer failed; 4 nothing was measured; 130
    interrupted.

    Parameters
    ----------
    scenes
        Scene files or folders of them; none: one of each model from the corpus, each renderer on the first three that it can do.
    adapter
        Only these adapters, separated by commas; none: all that are installed.
    error
        Ask for the cheapest setting whose error is at most this, as a share of the largest radiance.
    time
        Ask for the most accurate setting that takes at most so many seconds per picture.
    clock
        Which time fronts and answers go by.
    out
        Folder of the results; absent, empty, or an earlier measurement's.
    repeats
        How often each picture is made, at least 3; none: 5.
    grid
        Measure all combinations of all steps of a renderer's knobs where they are at most so many, else each knob alone and all
        together; none: 12.
    features
        Measure also what each feature of a scene costs.
    case_filter
        Only the cases of this name; * and ? are wild.
    timeout
        Seconds that one render may take.
    presets
        Write the presets that follow to this file too.
    page
        Write the page with the numbers to this file too, as Markdown.
    html
        Build the report page and the plots.
    limit
        Raise a limit on specs, NAME=VALUE; may be given several times.
    json
        Print tradeoff.json to stdout.
    """
    from dataclasses import replace

    from equilux.adapter import Limits
    from equilux.machine import usable_memory
    from equilux.tradeoff.folder import FILE, check_usable, scratch_in
    from equilux.tradeoff.trade import tradeoff as measured_by
    from equilux.tradeoff.words import exit_code, told

    _check_numbers(error, time, repeats, grid, timeout)
    check_usable(out)
    question = replace(
        _question(scenes, adapter, case_filter, limit, as_json=json),
        clock=clock, with_features=features, limits=Limits(timeout, usable_memory()), command=("equilux", *sys.argv[1:]),
    )  # fmt: skip
    asked = error is not None or time is not None
    if asked:
        question = replace(question, errors=_only(error), times=_only(time))
    if repeats is not None:
        question = replace(question, repeats=repeats)
    if grid is not None:
        question = replace(question, grid_limit=grid)
    with scratch_in(out) as scratch:
        found = measured_by(question, scratch, _say)
    _write(found, out, presets, page)
    if html:
        _report(out, as_json=json)
    if json:
        inputs.print_json(found.model_dump(mode="json"))
    else:
        sys.stdout.write(told(found, asked=asked))
        sys.stdout.write(f"results: {shown(out / FILE)}\n")
    return exit_code(found, asked=asked)


def _only(bound: float | None) -> tuple[float, ...]:
    return () if bound is None else (bound,)


def _check_numbers(error: float | None, time: float | None, repeats: int | None, grid: int | None, timeout: float) -> None:
    if error is not None:
        inputs.above_zero("--error", error, "largest radiances")
    if time is not None:
        inputs.above_zero("--time", time, "seconds")
    if repeats is not None and repeats < 3:
        raise BadUsage(f"--repeats: got {repeats}, expected an integer of at least 3: fewer have no interval")
    if grid is not None:
        inputs.at_least_one("--grid", grid)
    inputs.above_zero("--timeout", timeout, "seconds")


def _question(
    scenes: Sequence[Path], adapter: str | None, case_filter: str | None, limit: Sequence[str], *, as_json: bool
) -> Question:
    from equilux import plan
    from equilux.registry import Registry
    from equilux.tradeoff.trade import Question
    from equilux.trust import TRUTHS
    from equilux_scenes.loader import SUFFIX, corpus_folder

    chosen = scenes or [corpus_folder() / f"{name}{SUFFIX}" for name in DEFAULT_SCENES]
    loaded = inputs.load(chosen, limit, as_json=as_json)
    names = inputs.split_names("--adapter", adapter)
    registry = Registry.discover()
    entries = registry.select(names, option="--adapter") if names else list(registry.entries.values())
    if names and all(name == TRUTHS[0] for name in names):
        raise BadUsage(f"--adapter: the {TRUTHS[0]} is what errors are measured against; it has no setting to trade")
    cases = plan.filter_cases((case for scene in loaded for case in scene.cases), case_filter)
    return Question(cases, entries, cases_per_renderer=None if scenes else DEFAULT_CASES_PER_RENDERER)


def _write(found: Tradeoff, out: Path, presets: Path | None, page: Path | None) -> None:
    """All files but the report. Raises BadUsage for one that cannot be written."""
    from equilux.tradeoff.folder import FILE
    from equilux.tradeoff.page import page_of
    from equilux.wholefile import whole_file, write_json

    write_json(out / FILE, found.model_dump(mode="json"))
    try:
        if presets is not None:
            write_json(presets, found.presets.model_dump(mode="json"))
        if page is not None:
            with whole_file(page, suffix=".md") as temporary:
                temporary.write_text(page_of(found), encoding="utf-8")
    except OSError as problem:
        raise BadUsage(f"'{problem.filename}' cannot be written: {problem.strerror}") from problem


def _report(out: Path, *, as_json: bool) -> None:
    from equilux_report import build_tradeoff

    page = build_tradeoff(out)
    (sys.stderr if as_json else sys.stdout).write(f"report: {shown(page)}\n")


def _say(line: str) -> None:
    sys.stderr.write(line + "\n")
    sys.stderr.flush()
