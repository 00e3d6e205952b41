"""Thumbnails of renders and of normalised errors. They shrink without losing what matters: a single bad pixel stays visible."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import numpy as np
import numpy.typing as npt

from equilux_report import colour, png
from equilux_report.pixels import BANDS, Plane

WIDTH = 128

Floats = npt.NDArray[np.float64]


def exposure_stops(planes: Mapping[str, Plane]) -> float:
    """Stops that bring the 99.5th percentile of the lit values to white, in tenths; 0 for a picture without light."""
    values = np.concatenate([planes[band].ravel() for band in BANDS])
    lit = values[np.isfinite(values) & (values > 0)].astype(np.float64)
    if lit.size == 0:
        return 0.0
    return float(np.clip(np.round(-np.log2(np.percentile(lit, 99.5)), 1), -60, 60))


def of_render(planes: Mapping[str, Plane], stops: float) -> bytes:
    """PNG of the picture at an exposure: box-averaged in linear light; non-finite pixels keep their colour when shrunk."""
    image = np.stack([planes[band] for band in BANDS], axis=-1).astype(np.float64)
    blocks = _blocks(image)
    finite = np.isfinite(blocks)
    mean = np.where(finite, blocks, 0).sum(axis=(1, 3)) / np.maximum(finite.sum(axis=(1, 3)), 1)
    pixels = np.round(255 * colour.srgb_encode(mean * 2.0**stops)).astype(np.uint8)
    for bad, paint in (
        (blocks == -np.inf, colour.MINUS_INF_COLOUR),
        (blocks == np.inf, colour.PLUS_INF_COLOUR),
        (np.isnan(blocks), colour.NAN_COLOUR),
    ):
        pixels[bad.any(axis=(1, 3, 4))] = paint
    return png.encode(pixels)


def of_normalised_error(planes: Mapping[str, Plane]) -> bytes:
    """PNG of the signed E_n of the worst band, the worst pixel of each block. Edge pixels, which no verdict counts, stay dim."""
    en = np.stack([planes[f"en.{band}"] for band in BANDS], axis=-1).astype(np.float64)
    bad = ~np.isfinite(en) | (planes["class"] == 3)[..., None]
    edge = (planes["class"] == 2)[..., None]
    signed = np.where(bad, 0, np.where(edge, np.clip(en, -1, 1), en))
    blocks = _blocks(signed)
    count = blocks.shape[0] * blocks.shape[2]
    flat = blocks.transpose(0, 2, 1, 3, 4).reshape(count, -1)
    worst = flat[np.arange(count), np.abs(flat).argmax(axis=1)].reshape(blocks.shape[0], blocks.shape[2])
    pixels = colour.diverging_lookup(colour.heat_position(worst), _diverging()).copy()
    pixels[_blocks(bad.astype(np.float64)).any(axis=(1, 3, 4))] = colour.NAN_COLOUR
    return png.encode(pixels)


@cache
def _diverging() -> colour.Table:
    return colour.diverging()


def _blocks(image: Floats) -> Floats:
    """(h, w, c) → (rows, k, columns, k, c), k the smallest factor that makes it at most WIDTH wide; the rim is repeated."""
    height, width = image.shape[:2]
    factor = -(-width // WIDTH)
    padded = np.pad(image, ((0, -height % factor), (0, -width % factor), (0, 0)), mode="edge")
    return padded.reshape(padded.shape[0] // factor, factor, padded.shape[1] // factor, factor, image.shape[2])
