"""Raw files → float64 radiance, and the budget: rounding, per pixel."""

from __future__ import annotations

import json

import numpy as np

from equilux.adapter import Bound, Budget, Program, RawRender, Reading
from equilux_adapters._vouched import said_of_lost, vouched
from equilux_adapters.oracle.render import BOUND, RADIANCE

_LOCAL = (
    "Rounding of the closed form's evaluation, first order in u = 2^-53 and a tenth more; geometry is exact (double-double) "
    "and rounded once. 2 u (K_emit + K_amb L_amb) + u Σ E_i [(e_i + 12) K_diff + (e_i + 6 + k s(p)) K_spec] + u L, "
    "where e_i (0 to 9, and the spot's) is the light's own error, s(p) = √p ((p−1)/p)^((p−1)/2) is how much the highlight feels "
    "a direction's, and k is "
)

REASONS = {
    "phong": _LOCAL + "34.",
    "opengl": _LOCAL + "4; and each light's ambient share, (e_i + 4) u.",
    "raytraced": _LOCAL
    + "34 in front and 4 behind; e_i has 3 more for 1 − t or t, and 4 for each transparent object on the light's way. Summed "
    "over the surfaces that the paths meet with their weights w, + 3 u w L per bounce and u L per term; + what the rounding of "
    "geometry, 2^-96 and magnified by every bounce (ray_errors.py), makes of each.",
    "reflection-equation": "Integrals along the borders of what is seen of each emitter: for the diffuse term in closed form, "
    "for the highlight by Gauss–Legendre panels, each with a proven bound of at most u/(p + 1) (emitters/panels.py). Rounding: "
    "16 u, and more close to a rim or a long edge, times the integral of the lobe's height along the border (emitters/lobe.py, "
    "lambert.py); lights without an extent as in model phong.",
}


def reading(raw: RawRender, program: Program) -> Reading:
    """The picture with its one term, `arithmetic`."""
    model = json.loads(program.files[program.entry])["model"]
    image = np.load(raw.files[RADIANCE])
    held, lost = vouched(image, np.load(raw.files[BOUND]))
    return Reading(image, Budget((Bound("arithmetic", REASONS[model] + said_of_lost(lost), abs=held),)))
