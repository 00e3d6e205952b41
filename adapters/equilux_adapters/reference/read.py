"""Arrays → linear radiance and its budget."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from equilux.adapter import Bound, Budget, Geometric, Program, RawRender, Reading
from equilux.budget import Term
from equilux_adapters._vouched import said_of_lost, vouched
from equilux_adapters.reference.knobs import ReferenceKnobs

EXACT_REASON = (
    "rounding of the shading in double precision, per pixel, term by term (derived in reference_impl/src/phong.h, opengl.h and "
    "raytraced.h); the geometry is found in double-double, and what many reflections make of that is included (spread.h)"
)
FLOAT_REASON = (
    "rounding of geometry and shading in single precision, per pixel, term by term, carried from hit to hit (derived in "
    "reference_impl/src/fast/shading.h and strayed.h), and of the radiance to float32"
)


def read(raw: RawRender, program: Program, knobs: ReferenceKnobs) -> Reading:
    """(h, w, 3), row 0 on top, nothing rounded on the way: float64, of single precision widened."""
    image = np.load(raw.files["radiance"], allow_pickle=False).astype(np.float64)
    rounding = np.load(raw.files["rounding"], allow_pickle=False).astype(np.float64)
    arithmetic = _arithmetic(image, rounding, FLOAT_REASON if knobs.precision == "float" else EXACT_REASON)
    if knobs.precision != "exact":
        displaced = Geometric(
            "single precision",
            "packets of rays in single precision find what is seen: silhouettes and borders of shadows may be displaced; shadow "
            "rays start 2^-19 of the lengths involved beside the surface (reference_impl/src/fast/packet.h)",
            film_px=float(np.load(raw.files["film_px"], allow_pickle=False)),
        )
        return Reading(image, Budget((arithmetic, displaced, *_of_knobs(program.data))))
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


def _arithmetic(image: npt.NDArray[np.float64], rounding: npt.NDArray[np.float64], reason: str) -> Bound:
    held, lost = vouched(image, rounding)
    return Bound("arithmetic", reason + said_of_lost(lost), abs=held)
