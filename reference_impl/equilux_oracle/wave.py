"""Generations of rays, and the film positions that they add to."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from equilux_oracle.camera import Rays
from equilux_oracle.doubledouble import DD, Array, Bools, Index
from equilux_oracle.local_formula import UNIT_ROUNDOFF
from equilux_oracle.ray_errors import RayError

Indices = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Wave:
    """One generation of n rays: the positions that they belong to (n,), unit directions, weights (3, n) with a bound on their
    relative error in u (n,), how far the rays may be off, and the object that each leaves (n,)."""

    position: Indices
    rays: Rays
    weight: Array
    weight_error: Array
    error: RayError
    left: Indices

    def __getitem__(self, index: Index) -> Wave:
        return Wave(
            self.position[index],
            self.rays[index],
            self.weight[:, index],
            self.weight_error[index],
            self.error[index],
            self.left[index],
        )

    def __len__(self) -> int:
        return len(self.position)

    def parts(self, size: int) -> Iterator[Wave]:
        """The same rays, at most `size` at a time."""
        for start in range(0, len(self), size):
            yield self[start : start + size]


def together(waves: list[Wave]) -> Wave:
    def joined(parts: list[DD]) -> DD:
        return DD(np.concatenate([p.hi for p in parts], axis=1), np.concatenate([p.lo for p in parts], axis=1))

    position = np.concatenate([wave.position for wave in waves])
    offset, direction = joined([wave.rays.offset for wave in waves]), joined([wave.rays.direction for wave in waves])
    return Wave(
        position,
        Rays(offset, direction, len(position)),
        np.concatenate([wave.weight for wave in waves], axis=1),
        np.concatenate([wave.weight_error for wave in waves]),
        RayError(np.concatenate([wave.error.lateral for wave in waves]), np.concatenate([wave.error.angle for wave in waves])),
        np.concatenate([wave.left for wave in waves]),
    )


@dataclass
class Sums:
    """What is being summed at n film positions, (3, n) each, how many terms each has, and whether it is undecided, (n,)."""

    radiance: Array
    bound: Array
    scale: Array
    terms: Array
    undecided: Bools

    @classmethod
    def black(cls, count: int) -> Sums:
        return cls(np.zeros((3, count)), np.zeros((3, count)), np.zeros((3, count)), np.zeros(count), np.zeros(count, dtype=bool))

    def doubt(self, positions: Indices) -> None:
        """No digit of these is vouched for."""
        self.undecided[positions] = True

    def add(self, wave: Wave, radiance: Array, bound: Array, scale: Array) -> None:
        """Add what surfaces, or the background, send along the wave's rays; bound is absolute."""
        with_weights = wave.weight * (bound + UNIT_ROUNDOFF * (wave.weight_error + 1.0) * radiance)
        for whole, part in (
            (self.radiance, wave.weight * radiance), (self.bound, with_weights), (self.scale, wave.weight * scale)
        ):  # fmt: skip
            for band in range(3):
                whole[band] += np.bincount(wave.position, part[band], whole.shape[1])
        self.terms += np.bincount(wave.position, minlength=len(self.terms))

    def finish(self) -> tuple[Array, Array, Array]:
        """Radiance, bound, scale, (n, 3) each. Second order, and the bound's own rounding, are a tenth."""
        bound = 1.1 * (self.bound + UNIT_ROUNDOFF * self.terms * self.radiance)
        bound[:, self.undecided] = np.inf
        return self.radiance.T, bound.T, self.scale.T
