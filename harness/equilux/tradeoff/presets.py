"""Presets and ladders, derived from a measurement; and those that are shipped, from one that docs/tradeoff.md tells of."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from functools import cache
from importlib.resources import files
from typing import Any

from pydantic import ValidationError

from equilux.complaint import BadUsage
from equilux.registry import Entry
from equilux.tradeoff.front import seconds_of
from equilux.tradeoff.record import AdapterPresets, Clock, Measured, Preset, Presets, Rung, Tradeoff

NAMES = ("fast", "balanced", "exact")
FAST_ERROR, BALANCED_ERROR = 1e-2, 1e-4
"""What `fast` and `balanced` are: the cheapest settings as accurate as this on every measured case."""
AS_GOOD = 1.1
"""Settings within this factor of the best accuracy are as accurate: the cheapest of them is `exact`."""
WORTH_A_RUNG = 0.7
"""A setting is a rung of the ladder if on some case its claim is at most this share of all cheaper rungs' claims."""
SHIPPED = "presets.json"

BySetting = dict[str, dict[str, Measured]]
"""Settings that were measured on every case that the renderer can do, by their knobs; each by case."""


def derive(measured: Tradeoff) -> Presets:
    """The presets and the ladder of every renderer that has knobs to set."""
    made = measured.made
    names = sorted({name for case in measured.cases for name in case.renderers})
    adapters = {}
    for name in names:
        settings = _settings(measured, name)
        if len(settings) > 1:
            adapters[name] = AdapterPresets(
                version=made.versions.get(name, ""), presets=_presets(settings, made.clock), ladder=_ladder(settings, made.clock)
            )
    processor, cores = str(made.machine.get("processor", "")), int(made.machine.get("cores", 0))
    return Presets(equilux=made.equilux, measured=made.started, processor=processor, cores=cores, adapters=adapters)


def _settings(measured: Tradeoff, name: str) -> BySetting:
    """Those that were measured on every case that the renderer can do, and did something there."""
    cases = [case for case in measured.cases if name in case.renderers and case.renderers[name].status == "measured"]
    found: BySetting = {}
    for case in cases:
        for setting in case.renderers[name].settings:
            if setting.times is not None:
                found.setdefault(json.dumps(setting.knobs, sort_keys=True), {})[case.case] = setting
    everywhere = {key: by_case for key, by_case in found.items() if len(by_case) == len(cases)}
    default = next((by_case for by_case in everywhere.values() if _is_default(by_case)), None)
    return {key: by_case for key, by_case in everywhere.items() if by_case is default or _says_something(by_case, default)}


def _says_something(by_case: Mapping[str, Measured], default: Mapping[str, Measured] | None) -> bool:
    """Whether a setting may be chosen: one that did nothing to any measured picture may spoil others, as a recursion depth of 0
    does where no mirror was measured. The most accurate knobs spoil none."""
    if default is None or next(iter(by_case.values())).most_accurate_knobs:
        return True
    return any((own.accuracy, own.claimed) != (default[case].accuracy, default[case].claimed) for case, own in by_case.items())


def _presets(settings: BySetting, clock: Clock) -> dict[str, Preset]:
    """By name. Where none is as accurate as asked, the most accurate one stands for it, and the rule says so."""
    worst = {key: accuracy for key, by_case in settings.items() if (accuracy := _worst_accuracy(by_case)) is not None}
    if not worst:
        return {}

    def cheapest(bound: float) -> str | None:
        return _cheapest({key: settings[key] for key, accuracy in worst.items() if accuracy <= bound}, worst, clock)

    best = min(worst.values())
    exact = cheapest(best * AS_GOOD)
    rules = {
        "fast": (FAST_ERROR, f"cheapest with error ≤ {FAST_ERROR:g} on every measured case"),
        "balanced": (BALANCED_ERROR, f"cheapest with error ≤ {BALANCED_ERROR:g} on every measured case"),
        "exact": (best * AS_GOOD, "most accurate; the cheapest of those within a tenth of it"),
    }
    found = {}
    for name, (bound, rule) in rules.items():
        key = cheapest(bound)
        if key is None:
            key, rule = exact, f"none reaches {bound:g}: the most accurate"
        if key is not None:
            found[name] = _preset(settings[key], rule, clock)
    return found


def _cheapest(settings: BySetting, worst: Mapping[str, float], clock: Clock) -> str | None:
    """The cheapest setting; of all that take as long as it, as far as could be measured, the default one, else the most accurate:
    a knob that gains nothing on the measured cases is not turned, for on others it may lose something."""
    if not settings:
        return None
    first = min(settings, key=lambda key: _cost(settings[key], clock))
    as_fast = [key for key in settings if _as_fast(settings[key], settings[first], clock)]
    return min(as_fast, key=lambda key: (not _is_default(settings[key]), worst[key]))


def _as_fast(by_case: Mapping[str, Measured], other: Mapping[str, Measured], clock: Clock) -> bool:
    """Whether the intervals of the two times overlap on every case."""
    return all(
        _interval(by_case[case], clock)[0] <= _interval(other[case], clock)[1]
        and _interval(other[case], clock)[0] <= _interval(by_case[case], clock)[1]
        for case in by_case
    )


def _interval(setting: Measured, clock: Clock) -> tuple[float, float]:
    assert setting.times is not None  # _settings
    total = getattr(setting.times, clock)["total"]
    return total.low, total.high


def _is_default(by_case: Mapping[str, Measured]) -> bool:
    return next(iter(by_case.values())).default


def _preset(by_case: Mapping[str, Measured], rule: str, clock: Clock) -> Preset:
    one = next(iter(by_case.values()))
    cases = {case: (setting.accuracy, seconds_of(setting, clock)) for case, setting in by_case.items()}
    seconds = [taken for _, taken in cases.values() if taken is not None]
    return Preset(
        knobs=one.knobs, label=one.label, rule=rule, accuracy=_worst_accuracy(by_case), seconds=max(seconds), cases=cases
    )  # fmt: skip


def _worst_accuracy(by_case: Mapping[str, Measured]) -> float | None:
    """Over the cases; None where it is not known on one of them."""
    found = [setting.accuracy for setting in by_case.values()]
    known = [accuracy for accuracy in found if accuracy is not None]
    return max(known) if len(known) == len(found) else None


def _cost(by_case: Mapping[str, Measured], clock: Clock) -> float:
    """Geometric mean of the seconds over the cases: no slow case outweighs the others."""
    taken = [seconds_of(setting, clock) or math.inf for setting in by_case.values()]
    return math.exp(sum(math.log(max(each, 1e-9)) for each in taken) / len(taken))


def _ladder(settings: BySetting, clock: Clock) -> list[Rung]:
    """The settings that claim something better than all cheaper ones on some case, cheapest first. The cases of a corpus ask for
    more than the measured ones do, so the last is the setting whose knobs are all at their most accurate."""
    ordered = sorted(settings.values(), key=lambda by_case: _cost(by_case, clock))
    last = [by_case for by_case in ordered if next(iter(by_case.values())).most_accurate_knobs]
    kept: list[dict[str, Measured]] = []
    for by_case in ordered:
        if by_case not in last and any(
            setting.claimed is not None and setting.claimed <= WORTH_A_RUNG * _best(kept, case)
            for case, setting in by_case.items()
        ):  # fmt: skip
            kept.append(by_case)
    return [_rung(by_case, clock) for by_case in [*kept, *last]]


def _best(kept: Iterable[Mapping[str, Measured]], case: str) -> float:
    claims = [by_case[case].claimed for by_case in kept]
    return min((claim for claim in claims if claim is not None), default=math.inf)


def _rung(by_case: Mapping[str, Measured], clock: Clock) -> Rung:
    one = next(iter(by_case.values()))
    claims = {case: setting.claimed for case, setting in by_case.items()}
    return Rung(knobs=one.knobs, label=one.label, seconds=_cost(by_case, clock), claimed=claims)


# --- those that are shipped -------------------------------------------------------------------------------------------


@cache
def shipped() -> Presets:
    """The presets that came with this version of equilux."""
    return Presets.model_validate_json(files("equilux.tradeoff").joinpath(SHIPPED).read_bytes())


def preset_settings(name: str, entries: Iterable[Entry]) -> list[str]:
    """A preset as `--set` settings, of every adapter that has one. Raises BadUsage for a name that is none, and for one that
    does not fit the knobs of an adapter that is installed."""
    if name not in NAMES:
        raise BadUsage(f"--preset: got '{name}', allowed {', '.join(NAMES)}")
    found = []
    for entry in entries:
        known = shipped().adapters.get(entry.name)
        if entry.adapter is not None and known is not None and name in known.presets:
            _check(entry, known.presets[name].knobs, f"--preset {name}")
            found += [f"{entry.name}.{knob}={_typed(value)}" for knob, value in known.presets[name].knobs.items()]
    return found


def ladder_of(entry: Entry, fixed: Mapping[str, Any], base: Mapping[str, Any]) -> list[dict[str, Any]]:
    """All knobs of an adapter for each rung of its ladder, cheapest first. base: its knobs as they are else. fixed: what the user
    has set, which no rung changes; rungs that differ in nothing else fall together. One rung where no ladder is known."""
    known = shipped().adapters.get(entry.name)
    if entry.adapter is None or known is None or not known.ladder:
        return [dict(base)]
    found: list[dict[str, Any]] = []
    for rung in known.ladder:
        _check(entry, rung.knobs, "--accuracy")
        knobs = {**base, **rung.knobs, **fixed}
        if knobs not in found:
            found.append(knobs)
    return found


def _check(entry: Entry, knobs: Mapping[str, Any], option: str) -> None:
    try:
        entry.adapter.Knobs.model_validate(knobs)  # type: ignore[union-attr]
    except ValidationError as problem:
        where = "; ".join(f"{'.'.join(map(str, error['loc']))}: {error['msg']}" for error in problem.errors())
        raise BadUsage(
            f"{option}: the shipped measurement does not fit the knobs of {entry.name} ({where}); measure anew: "
            "equilux tradeoff --presets FILE"
        ) from None


def _typed(value: Any) -> str:
    return json.dumps(value) if isinstance(value, list | dict | bool) or value is None else str(value)
