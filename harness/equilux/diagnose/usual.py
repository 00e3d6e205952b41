"""Values that renderers are known to use: tried as they stand, since beside another fault a rule's own estimate may be misled."""

from __future__ import annotations

import math
from collections.abc import Mapping

from equilux.diagnose.trials import Bench
from equilux_tracer.causes import Applied

USUAL: Mapping[str, tuple[Applied, ...]] = {
    "gamma-encoded": tuple(Applied("gamma-encoded", curve) for curve in ("srgb", "2.2")),
    "quantised": (Applied("quantised", 8),),
    "clamped": (Applied("clamped", 1.0),),
    "scaled": tuple(Applied("scaled", k) for k in (math.pi, 1 / math.pi, 2.0, 0.5)),
    "exponent-scaled": tuple(Applied("exponent-scaled", k) for k in (4.0, 0.25, 2.0, 0.5)),
    "exponent-clamped": tuple(Applied("exponent-clamped", most) for most in (128.0, 64.0, 10.0)),
    "spot-exponent-clamped": (Applied("spot-exponent-clamped", 128.0),),
    "weight-cut": tuple(Applied("weight-cut", w) for w in (1 / 255, 0.05, 0.01, 0.1, 0.02, 0.2)),
}
"""The commonest first. 4 and 1/4 turn Phong's exponent into one for Blinn's half vector and back."""


def usual(hypothesis: Applied) -> list[Applied]:
    """The usual values of a cause in this reading."""
    return [applied for applied in USUAL.get(hypothesis.cause, ()) if applied.reading == hypothesis.reading]


def is_usual(applied: Applied) -> bool:
    """Whether the parameter is one of the usual values of its cause, in any reading."""
    return any(known.parameter == applied.parameter for known in USUAL.get(applied.cause, ()))


def all_usual(bench: Bench) -> list[Applied]:
    """Those of every cause that can change this case's picture."""
    found: list[Applied] = []
    for id_, values in USUAL.items():
        rule = bench.rules.get(id_)
        if rule is None:
            continue
        try:
            readings = {hypothesis.reading for hypothesis in rule.hypotheses(bench.case)}
        except Exception as problem:
            bench.refused[(Applied(id_),)] = f"hypotheses: {type(problem).__name__}: {problem}"
            continue
        found += [applied for applied in values if applied.reading in readings]
    return found
