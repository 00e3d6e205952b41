"""The few hundred pixels on which hypotheses are tried: of everything that is seen, wrong and right, something."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from equilux.compare import AGREE, DIVERGE, PairResult, RenderedImage, pair_bound
from equilux_scenes.case import Case
from equilux_tracer import Tracer
from equilux_tracer.causes import Evidence

Floats = npt.NDArray[np.float64]
Pixels = npt.NDArray[np.intp]

DIVERGING, AGREEING = 280, 120
"""How many pixels of either kind are tried on. A cause that concerns one in a hundred of the diverging pixels is then still
seen in two or three of them, and more where these pixels are a stratum of their own."""
SLOW_S = 100e-6
"""Above this much per position (integrals over many emitters) a third of the pixels must do."""
POOL = 2400
"""Pixels whose terms are looked at before the sample is drawn from them."""

MODEL_CHANNELS = (
    "radiance", "emission", "ambient", "light_ambient", "diffuse", "specular", "reflected", "transmitted", "object_id", "normal",
    "position",
)  # fmt: skip
TERMS = ("emission", "ambient", "light_ambient", "diffuse", "specular", "reflected", "transmitted")


@dataclass(frozen=True)
class Sample:
    """pixels: (n,) row-major indices; evidence: what is seen there; seconds_per_position: what one costs."""

    pixels: Pixels
    evidence: Evidence
    seconds_per_position: float

    @property
    def film_xy(self) -> Floats:
        return np.asarray(self.evidence.film_xy)

    @property
    def diverging(self) -> npt.NDArray[np.bool_]:
        return self.evidence.diverging


def centres(pixels: Pixels, width: int) -> Floats:
    """(n, 2): film positions of pixels' centres."""
    return np.stack([pixels % width + 0.5, pixels // width + 0.5], axis=-1)


def gather(case: Case, side: RenderedImage, truth: RenderedImage, scored: PairResult, model: Tracer) -> Sample | None:
    """None where no pixel diverges that has a value. The result does not depend on chance."""
    width = side.image.shape[1]
    classes = scored.planes["class"].reshape(-1)
    finite = np.isfinite(side.image).all(axis=2).reshape(-1)
    diverging, agreeing = np.flatnonzero((classes == DIVERGE) & finite), np.flatnonzero((classes == AGREE) & finite)
    if not len(diverging):
        return None
    error = np.max([np.abs(scored.planes["en." + band].reshape(-1)) for band in "RGB"], axis=0)
    decade = np.floor(np.log10(np.clip(np.nan_to_num(error, nan=0.0, posinf=1e12), 1e-3, 1e12))).astype(int)
    cost = _cost(model, centres(diverging[:: max(1, len(diverging) // 16)][:16], width))
    share = 1.0 if cost < SLOW_S else 1 / 3
    pool_size = POOL if cost < SLOW_S else POOL // 6
    chosen = []
    for pixels, wanted in ((diverging, int(DIVERGING * share)), (agreeing, int(AGREEING * share))):
        if len(pixels):
            pool = _spread(pixels, width, decade, pool_size)
            terms = model.evaluate(centres(pool, width), ("object_id", *TERMS))
            strata = np.concatenate([_strata(terms), decade[pool][:, None] // 2], axis=1)
            chosen.append(np.union1d(_one_of_each(pool, strata, wanted), _extremes(pixels, error, truth, side)))
    return _sample(case, side, truth, scored, model, np.sort(np.concatenate(chosen)), cost)


def enlarged(
    sample: Sample, pixels: Pixels, side: RenderedImage, truth: RenderedImage, scored: PairResult, model: Tracer
) -> Sample:
    """The sample of these pixels, ascending, instead."""
    return _sample(sample.evidence.case, side, truth, scored, model, pixels, sample.seconds_per_position)


def _sample(
    case: Case, side: RenderedImage, truth: RenderedImage, scored: PairResult, model: Tracer, pixels: Pixels, cost: float
) -> Sample:
    film_xy = centres(pixels, side.image.shape[1])
    a, b = (np.asarray(part.image.reshape(-1, 3)[pixels], np.float64) for part in (side, truth))
    bound = pair_bound(a, b, side.uncertainty, truth.uncertainty, scored.json["coverage_factor"], pixels)
    evidence = Evidence(
        case=case, film_xy=film_xy, measured=a, bound=bound, model=model.evaluate(film_xy, MODEL_CHANNELS),
        diverging=scored.planes["class"].reshape(-1)[pixels] == DIVERGE, picture=side.image,
        truth=np.asarray(truth.image, np.float64),
    )  # fmt: skip
    return Sample(pixels, evidence, cost)


def _cost(model: Tracer, film_xy: Floats) -> float:
    """Seconds of work per position, the faster of two tries; this process's work alone, since others on the machine must not
    change the sample.
    """
    times = []
    for _ in range(2):
        started = time.thread_time()
        model.evaluate(film_xy, threads=1)
        times.append(time.thread_time() - started)
    return min(times) / len(film_xy)


def _quasi_random(pixels: Pixels, width: int) -> Pixels:
    """The same pixels in an order whose every beginning is spread evenly over the picture (the lattice of the plastic number)."""
    x, y = pixels % width, pixels // width
    key = np.modf(0.7548776662466927 * x + 0.5698402909980532 * y)[0]
    return pixels[np.lexsort((pixels, key))]


def _spread(pixels: Pixels, width: int, decade: npt.NDArray[np.int_], wanted: int) -> Pixels:
    """At most `wanted`, alike many of each decade of |E_n| as far as there are, spread over the picture."""
    if len(pixels) <= wanted:
        return _quasi_random(pixels, width)
    return _one_of_each(_quasi_random(pixels, width), decade[_quasi_random(pixels, width)][:, None], wanted)


def _one_of_each(pixels: Pixels, strata: npt.NDArray[Any], wanted: int) -> Pixels:
    """The first of each stratum, then the second of each, …, until there are `wanted`."""
    if not len(pixels):
        return pixels
    _, stratum = np.unique(strata, axis=0, return_inverse=True)
    stratum = stratum.reshape(-1)
    order = np.argsort(stratum, kind="stable")
    starts = np.flatnonzero(np.diff(stratum[order], prepend=-1))
    turn = np.empty(len(pixels), np.intp)
    turn[order] = np.arange(len(pixels)) - np.repeat(starts, np.diff(np.append(starts, len(pixels))))
    return np.asarray(pixels[np.argsort(turn, kind="stable")[:wanted]])


def _strata(terms: dict[str, npt.NDArray[Any]]) -> npt.NDArray[np.int64]:
    """(n, k): the object, and which terms of which lights are there (a highlight: more than a thousandth of the light)."""
    columns = [terms["object_id"].astype(np.int64)[:, None]]
    for name in TERMS:
        value = np.asarray(terms[name])
        present = value.max(axis=-1) > 0
        columns.append(present.reshape(len(present), -1).astype(np.int64))
        if name == "specular" and present.size:
            total = terms["diffuse"].max(axis=-1) + value.max(axis=-1)
            columns.append((value.max(axis=-1) > 1e-3 * total).reshape(len(present), -1).astype(np.int64))
    return np.concatenate(columns, axis=1)


def _extremes(pixels: Pixels, error: npt.NDArray[Any], truth: RenderedImage, side: RenderedImage) -> Pixels:
    """The worst, the brightest and the darkest of both pictures."""
    measured, true = (np.asarray(part.image.reshape(-1, 3)[pixels], np.float64).sum(axis=1) for part in (side, truth))
    found = [
        np.argmax(np.nan_to_num(error[pixels])), measured.argmax(), measured.argmin(), true.argmax(), true.argmin(),
    ]  # fmt: skip
    return np.unique(pixels[found])
