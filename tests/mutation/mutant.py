"""A mutant: a renderer with one fault, or two, and the scenes on which it is tried."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from equilux_scenes.case import Case
from mutation.faults import Faults, together
from mutation.scenes import corpus, stages

ALL = ("phong", "opengl", "raytraced")
LOCAL = ("phong", "opengl")
RAYTRACED = ("raytraced",)

MOST_OF_CORPUS = 12
"""Scenes of the corpus tried for one mutant at most, drawn by its name."""


@dataclass(frozen=True)
class Mutant:
    """name: unique. causes: ids of what is wrong with it, in the order of `parts`. parts: the faults one by one. models, needs:
    scenes of these models are tried that require one of these features each ("a|b": either). suits: which of those.
    variant: of the stages. on_corpus: whether scenes of the corpus are tried too.
    """

    name: str
    causes: tuple[str, ...]
    parts: tuple[Faults, ...]
    models: tuple[str, ...] = ALL
    needs: tuple[str, ...] = ()
    suits: Callable[[Case], bool] = field(default=lambda case: True)
    variant: str = ""
    on_corpus: bool = True

    @property
    def faults(self) -> Faults:
        whole = self.parts[0]
        for part in self.parts[1:]:
            whole = together(whole, part)
        return whole

    def scenes(self) -> Iterator[Case]:
        """Candidates: one of the corpus, then stages and corpus in turn; the same on every machine."""
        mine: list[Case] = []
        if self.on_corpus:
            mine = [case for case in corpus().values() if self.may_show(case)]
            random.Random(self.name).shuffle(mine)
            mine = mine[:MOST_OF_CORPUS]
        ours = [case for case in stages(self.models, self.variant) if self.may_show(case)]
        for k in range(max(len(mine), len(ours))):
            yield from mine[k : k + 1]
            yield from ours[k : k + 1]

    def may_show(self, case: Case) -> bool:
        """Whether the scene has what the fault concerns."""
        if case.scene.model not in self.models or not self.suits(case):
            return False
        return all(any(feature in case.requires for feature in either.split("|")) for either in self.needs)


def pair(a: Mutant, b: Mutant) -> Mutant:
    """Both faults in one renderer, on scenes that have what both concern."""
    return Mutant(
        f"{a.name} + {b.name}",
        a.causes + b.causes,
        a.parts + b.parts,
        tuple(model for model in a.models if model in b.models),
        a.needs + b.needs,
        lambda case: a.suits(case) and b.suits(case),
        a.variant or b.variant,
        a.on_corpus and b.on_corpus,
    )
