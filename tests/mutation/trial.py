"""One mutant on one scene: is the fault visible, is it detected, is it named?"""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from equilux.budget import Bound, Budget
from equilux.compare import PairResult, RenderedImage, compare_pair, pair_bound
from equilux.diagnosing import TIME_LIMIT_S
from equilux.score import truth_of
from equilux.uncertainty import stated
from equilux_scenes.case import Case
from equilux_tracer import Tracer
from mutation.faults import NONE, together
from mutation.mutant import Mutant
from mutation.renderer import picture
from support.edges import on_edge

Array = npt.NDArray[np.float64]

ADAPTER = "mutant"
BUDGET = Budget(
    (
        Bound(
            "arithmetic",
            "double precision: hit points to 2^-53 of coordinates below 10, which a few bounces off things of 0.2 m amplify by "
            "20 each, and highlights by their exponent: a single-precision unit or two is far above that and hides nothing",
            abs=1e-8,
            rel=1e-7,
        ),
    )
)
"""What the renderer states: `unmutated` cases prove that it holds."""
SCENES_PER_MUTANT = 6
ALMOST_ALL = 0.98
"""Share of the diverging pixels that the causes found must account for; what is left is then said to be unexplained, and is no
other cause."""


@dataclass
class Trial:
    """visible: pixels, not edges, that the fault moves by more than B (of a pair of faults: that the less visible of them does).
    found: ids of the causes named, with parameter and reading, each with the ids that it cannot be told from. named: whether
    they are the injected ones.
    """

    mutant: str
    causes: tuple[str, ...]
    case: str
    visible: int
    detected: bool = False
    found: list[dict[str, Any]] = field(default_factory=list)
    named: bool = False
    explained: float = 0.0
    seconds: float = 0.0
    rivals: dict[str, bool] = field(default_factory=dict)
    """Comparing tool → whether it lets the mutant through."""

    def to_json(self) -> dict[str, Any]:
        return asdict(self)


@dataclass(frozen=True)
class Staged:
    """A case with what is known of it before any mutant is shown: truth, unmutated picture."""

    case: Case
    tracer: Tracer
    truth: RenderedImage
    right: Array

    def side(self, image: Array) -> RenderedImage:
        """A picture as the renderer would deliver it: float32, with its budget."""
        single = image.astype(np.float32)
        return RenderedImage(ADAPTER, single, stated(BUDGET, single))

    def moved(self, image: Array, other: Array) -> int:
        """Pixels off edges where two pictures of this renderer differ by more than B."""
        if image.shape != other.shape:
            return other.shape[0] * other.shape[1]
        side, right = self.side(image), self.side(other)
        bound = pair_bound(side.image.astype(np.float64), self.truth.image.astype(np.float64), side.uncertainty,
                           self.truth.uncertainty, 0.0)  # fmt: skip
        apart = np.abs(side.image.astype(np.float64) - right.image.astype(np.float64))
        rows, columns = np.nonzero((apart > bound).any(axis=2))
        if not len(rows):
            return 0
        return int((~on_edge(self.tracer, np.stack([columns, rows], axis=1) + 0.5)).sum())


@lru_cache(maxsize=64)
def staged(case: Case) -> Staged:
    tracer = Tracer(case)
    return Staged(case, tracer, truth_of(case, tracer), picture(case, NONE))


def trials(mutant: Mutant, wanted: int = SCENES_PER_MUTANT, *, name: bool = True) -> Iterator[tuple[Trial, Staged, Array]]:
    """The first `wanted` scenes on which the mutant is visible, each tried; with the scene and the mutant's picture."""
    count = 0
    for case in mutant.scenes():
        if count == wanted:
            return
        on, image = staged(case), picture(case, mutant.faults)
        visible = visibility(mutant, on, image)
        if visible:
            yield tried(mutant, on, image, visible, name=name), on, image
            count += 1


def visibility(mutant: Mutant, on: Staged, image: Array) -> int:
    """Pixels: see Trial. Each of two faults must show beside the other."""
    pixels = [on.moved(image, on.right)]
    if len(mutant.parts) > 1:
        if not pixels[0]:
            return 0
        for left_out in range(len(mutant.parts)):
            others = NONE
            for k, part in enumerate(mutant.parts):
                others = together(others, part) if k != left_out else others
            pixels.append(on.moved(image, picture(on.case, others)))
    return min(pixels)


def tried(mutant: Mutant, on: Staged, image: Array, visible: int, *, name: bool = True) -> Trial:
    trial = Trial(mutant.name, mutant.causes, on.case.name, visible)
    side = on.side(image)
    scored = compare_pair(side, on.truth, on.tracer)
    trial.detected = scored.json["verdict"] == "diverge"
    if trial.detected and name:
        _name(trial, on, side, scored)
    return trial


def _name(trial: Trial, on: Staged, side: RenderedImage, scored: PairResult) -> None:
    from equilux.diagnose.search import diagnose

    options: dict[str, Any] = {"restate": None, "time_limit_s": TIME_LIMIT_S}
    known = inspect.signature(diagnose).parameters
    diagnosis = diagnose(on.case, side, on.truth, scored, **{key: value for key, value in options.items() if key in known})
    for cause in diagnosis.causes:
        trial.found.append(
            {
                "id": cause.id, "parameter": cause.parameter, "reading": cause.reading, "explained": cause.explained,
                "alternatives": sorted({other.id for other in cause.alternatives} - {cause.id}),
            }
        )  # fmt: skip
    trial.explained, trial.seconds = diagnosis.explained, diagnosis.seconds
    almost_all = trial.explained >= ALMOST_ALL
    trial.named = rightly_named(trial.causes, [c for c in trial.found if not (almost_all and c["id"] == "unexplained")])


def rightly_named(injected: tuple[str, ...], found: list[dict[str, Any]]) -> bool:
    """Whether the causes found are the injected ones, one for one: each by its own id or among those that the scene cannot tell
    from it. Anything more is wrong.
    """
    if len(injected) != len(found):
        return False
    if not injected:
        return True
    first, rest = injected[0], injected[1:]
    return any(
        first in (cause["id"], *cause["alternatives"]) and rightly_named(rest, found[:k] + found[k + 1 :])
        for k, cause in enumerate(found)
    )
