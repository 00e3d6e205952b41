"""Raw files → float64 radiance, and the budget: rounding, per pixel."""

from __future__ import annotations

import numpy as np

from equilux.adapter import Bound, Budget, RawRender, Reading
from equilux_adapters.oracle.render import BOUND, RADIANCE

REASON = (
    "Rounding of the closed form's evaluation, first order in u = 2^-53 and a tenth more; geometry is exact (double-double) "
    "and rounded once. 2 u (K_emit + K_amb L_amb) + u Σ E_i [(e_i + 12) K_diff + (e_i + 6 + 34 s(p)) K_spec] + u L, "
    "where e_i (0 to 9, and the spot's) is the light's own error "
    "and s(p) = √p ((p−1)/p)^((p−1)/2) is how much the highlight feels a direction's."
)


def reading(raw: RawRender) -> Reading:
    """The picture with its one term, `arithmetic`."""
    bound = Bound("arithmetic", REASON, abs=np.load(raw.files[BOUND]))
    return Reading(np.load(raw.files[RADIANCE]), Budget((bound,)))
