"""What the oracle finds out about film positions, whatever the lighting model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from equilux_oracle.doubledouble import Array
from equilux_scenes.model import Film

SLICE = 8192
"""Rays at once: the temporaries of one double-double product then stay in a core's cache."""


@dataclass(frozen=True)
class Examination:
    """n film positions: what is seen there, and what the error of any evaluation is measured in.

    radiance, W/(m²·sr), (n, 3). bound: hard limit on the absolute error of its arithmetic, (n, 3). scale: K_emit + K_amb L_amb +
    Σ E_i (K_diff + K_spec) over all lights, in model `raytraced` summed over all surfaces along the paths, each with its weight,
    (n, 3); 0 where nothing is hit. facing: N·V, (n,); 1 where nothing is hit. object_id: (n,), −1 where nothing is hit.
    """

    radiance: Array
    bound: Array
    scale: Array
    facing: Array
    object_id: npt.NDArray[np.int64]


def pixel_centers(film: Film) -> Array:
    """Film positions (h·w, 2) of the pixel centres, row by row from the top."""
    y, x = np.mgrid[0 : film.height, 0 : film.width]
    return np.stack([x.ravel() + 0.5, y.ravel() + 0.5], axis=1)
