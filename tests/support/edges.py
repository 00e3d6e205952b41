"""Where a film position lies on a discontinuity: the reference's path signature changes within a given distance of it."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from equilux_tracer import Tracer

LEAST_DELTA_PX = 1e-6
"""The film-position uncertainty that even exact renderers have (comparison.md)."""


def on_edge(tracer: Tracer, film_xy: npt.ArrayLike, delta_px: float = LEAST_DELTA_PX) -> npt.NDArray[np.bool_]:
    """Whether the signature at 16 points on rings of radius δ/2 and δ differs from that at the centre: (n, 2) pixels → (n,)."""
    center = np.asarray(film_xy, dtype=np.float64).reshape(-1, 2)
    here = tracer.evaluate(center, ["signature"])["signature"]
    differs = np.zeros(len(center), dtype=bool)
    for radius in (delta_px / 2, delta_px):
        for k in range(8):
            angle = 2 * math.pi * (k + 0.5) / 8
            around = center + np.array([radius * math.cos(angle), radius * math.sin(angle)])
            differs |= tracer.evaluate(around, ["signature"])["signature"] != here
    return differs
