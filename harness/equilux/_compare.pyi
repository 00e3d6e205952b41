"""The comparison kernel (C++): one pass over two radiance images."""

from collections.abc import Sequence
from typing import Any, TypedDict

import numpy as np
import numpy.typing as npt

class Scores(TypedDict):
    """Classes, normalised error and statistics of a pair; statistics are over the bands of pixels neither edge nor invalid."""

    agree: int
    diverge: int
    edge: int
    invalid: int
    invalid_a: dict[str, int]  # pixels of side a holding at least one "nan", "+inf", "-inf", "negative" (beyond its own B)
    invalid_b: dict[str, int]
    scored_values: int  # bands counted in the statistics
    max_abs: float
    max_rel: float  # −1 where no |b| exceeds its own uncertainty
    sum: float  # Σ (a − b)
    sum_of_squares: float
    p50: float  # the smallest |a − b| that 50 % of the values do not exceed
    p95: float
    p99: float
    edge_max_abs: float
    en_max: float  # may be ∞
    en_infinite: int  # bands with B = 0 that differ
    worst_pixel: int  # row-major index of the largest |E_n|, the first of equals; −1 if nothing was scored
    farthest_pixel: int  # the same of the largest |a − b|
    first_invalid: int  # row-major index, or −1
    en_counts: list[int]  # en_edges[i] < |E_n| ≤ en_edges[i + 1]; the first bin reaches to 0, the last to ∞
    classes: npt.NDArray[np.uint8]  # (h, w): 0 agree, 1 diverge, 2 edge, 3 invalid

def compare(
    a: npt.NDArray[Any],
    b: npt.NDArray[Any],
    *,
    abs_a: float = 0.0,
    rel_a: float = 0.0,
    per_pixel_a: npt.NDArray[np.float32] | None = None,
    sigma_a: npt.NDArray[np.float32] | None = None,
    abs_b: float = 0.0,
    rel_b: float = 0.0,
    per_pixel_b: npt.NDArray[np.float32] | None = None,
    sigma_b: npt.NDArray[np.float32] | None = None,
    coverage_factor: float = 0.0,
    edge: npt.NDArray[np.uint8] | None = None,
    en_edges: Sequence[float],
    difference: npt.NDArray[np.float32] | None = None,
    normalised_error: npt.NDArray[np.float32] | None = None,
    threads: int = 0,
) -> Scores:
    """Compare two C-contiguous (h, w, 3) images, float32 or float64 each.

    A side's bound is abs + rel |L| + per_pixel, of its own L; a pair's is B = bound_a + bound_b + coverage_factor
    √(σ_a² + σ_b²); a band agrees when |a − b| ≤ B, and E_n = (a − b)/B (ISO 13528), 0 where a = b whatever B is. A
    pixel has its worst band's class. `edge` excuses pixels that would diverge. `difference` and `normalised_error`, (h,
    w, 3), are written where given: a − b, and E_n (NaN where a or b is not finite; |E_n| ≤ 1 exactly where the band
    agrees). `en_edges` ascend by an eighth each at least. The result does not depend on `threads` (0: all). Raises
    ValueError on shapes that do not match, and on bounds that are negative or not finite where both radiances are
    finite.
    """
