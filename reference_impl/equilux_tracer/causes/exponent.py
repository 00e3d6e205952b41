"""Faults of the power in the highlight: its exponent, and the cosine that it is taken of."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence

import numpy as np

from equilux_scenes.case import Case
from equilux_scenes.model import Scene
from equilux_tracer.causes.fits import Lobes, with_round_numbers
from equilux_tracer.causes.rewrite import CheckedRule, has_highlight, is_shiny, used_materials, with_materials
from equilux_tracer.causes.rule import Applied, Continuous, Evidence
from equilux_tracer.shading_rules import ShadingRules

KNOWN_CLAMPS = (1.0, 2.0, 5.0, 10.0, 16.0, 20.0, 32.0, 50.0, 64.0, 100.0, 127.0, 128.0, 200.0, 250.0, 255.0, 256.0, 500.0, 512.0,
                1000.0, 1024.0)  # fmt: skip
KNOWN_SCALES = (1 / 128, 0.01, 1 / 16, 0.1, 0.125, 0.2, 0.25, 0.3, 1 / 3, 0.4, 0.5, 2 / 3, 0.75, 0.8, 0.9, 1.1, 1.2, 1.25, 4 / 3,
                1.5, 1.6, 2.0, 2.5, 3.0, math.pi, 4.0, 5.0, 8.0, 10.0, 16.0, 100.0, 128.0)  # fmt: skip
KNOWN_FLOORS = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.05, 0.1, 0.2, 0.25, 0.3, 0.5)


def _exponents(scene: Scene) -> list[float]:
    """The exponents of what shines, ascending, each once."""
    return sorted({material.exponent for material in used_materials(scene) if is_shiny(material, scene)})


class ExponentClamped(CheckedRule):
    """Exponents beyond a limit are taken as the limit, silently: 128 in VTK (Q5) and in the fixed-function API (OpenGL Q6)."""

    id = "exponent-clamped"
    group = "highlight"
    formula = ("K_spec max(0, R·V)^p", "K_spec max(0, R·V)^min(p, max)")
    parameter = Continuous("max", "", 0.01, 1e6, "log")

    def touches(self, scene: Scene) -> bool:
        return has_highlight(scene) and _exponents(scene)[-1] > self.parameter.low

    def change_case(self, case: Case, applied: Applied) -> Case:
        most = float(applied.parameter)  # type: ignore[arg-type]
        return with_materials(case, lambda m: {"exponent": min(m.exponent, most)})

    def estimates(self, hypothesis: Applied, evidence: Evidence) -> Sequence[Applied]:
        largest = _exponents(evidence.case.scene)[-1]
        if largest <= self.parameter.low:  # under other causes nothing may be left to clamp
            return []
        lobes = Lobes(evidence)
        grid = np.geomspace(max(self.parameter.low, 1e-4 * largest), largest * 0.999, 60)
        best = lobes.best(lambda most: lobes.predicted(np.minimum(lobes.exponent, most)), grid)
        values = (
            with_round_numbers(best, [n for n in KNOWN_CLAMPS if n < largest]) or [n for n in KNOWN_CLAMPS if n < largest][::-1]
        )
        return [Applied(self.id, value) for value in values]


class ExponentScaled(CheckedRule):
    """Every exponent is multiplied: by 4 or 1/4 where Phong's and Blinn's are converted into each other, by 128 where shininess
    is meant as a share of the largest."""

    id = "exponent-scaled"
    group = "highlight"
    formula = ("K_spec max(0, R·V)^p", "K_spec max(0, R·V)^(k p)")
    parameter = Continuous("k", "", 1 / 256, 256, "log", neutral=1.0)
    suspects = "translation"

    def touches(self, scene: Scene) -> bool:
        return has_highlight(scene) and _exponents(scene)[-1] > 0

    def change_case(self, case: Case, applied: Applied) -> Case:
        k = float(applied.parameter)  # type: ignore[arg-type]
        return with_materials(case, lambda m: {"exponent": k * m.exponent})

    def estimates(self, hypothesis: Applied, evidence: Evidence) -> Sequence[Applied]:
        lobes = Lobes(evidence)
        # An even number of steps would have 1 on the grid, where nothing changes.
        best = lobes.best(
            lambda k: lobes.predicted(k * lobes.exponent), np.geomspace(self.parameter.low, self.parameter.high, 80)
        )
        values = with_round_numbers(best, KNOWN_SCALES) or [4.0, 0.25, 2.0, 0.5]
        return [Applied(self.id, value) for value in values]


class SpecularFloored(CheckedRule):
    """The cosine is raised to a small number before the power, so that a surface turned away from the mirror direction (but lit)
    still shines where p is small: 1e-5 in VTK (Q6)."""

    id = "specular-floored"
    group = "highlight"
    formula = ("K_spec max(0, R·V)^p", "K_spec max(floor, R·V)^p where N·L > 0")
    parameter = Continuous("floor", "", 1e-9, 0.95, "log")

    def touches(self, scene: Scene) -> bool:
        return has_highlight(scene)

    def change_shading(self, rules: ShadingRules, applied: Applied) -> ShadingRules:
        return dataclasses.replace(rules, specular_floor=float(applied.parameter))  # type: ignore[arg-type]

    def estimates(self, hypothesis: Applied, evidence: Evidence) -> Sequence[Applied]:
        lobes = Lobes(evidence)
        grid = np.geomspace(self.parameter.low, self.parameter.high, 80)
        best = lobes.best(lambda floor: lobes.predicted(floor=floor), grid)
        return [Applied(self.id, value) for value in with_round_numbers(best, KNOWN_FLOORS) or KNOWN_FLOORS]
