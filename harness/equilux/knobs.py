"""`--set [ADAPTER.]KNOB=VALUE`: knobs given as text, checked against each adapter's typed model."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from equilux.adapter import Knobs
from equilux.complaint import BadUsage, nearest
from equilux.registry import Entry


def resolve(settings: Sequence[str], entries: Sequence[Entry]) -> dict[str, Knobs]:
    """The knobs of every usable adapter, defaults filled in.

    A knob without an adapter's name is set for every selected adapter that has it. Raises BadUsage, all complaints at once.
    """
    models = {entry.name: entry.adapter.Knobs for entry in entries if entry.adapter is not None}
    wanted: dict[str, dict[str, Any]] = {name: {} for name in models}
    wrong: list[str] = []
    for setting in settings:
        _place(setting, models, wanted, wrong)
    resolved: dict[str, Knobs] = {}
    for name, model in models.items():
        try:
            resolved[name] = model.model_validate(wanted[name])
        except ValidationError as problem:
            wrong += [_explained(name, error) for error in problem.errors()]
    if wrong:
        raise BadUsage(*wrong)
    return resolved


def _place(setting: str, models: Mapping[str, type[Knobs]], wanted: dict[str, dict[str, Any]], wrong: list[str]) -> None:
    """Put one setting where it belongs, or say what is wrong with it."""
    path, equals, text = setting.partition("=")
    if not equals or not path:
        wrong.append(f"--set: got '{setting}', expected [ADAPTER.]KNOB=VALUE, for example --set vtk.samples=4")
        return
    adapter, dot, knob = path.rpartition(".")
    if dot and adapter not in models:
        wrong.append(
            f"--set: '{adapter}' of '{setting}' is not among the adapters of this run ({', '.join(models)})"
            f"{nearest(adapter, models)}"
        )
        return
    havers = [name for name in ([adapter] if dot else models) if knob in models[name].model_fields]
    if not havers:
        known = sorted({f"{name}.{field}" for name in ([adapter] if dot else models) for field in models[name].model_fields})
        plain = {full.partition(".")[2]: full for full in known}
        hint = nearest(knob, plain)
        wrong.append(f"--set: unknown knob '{path}'; known are {', '.join(known) or 'none: these adapters have no knobs'}{hint}")
    for name in havers:
        wanted[name][knob] = _value(text)


def _value(text: str) -> Any:
    """Lists and objects as JSON; everything else stays text, which the model turns into the type of the knob."""
    if text[:1] in "[{" and text:
        try:
            return json.loads(text)
        except json.JSONDecodeError:
            return text
    return text


def _explained(adapter: str, error: Any) -> str:
    """One pydantic complaint as `what, got, allowed`."""
    where = ".".join(str(part) for part in (adapter, *error["loc"]))
    got = json.dumps(error["input"], default=str)
    return f"--set: {where}: got {got}; {error['msg'][:1].lower()}{error['msg'][1:]}"


def steps_of(model: type[Knobs]) -> dict[str, list[Any]]:
    """The values of each knob that a measurement of the trade tries, fastest first: `steps` in the field's `json_schema_extra`.
    Knobs that declare none (threads) do not trade accuracy, and are left out."""
    found = {}
    for name, field in model.model_fields.items():
        extra = field.json_schema_extra
        if isinstance(extra, dict) and isinstance(steps := extra.get("steps"), list) and steps:
            found[name] = list(steps)
    return found
