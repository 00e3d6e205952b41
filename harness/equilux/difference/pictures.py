"""Pictures that changed between two runs, and by how much, in radiance and in units of what both claim to know."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from equilux.casework import saved_picture
from equilux.compare import pair_bound
from equilux.difference.changes import Change
from equilux.explain.numbers import UNIT, short
from equilux.readrun import ReadRun
from equilux.tree import read_json
from equilux.uncertainty import Uncertainty, coverage_factor


@dataclass(frozen=True)
class PictureChange:
    """max_abs: largest |ΔL|, W/(m²·sr), infinite where a value is no number in one picture alone. en: largest |ΔL|/B, B what both
    renders state together. x, y: where that is."""

    max_abs: float
    en: float
    x: int
    y: int


def compare_pictures(a: ReadRun, b: ReadRun) -> Iterator[Change]:
    """Every render that is in both runs and whose picture is another one."""
    after = {case.case: case for case in b.results.cases}
    for case in a.results.cases:
        for adapter in case.renders if case.case in after else ():
            yield from _of_render(a, b, case.case, adapter)


def _of_render(a: ReadRun, b: ReadRun, case: str, adapter: str) -> Iterator[Change]:
    facts_a, facts_b = ((run.render_json(case, adapter).get("image") or {}) for run in (a, b))
    if not facts_a or not facts_b or facts_a.get("sha256") == facts_b.get("sha256") is not None:
        return
    before, after = facts_a.get("sha256"), facts_b.get("sha256")
    try:
        change = measure(a.render_folder(case, adapter), b.render_folder(case, adapter))
    except (OSError, ValueError, KeyError, TypeError) as problem:
        what = f"{adapter}: the picture changed, by how much cannot be said"
        yield Change("picture", what, True, case, adapter, before, after, " ".join(str(problem).split()), math.inf)
        return
    if change is None:  # no hash in an older tree, and the same values
        return
    where = f"at ({change.x}, {change.y})"
    if not math.isfinite(change.max_abs):
        what, detail = f"{adapter}: the picture changed, it holds values that are no numbers", where
    else:
        beyond = "beyond" if change.en > 1 else "within"
        what = f"{adapter}: the picture changed {beyond} its stated uncertainty"
        detail = f"|ΔL| at most {short(change.max_abs)} {UNIT}, {_times(change.en)} {where}"
    yield Change("picture", what, not change.en <= 1, case, adapter, before, after, detail, change.en)


def _times(en: float) -> str:
    return f"{short(en)} × the uncertainty of both" if math.isfinite(en) else "where both claim to be exact"


def measure(folder_a: Path, folder_b: Path) -> PictureChange | None:
    """How far two renders of the same case are apart; None where they are equal. Raises OSError where a picture cannot be read,
    ValueError where their size differs."""
    one, other = saved_picture(folder_a), saved_picture(folder_b)
    if one.shape != other.shape:
        sizes = " and ".join(f"{image.shape[1]}×{image.shape[0]}" for image in (one, other))
        raise ValueError(f"their sizes differ: {sizes} pixels")
    stated_a, stated_b = _stated(folder_a), _stated(folder_b)
    x, y = (image.astype(np.float64) for image in (one, other))
    with np.errstate(invalid="ignore", divide="ignore"):
        apart = np.where((x == y) | (np.isnan(x) & np.isnan(y)), 0.0, np.abs(x - y))
        apart = np.where(np.isnan(apart), np.inf, apart)
        if not apart.any():
            return None
        finite_x, finite_y = np.nan_to_num(x, posinf=0, neginf=0), np.nan_to_num(y, posinf=0, neginf=0)
        bound = pair_bound(finite_x, finite_y, stated_a, stated_b, coverage_factor(stated_a, stated_b, x.size))
        en = np.where(apart > 0, apart / bound, 0.0)
    row, column = divmod(int(np.argmax(en.max(axis=2))), en.shape[1])
    return PictureChange(float(apart.max()), float(en.max()), column, row)


def _stated(folder: Path) -> Uncertainty:
    record: dict[str, Any] = read_json(folder / "render.json") or {}
    stated = record.get("uncertainty") or {}
    return Uncertainty.from_json({"abs": 0.0, "rel": 0.0, "film_px": 0.0, "terms": [], **stated}, folder / "uncertainty.exr")
