"""Comparing two images the plain way: NumPy, whole arrays, one statement per definition. What the kernel is held against."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


def order_statistic(values: npt.NDArray[Any], percent: int) -> float:
    """The smallest value that `percent` % of the values do not exceed. In integers: np.percentile rounds the rank."""
    return float(np.sort(values, axis=None)[-(-values.size * percent // 100) - 1])


def plain_comparison(
    a: npt.NDArray[Any],
    b: npt.NDArray[Any],
    bound_a: Floats | float,
    bound_b: Floats | float,
    sampled: Floats | float = 0.0,
    edge: npt.NDArray[np.bool_] | None = None,
) -> dict[str, Any]:
    """bound_a, bound_b: each side's own hard bound; sampled: k √(σ_a² + σ_b²). Negative values are held against the hard
    bounds alone.
    """
    a, b = a.astype(np.float64), b.astype(np.float64)
    own_a, own_b = np.broadcast_to(bound_a, a.shape), np.broadcast_to(bound_b, b.shape)
    bound = own_a + own_b + sampled
    finite = np.isfinite(a) & np.isfinite(b)
    with np.errstate(all="ignore"):
        difference = a - b
        magnitude = np.abs(difference)
        en = np.where(magnitude == 0, 0.0, difference / bound)
        invalid = (~finite | (a < -own_a) | (b < -own_b)).any(axis=2)
        outside = (~(magnitude <= bound)).any(axis=2) & ~invalid
    excused = outside & edge if edge is not None else np.zeros_like(outside)
    scored = ~invalid & ~excused
    out: dict[str, Any] = {
        "classes": np.select([invalid, excused, outside], [3, 2, 1], 0),
        "difference": difference,
        "en": np.where(finite, en, np.nan),
        "edge_max_abs": float(magnitude[excused].max()) if excused.any() else 0.0,
        "scored_values": int(3 * scored.sum()),
    }
    if scored.any():
        values, signed, errors = magnitude[scored].ravel(), difference[scored].ravel(), np.abs(en[scored]).ravel()
        reference, own = np.abs(b[scored]).ravel(), own_b[scored].ravel()
        known = reference > own
        out |= {
            "max_abs": float(values.max()),
            "max_rel": float((values[known] / reference[known]).max()) if known.any() else -1.0,
            "sum": float(signed.sum()),
            "sum_of_squares": float((values**2).sum()),
            **{f"p{percent}": order_statistic(values, percent) for percent in (50, 95, 99)},
            "en_max": float(errors.max()),
            "worst_pixel": int(np.flatnonzero(scored.ravel())[errors.argmax() // 3]),
            "farthest_pixel": int(np.flatnonzero(scored.ravel())[values.argmax() // 3]),
        }
    return out
