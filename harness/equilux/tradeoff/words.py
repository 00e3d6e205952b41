"""A measurement as the command prints it."""

from __future__ import annotations

from collections.abc import Iterable

from equilux.cli.inputs import table
from equilux.judge import FAILED
from equilux.tradeoff.answers import ANY
from equilux.tradeoff.record import Answer, CaseTrade, FeatureCost, Measured, Spread, StartUp, Tradeoff

NONE = "–"


def exit_code(found: Tradeoff, *, asked: bool) -> int:
    """See `equilux tradeoff --help`. asked: somebody asked for a bound, so that not to meet it is an answer too."""
    settings = [(trade, setting) for case in found.cases for trade in case.renderers.values() for setting in trade.settings]
    if any(setting.status in FAILED for _, setting in settings) or any(
        trade.status == "failed" for case in found.cases for trade in case.renderers.values()
    ):
        return 3
    if not any(setting.times is not None for _, setting in settings):
        return 4
    return 1 if asked and _unmet(found) else 0


def _unmet(found: Tradeoff) -> bool:
    """Whether some case has a bound that no renderer meets."""
    met: dict[tuple[str, str, float], bool] = {}
    for answer in found.answers:
        key = (answer.case, answer.question, answer.bound)
        met[key] = met.get(key, False) or answer.found is not None
    return not all(met.values())


def told(found: Tradeoff, *, asked: bool) -> str:
    """Plain text: what every front holds, the answers, what features cost. asked: somebody asked for a bound, so that every
    renderer's answer is shown; else those of all together alone."""
    shown = [answer for answer in found.answers if asked or answer.renderer == ANY]
    parts = [_case(case, [answer for answer in shown if answer.case == case.case]) for case in found.cases]
    parts += [_start_up(found.start_up), _features(found.features)]
    return "\n".join(part for part in parts if part)


def _case(case: CaseTrade, answers: Iterable[Answer]) -> str:
    rows: list[tuple[str, ...]] = [("", "renderer", "setting", "error", "claimed", "wall s", "interval", "cpu s", "")]
    for name, trade in case.renderers.items():
        shown = [setting for setting in trade.settings if setting.front or setting.default or setting.status in FAILED]
        rows += [_row(name, setting) for setting in shown]
        if not trade.settings:
            rows.append(("", name, trade.status, "", "", "", "", "", trade.reason or ""))
    head = f"{case.case}: error against the {case.truth}, as a share of the largest radiance; * front of all, + of its renderer\n"
    return head + table(rows, right=frozenset({3, 4, 5, 7})) + _answers(answers)


def _row(name: str, setting: Measured) -> tuple[str, ...]:
    mark = "*" if setting.front_of_all else "+" if setting.front else ""
    if setting.times is None:
        return (mark, name, setting.label, setting.status, "", "", "", "", setting.reason or "")
    wall, cpu = setting.times.wall["total"], setting.times.cpu["total"]
    note = f"to its dialect; {short(setting.error.max_rel)} to the model" if setting.error_to_dialect and setting.error else ""
    return (
        mark, name, setting.label, short(setting.accuracy), short(setting.claimed), f"{wall.median:.3g}", interval(wall),
        f"{cpu.median:.3g}", note,
    )  # fmt: skip


def _answers(answers: Iterable[Answer]) -> str:
    lines = []
    for answer in answers:
        who = f"{answer.renderer}: " if answer.renderer != ANY else ""
        question = f"error ≤ {answer.bound:g}" if answer.question == "error" else f"within {answer.bound:g} s"
        if answer.found is None:
            lines.append(f"{who}{question}: no setting")
        else:
            lines.append(f"{who}{question}: {answer.found}, {answer.label} ({short(answer.accuracy)} in {answer.seconds:.3g} s)")
    return "".join(f"  {line}\n" for line in lines)


def _start_up(start_up: dict[str, StartUp]) -> str:
    if not start_up:
        return ""
    rows: list[tuple[str, ...]] = [("renderer", "start-up wall s", "cpu s", "smallest picture wall s", "cpu s")]
    for name, seen in start_up.items():
        spreads = (seen.wall, seen.cpu, seen.small_picture_wall, seen.small_picture_cpu)
        rows.append((name, *(f"{each.median:.3g}" for each in spreads)))
    return table(rows, right=frozenset({1, 2, 3, 4}))


def _features(features: list[FeatureCost]) -> str:
    rows = [("feature", "renderer", "without, cpu s", "extra cpu s", "interval", "extra wall s", "interval")]
    for feature in features:
        for name, cost in feature.renderers.items():
            if cost.without_cpu is None or cost.extra_cpu is None or cost.extra_wall is None:
                continue
            rows.append(
                (feature.feature, name, f"{cost.without_cpu.median:.3g}", f"{cost.extra_cpu.median:+.3g}",
                 interval(cost.extra_cpu), f"{cost.extra_wall.median:+.3g}", interval(cost.extra_wall))
            )  # fmt: skip
    return table(rows, right=frozenset({2, 3, 5})) if len(rows) > 1 else ""


def short(value: float | None) -> str:
    return NONE if value is None else f"{value:.2g}"


def interval(spread: Spread) -> str:
    return f"{spread.low:.3g} to {spread.high:.3g}"
