"""What a renderer always does otherwise than the model says, as its adapter declares it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from equilux_scenes.case import Case
    from equilux_tracer.causes import Applied


@dataclass(frozen=True)
class Declared:
    """One rule of a dialect: a cause (contracts §5, or a third party's `name:cause`) with its parameter.

    parameter: None where the cause has none, or where it depends on the scene (`light-missing`). reading: which of the cause's
    readings (docs/causes.md); "" the first. quirk: where the adapter says more about it, such as "Q5". models: the models in
    which the renderer does so; empty: in all. unless: features; a scene that requires one of them is not concerned.
    """

    cause: str
    parameter: Any = None
    reading: str = ""
    quirk: str = ""
    models: tuple[str, ...] = ()
    unless: tuple[str, ...] = ()


def declared_dialect(adapter: Any) -> tuple[Declared, ...]:
    """The adapter's optional attribute `dialect`: a sequence of Declared."""
    return tuple(getattr(adapter, "dialect", ()))


def dialect_on(case: Case, dialect: Sequence[Declared], rules: Mapping[str, Any]) -> tuple[Applied, ...]:
    """The declared rules that concern this case, ready to be applied: those of its model, whose cause has a rule that may change
    its picture."""
    from equilux_tracer.causes import Applied

    required = set(case.requires)
    out = []
    for declared in dialect:
        rule = rules.get(declared.cause)
        if rule is None or (declared.models and case.scene.model not in declared.models) or required & set(declared.unless):
            continue
        if rule.hypotheses(case):
            out.append(Applied(declared.cause, declared.parameter, declared.reading))
    return tuple(out)
