"""A picture against the reference within its own stated budget: what every step of every knob is held to."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np

from equilux.adapter import Bound, Budget
from equilux.compare import PairResult, RenderedImage, compare_pair
from equilux.uncertainty import stated
from equilux_scenes.case import Case
from equilux_tracer import Tracer

EXACT = Budget((Bound("rounding", "the reference's own, in double", abs=1e-12, rel=1e-12),))
APPROACHED = 0.1
"""A budget a factor of ten above anything it bounds would prove nothing."""


class Rendered(Protocol):
    """What `run` of a renderer's support module gives."""

    @property
    def case(self) -> Case: ...
    @property
    def image(self) -> np.ndarray: ...
    @property
    def budget(self) -> Budget: ...


def held_against_reference(result: Rendered) -> PairResult:
    """The picture against the reference, as `equilux run` judges it."""
    tracer = Tracer(result.case)
    truth = tracer.render()["radiance"]
    image = np.asarray(result.image)
    mine = RenderedImage("picture", image, stated(result.budget, image, tracer))
    return compare_pair(mine, RenderedImage("reference", truth, stated(EXACT, truth, tracer)), tracer)


def complaint(result: Rendered, setting: Any) -> str | None:
    """None where every pixel off edges is within the budget and some come near it, to a tenth; else both numbers."""
    found = held_against_reference(result).json
    where = f"{result.case.name}, {setting}"
    if found["diverge"] or found["invalid"]:
        return f"{where}: {found['diverge']} diverge, {found['invalid']} invalid; worst {found['worst']}, E_n {found['en_max']}"
    if found["en_max"] < APPROACHED:
        return f"{where}: the largest error is {found['en_max']:.3g} of what the budget states: nothing could trip it"
    return None
