"""Which exposures a picture needs, and how they merge: render, look, add only where needed.

An exposure of full scale F shows radiances below F in steps of F/65535, so within half a step, and clips the rest (Q22). The
ladder of full scales is F_k = darkest · qᵏ⁺¹, q a little under 2 · 65535 · relative_precision: a radiance between F_{k−1} and
F_k is shown by rung k to `relative_precision`, and rung 0 shows what is darker than `darkest` to relative_precision · darkest.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

CLIPPED = 65535  # the brightest code: this radiance or more
HALF_STEP = 0.5 / CLIPPED  # of the full scale
MARGIN = 0.98  # of the ladder's ratio, left for float32 arithmetic
DEPTHS = 2  # looks into a black picture: 65535² below `darkest`
SPECULATION = 3  # rungs that a first look starts together: most pictures shade from something bright to black

Codes = npt.NDArray[np.uint16]
Floats = npt.NDArray[np.float64]


def merge(exposures: Mapping[float, Codes]) -> tuple[Floats, Floats]:
    """Radiance and the full scale it was read at, both (h, w, 3): per value the brightest exposure that did not clip.

    exposures: full scale → codes. A value that every exposure clips reads as the largest full scale.
    """
    scales = sorted(exposures, reverse=True)
    radiance: Floats = exposures[scales[0]].astype(np.float64) * (scales[0] / CLIPPED)
    used: Floats = np.full(radiance.shape, scales[0])
    for scale in scales[1:]:
        open_ = exposures[scale] < CLIPPED
        radiance[open_] = exposures[scale][open_] * (scale / CLIPPED)
        used[open_] = scale
    return radiance, used


class Plan:
    """The exposures of one picture, decided in waves.

    limit: most exposures to merge. ceiling: an upper bound of the picture's radiance; it says where to start, nothing more.
    """

    def __init__(self, limit: int, relative_precision: float, darkest: float, ceiling: float) -> None:
        self.limit = limit
        self.relative_precision = relative_precision
        self.darkest = darkest
        self.ceiling = ceiling
        self.looked: dict[float, Codes] = {}

    def next_wave(self) -> list[float]:
        """Full scales to render now, several at once where all are sure to be needed; empty when the picture is complete."""
        if not self.looked:
            return self._first_wave()
        if not self._unclipped():
            return self._brighter()
        return self._missing()

    def chosen(self) -> dict[float, Codes]:
        """The exposures to merge: the smallest full scale that clips nothing and, up to the limit, those below that show more."""
        top = min(self._unclipped())
        useful = [scale for scale, codes in self.looked.items() if scale <= top and int(codes.min()) < CLIPPED]
        return {scale: self.looked[scale] for scale in sorted(useful, reverse=True)[: self.limit]}

    @property
    def _ratio(self) -> float:
        return max(2.0, MARGIN * self.relative_precision / HALF_STEP)

    def _rung(self, k: int) -> float:
        return expressible(self.darkest * self._ratio ** (k + 1))

    def _first_wave(self) -> list[float]:
        if self.limit == 1:
            # a picture as a file shows it: full scale 1
            return [1.0]
        if 0 < self.ceiling <= self._rung(-1):
            # darker altogether than what the ladder is made for
            return [expressible(self.ceiling * 1.001)]
        top = next(k for k in range(100) if self._rung(k) >= self.ceiling)
        return [self._rung(k) for k in range(min(top + 1, SPECULATION, self.limit))]

    def _brighter(self) -> list[float]:
        """Something is brighter than all that was looked at: the next rung, and the one above if the ceiling allows for it."""
        following = expressible(max(self.looked) * self._ratio)
        beyond = [expressible(following * self._ratio)] if self.limit > 1 and self.ceiling > following else []
        return [following, *beyond]

    def _unclipped(self) -> list[float]:
        return [scale for scale, codes in self.looked.items() if int(codes.max()) < CLIPPED]

    def _missing(self) -> list[float]:
        """The rungs that would show to the precision asked for what no exposure so far does."""
        chosen = self.chosen()
        radiance, used = merge(chosen)
        if not radiance.any():
            return self._deeper(float(used.max()))
        # black counts as unknown up to half a step; the brightest value of a dark picture gets full precision too
        asked = np.maximum(radiance + used * HALF_STEP, min(self.darkest, float(radiance.max())))
        lacking = used * HALF_STEP > self.relative_precision * asked * (1.0 + 1e-6)
        if not lacking.any():
            return []
        steps = np.floor(np.log(asked[lacking] / self.darkest) / math.log(self._ratio) + 1e-9).astype(int)
        wanted = {self._rung(int(k)) for k in np.unique(steps)} - set(self.looked)
        return sorted(wanted, reverse=True)[: max(0, self.limit - len(chosen))]

    def _deeper(self, seen: float) -> list[float]:
        """All black: look below the first step, DEPTHS times at most, unless the ceiling says that nothing is there."""
        black = [scale for scale in self.looked if scale < self._rung(0)]
        if self.limit == 1 or len(black) >= DEPTHS or self.ceiling <= seen * HALF_STEP * self.relative_precision:
            return []
        return [expressible(min(min(self.looked), self._rung(0)) / CLIPPED)]


def factor(full_scale: float) -> str:
    """What radiance is multiplied by: 1 / full_scale in four digits; POV-Ray's command line keeps no more than six (Q24)."""
    return f"{1.0 / full_scale:.4g}"


def expressible(full_scale: float) -> float:
    """The full scale near `full_scale` whose factor is exactly what is written."""
    return 1.0 / float(factor(full_scale))
