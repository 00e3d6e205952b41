"""Causes in sentences."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

from equilux.diagnose.scales import recognised as name_of
from equilux.diagnose.trials import Causes
from equilux_scenes.causes import CAUSES
from equilux_tracer.causes import Applied, Rule, Vector

TOLD = 0.5
"""A correlation below says nothing worth a word."""
FEW_DIGITS = 6
"""A number no longer than this (0.5, 0.0625) needs no name (1/2, 1/16)."""
MOST_REFUSALS = 3


SAID: Mapping[str, str] = {
    "shifted": "the picture is displaced by {} to the right and down",
    "gamma-encoded": "pixels are encoded by the curve {} instead of linear",
    "clamped": "radiance is cut off at {}",
    "quantised": "radiance is rounded to {}",
    "bands-swapped": "the three bands are in the order {}",
    "scaled": "radiance is multiplied by {}",
    "faceted-normals": "a curved shape shows facets with face normals, {} segments around it",
    "vertex-lighting": "lighting is evaluated at vertices, {} segments around a curved shape, and interpolated",
    "tessellated": "a curved shape is replaced by triangles, {} segments around it",
    "exponent-clamped": "the highlight's exponent is cut off at {}",
    "exponent-scaled": "the highlight's exponent is multiplied by {}",
    "specular-floored": "R·V is raised to {} before the power",
    "light-missing": "the light {} is left out",
    "attenuation-term-missing": "the {} term of the attenuation is left out",
    "spot-exponent-clamped": "the spot's exponent is cut off at {}",
    "spot-cone-ignored": "the spot's cone has no effect from {} on",
    "recursion-cut": "reflections end after {} of them",
    "weight-cut": "rays below a weight of {} are not followed",
    "shadow-bias": "blockers nearer than {} are missed",
    "background-missing": "rays that miss show {} instead of the background",
}
"""Sentences of the causes that have a parameter, which stands in the place of {}."""


def sentence(rule: Rule, applied: Applied) -> str:
    """What the renderer does, with the parameter: 'radiance is multiplied by 3.141593 (π)'. A third party's rule says its
    summary, then the parameter by name."""
    template = SAID.get(applied.cause)
    text = rule.summary or CAUSES.get(applied.cause, applied.cause)
    if applied.parameter is not None and template is not None:
        text = template.format(_value(rule, applied))
    elif applied.parameter is not None:
        text += f": {_name(rule)} = {_value(rule, applied)}"
    reading = rule.readings.get(applied.reading, applied.reading) if applied.reading else ""
    return text + (f" ({reading})" if reading else "")


def _name(rule: Rule) -> str:
    kind = rule.parameter
    return ", ".join(kind.names) if isinstance(kind, Vector) else kind.name if kind is not None else "parameter"


def _value(rule: Rule, applied: Applied) -> str:
    """With its unit, and its name where it has one: '0.5 W/(m²·sr)', '(1, 0) px', '3.141593 (π)'."""
    values = applied.parameter if isinstance(applied.parameter, tuple) else (applied.parameter,)
    shown = ", ".join(_shown(value, rule) for value in values)
    if len(values) > 1:
        shown = f"({shown})"
    unit = rule.parameter.unit if rule.parameter is not None else ""
    known = recognised(applied)
    if unit and applied.cause == "quantised" and applied.parameter != 1:
        unit += "s"
    return shown + (unit if unit == "°" else f" {unit}" if unit else "") + (f" ({known})" if known is not None else "")


def _shown(value: object, rule: Rule) -> str:
    """Seven digits; of a vector no more than a millionth of its step, below which is only what a fit leaves."""
    if not isinstance(value, float):
        return str(value)
    if isinstance(rule.parameter, Vector):
        least = 1e-6 * rule.parameter.step
        value = round(value / least) * least + 0.0
    return f"{value:.7g}"


def recognised(applied: Applied) -> str | None:
    """The name of the parameter's value, where it has one that says more than its digits do: "π", "255/256"."""
    if not isinstance(applied.parameter, float) or len(f"{applied.parameter:.7g}") <= FEW_DIGITS:
        return None
    return name_of(applied.parameter)


def formula(rule: Rule, applied: Applied) -> tuple[str, str]:
    """What the model says, what the renderer does instead (of a reading: its own words)."""
    before, after = rule.formula
    reading = rule.readings.get(applied.reading, "") if applied.reading else ""
    return (before, reading or after)


def of_unexplained(left: int, diverging: int, terms: Mapping[str, float], untried: Sequence[str] = ()) -> str:
    """What is left, what it goes with, and what could not be tried."""
    text = f"{left} of {diverging} diverging pixels are not accounted for"
    strongest = next(iter(terms.items()), None)
    if strongest is not None and abs(strongest[1]) >= TOLD:
        text += f"; the remaining difference follows the term {strongest[0]} (correlation {strongest[1]:+.2f})"
    return "; ".join([text, *untried])


def of_refusals(refused: Mapping[Causes, str]) -> list[str]:
    """One line for each way in which hypotheses could not be tried: "acme:gloss could not be tried 12 times (ValueError: …)"."""
    counts = Counter((" + ".join(applied.cause for applied in causes), why) for causes, why in refused.items())
    shown = [
        f"{ids} could not be tried{f' {times} times' if times > 1 else ''} ({why})"
        for (ids, why), times in counts.most_common(MOST_REFUSALS)
    ]
    rest = len(counts) - len(shown)
    return [*shown, f"{rest} more could not be tried"] if rest else shown
