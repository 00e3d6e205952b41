"""`equilux explain`: why two renders differ, from a results tree alone."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from equilux.cli import inputs
from equilux.complaint import BadUsage

if TYPE_CHECKING:
    from equilux.explain.pixel import PixelFacts
    from equilux.readrun import ReadRun
    from equilux.results import CaseRecord, PairRecord


def explain(
    run: Path,
    case: str,
    a: str,
    b: str,
    /,
    *,
    pixel: str | None = None,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Say why two renders of a case differ, in words and numbers, from the results tree of a run.

    The verdict; both values at the worst pixel, and the uncertainty they are held against, term by term; the causes that were
    proven, with the formula of the model and that of the renderer, and what they leave; whether that was declared and expected;
    what to do next. Exit code: 0 it was told, 2 bad usage.

    Parameters
    ----------
    run
        Folder of the results tree.
    case
        Name of the case, in quotes where it has brackets; * and ? are wild, exactly one case must match.
    a
        One adapter.
    b
        The other, in either order.
    pixel
        Explain this pixel alone: X,Y from the top left, from 0.
    json
        Print the machine form.
    """
    from equilux.explain import gather, machine_form, sentences
    from equilux.readrun import read_run

    place = _place(pixel)
    read = read_run(run)
    _note_ignored(read)
    record = gather.find_case(read, case)
    pair = gather.find_pair(record, a, b)
    if isinstance(pair, gather.NoPair):
        if place is not None:
            raise BadUsage(f"--pixel: {pair.a} and {pair.b} were not compared: {'; '.join(pair.why)}")
        if json:
            inputs.print_json(machine_form.no_pair_json(pair))
        else:
            _print(machine_form.no_pair_lines(pair))
        return 0
    told = gather.gather(read, record, pair)
    facts = _pixel(read, record, pair, place) if place is not None else None
    if json:
        inputs.print_json(machine_form.pair_json(record, pair, told, facts))
    elif facts is not None:
        _print([f"{record.case}: {pair.a} against {pair.b}", *sentences.pixel_lines(pair, facts)])
    else:
        _print(sentences.explain_pair(record, pair, told))
    return 0


def _print(lines: list[str]) -> None:
    sys.stdout.write("".join(f"{line}\n" for line in lines))


def _note_ignored(read: ReadRun) -> None:
    if read.ignored:
        sys.stderr.write(f"{read.root}: unknown to this version of equilux and left out: {', '.join(read.ignored)}\n")


def _place(text: str | None) -> tuple[int, int] | None:
    if text is None:
        return None
    found = re.fullmatch(r"\s*([0-9]{1,9})\s*,\s*([0-9]{1,9})\s*", text)
    if found is None:
        raise BadUsage(f"--pixel: got '{text}', allowed two integers X,Y counted from 0 at the top left, such as --pixel 128,40")
    return int(found[1]), int(found[2])


def _pixel(read: ReadRun, case: CaseRecord, pair: PairRecord, place: tuple[int, int]) -> PixelFacts:
    from equilux.explain.gather import read_pixel

    x, y = place
    if x >= case.width or y >= case.height:
        raise BadUsage(
            f"--pixel: got {x},{y}, allowed 0,0 to {case.width - 1},{case.height - 1}: {case.case} is {case.width}×{case.height}"
        )
    try:
        return read_pixel(read, case, pair, x, y)
    except (OSError, ValueError, KeyError, TypeError) as problem:
        raise BadUsage(f"--pixel: the pictures cannot be read: {problem}") from problem
