"""How long a comparison takes, beside a tool that computes less of it in the same minute on the same machine."""

from __future__ import annotations

import numpy as np
import OpenImageIO as oiio

from bench.measured import Measured, Seconds, interleaved, ratio, timed
from equilux import _compare
from equilux.compare import EN_EDGES

SHAPE = (1080, 1920, 3)
ROUNDS = 9


def measure() -> Measured:
    """Two 1080p float32 images in memory. ImageBufAlgo.compare gives mean, rms, peak and counts; the kernel gives classes, E_n
    and percentiles as well."""
    rng = np.random.default_rng(1)
    b = rng.random(SHAPE, dtype=np.float32)
    a = b * (1 + 1e-4 * rng.standard_normal(SHAPE, dtype=np.float32))
    left, right = oiio.ImageBuf(a), oiio.ImageBuf(b)
    difference, normalised_error = np.empty(SHAPE, np.float32), np.empty(SHAPE, np.float32)

    def kernel() -> Seconds:
        return timed(
            lambda: _compare.compare(
                a, b, rel_a=2e-4, en_edges=EN_EDGES, difference=difference, normalised_error=normalised_error
            )
        )

    def tool() -> Seconds:
        return timed(lambda: oiio.ImageBufAlgo.compare(left, right, 1e-3, 1e-3))

    times = interleaved({"kernel": kernel, "ImageBufAlgo.compare": tool}, ROUNDS)
    walls = {name: [one.wall for one in found] for name, found in times.items()}
    found = ratio(walls["kernel"], walls["ImageBufAlgo.compare"])
    ours, theirs = min(walls["kernel"]), min(walls["ImageBufAlgo.compare"])
    return Measured(
        "compare",
        ratios={"compare_vs_oiio": found["median"]},
        numbers={"wall_s": walls, "compare_vs_oiio": found},
        lines=[f"1080p float32 pair: kernel {ours:.3f} s, ImageBufAlgo.compare {theirs:.3f} s (best of {ROUNDS})"],
    )
