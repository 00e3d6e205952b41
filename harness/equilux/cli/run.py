"""`equilux run`: render scenes with every adapter, compare, judge, report."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from equilux.cli import inputs, pinning
from equilux.cli.inputs import shown
from equilux.complaint import BadUsage

if TYPE_CHECKING:
    from equilux.adapter import Knobs
    from equilux.plan import Plan, Selection
    from equilux.results import Results
    from equilux.run import Finished

Flag = Annotated[bool, Parameter(negative="")]

COMPLETE = (0, 1, 4)
"""Exit codes of a run that did all its work."""


def run(
    *scenes: Path,
    adapters: str | None = None,
    out: Path = Path("equilux-out"),
    jobs: int | None = None,
    accuracy: float | None = None,
    preset: str | None = None,
    set_: Annotated[tuple[str, ...], Parameter(name="--set", negative="")] = (),
    case_filter: str | None = None,
    timeout: float = 120.0,
    memory: float | None = None,
    fail_fast: Flag = False,
    plan: Flag = False,
    reuse: Annotated[bool, Parameter(name="--reuse")] = True,
    as_is: Flag = False,
    html: bool = True,
    flip: Flag = False,
    diagnose: bool = True,
    diagnosis_timeout: float = 20.0,
    update_expectations: Flag = False,
    yes: Flag = False,
    limit: Annotated[tuple[str, ...], Parameter(name="--limit", negative="")] = (),
    json: Flag = False,
) -> int:
    """Render scenes with every adapter, compare the pictures pixel by pixel, judge, report.

    Exit code: 0 every expectation held; 1 an unexpected divergence, or a pinned one that is gone; 2 bad usage or a bad spec; 3 a
    renderer failed; 4 nothing was scored; 130 interrupted.

    Parameters
    ----------
    scenes
        Scene files or folders of them; none: the shipped corpus.
    adapters
        Adapters to use, separated by commas; the reference and the oracle are added. None given: all that are installed.
    out
        Folder of the results tree. An earlier run's is continued where scenes, adapters, versions and knobs agree, else replaced.
    jobs
        How many cores to use; none: all.
    accuracy
        Use, case by case, each renderer's cheapest setting whose stated uncertainty is at most this share of the largest
        radiance, on every pixel that is no edge. Settings and their order: docs/tradeoff.md.
    preset
        Settings of all knobs, derived from a measurement: fast, balanced, exact. Their numbers: docs/tradeoff.md.
    set_
        A knob, [ADAPTER.]KNOB=VALUE; may be given several times.
    case_filter
        Only the cases of this name; * and ? are wild.
    timeout
        Seconds that one render may take.
    memory
        MiB that one render may hold resident, with everything it started; none: 8192, or four fifths of the machine's memory.
    fail_fast
        Stop at the first failure or unexpected divergence.
    plan
        Show what would run, and stop.
    reuse
        Take renders and statistics that were made before from the same inputs by the same code.
    as_is
        Render also with an adapter that lacks a feature of the scene, and judge what comes.
    html
        Build the HTML report.
    flip
        Compute HDR-FLIP too, a perceptual aid; slow.
    diagnose
        Say why a render diverges from the truth, and judge expectations by their causes.
    diagnosis_timeout
        Seconds that the diagnosis of one render may take.
    update_expectations
        Propose the edit of the spec files that would make this run's judgement pass: proven causes are pinned, vanished ones
        removed, comments stay. Prints the diff and keeps it as OUT/expectations.patch; writes the files only when confirmed, on a
        terminal or by --yes. Never in CI.
    yes
        Confirm what --update-expectations proposes.
    limit
        Raise a limit on specs, NAME=VALUE; may be given several times.
    json
        Print results.json (with --plan: the plan; on bad specs: the list of errors) to stdout.
    """
    inputs.above_zero("--timeout", timeout, "seconds")
    inputs.above_zero("--diagnosis-timeout", diagnosis_timeout, "seconds")
    if memory is not None:
        inputs.above_zero("--memory", memory, "MiB")
    if jobs is not None:
        inputs.at_least_one("--jobs", jobs)
    if accuracy is not None:
        inputs.above_zero("--accuracy", accuracy, "largest radiances")
    if accuracy is not None and preset is not None:
        raise BadUsage("--accuracy and --preset: got both, allowed one of them; --set may fix single knobs beside either")
    _check_flip(flip)
    pinning.check_allowed(update=update_expectations, yes=yes, plan=plan, diagnose=diagnose)
    names = inputs.split_names("--adapters", adapters)
    from equilux.ci import announces
    from equilux.tree import check_usable
    from equilux.unchanged import Inputs, earlier_results, remember

    chosen = _chosen(names, set_, preset)
    choices = {
        "adapters": names, "accuracy": accuracy, "case_filter": case_filter, "timeout": timeout, "memory": memory, "as_is": as_is,
        "html": html, "flip": flip, "diagnose": diagnose, "diagnosis_timeout": diagnosis_timeout, "limit": limit,
    }  # fmt: skip
    state = None
    if reuse and not (plan or fail_fast or update_expectations or announces()):
        check_usable(out)
        state = Inputs(choices, scenes, chosen.selection.entries, chosen.knobs).state()
        if (earlier := earlier_results(out, state)) is not None:
            return _take_over(earlier, out, chosen.selection.added, html=html, as_json=json)
    planned = _planned(scenes, chosen, case_filter, limit, as_is=as_is, as_json=json)
    planned = _with_accuracy(planned, accuracy)
    check_usable(out)
    _tell_added(planned.added)
    if plan:
        return _show_plan(planned, as_json=json)
    from equilux import ci
    from equilux.run import ENGINE_FAULT, INTERRUPTED

    diagnosis_limit_s = diagnosis_timeout if diagnose else None
    finished = _execute(planned, out, jobs, timeout, memory, diagnosis_limit_s, reuse=reuse, fail_fast=fail_fast, flip=flip)
    _tell(finished.results, finished.errors, out, as_json=json)
    ci.announce(ci.RunView(finished.results, out, planned.named, ci.sources_of(planned.cases), finished.errors))
    pinning.forget(out)
    if html and finished.exit_code != INTERRUPTED:
        try:
            page = _report(out)
        except OSError as problem:  # a full disk: the results stand, the run's work is not all done
            sys.stderr.write(f"the report cannot be written: {problem}\n")
            return ENGINE_FAULT
        (sys.stderr if json else sys.stdout).write(f"report: {shown(page)}\n")
    if state is not None and finished.exit_code in COMPLETE and not finished.errors:
        remember(out, state, planned.cases, finished.results, diagnosis_timeout)
    if update_expectations and finished.exit_code != INTERRUPTED:
        sources = {case.source for case in planned.cases}
        pinning.update_expectations(finished.results, sources, out, limit, yes=yes, as_json=json)
    return finished.exit_code


def _check_flip(flip: bool) -> None:
    from importlib.util import find_spec

    if flip and find_spec("flip_evaluator") is None:
        raise BadUsage("--flip: HDR-FLIP needs the package flip-evaluator: install equilux[flip]")


@dataclass(frozen=True)
class _Chosen:
    """Who takes part, and with which knobs."""

    selection: Selection
    knobs: Mapping[str, Knobs]


def _chosen(adapters: list[str] | None, settings: tuple[str, ...], preset: str | None) -> _Chosen:
    from equilux import knobs, plan
    from equilux.registry import Registry

    selection = plan.select_adapters(Registry.discover(), adapters)
    if preset is not None:
        from equilux.tradeoff.presets import preset_settings

        settings = (*preset_settings(preset, selection.entries), *settings)
    return _Chosen(selection, knobs.resolve(settings, selection.entries))


def _planned(
    scenes: tuple[Path, ...], chosen: _Chosen, case_filter: str | None, limit: tuple[str, ...], *, as_is: bool, as_json: bool
) -> Plan:
    from equilux import plan

    loaded = inputs.load(scenes, limit, as_json=as_json)
    cases = plan.filter_cases((case for scene in loaded for case in scene.cases), case_filter)
    return plan.make_plan(cases, chosen.selection, chosen.knobs, as_is=as_is)


def _tell_added(names: Sequence[str]) -> None:
    if names:
        sys.stderr.write(f"added {' and '.join(names)}: there is always a truth to judge against\n")


def _take_over(earlier: Results, out: Path, added: Sequence[str], *, html: bool, as_json: bool) -> int:
    """Tell what an earlier run left, where a new one would make the same again."""
    _tell_added(added)
    _tell(earlier, (), out, as_json=as_json)
    said = sys.stderr if as_json else sys.stdout
    said.write(f"nothing has changed since the run of {earlier.run.ended}: nothing was rendered or compared again\n")
    if html:
        said.write(f"report: {shown(out / 'report' / 'index.html')}\n")
    return earlier.summary.exit_code


def _with_accuracy(plan: Plan, accuracy: float | None) -> Plan:
    if accuracy is None:
        return plan
    from dataclasses import replace

    from equilux.accuracy import ladders_of

    return replace(plan, ladders=ladders_of(accuracy, plan.entries, plan.knobs))


def _show_plan(plan: Plan, *, as_json: bool) -> int:
    from equilux.explain.numbers import counted

    if as_json:
        inputs.print_json(
            [
                {
                    "case": render.case.name,
                    "adapter": render.adapter,
                    "action": render.action,
                    "reason": render.reason,
                    "missing_features": list(render.missing_features),
                }
                for render in plan.renders
            ]
        )
        return 0
    rows = [("case", "adapter", "action", "why")]
    rows += [(render.case.name, render.adapter, render.action, render.reason or "") for render in plan.renders]
    sys.stdout.write(inputs.table(rows))
    running = sum(render.action == "run" for render in plan.renders)
    sys.stdout.write(f"{counted(len(plan.cases), 'case')}, {running} of {len(plan.renders)} renders would run\n")
    return 0


def _execute(
    plan: Plan, out: Path, jobs: int | None, timeout: float, memory: float | None, diagnosis_limit_s: float | None, *,
    reuse: bool, fail_fast: bool, flip: bool,
) -> Finished:  # fmt: skip
    from equilux import progress
    from equilux.adapter import Limits
    from equilux.diagnosing import TIME_LIMIT_S
    from equilux.machine import available_cores, usable_memory
    from equilux.reuse import Store, default_root
    from equilux.run import Options, execute

    store = Store(default_root()) if reuse else None
    options = Options(
        out=out,
        jobs=jobs or available_cores(),
        limits=Limits(timeout, usable_memory() if memory is None else int(memory * 2**20)),
        reuse=reuse,
        store=store,
        fail_fast=fail_fast,
        flip=flip,
        diagnose=diagnosis_limit_s is not None,
        diagnosis_limit_s=diagnosis_limit_s or TIME_LIMIT_S,
        command=("equilux", *sys.argv[1:]),
    )
    finished = execute(plan, options, progress.suitable())
    if store is not None and store.written:
        store.prune()
    return finished


def _report(out: Path) -> Path:
    from equilux_report import build

    return build(out)


def _tell(results: Results, errors: Sequence[str], out: Path, *, as_json: bool) -> None:
    from equilux.cli.summary import summary

    for error in errors:
        sys.stderr.write(f"{error}\n")
    if as_json:
        inputs.print_json(results.model_dump(mode="json"))
    else:
        sys.stdout.write(summary(results))
        sys.stdout.write(f"results: {out / 'results.json'}\n")
    sys.stdout.flush()
