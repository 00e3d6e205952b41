"""What the oracle finds out about film positions, whatever the lighting model."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from equilux_oracle.doubledouble import Array
from equilux_scenes.model import Film, Scene

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

    def completed(self, scene: Scene) -> Examination:
        """With what the ends of double's range do: where radiance overflows it is Inf, and its bound too; below the smallest
        normal double, 2^-1022, each of a light's few products may lose 2^-1075 more, at every surface of a path."""
        coefficients = [sum(map(max, (m.diffuse, m.specular, m.ambient))) for m in scene.materials.values()]
        surfaces = 2.0 ** min(scene.recursion_limit, 60) if scene.model == "raytraced" else 1.0
        lost = 8 * 2.0**-1074 * (len(scene.delta_lights) + 1) * (1 + max(coefficients, default=0.0)) * surfaces
        held = np.isfinite(self.radiance)
        bound = np.where(held & ~np.isnan(self.bound), self.bound + lost, np.inf)
        return replace(self, radiance=np.where(held, self.radiance, np.inf), bound=bound)


def pixel_centers(film: Film) -> Array:
    """Film positions (h·w, 2) of the pixel centres, row by row from the top."""
    y, x = np.mgrid[0 : film.height, 0 : film.width]
    return np.stack([x.ravel() + 0.5, y.ravel() + 0.5], axis=1)
