"""Pictures that are no pictures: each must diverge or be refused, never pass."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from equilux.compare import RenderedImage, compare_pair
from equilux.complaint import BadUsage
from equilux.score import score_image
from equilux.uncertainty import stated
from equilux_scenes.case import Case
from mutation.trial import ADAPTER, BUDGET, Staged, staged

Array = npt.NDArray[np.float32]


def broken_pictures(right: Array, other: Array) -> Iterator[tuple[str, Array]]:
    """What → picture, made of the right one and of another scene's."""

    def spoilt(value: float, where: Any) -> Array:
        image = right.copy()
        image[where] = value
        return image

    height, width = right.shape[:2]
    one, half = (height // 3, width // 3, 1), slice(height // 2, None)
    for name, value in (("NaN", np.nan), ("+Inf", np.inf), ("-Inf", -np.inf)):
        yield f"one {name}", spoilt(value, one)
        yield f"all {name}", np.full_like(right, value)
    yield "one negative value", spoilt(-1.0, one)
    yield "black", np.zeros_like(right)
    yield "its own mean everywhere", np.full_like(right, right.mean())
    yield "its own corner everywhere", np.broadcast_to(right[:1, :1], right.shape).copy()
    yield "lower half missing: black", spoilt(0.0, half)
    yield "lower half missing: repeated", np.concatenate([right[: height // 2], right[: height - height // 2]])
    yield "a row too few", right[:-1].copy()
    yield "a column too many", np.concatenate([right, right[:, -1:]], axis=1)
    yield "half the size", right[::2, ::2].copy()
    yield "another scene's", other if other.shape == right.shape else np.resize(other, right.shape)
    yield "negated", -right


def passed(case: Case, other: Case, folder: Path) -> tuple[int, list[str]]:
    """How many broken pictures of a case were tried, and which were let through: as arrays by the comparison, and as files by
    `equilux score`.
    """
    on, instead = staged(case), staged(other)
    right = on.right.astype(np.float32)
    tried, wrong = 0, []
    for name, image in broken_pictures(right, instead.right.astype(np.float32)):
        tried += 2
        if _compared(on, image) != "diverge":
            wrong.append(name)
        file = folder / "picture.npy"
        np.save(file, image)
        if _scored(on, file) not in ("diverge", "refused"):
            wrong.append(f"{name} (file)")
    whole = folder / "whole.npy"
    np.save(whole, right)
    assert _scored(on, whole) == "agree", "the right picture itself must pass"
    for cut in (1, 100, whole.stat().st_size // 2):
        tried += 1
        file = folder / "cut.npy"
        file.write_bytes(whole.read_bytes()[:-cut])
        if _scored(on, file) != "refused":
            wrong.append(f"file cut short by {cut} bytes")
    return tried, wrong


def _compared(on: Staged, image: Array) -> str:
    return str(compare_pair(RenderedImage(ADAPTER, image, stated(BUDGET, image)), on.truth, on.tracer).json["verdict"])


def _scored(on: Staged, file: Path) -> str:
    try:
        return str(score_image(on.case, file, abs_=1e-8, rel=1e-7, truth=on.truth, tracer=on.tracer).json["verdict"])
    except BadUsage:
        return "refused"
