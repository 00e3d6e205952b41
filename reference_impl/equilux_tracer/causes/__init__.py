"""The causes of contracts §5 as rules that the tracer can apply: one class per id, by group in one file each."""

from __future__ import annotations

from collections.abc import Mapping

from equilux_tracer.causes import geometry, highlight, image, light, transport
from equilux_tracer.causes.changed import ChangedTracer
from equilux_tracer.causes.rule import Applied, Continuous, Discrete, Evidence, Floats, Parameter, Rule, Vector, is_neutral

RULES: Mapping[str, Rule] = {rule.id: rule for group in (image, geometry, highlight, light, transport) for rule in group.RULES}
"""Every cause of contracts §5 but `unexplained`, in the order of `equilux_scenes.causes.CAUSES`."""

__all__ = [
    "RULES",
    "Applied",
    "ChangedTracer",
    "Continuous",
    "Discrete",
    "Evidence",
    "Floats",
    "Parameter",
    "Rule",
    "Vector",
    "is_neutral",
]
