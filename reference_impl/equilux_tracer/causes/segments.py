"""Into how many triangles, and in which style, a renderer divides curved shapes: found by trying on some of the pixels."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from equilux_scenes.case import Case
from equilux_scenes.model import Sphere
from equilux_tracer.causes.changed import ChangedTracer
from equilux_tracer.causes.rule import Applied, Evidence, Floats, Parameter, Rule
from equilux_tracer.causes.tessellation import Style

TYPICAL = (4, 5, 6, 8, 10, 12, 16, 20, 24, 30, 32, 36, 40, 48, 64, 96, 100, 128, 180, 200, 256)
COMMON = (32, 16, 64, 24, 8, 48, 12, 20, 128)
CUTS = (0, 1, 2, 3, 4, 5)
MOST_PIXELS = 120
MOST_TRIANGLES = 500_000
"""In all trials together: about a second's work; each counts 500 more for what does not depend on them."""
FOUND = 0.05
"""A trial that is wrong on no greater share of the pixels is the right one: silhouettes may be."""
WINDOW = 4.0
"""How far the picture's change may be from the plainest style's: other styles make a few times as much of it, or as little."""


def best_tessellations(rule: Rule, styles: Mapping[str, Style], curved: Sequence[int], evidence: Evidence) -> list[Applied]:
    """The two likeliest of a rule's readings `styles`, with the number of segments; none where what diverges is elsewhere.

    What changes in a picture goes like n^-2 (normals interpolated) or n^-1 (face normals): the plainest style tells about which
    n to look at; then the main styles are tried there with typical numbers, and those that come nearest with all numbers.
    """
    seen = evidence.model["object_id"][evidence.diverging]
    if not len(seen) or np.isin(seen, curved).mean() < 0.2:
        return []
    shapes = [evidence.case.scene.objects[index] for index in curved]
    styles = _distinct(styles, any(isinstance(s, Sphere) for s in shapes), any(not isinstance(s, Sphere) for s in shapes))
    trials = _Trials(rule, evidence)
    low, high = trials.window(next(iter(styles)))
    typical = sorted((n for n in TYPICAL if low <= n <= high), key=lambda n: COMMON.index(n) if n in COMMON else len(COMMON))
    common = [count for count in COMMON if low <= count <= high]
    likely, others = _by_likelihood(styles)
    # number by number, so that the likely ones are all tried before much has been spent on many triangles
    for names, counts in ((likely, typical), (others, common or typical[:3])):
        for name in names:
            trials.of_all(name, CUTS if styles[name].rows == "icosphere" else ())
        for count in counts:
            for name in names:
                trials.of_all(name, () if styles[name].rows == "icosphere" else [count])
    between = [count for count in range(low, high + 1) if count <= 40 or count % 4 == 0 or count % 10 == 0]
    for applied in trials.best(2, by_reading=True):
        trials.of_all(applied.reading, () if styles[applied.reading].rows == "icosphere" else between)
    for applied in trials.best(3):
        other = replace(styles[applied.reading], other_diagonals=not styles[applied.reading].other_diagonals)
        for name in (name for name, each in styles.items() if each == other):
            trials.of_all(name, [applied.parameter])
    return trials.best(2)


def _by_likelihood(styles: Mapping[str, Style]) -> tuple[list[str], list[str]]:
    """What libraries make by default, and the rest; the other diagonals are tried last, of the best."""
    main = {name: style for name, style in styles.items() if not style.other_diagonals}

    def is_likely(style: Style) -> bool:
        plain = style.normals in ("exact", "flat") and style.axis != "x"
        return plain and (style.rows in ("n/2", "n") or (style.rows == "icosphere" and style.axis == "y"))

    return [name for name in main if is_likely(main[name])], [name for name in main if not is_likely(main[name])]


def _distinct(styles: Mapping[str, Style], spheres: bool, rounds: bool) -> dict[str, Style]:
    """Those that differ where there are spheres, and where there are cylinders or discs."""
    return {
        name: style
        for name, style in styles.items()
        if (spheres or (style.rows == "n/2" and style.axis == "y"))
        and (rounds or (not style.turn and style.normals != "averaged over edges"))
    }


class _Trials:
    """How far each hypothesis is off, on a few pixels. Stops when one is right, or too much was tried."""

    def __init__(self, rule: Rule, evidence: Evidence) -> None:
        self._rule = rule
        self._case: Case = evidence.case
        diverging, agreeing = np.flatnonzero(evidence.diverging), np.flatnonzero(~evidence.diverging)
        # inside a polygon's circle, what agrees speaks against too few segments
        on_objects = agreeing[evidence.model["object_id"][agreeing] >= 0]
        agreeing = on_objects if len(on_objects) else agreeing
        few = MOST_PIXELS // 3
        chosen = np.concatenate([diverging[:: len(diverging) // MOST_PIXELS + 1], agreeing[:: len(agreeing) // few + 1]])
        self._diverging = evidence.diverging[chosen]
        self._film_xy = np.ascontiguousarray(evidence.film_xy[chosen])
        self._measured = evidence.measured[chosen]
        self._bound = np.maximum(evidence.bound[chosen], 1e-300)
        self._model = evidence.model["radiance"][chosen]
        self._off: dict[Applied, float] = {}
        self._found = False
        self._left = MOST_TRIANGLES

    def window(self, reading: str) -> tuple[int, int]:
        """The least and the largest number of segments that change the picture about as much as it is changed."""
        wanted = self._change(self._measured)
        near = []
        for count in TYPICAL:
            ratio = self._try(Applied(self._rule.id, count, reading)) / max(wanted, 1e-300)
            if 1 / WINDOW <= ratio <= WINDOW:
                near.append(count)
            if ratio < 1 / WINDOW or self._found:
                break
        return (near[0], near[-1]) if near else (TYPICAL[0], TYPICAL[-1])

    def of_all(self, reading: str, counts: Iterable[Parameter]) -> None:
        """Try these numbers of segments."""
        for count in counts:
            applied = Applied(self._rule.id, count, reading)
            if applied not in self._off and not self._found and self._left > 0:
                self._try(applied)

    def best(self, number: int, *, by_reading: bool = False) -> list[Applied]:
        """Those that are least off; by_reading: of each reading only its best."""
        ranked = sorted(self._off, key=self._off.__getitem__)
        if by_reading:
            ranked = list({applied.reading: applied for applied in reversed(ranked)}.values())
            ranked.sort(key=self._off.__getitem__)
        return ranked[:number]

    def _try(self, applied: Applied) -> float:
        """How much the picture changes."""
        shown = self._shown(applied)
        off = np.nan_to_num((np.abs(self._measured - shown) / self._bound).max(axis=1), nan=1e9)
        self._off[applied] = float(np.mean(np.log1p(off)))
        wrong = off > 1
        self._found = self._found or all(
            wrong[part].mean() <= FOUND for part in (self._diverging, ~self._diverging) if part.any()
        )
        return self._change(shown)

    def _shown(self, applied: Applied) -> Floats:
        tracer = ChangedTracer(self._case, [applied], {self._rule.id: self._rule})
        made = (mesh for index, mesh in tracer.changed_case.meshes.items() if index not in self._case.meshes)
        self._left -= 500 + sum(len(mesh.faces) for mesh in made)
        shown: Floats = tracer.evaluate(self._film_xy)["radiance"]
        return shown

    def _change(self, shown: Floats) -> float:
        """Off silhouettes, where a pixel changes altogether or not at all: the lower quartile of what changes."""
        change = np.abs(shown - self._model).max(axis=1)
        return float(np.quantile(change[change > 0], 0.25)) if (change > 0).any() else 0.0
