"""What breaks, from the picture: a renderer's values beside the truth's on the pixels that are wrong.

Every kind counts pixels. NaN and the infinities are counted by kind and enter nothing else; a picture has one main symptom, the
most telling of those that cover most of the wrong pixels.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

Kind = Literal[
    "nan", "inf", "negative", "black", "vanishes", "leak", "acne", "saturates", "quantised", "scaled", "outline",
    "bright", "dark", "wrong",
]  # fmt: skip
KINDS: tuple[Kind, ...] = (
    "nan", "inf", "negative", "black", "vanishes", "leak", "acne", "saturates", "quantised", "scaled", "outline",
    "bright", "dark", "wrong",
)  # fmt: skip

WORDS: dict[Kind, str] = {
    "nan": "shows NaN",
    "inf": "shows Inf",
    "negative": "shows negative radiance",
    "black": "is black where something should be",
    "vanishes": "shows the background where something should be",
    "leak": "shows what lies beside or behind it",
    "acne": "is wrong on scattered pixels within a surface",
    "saturates": "stops at a ceiling",
    "quantised": "has only a few levels left",
    "scaled": "is wrong by one factor",
    "outline": "has outlines in the wrong place",
    "bright": "is too bright",
    "dark": "is too dark",
    "wrong": "is wrong",
}

MOST = 0.9
"""Share of the wrong pixels that a symptom must cover to be the main one."""
SAME = 1e-3
"""Relative difference below which two radiances are the same colour, a factor the same factor. Symptoms are words about pictures
that have already been found wrong; nothing is judged by it."""
FEWEST = 8
"""Wrong pixels below which nothing can be said of how they are spread or how many levels they have."""
FEW_COLOURS = 16
"""Different colours of a picture up to which a wrong one can be told to be another surface's."""
SCATTERED = 0.5
"""Of how wrong pixels cluster (0 as by chance, 1 all together): below this they are scattered."""


@dataclass(frozen=True)
class Symptom:
    """kind: the main symptom. pixels: how many are wrong, of `of`. counts: pixels by kind (a pixel may count for several).
    factor: of `scaled`; ceiling: of `saturates`, W/(m²·sr)."""

    kind: Kind
    pixels: int
    of: int
    counts: dict[Kind, int] = field(default_factory=dict)
    factor: float | None = None
    ceiling: float | None = None

    @property
    def words(self) -> str:
        text = WORDS[self.kind]
        if self.factor is not None:
            text += f" ({self.factor:.6g})"
        if self.ceiling is not None:
            text += f" ({self.ceiling:.6g} W/(m²·sr))"
        return f"{text}: {self.pixels} of {self.of} pixels"


def symptom(picture: npt.NDArray[Any], truth: npt.NDArray[Any], wrong: Mask, background: npt.NDArray[Any]) -> Symptom | None:
    """What breaks on the `wrong` pixels, None where there are none.

    picture, truth: (h, w, 3) radiance; wrong: (h, w); background: (3,) radiance of rays that miss.
    """
    if not wrong.any():
        return None
    a, b = picture.astype(np.float64), truth.astype(np.float64)
    finite = np.isfinite(a).all(axis=2) & np.isfinite(b).all(axis=2)
    masks: dict[Kind, Mask] = {
        "nan": np.asarray(np.isnan(a).any(axis=2)),
        "inf": np.asarray(np.isinf(a).any(axis=2)),
    }
    usable = wrong & finite
    numbers: dict[str, float] = {}
    masks |= _of_values(a, b, usable, np.asarray(background, np.float64), numbers)
    masks |= _of_places(b, usable)
    counts = {kind: int(masks[kind].sum()) for kind in KINDS if kind in masks and masks[kind].any()}
    main = _main(counts, int(wrong.sum()), int(usable.sum()))
    return Symptom(
        main, int(wrong.sum()), wrong.size, counts, numbers.get("factor") if main == "scaled" else None,
        numbers.get("ceiling") if main == "saturates" else None,
    )  # fmt: skip


def _main(counts: dict[Kind, int], wrong: int, usable: int) -> Kind:
    """Not-a-numbers come first however few; then the first kind that covers most of what is wrong."""
    for kind in ("nan", "inf"):
        if counts.get(kind):
            return kind
    order: tuple[Kind, ...] = (
        "negative",
        "black",
        "vanishes",
        "saturates",
        "scaled",
        "quantised",
        "leak",
        "outline",
        "acne",
        "bright",
        "dark",
    )
    return next((kind for kind in order if counts.get(kind, 0) >= MOST * usable > 0), "wrong")


def _of_values(a: Floats, b: Floats, usable: Mask, background: Floats, numbers: dict[str, float]) -> dict[Kind, Mask]:
    """Symptoms that single values show."""
    size = float(np.abs(b[usable]).max()) if usable.any() else 0.0
    with np.errstate(over="ignore", invalid="ignore"):
        is_background = (np.abs(a - background) <= SAME * np.maximum(np.abs(background), 1e-9 * size)).all(axis=2)
        truth_is_background = (np.abs(b - background) <= SAME * np.maximum(np.abs(background), 1e-9 * size)).all(axis=2)
    masks: dict[Kind, Mask] = {
        "negative": usable & (a < -SAME * size).any(axis=2),
        "black": usable & (a == 0).all(axis=2) & (b != 0).any(axis=2),
        "vanishes": usable & is_background & ~truth_is_background & (background != 0).any(),
    }
    if int(usable.sum()) >= FEWEST:
        masks["saturates"] = _saturated(a, b, usable, numbers)
        masks["scaled"] = _scaled(a, b, usable, numbers)
        masks["quantised"] = _quantised(a, b, usable)
    masks["leak"] = _of_another_surface(a, b, usable)
    masks["bright"] = usable & (a >= b).all(axis=2)
    masks["dark"] = usable & (a <= b).all(axis=2)
    return masks


def _saturated(a: Floats, b: Floats, usable: Mask, numbers: dict[str, float]) -> Mask:
    """Pixels whose brightest band stands at the ceiling of the picture, the truth beyond it."""
    ceiling = float(a[usable].max())
    brightest = a.max(axis=2)
    at = usable & (brightest >= (1 - SAME) * ceiling) & (b.max(axis=2) > (1 + SAME) * ceiling) & (ceiling > 0)
    numbers["ceiling"] = ceiling
    return np.asarray(at)


def _scaled(a: Floats, b: Floats, usable: Mask, numbers: dict[str, float]) -> Mask:
    """Pixels that are the truth times one factor."""
    values_a, values_b = a[usable], b[usable]
    lit = values_b > 0
    if not lit.any():
        return np.zeros_like(usable)
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        factor = float(np.median(values_a[lit] / values_b[lit]))
        same = (np.abs(a - factor * b) <= SAME * np.abs(factor * b)).all(axis=2)
    if not np.isfinite(factor) or factor <= 0 or abs(factor - 1) <= SAME:
        return np.zeros_like(usable)
    numbers["factor"] = factor
    return np.asarray(usable & same)


def _quantised(a: Floats, b: Floats, usable: Mask) -> Mask:
    """All wrong pixels, where they share an eighth of the levels that the truth has there, or fewer."""
    levels = max(len(np.unique(a[usable][:, band])) for band in range(3))
    true_levels = max(len(np.unique(b[usable][:, band])) for band in range(3))
    return usable if 1 < levels <= true_levels / 8 else np.zeros_like(usable)


def _of_another_surface(a: Floats, b: Floats, usable: Mask) -> Mask:
    """Pixels that show one of the few colours that the picture has elsewhere: the wall in the place of the card before it."""
    colours = np.unique(b[~usable & np.isfinite(b).all(axis=2)], axis=0)
    if not 0 < len(colours) <= FEW_COLOURS:
        return np.zeros_like(usable)
    with np.errstate(over="ignore", invalid="ignore"):
        same = np.asarray((np.abs(a[:, :, None] - colours) <= SAME * np.abs(colours)).all(axis=3))
    return np.asarray(usable & same.any(axis=2))


def _of_places(b: Floats, usable: Mask) -> dict[Kind, Mask]:
    """Symptoms that only show in how pixels lie."""
    masks: dict[Kind, Mask] = {"outline": usable & _beside_outlines(b)}
    if int(usable.sum()) >= FEWEST and clustering(usable) < SCATTERED:
        masks["acne"] = usable
    return masks


def clustering(wrong: Mask) -> float:
    """How wrong pixels keep together: (q − p)/(1 − p) with p the share of wrong pixels in the box around them and q the share of
    a wrong pixel's neighbours to the right and below that are wrong too. 0 as by chance, 1 all together."""
    rows, columns = np.flatnonzero(wrong.any(axis=1)), np.flatnonzero(wrong.any(axis=0))
    box = wrong[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    pairs = [(box[:, :-1], box[:, 1:]), (box[:-1], box[1:])]
    first = sum(int(one.sum()) for one, _ in pairs)
    both = sum(int((one & other).sum()) for one, other in pairs)
    share = float(box.mean())
    if share == 1 or first == 0:
        return 1.0
    return (both / first - share) / (1 - share)


def _beside_outlines(b: Floats) -> Mask:
    """Pixels next to one whose truth is much different: a tenth of the largest value."""
    step = 0.1 * float(np.abs(b[np.isfinite(b)]).max(initial=0.0))
    near = np.zeros(b.shape[:2], bool)
    with np.errstate(invalid="ignore", over="ignore"):
        across = np.abs(np.diff(b, axis=1)).max(axis=2) > step
        down = np.abs(np.diff(b, axis=0)).max(axis=2) > step
    near[:, :-1] |= across
    near[:, 1:] |= across
    near[:-1] |= down
    near[1:] |= down
    return near
