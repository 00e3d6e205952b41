"""What to try on a case, and which of two causes that do the same is named first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import numpy.typing as npt

from equilux.diagnose.fit import fitted
from equilux.diagnose.trials import Bench, Causes, Trial, changes_film, changes_values, ordered
from equilux.diagnose.usual import is_usual
from equilux_tracer.causes import Applied, Discrete, Rule, is_neutral

Mask = npt.NDArray[np.bool_]
Rank = tuple[bool, bool, int, bool, int, int, int]
GROUPS = ("image", "highlight", "light", "transport", "geometry")
"""Of a black picture a missing term is the plainest account; another geometry, the least plain."""
CURVE_DIGITS = 4
"""Characters of an exponent that somebody chose: 2.2, 1.75."""


def _is_fitted(applied: Applied) -> bool:
    """A number, or a curve's exponent of more digits than anybody chooses."""
    value = applied.parameter
    return not isinstance(value, str) or (len(value) > CURVE_DIGITS and value.replace(".", "").isdigit())


@dataclass(frozen=True)
class Preference:
    """The order of names among causes that explain alike: what the adapter declares, what the scene expects, what has no
    parameter, plain readings, terms before geometry, the order of the catalogue.
    """

    rules: Mapping[str, Rule]
    dialect: tuple[Applied, ...] = ()
    expected: tuple[str, ...] = ()

    def declares(self, applied: Applied) -> bool:
        return any(
            declared.cause == applied.cause and declared.parameter in (None, applied.parameter) for declared in self.dialect
        )

    def is_unheard_of(self, applied: Applied) -> bool:
        """Neither declared nor expected."""
        return applied.cause not in self.expected and all(declared.cause != applied.cause for declared in self.dialect)

    def of(self, applied: Applied) -> Rank:
        """Sorts the preferred one first. A parameter that names a light or an order is worth less than none, and more than a
        number, which can be fitted; a usual number is believed more readily than another one."""
        rule = self.rules[applied.cause]
        readings = list(rule.readings)
        return (
            not self.declares(applied),
            applied.cause not in self.expected,
            0 if applied.parameter is None else 1 if not _is_fitted(applied) else 2 if is_usual(applied) else 3,
            bool(applied.reading),
            GROUPS.index(rule.group) if rule.group in GROUPS else len(GROUPS),
            list(self.rules).index(applied.cause),
            readings.index(applied.reading) if applied.reading in readings else len(readings),
        )

    def of_all(self, causes: Causes) -> tuple[int, int, int, list[Rank]]:
        each = sorted(self.of(applied) for applied in causes)
        return (*(sum(one[index] for one in each) for index in range(3)), each)  # type: ignore[return-value]


@dataclass(frozen=True, eq=False)
class Single:
    """One cause by itself on the sample. touches: (n,) the pixels that it changes beyond B."""

    applied: Applied
    trial: Trial
    touches: Mask


def every_hypothesis(bench: Bench, preference: Preference) -> list[Applied]:
    """All that the rules propose for the case, the preferred first; numbers to be fitted are still None."""
    found = []
    for rule in bench.rules.values():
        try:
            found += list(rule.hypotheses(bench.case))
        except Exception as problem:
            bench.refused[(Applied(rule.id),)] = f"hypotheses: {type(problem).__name__}: {problem}"
    return sorted(dict.fromkeys(found), key=preference.of)


def is_costly(bench: Bench, applied: Applied) -> bool:
    """Whether its parameter is found only by making many meshes: tried once the cheap causes have failed."""
    kind = bench.rules[applied.cause].parameter
    return applied.parameter is None and isinstance(kind, Discrete) and kind.name == "segments"


def single(bench: Bench, hypothesis: Applied, model: Trial) -> Single | None:
    """The hypothesis tried, its numbers fitted; None where it cannot be rendered or does nothing."""
    rule = bench.rules[hypothesis.cause]
    if hypothesis.parameter is None and rule.parameter is not None:
        trial = fitted(bench, (hypothesis,), 0)
    else:
        trial = bench.trial((hypothesis,))
    if trial is None or is_neutral(rule, trial.causes[0]):
        return None
    touches = np.asarray((np.abs(trial.radiance - model.radiance) > trial.bound).any(axis=1))
    return Single(trial.causes[0], trial, touches) if touches.any() else None


def ranked_pairs(bench: Bench, singles: Sequence[Single], model: Trial) -> list[Causes]:
    """Pairs of different causes, those first that can be expected to explain most.

    A diverging pixel can be expected to be explained where one of the two explains it alone, where the sum of both effects
    does, or, at half the weight, where both change it or one changes where it looks: then anything may come out.
    """
    evidence = bench.sample.evidence
    wrong = evidence.diverging
    if len(singles) < 2:
        return []
    effect = np.stack([one.trial.radiance - model.radiance for one in singles])[:, wrong]
    right = np.stack([one.trial.explains for one in singles])[:, wrong]
    touches = np.stack([one.touches for one in singles])[:, wrong]
    moves = np.array([changes_film(bench.rules[one.applied.cause]) for one in singles])
    rest, bound = (evidence.measured - model.radiance)[wrong], model.bound[wrong]
    scored = []
    for first, second in combinations(range(len(singles)), 2):
        if singles[first].applied.cause == singles[second].applied.cause and not _may_repeat(singles[first].applied):
            continue
        with np.errstate(all="ignore"):
            summed = (np.abs(rest - effect[first] - effect[second]) <= bound).all(axis=1)
        surely = right[first] | right[second] | summed
        both, either = touches[first] & touches[second], touches[first] | touches[second]
        perhaps = either if moves[first] or moves[second] else both
        score = surely.sum() + 0.5 * (perhaps & ~surely).sum()
        scored.append((-float(score), first, second))
    out: list[Causes] = []
    for _, first, second in sorted(scored):
        out += both_orders(bench, singles[first].applied, singles[second].applied)
    return out


def _may_repeat(applied: Applied) -> bool:
    """Two lights may be missing; two factors are one."""
    return isinstance(applied.parameter, str)


def both_orders(bench: Bench, first: Applied, second: Applied) -> list[Causes]:
    """The pair as it is made, and the other way round where that is another picture."""
    pair = ordered((first, second), bench.rules)
    one, other = (bench.rules[applied.cause] for applied in pair)
    matters = (changes_film(one) and changes_film(other)) or (changes_values(one) and changes_values(other))
    return [pair, pair[::-1]] if matters else [pair]
