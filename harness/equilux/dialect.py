"""What a renderer always does otherwise than the model says, as its adapter declares it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from equilux_scenes.causes import CAUSES, is_known

if TYPE_CHECKING:
    from equilux_scenes.case import Case
    from equilux_tracer.causes import Applied

_MODEL = "model."


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
    """The adapter's optional attribute `dialect`, and after it the causes that stand for its lacks (`lack_causes`) as far as the
    dialect does not name them: they are declarations too."""
    dialect = tuple(getattr(adapter, "dialect", ()))
    named = {declared.cause for declared in dialect}
    lacking: dict[str, tuple[str, ...]] = {}
    for feature, cause in getattr(adapter, "lack_causes", {}).items():
        if cause not in named:
            lacking[cause] = (*lacking.get(cause, ()), feature)
    return (*dialect, *(Declared(cause, models=_models_of(features)) for cause, features in lacking.items()))


def _models_of(features: Sequence[str]) -> tuple[str, ...]:
    """The models a cause is limited to, where it stands for the lack of models and of nothing else."""
    if all(feature.startswith(_MODEL) for feature in features):
        return tuple(feature.removeprefix(_MODEL) for feature in features)
    return ()


def complaints_about(dialect: Any) -> list[str]:
    """Everything by which a value is no dialect, in words; empty where it is one. Readings and parameters are not looked at:
    that would need the rules."""
    if isinstance(dialect, str) or not isinstance(dialect, Sequence):
        return [f"dialect is a {type(dialect).__name__}, expected a sequence of equilux.dialect.Declared"]
    wrong = [f"dialect holds a {type(part).__name__}, expected Declared" for part in dialect if not isinstance(part, Declared)]
    unknown = [part.cause for part in dialect if isinstance(part, Declared) and not is_known(part.cause)]
    return [*wrong, *(f"dialect: no cause has the id {cause!r}" for cause in unknown)]


def told(dialect: Sequence[Declared], rules: Mapping[str, Any]) -> list[dict[str, Any]]:
    """A dialect for run.json, with the words and the formula of each rule: whoever reads a results tree has no rules at hand."""
    out = []
    for declared in dialect:
        rule = rules.get(declared.cause)
        formula = None
        if rule is not None:
            formula = [rule.formula[0], rule.readings.get(declared.reading, "") or rule.formula[1]]
        words = rule.summary if rule is not None else CAUSES.get(declared.cause, "")
        out.append({**asdict(declared), "words": words, "formula": formula})
    return out


def dialect_on(case: Case, dialect: Sequence[Declared], rules: Mapping[str, Any]) -> tuple[Applied, ...]:
    """The declared rules that concern this case, ready to be applied: those of its model, whose cause has a rule that may change
    its picture. A parameter that the declaration leaves open stays None: it depends on the scene, and is to be found.

    Raises ValueError for a reading that the cause does not have.
    """
    from equilux_tracer.causes import Applied

    required = set(case.requires)
    out = []
    for declared in dialect:
        rule = rules.get(declared.cause)
        if rule is None or (declared.models and case.scene.model not in declared.models) or required & set(declared.unless):
            continue
        if declared.reading not in rule.readings:
            allowed = ", ".join(repr(reading) for reading in rule.readings)
            raise ValueError(f"dialect: {declared.cause} has no reading {declared.reading!r}, allowed {allowed}")
        if rule.hypotheses(case):
            out.append(Applied(declared.cause, declared.parameter, declared.reading))
    return tuple(out)
