"""docs/tradeoff.md, from a measurement: `equilux tradeoff --page docs/tradeoff.md`."""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Sequence

from equilux.tradeoff.front import seconds_of
from equilux.tradeoff.presets import NAMES
from equilux.tradeoff.record import CaseTrade, Clock, FeatureCost, Measured, Preset, RendererTrade, Spread, Tradeoff
from equilux.tradeoff.words import NONE, short


def page_of(found: Tradeoff) -> str:
    """Markdown: presets, fronts, start-up and what features cost, with the numbers and where they come from."""
    parts = [_head(found), _presets(found), _start_up(found), "## Fronts\n"]
    parts += [_case(case, found.made.clock) for case in found.cases]
    parts.append(_features(found.features))
    return "\n".join(parts)


def _head(found: Tradeoff) -> str:
    made = found.made
    where = f"{made.machine.get('processor', '')}, {made.machine.get('cores', '?')} cores"
    versions = ", ".join(f"{name} {version}" for name, version in made.versions.items())
    confidence = _confidence(found)
    return f"""# Speed for accuracy, measured

This page is made by one command, and is not edited:

    {shlex.join(made.command)}

Made {made.started} with equilux {made.equilux} in {made.seconds:.0f} s on {where}: {versions}.

**Error**: max |ΔL| / max |L| over the pixels that are no edges, against the closed form (oracle) or the reference in
its exact mode, which each table says. Where an adapter declares to do something otherwise than the model, the number is
against the reference doing likewise, and the error against the model stands beside it. **Claimed**: the largest
uncertainty that the renderer states for itself, on the same scale. **Time**: one picture in a worker that is already
running, median of {made.repeats} interleaved repeats, and the interval that holds the true median with {confidence:.1%}
whatever the distribution. CPU time counts all threads and child processes; a renderer that sleeps or uses several cores
has another wall time. Fronts and answers go by {made.clock} time.
"""


def _confidence(found: Tradeoff) -> float:
    spreads = [setting.times.wall["total"] for _, _, setting in _all(found.cases) if setting.times is not None]
    return min((spread.confidence for spread in spreads), default=0.0)


def _all(cases: Iterable[CaseTrade]) -> Iterable[tuple[CaseTrade, str, Measured]]:
    for case in cases:
        for name, trade in case.renderers.items():
            for setting in trade.settings:
                yield case, name, setting


def _presets(found: Tradeoff) -> str:
    rows = []
    for name, adapter in found.presets.adapters.items():
        for preset in (preset for preset in NAMES if preset in adapter.presets):
            chosen = adapter.presets[preset]
            rows.append((name, f"`{preset}`", _knobs(chosen), short(chosen.accuracy), _seconds(chosen.seconds), chosen.rule))
    ladders = [
        f"- **{name}**: " + " → ".join(rung.label for rung in adapter.ladder) for name, adapter in found.presets.adapters.items()
    ]
    return f"""## Presets

`equilux run --preset NAME` sets the knobs of every renderer; `--set` overrides. Error and seconds are the worst of the
cases below.

{_table(("renderer", "preset", "knobs", "error", "s", "rule"), rows)}
`equilux run --accuracy E` tries these settings in turn, case by case, until the uncertainty that the renderer states on
that very case is at most E of the largest radiance:

{chr(10).join(ladders)}
"""


def _knobs(preset: Preset) -> str:
    return f"{preset.label}" if preset.label else "default"


def _start_up(found: Tradeoff) -> str:
    rows = [
        (name, _spread(seen.wall), _spread(seen.cpu), _spread(seen.small_picture_wall), _spread(seen.small_picture_cpu))
        for name, seen in found.start_up.items()
    ]
    return f"""## Start-up

What is paid once per worker (a fork, the renderer's import, its first context): its first picture less a later one of
the same. And what every picture costs however small it is: 8 × 6 pixels, default knobs.

{_table(("renderer", "start-up wall s", "CPU s", "smallest picture wall s", "CPU s"), rows)}"""


def _case(case: CaseTrade, clock: Clock) -> str:
    rows = []
    for name, trade in case.renderers.items():
        rows += [_row(name, setting, clock) for setting in trade.settings if setting.front or setting.default]
    left = [_why_not(name, trade) for name, trade in case.renderers.items() if not trade.settings]
    note = f"\nNot measured: {'; '.join(left)}.\n" if left else ""
    header = ("renderer", "setting", "error", "claimed", "wall s", "CPU s", "front of all")
    return f"""### {case.case}

{case.about} {case.width} × {case.height}, against the {case.truth}.

{_table(header, rows)}{note}"""


def _why_not(name: str, trade: RendererTrade) -> str:
    return f"{name} ({trade.status}{': ' + trade.reason if trade.reason else ''})"


def _row(name: str, setting: Measured, clock: Clock) -> tuple[str, ...]:
    error = short(setting.accuracy)
    if setting.error_to_dialect is not None and setting.error is not None:
        error += f" (to the model {short(setting.error.max_rel)}: {', '.join(setting.dialect)})"
    if setting.times is None or seconds_of(setting, clock) is None:
        return (name, setting.label, setting.status, "", "", "", "")
    wall, cpu = setting.times.wall["total"], setting.times.cpu["total"]
    mark = "yes" if setting.front_of_all else "" if setting.front else "(default)"
    return (name, setting.label, error, short(setting.claimed), _spread(wall), _spread(cpu), mark)


def _features(features: Sequence[FeatureCost]) -> str:
    if not features:
        return ""
    rows = []
    for feature in features:
        for name, cost in feature.renderers.items():
            if cost.without_cpu is not None and cost.extra_cpu is not None and cost.extra_wall is not None:
                share = cost.extra_cpu.median / cost.without_cpu.median if cost.without_cpu.median else 0.0
                rows.append(
                    (feature.feature, name, _spread(cost.without_cpu), _signed(cost.extra_cpu), f"{share:+.0%}",
                     _signed(cost.extra_wall))
                )  # fmt: skip
    words = "\n".join(f"- **{feature.feature}**: {feature.words}" for feature in features)
    return f"""## What a feature costs

The same scene with a feature and without it, default knobs; the difference of each round, its median and interval. An
interval that holds 0 shows no cost. A renderer that cannot do one of the two scenes is left out.

{words}

{_table(("feature", "renderer", "without: CPU s", "extra CPU s", "share", "extra wall s"), rows)}"""


def _spread(spread: Spread) -> str:
    return f"{spread.median:.3g} ({spread.low:.3g}–{spread.high:.3g})"


def _signed(spread: Spread) -> str:
    return f"{spread.median:+.2g} ({spread.low:+.2g} to {spread.high:+.2g})"


def _seconds(value: float | None) -> str:
    return NONE if value is None else f"{value:.3g}"


def _table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    cells = [header, ["---"] * len(header), *rows]
    return "".join(f"| {' | '.join(cell.replace('|', '/') for cell in row)} |\n" for row in cells)
