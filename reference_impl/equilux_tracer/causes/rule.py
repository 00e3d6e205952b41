"""What a cause is to the tracer: a named, parameterised change of the model, of the scene, or of the picture."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np
import numpy.typing as npt

from equilux_scenes.case import Case
from equilux_scenes.causes import CAUSES
from equilux_tracer.shading_rules import ShadingRules

Floats = npt.NDArray[np.float64]
Parameter = float | int | str | tuple[float, ...] | tuple[str, ...] | None

Group = Literal["image", "geometry", "highlight", "light", "transport"]


@dataclass(frozen=True)
class Applied:
    """A cause with its parameter fixed: a hypothesis, or, once a render proved it, a finding.

    reading: which of the rule's `readings` is meant; "" is the first.
    """

    cause: str
    parameter: Parameter = None
    reading: str = ""

    def __str__(self) -> str:
        parameter = "" if self.parameter is None else f"[{_shown(self.parameter)}]"
        return self.cause + parameter + (f" ({self.reading})" if self.reading else "")


def _shown(parameter: Parameter) -> str:
    if isinstance(parameter, tuple):
        return ", ".join(_shown(part) for part in parameter)
    return f"{parameter:.6g}" if isinstance(parameter, float) else str(parameter)


@dataclass(frozen=True)
class Continuous:
    """A parameter that is a number: where to look for it.

    low, high: the range searched; scale: "log" needs low > 0. neutral: the value, if any, at which the rule changes nothing.
    """

    name: str
    unit: str
    low: float
    high: float
    scale: Literal["linear", "log"] = "linear"
    neutral: float | None = None


@dataclass(frozen=True)
class Vector:
    """A parameter that is several numbers at once. There is no grid to search: `Rule.estimates` finds them.

    names: of the components. step: from an estimate, how far to look first when refining it. neutral: as in `Continuous`.
    """

    names: tuple[str, ...]
    unit: str
    step: float
    neutral: tuple[float, ...] | None = None


@dataclass(frozen=True)
class Discrete:
    """A parameter with few possible values: `Rule.hypotheses` lists them, or leaves None and `Rule.estimates` picks some."""

    name: str
    unit: str = ""


@dataclass(frozen=True)
class Evidence:
    """The pixels on which hypotheses are tried, and what the renderer and the model show there.

    film_xy: (n, 2) pixel centres. measured, bound: (n, 3), the renderer's radiance and B of the pair there. model: the unchanged
    tracer's channels at film_xy ("radiance", "emission", "ambient", "light_ambient", "diffuse", "specular", "reflected",
    "transmitted", "object_id", "normal", "position"). diverging: (n,) which of the pixels diverge from the model. picture: the
    renderer's whole picture, (h, w, 3). truth: the model's, same shape.
    """

    case: Case
    film_xy: Floats
    measured: Floats
    bound: Floats
    model: Mapping[str, npt.NDArray[Any]]
    diverging: npt.NDArray[np.bool_]
    picture: npt.NDArray[np.floating]
    truth: Floats


class Rule:
    """One cause. A subclass per id: its docstring says what such a renderer does, and it overrides what it changes.

    Subclasses set id, formula (what the model says → what the renderer does instead; Unicode text) and group.
    """

    id: ClassVar[str]
    group: ClassVar[Group]
    formula: ClassVar[tuple[str, str]]
    readings: ClassVar[Mapping[str, str]] = {"": ""}
    """Ways in which renderers are known to carry out this one idea: name → formula or words. The first is named ""."""
    parameter: ClassVar[Continuous | Vector | Discrete | None] = None
    suspects: ClassVar[Literal["renderer", "translation"]] = "renderer"
    """Whose fault it more likely is where nobody declared it: the renderer's own code, or the translation to it (axes, units,
    order of bands, names)."""

    @property
    def summary(self) -> str:
        return CAUSES.get(self.id, "")

    def hypotheses(self, case: Case) -> Sequence[Applied]:
        """Everything worth trying on this case, continuous parameters left None. Empty where the rule cannot change its picture
        (no lights, no meshes, no transparency …): the cheaper that is found out, the better."""
        return [Applied(self.id, None, reading) for reading in self.readings]

    def estimates(self, hypothesis: Applied, evidence: Evidence) -> Sequence[Applied]:
        """Values to start from, best first, for a hypothesis whose parameter was left None; the search refines those that are
        continuous (floats, or tuples of a `Vector`). What comes back may have another reading than `hypothesis`, and there may
        be none: then the evidence speaks against it. Without an override: a coarse grid over a `Continuous` parameter's range."""
        if not isinstance(self.parameter, Continuous):
            return [hypothesis]
        low, high = self.parameter.low, self.parameter.high
        values = np.geomspace(low, high, 17) if self.parameter.scale == "log" else np.linspace(low, high, 17)
        return [Applied(self.id, float(value), hypothesis.reading) for value in values]

    # --- what it changes; each default changes nothing ------------------------------------------------------------------

    def change_case(self, case: Case, applied: Applied) -> Case:
        """The scene that the renderer behaves as if it had been given. Must change neither the film's size nor the
        number and order of objects and lights. The result need not be a valid spec (`model_copy(update=…)` does not validate)."""
        return case

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        """The tracer's rules (`dataclasses.replace`)."""
        return rules

    def change_film(self, film_xy: Floats, case: Case, applied: Applied) -> Floats:
        """Where on the true film the renderer's picture shows what it shows at film_xy, (n, 2) pixels → (n, 2)."""
        return film_xy

    def change_radiance(self, radiance: Floats, film_xy: Floats, case: Case, applied: Applied) -> Floats:
        """The renderer's value where the radiance is `radiance`, (n, 3) → (n, 3), pixel by pixel. film_xy: (n, 2), where in the
        picture that this rule makes."""
        return radiance


def is_neutral(rule: Rule, applied: Applied) -> bool:
    """Whether the parameter is the one at which the rule changes nothing."""
    neutral = rule.parameter.neutral if isinstance(rule.parameter, Continuous | Vector) else None
    if isinstance(neutral, tuple):
        given = applied.parameter if isinstance(applied.parameter, tuple) else ()
        return len(given) == len(neutral) and all(_close(a, b) for a, b in zip(given, neutral, strict=True))
    return neutral is not None and _close(applied.parameter, neutral)


def _close(value: object, neutral: float) -> bool:
    return isinstance(value, float | int) and math.isclose(float(value), neutral, rel_tol=1e-12, abs_tol=1e-12)
