"""What a picture may lack where POV-Ray ends rays early by their weight (Q45): a bound over the whole picture, W/(m²·sr)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from equilux_adapters._bounds.paths import BOUNDLESS, Paths
from equilux_adapters.povray.materials import Coefficients
from equilux_adapters.povray.numbers import grey
from equilux_adapters.povray.textures import texture

PER_OCTAVE = 16  # steps of weight that rays are followed in, rounded down

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Surface:
    """local: the most that a hit shows of itself."""

    local: float
    material: Coefficients

    @property
    def onward(self) -> float:
        """The most that a hit adds of what secondary rays bring."""
        return self.material.onward

    def continued(self) -> Iterator[list[tuple[float, float]]]:
        """The sets of secondary rays that a hit may send: per ray, how much it counts and what POV-Ray takes that for.

        POV-Ray multiplies the weight of a mirrored ray by what layers above the mirroring one let through, and that of a total
        reflection, which counts 1, by what would have been let through (Q45).
        """
        m = self.material
        mirrored = [(max(m.reflection), max(m.reflection) * texture(m).above_mirror)] if any(m.reflection) else []
        through = [] if m.through is None else [(max(m.through), max(m.through))]
        yield mirrored + through
        if m.through is not None and m.ior != 1:
            yield [(1.0, max(m.through))]


def below_weight(paths: Paths[Surface], bailout: float) -> float:
    """What rays lighter than `bailout` would add, and what less than `bailout` of comes through the layers of a texture.

    F(n, w) is the most that is missing from a ray which POV-Ray gives the weight w and which has n bounces left, per unit of what
    it counts: of every surface that it may meet, the sum over secondary rays of how much each counts, times C(n − 1) if it is cut
    and F(n − 1, its weight) if it is not. Weights are rounded down to a grid, to which more is cut.
    """
    if bailout == 0:
        return 0.0
    steps = math.ceil(-math.log2(bailout) * PER_OCTAVE)
    missing: Floats = np.zeros(steps + 1)  # F(0, 2^(−k / PER_OCTAVE))
    for left in range(1, paths.bounces + 1):
        worst = np.zeros(steps + 1)
        for surface in paths.surfaces:
            for rays in surface.continued():
                lost = np.full(steps + 1, _of_layers(paths, surface, bailout, left))
                for counts, weight in rays:
                    lost += counts * _carried_on(missing, weight, bailout, paths.brings(left - 1))
                worst = np.maximum(worst, lost)
        missing = np.minimum(worst, BOUNDLESS)
    if paths.bounces == 0:
        return max((_of_layers(paths, surface, bailout, 0) for surface in paths.surfaces), default=0.0)
    return float(missing[0])


def _carried_on(missing: Floats, weight: float, bailout: float, brings: float) -> Floats:
    """For every weight of the grid, what is missing from a ray of `weight` times it."""
    own = np.exp2(-np.arange(len(missing)) / PER_OCTAVE) * weight
    if weight <= 0:
        return np.full(len(missing), brings)
    index = np.ceil(-np.log2(own) * PER_OCTAVE - 1e-9).astype(int)
    within = missing[np.clip(index, 0, len(missing) - 1)]
    return np.where((own < bailout * (1 + 1e-6)) | (index >= len(missing)), brings, np.minimum(within, brings))


def _of_layers(paths: Paths[Surface], surface: Surface, bailout: float, left: int) -> float:
    """What one hit lacks because layers, or what passes all of them, are not looked at."""
    material, onward = surface.material, paths.brings(left - 1) if left else 0.0
    if texture(material).dimmest <= bailout:
        return min(surface.local + material.onward * onward, BOUNDLESS)
    if material.through is None or grey(material.through) > bailout:
        return 0.0
    return (1.0 if material.ior != 1 else max(material.through)) * onward  # a total reflection is not found either
