"""How long a comparison takes, beside a tool that computes less of it in the same minute on the same machine."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio

from bench.measured import Measured, Seconds, interleaved, ratio, timed
from equilux import _compare
from equilux.compare import EN_EDGES, RenderedImage, compare_pair
from equilux.uncertainty import Uncertainty

FULL_HD = (1080, 1920)
FILMS = ((144, 256), (540, 960), FULL_HD, (2160, 3840))
ROUNDS = 9

Image = npt.NDArray[np.float32]


def pictures(height: int, width: int) -> tuple[Image, Image]:
    """Two noisy float32 pictures that differ by 1e-4 relative: no value is equal, none trivial."""
    rng = np.random.default_rng(1)
    b = rng.random((height, width, 3), dtype=np.float32)
    return b * (1 + 1e-4 * rng.standard_normal(b.shape, dtype=np.float32)), b


def contenders(height: int, width: int) -> dict[str, Callable[[], Seconds]]:
    """compare_pair: the public comparison, from two pictures to classes, E_n, percentiles and verdict; planes in fresh memory.
    kernel: the same without what Python does, its planes in memory that was used before. ImageBufAlgo.compare: mean, rms,
    peak and two counts of the same pictures."""
    a, b = pictures(height, width)
    left = RenderedImage("laboratory", a, Uncertainty(rel=2e-4))
    right = RenderedImage("reference", b, Uncertainty())
    difference, normalised_error = np.empty_like(a), np.empty_like(a)

    def kernel() -> object:
        return _compare.compare(a, b, rel_a=2e-4, en_edges=EN_EDGES, difference=difference, normalised_error=normalised_error)

    tool_left, tool_right = oiio.ImageBuf(a), oiio.ImageBuf(b)
    return {
        "compare_pair": lambda: timed(lambda: compare_pair(left, right, None)),
        "kernel": lambda: timed(kernel),
        "ImageBufAlgo.compare": lambda: timed(lambda: oiio.ImageBufAlgo.compare(tool_left, tool_right, 1e-3, 1e-3)),
    }


def measure() -> Measured:
    """Pairs of float32 pictures in memory, film by film; `compare_vs_oiio` is of 1080p, wall over wall, the whole public
    comparison."""
    films, lines, ratios = {}, [], {}
    for height, width in FILMS:
        times = interleaved(contenders(height, width), ROUNDS)
        megapixels = height * width / 1e6
        wall = {name: [one.wall for one in found] for name, found in times.items()}
        cpu = {name: [one.cpu for one in found] for name, found in times.items()}
        against = ratio(wall["compare_pair"], wall["ImageBufAlgo.compare"])
        films[f"{width}x{height}"] = {"megapixels": megapixels, "wall_s": wall, "cpu_s": cpu, "compare_vs_oiio": against}
        best = ", ".join(
            f"{name} {1e3 * min(wall[name]) / megapixels:.1f} (CPU {1e3 * min(cpu[name]) / megapixels:.1f})" for name in times
        )
        lines.append(f"{width}×{height}, ms per megapixel, best of {ROUNDS}: {best}; ratio {against['median']:.2f}")
        if (height, width) == FULL_HD:
            ratios["compare_vs_oiio"] = against["median"]
    return Measured("compare", ratios=ratios, numbers={"films": films}, lines=lines)
