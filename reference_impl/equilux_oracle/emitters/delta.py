"""Lights without an extent under the physical form: E_i f_r cosθ where N·L > 0 and nothing is in between.

    lambert       E K_diff (N·L)
    phong-classic E (K_diff (N·L) + K_spec max(0, R·V)^p)
    phong-cosine  E (K_diff + K_spec max(0, R·V)^p) (N·L)

The bound is that of `local_formula.py`, term by term, and for the receiver's cosine on the highlight another 12 u.
"""

from __future__ import annotations

import numpy as np

from equilux_oracle.doubledouble import DD, Array
from equilux_oracle.emitters.received import Reflecting
from equilux_oracle.highlight import MIRRORED, mirrored, sensitivity
from equilux_oracle.lights import Arriving, cosine_to_light

UNIT_ROUNDOFF = 2.0**-53


def from_light(arrives: Arriving, normal: DD, to_viewer: DD, here: Reflecting) -> tuple[Array, Array]:
    """Radiance (3, n) that an unblocked light causes, and a bound on its error."""
    value, bound = np.zeros_like(here.diffuse), np.zeros_like(here.diffuse)
    cosine = cosine_to_light(normal, arrives)
    lit = np.flatnonzero((cosine > 0.0) & np.any(arrives.value > 0.0, axis=0))
    if len(lit) == 0:
        return value, bound
    cosine, e, error, there = cosine[lit], arrives.value[:, lit], arrives.error[lit], here[lit]
    power = np.zeros(len(lit))
    if np.any(there.specular):
        power = mirrored(normal, arrives.to_light, to_viewer, here.exponent)(lit)
    receiver = np.where(there.cosine, cosine, 1.0)
    value[:, lit] = e * (there.diffuse * cosine + there.specular * power * receiver)
    highlight = error + 6.0 + MIRRORED * sensitivity(there.exponent) + np.where(there.cosine, 12.0, 0.0)
    bound[:, lit] = 1.1 * UNIT_ROUNDOFF * (e * (there.diffuse * (error + 12.0) + there.specular * highlight) + value[:, lit])
    return value, bound
