"""Into how many triangles, and in which style, a renderer divides curved shapes: found by trying on some of the pixels."""

from __future__ import annotations

import time
import weakref
from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import product
from typing import Literal

import numpy as np
import numpy.typing as npt

from equilux_scenes.case import Case
from equilux_scenes.model import Cylinder, Disc, Object, Sphere
from equilux_tracer.causes.changed import ChangedTracer
from equilux_tracer.causes.rule import Applied, Evidence, Floats, Rule
from equilux_tracer.causes.tessellation import Style

TYPICAL = (4, 5, 6, 8, 10, 12, 16, 20, 24, 30, 32, 36, 40, 48, 64, 96, 100, 128, 180, 200, 256)
COMMON = (32, 16, 64, 24, 8, 48, 12, 20, 128)
CUTS = (0, 1, 2, 3, 4, 5)
MOST_PIXELS = 120
MOST_SECONDS = 3.0
"""Of the processor, for scenes that take long to trace."""
MOST_TRIANGLES = 500_000
"""In all trials together: about a second's work; each counts 500 more for what does not depend on them."""
FOUND = 0.01
"""A trial that is wrong on no greater share of the pixels is the right one."""
KEPT = 0.2
"""Of an object that stayed curved, no greater share of the pixels diverges: by shadows and reflections of others."""
WINDOW = 5.0
"""How far the picture's change may be from the plainest style's: other styles make a few times as much of it, or as little."""


Normals = Literal["exact", "averaged", "averaged over edges", "flat"]


def best_tessellations(rule: Rule, prefix: str, normals: Sequence[Normals], evidence: Evidence) -> list[Applied]:
    """The two likeliest styles, with the number of segments; none where what diverges is elsewhere.

    What changes in a picture goes like n^-2 (normals interpolated) or n^-1 (face normals): the plainest style tells about which
    n to look at; then likely styles are tried there with typical numbers, others with common ones, and those that come nearest
    with all numbers. prefix: before a style's name in the reading; normals: those that the rule allows, the plainest first.
    """
    return [_applied(rule, prefix, style, count) for style, count in _remembered(rule, prefix, tuple(normals), evidence)]


_last: tuple[weakref.ref[Evidence], list[tuple[Style, int]]] | None = None


def _remembered(rule: Rule, prefix: str, normals: tuple[Normals, ...], evidence: Evidence) -> list[tuple[Style, int]]:
    """Flat triangles make one picture, whichever rule asks, unless there are smooth meshes that one of the rules facets, too."""
    global _last
    if normals != ("flat",) or any(mesh.vertex_normals is not None for mesh in evidence.case.meshes.values()):
        return _styles_found(rule, prefix, normals, evidence)
    last = _last
    if last is None or last[0]() is not evidence:
        last = (weakref.ref(evidence), _styles_found(rule, prefix, normals, evidence))
        _last = last
    return last[1]


def _styles_found(rule: Rule, prefix: str, normals: tuple[Normals, ...], evidence: Evidence) -> list[tuple[Style, int]]:
    objects = evidence.case.scene.objects
    curved = [index for index, obj in enumerate(objects) if isinstance(obj, Sphere | Cylinder | Disc)]
    seen = evidence.model["object_id"][evidence.diverging]
    if not len(seen) or np.isin(seen, curved).mean() < 0.02:
        return []
    trials = _Trials(rule, prefix, evidence)
    plain = Style(normals=normals[0])
    low, high = trials.window(plain)
    if not trials.promising(0.1):
        return []
    typical = sorted((n for n in TYPICAL if low <= n <= high), key=lambda n: COMMON.index(n) if n in COMMON else len(COMMON))
    common = [count for count in typical if count in COMMON] or typical[:3]
    likely, others = styles_worth_trying([objects[index] for index in curved], normals)
    # number by number, so that the likely ones are all tried before much has been spent on many triangles
    for styles, counts in ((likely, typical), (others, common)):
        for style in styles:
            trials.of_all(style, CUTS if style.rows == "icosphere" else ())
        for count in counts:
            for style in styles:
                trials.of_all(style, () if style.rows == "icosphere" else [count])
        if not trials.promising(0.5):
            return []
    between = [count for count in range(low, high + 1) if count <= 40 or count % 4 == 0 or count % 10 == 0]
    for style, _ in trials.best(2, by_style=True):
        trials.of_all(style, () if style.rows == "icosphere" else between)
    for style, best in trials.best(3):
        trials.of_all(replace(style, other_diagonals=not style.other_diagonals), [best])
    return trials.best(2)


def _applied(rule: Rule, prefix: str, style: Style, count: int) -> Applied:
    return Applied(rule.id, count, ", ".join(part for part in (prefix, style.name) if part))


def styles_worth_trying(shapes: Sequence[Object], normals: Sequence[Normals]) -> tuple[list[Style], list[Style]]:
    """Those that differ on these shapes: what libraries make by default, and the rest. The other diagonals are tried last, of
    the best."""
    kinds = {shape.kind for shape in shapes}
    rounds = [shape for shape in shapes if isinstance(shape, Cylinder | Disc)]
    plain = Style(normals=normals[0])
    balls = [replace(plain, rows=rows, axis=axis) for rows, axis in product(_ROWS, _AXES)] if "sphere" in kinds else [plain]
    likely = [style for style in balls if style.rows in ("n/2", "n", "icosphere") and style.axis != "x"]
    others = [style for style in balls if style not in likely]
    if rounds:
        slanted = any(np.count_nonzero(_axis(shape)) > 1 for shape in rounds)
        turns = [replace(plain, start=start, turn=turn) for start, turn in product(_STARTS if slanted else ("x",), _TURNS)]
        others += [replace(turned, axis=axis) for axis in (_AXES[:2] if "sphere" in kinds else ("y",)) for turned in turns]
    for left_out, kept in ((("disc",), {"sphere", "cylinder"}), (("disc", "cylinder"), {"sphere"})):
        if kinds & kept and kinds & set(left_out) and not (len(left_out) > 1 and "cylinder" not in kinds):
            likely += [replace(style, left_out=left_out) for style in likely if not style.left_out]
    more = [each for each in normals[1:] if each != "averaged over edges" or "cylinder" in kinds]
    others += [replace(style, normals=each) for each in more for style in likely]
    return list(dict.fromkeys(likely)), [style for style in dict.fromkeys(others) if style not in likely]


_ROWS: tuple[Literal["n/2", "n", "icosphere", "n-1", "n/2-1"], ...] = ("n/2", "n", "icosphere", "n-1", "n/2-1")
_AXES: tuple[Literal["y", "z", "x"], ...] = ("y", "z", "x")
_STARTS: tuple[Literal["across", "y", "z", "x"], ...] = ("across", "y", "z", "x")
_TURNS: tuple[Literal["", "quarter", "half a step"], ...] = ("", "quarter", "half a step")


def _axis(shape: Cylinder | Disc) -> Floats:
    return np.subtract(shape.top, shape.base) if isinstance(shape, Cylinder) else np.asarray(shape.normal)


class _Trials:
    """How far each hypothesis is off, on a few pixels. Stops when one is right, or too much was tried."""

    def __init__(self, rule: Rule, prefix: str, evidence: Evidence) -> None:
        self._rule, self._prefix = rule, prefix
        self._case: Case = evidence.case
        diverging = np.flatnonzero(evidence.diverging)
        diverging = diverging[:: len(diverging) // MOST_PIXELS + 1]
        width = self._case.scene.film.width
        near_xy = _agreeing_nearby(evidence, diverging)
        near = (near_xy[:, 1].astype(int) * width) + near_xy[:, 0].astype(int)
        largest_bound = np.full((len(near), 3), evidence.bound.max())
        kept = _kept_round(evidence)
        self._film_xy = np.ascontiguousarray(np.concatenate([evidence.film_xy[diverging], near_xy, evidence.film_xy[kept]]))
        picture = np.asarray(evidence.picture, np.float64).reshape(-1, 3)
        self._measured = np.concatenate([evidence.measured[diverging], picture[near], evidence.measured[kept]])
        bound = np.concatenate([evidence.bound[diverging], largest_bound, evidence.bound[kept]])
        self._bound = np.maximum(bound, 1e-300)
        model = evidence.model["radiance"]
        self._model = np.concatenate([model[diverging], evidence.truth.reshape(-1, 3)[near], model[kept]])
        self._parts = np.repeat([0, 1, 2], [len(diverging), len(near), len(kept)])
        self._off: dict[tuple[Style, int], float] = {}
        self._found = False
        self._left = MOST_TRIANGLES
        self._end = time.thread_time() + MOST_SECONDS

    def window(self, style: Style) -> tuple[int, int]:
        """The least and the largest number of segments that change the picture about as much as it is changed."""
        wanted = self._change(self._measured)
        near = []
        for count in TYPICAL:
            ratio = self._try(style, count) / max(wanted, 1e-300)
            if 1 / WINDOW <= ratio <= WINDOW:
                near.append(count)
            if ratio < 1 / WINDOW or self._found:
                break
        if not near:
            return TYPICAL[0], TYPICAL[-1]
        first, last = TYPICAL.index(near[0]), TYPICAL.index(near[-1])
        return TYPICAL[max(first - 1, 0)], TYPICAL[min(last + 1, len(TYPICAL) - 1)]

    def promising(self, gain: float) -> bool:
        """Whether the best comes nearer than the unchanged model, by this much of the mean logarithm. Measured: right numbers in
        wrong styles gain 1 and more, most other faults less than 0.1 of the plainest style and 0.3 of the likely ones.
        """
        unchanged = np.mean(np.log1p((np.abs(self._measured - self._model) / self._bound).max(axis=1)))
        return min(self._off.values()) <= float(unchanged) - gain

    def of_all(self, style: Style, counts: Iterable[int]) -> None:
        """Try these numbers of segments."""
        for count in counts:
            if (style, count) not in self._off and not self._found and self._left > 0 and time.thread_time() < self._end:
                self._try(style, count)

    def best(self, number: int, *, by_style: bool = False) -> list[tuple[Style, int]]:
        """Those that are least off; by_style: of each style only its best."""
        ranked = sorted(self._off, key=self._off.__getitem__)
        if by_style:
            ranked = list({style: (style, count) for style, count in reversed(ranked)}.values())
            ranked.sort(key=self._off.__getitem__)
        return ranked[:number]

    def _try(self, style: Style, count: int) -> float:
        """How much the picture changes."""
        tracer = ChangedTracer(self._case, [_applied(self._rule, self._prefix, style, count)], {self._rule.id: self._rule})
        made = (mesh for index, mesh in tracer.changed_case.meshes.items() if index not in self._case.meshes)
        self._left -= 500 + sum(len(mesh.faces) for mesh in made)
        shown = tracer.evaluate(self._film_xy)["radiance"]
        off = np.nan_to_num((np.abs(self._measured - shown) / self._bound).max(axis=1), nan=1e9)
        self._off[style, count] = float(np.mean(np.log1p(off)))
        wrong = off > 1
        self._found = self._found or all(wrong[self._parts == part].mean() <= FOUND for part in set(self._parts.tolist()))
        return self._change(shown)

    def _change(self, shown: Floats) -> float:
        """Off silhouettes, where a pixel changes altogether or not at all: the lower quartile of what changes where it should."""
        change = np.abs(shown - self._model)[self._parts == 0].max(axis=1)
        return float(np.quantile(change[change > 0], 0.25)) if (change > 0).any() else 0.0


def _kept_round(evidence: Evidence) -> npt.NDArray[np.intp]:
    """Pixels that agree, on curved objects of which (almost) none diverges: those were left as they are."""
    objects = evidence.case.scene.objects
    curved = [index for index, obj in enumerate(objects) if isinstance(obj, Sphere | Cylinder | Disc)]
    seen = np.asarray(evidence.model["object_id"])
    kept = [index for index in curved if (seen == index).any() and evidence.diverging[seen == index].mean() < KEPT]
    pixels = np.flatnonzero(np.isin(seen, kept) & ~evidence.diverging)
    return pixels[:: len(pixels) // (MOST_PIXELS // 3) + 1]


def _agreeing_nearby(evidence: Evidence, diverging: npt.NDArray[np.intp]) -> Floats:
    """(m, 2): centres of pixels next to diverging ones that do agree: inside a polygon's circle they speak against too few
    segments, outside against too large ones."""
    height, width = evidence.truth.shape[:2]
    agrees = (np.abs(np.asarray(evidence.picture) - evidence.truth) <= evidence.bound.max()).all(axis=2)
    around = evidence.film_xy[diverging][:, None] + np.array([[2, 0], [-2, 0], [0, 2], [0, -2], [5, 5], [-5, -5]])
    around = around.reshape(-1, 2)
    inside = around[((around > 0) & (around < [width, height])).all(axis=1)]
    chosen = np.unique(inside[agrees[inside[:, 1].astype(int), inside[:, 0].astype(int)]], axis=0)
    return np.asarray(chosen[:: len(chosen) // (MOST_PIXELS // 3) + 1], dtype=np.float64)
