"""Comparing two renders of one case: classes, normalised error, statistics and verdict (comparison.md).

The normalised error E_n = (L_a − L_b)/B is that of interlaboratory comparisons (ISO 13528:2022, 9.7), |E_n| ≤ 1 agrees; but in
the place of two expanded uncertainties added in quadrature stand hard bounds, which add, and only what was sampled is squared.
"""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from equilux import _compare, edges, hdr_flip, planes, uncertainty, verdict
from equilux.trust import TRUTHS, trust_rank
from equilux.uncertainty import Uncertainty
from equilux.verdict import Judgement
from equilux.wholefile import write_json

FloatImage = npt.NDArray[np.floating]
Plane = npt.NDArray[np.float32]

EN_EDGES: tuple[float, ...] = (0.0, *(10.0 ** (i / 4) for i in range(-24, 25)), float(np.finfo(np.float64).max))
"""Bins of the histogram of |E_n|: four per decade from 1e-6 to 1e6, 1 being an edge; the first bin reaches down to 0, the
last takes ∞ too.
"""

AGREE, DIVERGE, EDGE, INVALID = range(4)
"""Values of the class plane."""


def _comparer_version() -> str:
    """Changes whenever anything does that a comparison depends on, so that no statistics of an older comparer are ever reused."""
    sha = hashlib.sha256()
    for module in (_compare, edges, hdr_flip, uncertainty, verdict):
        sha.update(Path(str(module.__file__)).read_bytes())
    sha.update(Path(__file__).read_bytes())
    return f"1+{sha.hexdigest()[:16]}"


COMPARER_VERSION = _comparer_version()


class Reference(edges.Evaluator, Protocol):
    """What a comparison asks of the reference tracer of the case."""

    def render(self) -> dict[str, npt.NDArray[Any]]:
        """"radiance": (h, w, 3)."""
        ...


@dataclass(frozen=True)
class RenderedImage:
    """One side of a pair: who rendered it, (h, w, 3) linear radiance (float32 or float64), and its uncertainty.

    truth_rank: 0 for the oracle, 1 for the reference, more for the laboratories; None: by the adapter's name.
    """

    adapter: str
    image: FloatImage
    uncertainty: Uncertainty
    truth_rank: int | None = None

    @property
    def is_truth(self) -> bool:
        rank = trust_rank(self.adapter)[0] if self.truth_rank is None else self.truth_rank
        return rank < len(TRUTHS)


@dataclass(frozen=True)
class PairResult:
    """json: the pair's fields of results.json and more (`compare_pair`). planes: float32 or uint8 (h, w) by channel name,
    empty where the images could not be laid over each other.
    """

    json: dict[str, Any]
    planes: dict[str, npt.NDArray[Any]]


def compare_pair(a: RenderedImage, b: RenderedImage, tracer: Reference | None, *, flip: bool = False) -> PairResult:
    """Compare two renders of one case; b is the more trusted one. tracer: the reference of the case; without it no pixel is
    an edge.

    The JSON holds the pair fields of results.json (contracts §3; `max_rel` and the statistics are null where no band was
    scored, `en_max` is null where it is infinite) and: "invalid_kinds" {"a", "b"} → kind → number of pixels with at least one
    such band; "en_histogram" over |E_n| of the scored bands, `counts[i]` those in (`edges[i]`, `edges[i + 1]`], the first bin
    from 0 and the last to ∞; "en_max", "en_infinite" (bands that differ although B = 0); "scored_values"; "film_delta_px";
    "coverage_factor"; "comparer". flip: compute the mean HDR-FLIP error too (needs flip-evaluator; null where it gives no
    number).

    Raises ValueError on images that are not (h, w, 3) or have no pixel, and on uncertainties that are negative or not finite.
    """
    for side in (a, b):
        if side.image.ndim != 3 or side.image.shape[2] != 3 or side.image.size == 0:
            raise ValueError(f"{side.adapter}: image of shape {side.image.shape}, allowed (height ≥ 1, width ≥ 1, 3)")
    if a.image.shape != b.image.shape:
        return _different_size(a, b)
    image_a, image_b = _kernel_image(a.image), _kernel_image(b.image)
    k = uncertainty.coverage_factor(a.uncertainty, b.uncertainty, image_a.size)
    delta = edges.film_delta_px(a.uncertainty.film_px, b.uncertainty.film_px)
    scores, difference, normalised_error = _scores(image_a, image_b, a.uncertainty, b.uncertainty, k, delta, tracer)
    out = _fields(a, b, scores, image_a, image_b)
    out |= {"film_delta_px": delta, "coverage_factor": k}
    judgement = _judge(a, b, out, tracer)
    out |= {"verdict": judgement.verdict, "reason": judgement.reason}
    if flip:
        out["flip"] = hdr_flip.mean_flip(image_a, image_b)
    return PairResult(out, _planes(difference, normalised_error, scores["classes"]))


def write_pair(case_directory: Path, result: PairResult) -> None:
    """Write `pairs/<a>--<b>.json` and `.exr` under the case's folder, each whole or not at all. Raises OSError.

    The EXR's channels: R G B the signed difference a − b, en.R en.G en.B the normalised error (NaN where a or b is not
    finite), class.
    """
    folder = case_directory / "pairs"
    folder.mkdir(parents=True, exist_ok=True)
    stem = f"{result.json['a']}--{result.json['b']}"
    image = folder / f"{stem}.exr"
    if result.planes:
        planes.write_planes(image, result.planes)
    else:
        image.unlink(missing_ok=True)
    write_json(folder / f"{stem}.json", result.json)


# --- scoring ----------------------------------------------------------------------------------------------------------


def _kernel_image(image: FloatImage) -> FloatImage:
    """What the kernel takes: native float32 or float64, C-contiguous. Anything else is widened to double, which is exact."""
    if image.dtype not in (np.dtype(np.float32), np.dtype(np.float64)):
        if not np.issubdtype(image.dtype, np.floating) or image.dtype.itemsize > 8:
            raise ValueError(f"image of {image.dtype}, allowed float32 or float64")
        image = image.astype(np.float64)
    return np.ascontiguousarray(image)


def _scores(
    image_a: FloatImage, image_b: FloatImage, stated_a: Uncertainty, stated_b: Uncertainty, k: float, delta_px: float,
    tracer: Reference | None,
) -> tuple[_compare.Scores, Plane, Plane]:
    """Scores, a − b and E_n; the scores from a second pass, with the edges excused, where there are any."""

    difference, normalised_error = np.empty(image_a.shape, np.float32), np.empty(image_a.shape, np.float32)

    def run(edge: npt.NDArray[np.uint8] | None) -> _compare.Scores:
        return _compare.compare(
            image_a, image_b, abs_a=stated_a.abs, rel_a=stated_a.rel, per_pixel_a=stated_a.per_pixel, sigma_a=stated_a.sigma,
            abs_b=stated_b.abs, rel_b=stated_b.rel, per_pixel_b=stated_b.per_pixel, sigma_b=stated_b.sigma,
            coverage_factor=k, edge=edge, en_edges=EN_EDGES, difference=difference, normalised_error=normalised_error,
        )  # fmt: skip

    scores = run(None)
    if not scores["diverge"] or tracer is None:
        return scores, difference, normalised_error
    candidates = np.flatnonzero(scores["classes"] == DIVERGE)
    a, b = (image.reshape(-1, 3)[candidates].astype(np.float64) for image in (image_a, image_b))
    bound = pair_bound(a, b, stated_a, stated_b, k, candidates)
    is_edge = edges.edge_pixels(candidates, image_a.shape[1], a, b, bound, delta_px, tracer)
    if not is_edge.any():
        return scores, difference, normalised_error
    mask = np.zeros(scores["classes"].shape, np.uint8)
    mask.reshape(-1)[candidates[is_edge]] = 1
    return run(mask), difference, normalised_error


def pair_bound(
    a: npt.NDArray[np.float64], b: npt.NDArray[np.float64], stated_a: Uncertainty, stated_b: Uncertainty, k: float,
    pixels: npt.NDArray[np.intp] | None = None,
) -> npt.NDArray[np.float64]:
    """B = Σ bounds of both + k √(σ_a² + σ_b²), for radiances a and b of shape (…, 3), or (n, 3) at the given row-major
    `pixels`.
    """
    bound = stated_a.bound(a, pixels) + stated_b.bound(b, pixels)
    variances = [
        (side.sigma if pixels is None else side.sigma.reshape(-1, 3)[pixels]).astype(np.float64) ** 2
        for side in (stated_a, stated_b)
        if side.sigma is not None
    ]
    return bound + k * np.sqrt(sum(variances)) if variances else bound


def _fields(
    a: RenderedImage, b: RenderedImage, scores: _compare.Scores, image_a: FloatImage, image_b: FloatImage
) -> dict[str, Any]:
    values = scores["scored_values"]
    pixels = image_a.shape[0] * image_a.shape[1]
    out = _blank_fields(a, b, pixels)
    out |= {name: scores[name] for name in ("agree", "diverge", "edge", "invalid")}
    out["invalid_kinds"] = {"a": scores["invalid_a"], "b": scores["invalid_b"]}
    out["scored_values"] = values
    out["en_histogram"] = {"edges": list(EN_EDGES), "counts": scores["en_counts"]}
    if scores["edge"]:
        out["edge_max_abs"] = _number(scores["edge_max_abs"])
    if values:
        out |= {name: _number(scores[name]) for name in ("max_abs", "p50", "p95", "p99", "en_max")}
        out["max_rel"] = _number(scores["max_rel"]) if scores["max_rel"] >= 0 else None
        out["bias"] = _number(scores["sum"] / values)
        out["rms"] = _number(math.sqrt(scores["sum_of_squares"] / values))
        out["en_infinite"] = scores["en_infinite"]
    # Where nothing diverges but pixels are invalid, the first of them is what to look at: |E_n| elsewhere is harmless.
    harmless = not values or (scores["invalid"] and not scores["diverge"])
    place = scores["first_invalid"] if harmless else scores["worst_pixel"]
    if place >= 0:
        out["worst"] = _pixel(place, image_a, image_b)
    if scores["farthest_pixel"] >= 0:
        out["farthest"] = _pixel(scores["farthest_pixel"], image_a, image_b)
    return out


def _blank_fields(a: RenderedImage, b: RenderedImage, pixels: int) -> dict[str, Any]:
    """All fields of a pair, nothing scored yet."""
    statistics = ("max_abs", "max_rel", "rms", "bias", "p50", "p95", "p99")
    none: dict[str, int] = {"nan": 0, "+inf": 0, "-inf": 0, "negative": 0}
    return {
        "a": a.adapter, "b": b.adapter, "verdict": None, "reason": None, "pixels": pixels,
        "agree": 0, "diverge": 0, "edge": 0, "invalid": 0,
        **dict.fromkeys(statistics), "edge_max_abs": 0.0, "flip": None, "worst": None, "farthest": None,
        "explained": None, "causes": [],
        "invalid_kinds": {"a": dict(none), "b": dict(none)}, "scored_values": 0, "en_max": None, "en_infinite": 0,
        "en_histogram": {"edges": list(EN_EDGES), "counts": [0] * (len(EN_EDGES) - 1)},
        "film_delta_px": None, "coverage_factor": 0.0, "comparer": COMPARER_VERSION,
    }  # fmt: skip


def _number(value: float) -> float | None:
    """JSON knows neither NaN nor Inf."""
    return value if math.isfinite(value) else None


def _pixel(index: int, image_a: FloatImage, image_b: FloatImage) -> dict[str, Any]:
    y, x = divmod(index, image_a.shape[1])
    return {"x": x, "y": y, "a": [_number(float(v)) for v in image_a[y, x]], "b": [_number(float(v)) for v in image_b[y, x]]}


def _planes(difference: Plane, normalised_error: Plane, classes: npt.NDArray[np.uint8]) -> dict[str, npt.NDArray[Any]]:
    out: dict[str, npt.NDArray[Any]] = {}
    for prefix, image in (("", difference), ("en.", normalised_error)):
        out |= {prefix + band: image[..., i] for i, band in enumerate("RGB")}
    return out | {"class": classes}


# --- verdict ----------------------------------------------------------------------------------------------------------


def _different_size(a: RenderedImage, b: RenderedImage) -> PairResult:
    (height_a, width_a), (height_b, width_b) = a.image.shape[:2], b.image.shape[:2]
    out = _blank_fields(a, b, height_b * width_b)
    out["verdict"] = "diverge"
    out["reason"] = f"the images differ in size: {a.adapter} is {width_a}×{height_a}, {b.adapter} is {width_b}×{height_b} pixels"
    return PairResult(out, {})


def _judge(a: RenderedImage, b: RenderedImage, fields: dict[str, Any], tracer: Reference | None) -> Judgement:
    names = {"a": a.adapter, "b": b.adapter}
    kinds, invalid, pixels = fields["invalid_kinds"], fields["invalid"], fields["pixels"]
    obstacle = "; ".join(f"{side.adapter}: {side.uncertainty.obstacle}" for side in (a, b) if side.uncertainty.obstacle)
    if obstacle:
        return verdict.of_obstacle(obstacle, invalid, pixels, kinds, names)
    judgement = verdict.of_counts(fields["diverge"], invalid, pixels, kinds, names)
    blank = None if invalid else _wrongly_constant(a, b, fields["diverge"] > 0, tracer)
    if blank is not None:
        reason = f"the image of {blank} {verdict.CONSTANT}"
        return Judgement("diverge", f"{reason}; {judgement.reason}" if judgement.reason else reason)
    return judgement


def _wrongly_constant(a: RenderedImage, b: RenderedImage, diverges: bool, tracer: Reference | None) -> str | None:
    """The adapter whose image is constant where the truth is not, if there is one: the truth is b where b may stand for it,
    else the tracer.
    """
    suspects = [side for side in (a, b) if not side.is_truth and verdict.is_constant(side.image)]
    if not suspects:
        return None
    if b.is_truth:
        truth, bound = b.image, b.uncertainty.bound(b.image)
    elif tracer is not None:
        truth = np.asarray(tracer.render()["radiance"])
        bound = np.zeros(truth.shape)
    else:
        return None
    varying = verdict.varies(truth, bound)
    for side in suspects:
        wrong = diverges or verdict.hides_variation(side.image, side.uncertainty.bound(side.image[:1, :1]), varying)
        if varying.any() and wrong:
            return side.adapter
    return None
