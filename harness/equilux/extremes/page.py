"""docs/extremes.md: what a push of all axes found, as a table and by renderer.

`python -m equilux.extremes.page FOLDER/extremes.json > docs/extremes.md`
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from equilux.extremes.record import AxisRecord, Curve, Extremes, Turn
from equilux.extremes.words import line_of, turn_words, with_unit
from equilux.trust import TRUTHS

INTRODUCTION = """\
# Where each renderer breaks

One quantity at a time is pushed decade by decade from a value at which every renderer must hold, with all else compensated
(`equilux extremes --list`).

- **Bold**: the breakdown, the first value whose picture departs from the truth by more than both sides' stated uncertainty, or
  is missing.
- *Italic*: the adapter gives up with a word, from there on: it refuses the scene, it states an uncertainty as large as the
  picture, or the picture is off by more than a thousandth, within an uncertainty that says so.
- –: not expressible.

The truth is the oracle; for triangle meshes, which have no closed form, it is the reference.
"""


def page(record: Extremes) -> str:
    """The page as Markdown."""
    names = sorted(_judged(record), key=lambda name: (name in TRUTHS, name))
    parts = [INTRODUCTION, _made(record, names), _matrix(record, names)]
    parts += [_of_renderer(record, name) for name in names]
    return "\n".join(parts)


def _judged(record: Extremes) -> set[str]:
    return {
        curve.adapter
        for axis in record.axes
        for curve in axis.curves
        if any(point.outcome not in ("missing", "unjudged") for point in curve.points) and curve.adapter != TRUTHS[0]
    }


def _made(record: Extremes, names: Sequence[str]) -> str:
    renderers = "; ".join(f"{record.adapters[name].title} {record.adapters[name].version}" for name in names)
    return (
        f"Made by `equilux extremes` of equilux {record.run.equilux} and `python -m equilux.extremes.page` on "
        f"{record.run.ended[:10]}, {record.run.seconds:.0f} s of rendering. {renderers}.\n"
    )


def _matrix(record: Extremes, names: Sequence[str]) -> str:
    rows = ["| axis | " + " | ".join(names) + " |", "| --- |" + " --- |" * len(names)]
    for axis in record.axes:
        curves = {curve.adapter: curve for curve in axis.curves}
        cells = [_cell(axis, curves.get(name)) for name in names]
        rows.append(f"| {axis.title}{f' ({axis.unit})' if axis.unit else ''} | " + " | ".join(cells) + " |")
    return "\n".join(rows) + "\n"


def _cell(axis: AxisRecord, curve: Curve | None) -> str:
    if curve is None or curve.model is None or all(point.outcome == "missing" for point in curve.points):
        return "–"
    if all(point.outcome == "unjudged" for point in curve.points):
        return "the truth"
    return "<br>".join(_mark(turn) for turn in curve.turns)


def _mark(turn: Turn) -> str:
    arrow = "↓" if turn.direction == "down" else "↑"
    if turn.breakdown is not None:
        return f"{arrow} **{with_unit(turn.breakdown, '')}**"
    return f"{arrow} *{with_unit(turn.gives_up, '')}*" if turn.gives_up is not None else f"{arrow} holds"


def _of_renderer(record: Extremes, name: str) -> str:
    """What breaks, in words; axes without a word to say are not listed."""
    lines = []
    for axis in record.axes:
        for curve in axis.curves:
            told = [turn for turn in curve.turns if turn.breakdown is not None or turn.gives_up is not None]
            if curve.adapter == name and told:
                lines.append(f"- **{axis.title}** ({curve.model}): " + "; ".join(turn_words(axis, turn) for turn in told) + ".")
    body = "\n".join(lines) if lines else f"Holds on every axis: {_reach(record, name)}."
    return f"## {record.adapters[name].title}\n\n{body}\n"


def _reach(record: Extremes, name: str) -> str:
    return ", ".join(axis.name for axis in record.axes for curve in axis.curves if curve.adapter == name and line_of(axis, curve))


def main(arguments: Sequence[str]) -> int:
    if len(arguments) != 1:
        sys.stderr.write("usage: python -m equilux.extremes.page FOLDER/extremes.json > docs/extremes.md\n")
        return 2
    sys.stdout.write(page(Extremes.model_validate_json(Path(arguments[0]).read_text(encoding="utf-8"))))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
