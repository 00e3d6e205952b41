"""Arrays → linear radiance and its budget."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from equilux.adapter import Bound, Budget, Geometric, Program, RawRender, Reading
from equilux.budget import Term

NO_DIGIT = 1e30
"""W/(m²·sr). Between curved mirrors a bound grows with every bounce, beyond all numbers in the end: it then says nothing, and
this stands for it, because a budget holds finite numbers only."""


def read(raw: RawRender, program: Program) -> Reading:
    """(h, w, 3) float64, row 0 on top: nothing is rounded on the way."""
    image = np.load(raw.files["radiance"], allow_pickle=False)
    rounding = np.load(raw.files["rounding"], allow_pickle=False)
    lost = ~(rounding <= NO_DIGIT)
    arithmetic = Bound(
        "arithmetic",
        "rounding of the shading in double precision, per pixel, term by term (derived in reference_impl/src/phong.h, opengl.h "
        "and raytraced.h); the geometry is found in double-double, and what many reflections make of that is included (spread.h)"
        + _said_of_lost(int(lost.any(axis=2).sum())),
        abs=np.where(lost, NO_DIGIT, rounding),
    )
    error = np.load(raw.files["quadrature"], allow_pickle=False)
    terms = (arithmetic, *_of_knobs(program.data))
    if not error.any():
        return Reading(image, Budget(terms))
    quadrature = Bound(
        "quadrature",
        "error of the integrals over extended emitters, per pixel: estimated from the decay of each panel's Legendre "
        "coefficients, added up without regard to sign (reference_impl/src/quadrature.h)",
        abs=error,
    )
    return Reading(image, Budget((*terms, quadrature)))


def _of_knobs(facts: Mapping[str, Any]) -> Iterator[Term]:
    """What is left out for speed."""
    if "missing" in facts:
        reason = f"what more than {facts['depth']} bounces would bring: the largest weights of so many surfaces"
        yield Bound("recursion cut", reason, abs=facts["missing"])
    if "facets" in facts:
        normal, position = ({int(index): by for index, by in facts["facets"][key].items()} for key in ("normal", "position_m"))
        reason = "flat facets in place of round surfaces"
        yield Geometric("facets", reason, normal=normal, position_m=position, film_px=facts["facets"]["film_px"])


def _said_of_lost(pixels: int) -> str:
    return f"; of {pixels} pixels it cannot vouch for a single digit, and says {NO_DIGIT:g}" if pixels else ""
