"""Arrays → linear radiance and its budget."""

from __future__ import annotations

import numpy as np

from equilux.adapter import Bound, Budget, RawRender, Reading


def read(raw: RawRender) -> Reading:
    """(h, w, 3) float64, row 0 on top: nothing is rounded on the way."""
    image = np.load(raw.files["radiance"], allow_pickle=False)
    arithmetic = Bound(
        "arithmetic",
        "rounding of the shading in double precision, per pixel, term by term (derived in reference_impl/src/phong.h, opengl.h "
        "and raytraced.h); the geometry is found in double-double, and what many reflections make of that is included (spread.h)",
        abs=np.load(raw.files["rounding"], allow_pickle=False),
    )
    error = np.load(raw.files["quadrature"], allow_pickle=False)
    if not error.any():
        return Reading(image, Budget((arithmetic,)))
    quadrature = Bound(
        "quadrature",
        "error of the integrals over extended emitters, per pixel: estimated from the decay of each panel's Legendre "
        "coefficients, added up without regard to sign (reference_impl/src/quadrature.h)",
        abs=error,
    )
    return Reading(image, Budget((arithmetic, quadrature)))
