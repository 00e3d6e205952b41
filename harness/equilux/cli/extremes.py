"""`equilux extremes`: push one quantity decade by decade until each renderer breaks."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from equilux.cli import inputs
from equilux.cli.inputs import shown
from equilux.complaint import BadUsage, nearest

if TYPE_CHECKING:
    from equilux.extremes.axis import Axis
    from equilux.extremes.push import Push
    from equilux.extremes.record import Extremes
    from equilux.run import Options

Flag = Annotated[bool, Parameter(negative="")]


def extremes(
    *axes: str,
    adapters: str | None = None,
    out: Path = Path("equilux-extremes"),
    jobs: int | None = None,
    set_: Annotated[tuple[str, ...], Parameter(name="--set", negative="")] = (),
    timeout: float = 30.0,
    memory: float | None = None,
    diagnose: bool = True,
    diagnosis_timeout: float = 6.0,
    reuse: Annotated[bool, Parameter(name="--reuse")] = True,
    html: bool = True,
    list_: Annotated[bool, Parameter(name="--list", negative="")] = False,
    json: Flag = False,
) -> int:
    """Push one quantity decade by decade until each renderer breaks: where, and what breaks.

    A renderer that breaks is what is measured, not a failure of the command. Exit code: 0 all was measured; 2 bad usage; 3 the
    engine itself failed; 130 interrupted.

    Parameters
    ----------
    axes
        Axes to push, as --list names them; none: all.
    adapters
        Adapters to use, separated by commas; the reference and the oracle are added. None given: all that are installed.
    out
        Folder of the results tree, of extremes.json and of the page. An earlier push's is continued where it agrees.
    jobs
        How many cores to use; none: all.
    set_
        A knob, [ADAPTER.]KNOB=VALUE; may be given several times.
    timeout
        Seconds that one render may take.
    memory
        MiB that one render may hold resident, with everything it started; none: 8192, or four fifths of the machine's memory.
    diagnose
        Say why the first broken picture of each direction is wrong.
    diagnosis_timeout
        Seconds that the diagnosis of one render may take.
    reuse
        Take renders and statistics that were made before from the same inputs by the same code.
    html
        Build the page.
    list_
        Show the axes, and stop.
    json
        Print extremes.json (with --list: the axes) to stdout.
    """
    chosen = _chosen(axes)
    if list_:
        return _list(chosen, as_json=json)
    inputs.above_zero("--timeout", timeout, "seconds")
    inputs.above_zero("--diagnosis-timeout", diagnosis_timeout, "seconds")
    if memory is not None:
        inputs.above_zero("--memory", memory, "MiB")
    if jobs is not None:
        inputs.at_least_one("--jobs", jobs)
    push = _push(chosen, inputs.split_names("--adapters", adapters), set_)
    from equilux.extremes.run import FILE, carry_out
    from equilux.run import ENGINE_FAULT, INTERRUPTED
    from equilux.tree import check_usable

    check_usable(out)
    options = _options(out, jobs, timeout, memory, diagnosis_timeout if diagnose else None, reuse=reuse)
    done = carry_out(push, options)
    if options.store is not None and options.store.written:
        options.store.prune()
    for error in done.errors:
        sys.stderr.write(f"{error}\n")
    if done.record is None:
        sys.stderr.write("interrupted: the same command continues\n")
        return INTERRUPTED
    if json:
        inputs.print_json(done.record.model_dump(mode="json"))
    else:
        sys.stdout.write(table(done.record))
        sys.stdout.write(f"extremes: {shown(out / FILE)}\n")
    if html:
        _page(out, as_json=json)
    return ENGINE_FAULT if done.errors else 0


def _chosen(names: tuple[str, ...]) -> tuple[Axis, ...]:
    from equilux.extremes.axes import AXES, BY_NAME

    unknown = [name for name in dict.fromkeys(names) if name not in BY_NAME]
    if unknown:
        known = ", ".join(BY_NAME)
        raise BadUsage(*(f"unknown axis '{name}', allowed {known}{nearest(name, BY_NAME)}" for name in unknown))
    return tuple(axis for axis in AXES if axis.name in names) if names else AXES


def _list(axes: tuple[Axis, ...], *, as_json: bool) -> int:
    from equilux.extremes.axis import shown as number
    from equilux.extremes.words import with_unit

    if as_json:
        inputs.print_json(
            [
                {"name": axis.name, "title": axis.title, "unit": axis.unit, "benign": axis.benign, "values": list(axis.values),
                 "models": list(axis.models), "about": axis.about, "watch": axis.watch}
                for axis in axes
            ]
        )  # fmt: skip
        return 0
    rows = [("axis", "what is pushed", "from", "by way of", "to")]
    rows += [
        (axis.name, axis.title, number(axis.values[0]), number(axis.benign), with_unit(axis.values[-1], axis.unit))
        for axis in axes
    ]
    sys.stdout.write(inputs.table(rows, frozenset({2, 3})))
    return 0


def _push(axes: tuple[Axis, ...], names: list[str] | None, settings: tuple[str, ...]) -> Push:
    from equilux import knobs, plan
    from equilux.extremes.push import is_renderable, make_push
    from equilux.registry import Registry

    selection = plan.select_adapters(Registry.discover(), names)
    push = make_push(axes, selection, knobs.resolve(settings, selection.entries))
    if not is_renderable(push):
        raise BadUsage(
            "nothing can be rendered: none of these adapters is installed with its renderer (see: equilux adapters list)"
        )
    if push.plan.added:
        sys.stderr.write(f"added {' and '.join(push.plan.added)}: there is always a truth to judge against\n")
    return push


def _options(
    out: Path, jobs: int | None, timeout: float, memory: float | None, diagnosis_limit_s: float | None, *, reuse: bool
) -> Options:
    from equilux.adapter import Limits
    from equilux.diagnosing import TIME_LIMIT_S
    from equilux.machine import available_cores, usable_memory
    from equilux.reuse import Store, default_root
    from equilux.run import Options

    return Options(
        out=out,
        jobs=jobs or available_cores(),
        limits=Limits(timeout, usable_memory() if memory is None else int(memory * 2**20)),
        reuse=reuse,
        store=Store(default_root()) if reuse else None,
        diagnose=diagnosis_limit_s is not None,
        diagnosis_limit_s=diagnosis_limit_s or TIME_LIMIT_S,
        command=("equilux", *sys.argv[1:]),
    )


def table(record: Extremes) -> str:
    """One line per axis and renderer."""
    from equilux.extremes.words import line_of

    rows = [("axis", "renderer", "what it does")]
    rows += [
        (axis.name, curve.adapter, line_of(axis, curve))
        for axis in record.axes
        for curve in axis.curves
        if curve.adapter != "oracle"
    ]
    return inputs.table(rows)


def _page(out: Path, *, as_json: bool) -> None:
    from equilux_report.extremes import build_extremes

    page = build_extremes(out)
    (sys.stderr if as_json else sys.stdout).write(f"page: {shown(page)}\n")
