"""The picture that is displaced by so many pixels, or by half a one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from equilux_scenes.case import Case
from equilux_tracer.causes.rule import Applied, Evidence, Floats, Group, Rule, Vector
from equilux_tracer.tracer import Tracer

_SNAP_PX = 2e-3
"""An estimate this near to a multiple of 1/4 pixel is that."""


class Shifted(Rule):
    """The picture is displaced: what belongs at film position (x, y) is seen at (x + dx, y + dy), dx to the right, dy downwards.

    Half a pixel comes from sampling a pixel's corner in place of its centre (`i` for `i+½`: the picture moves by +½), whole ones
    from counting from 1, from borders and from headers. Readings differ only in what comes in from beyond the border.
    """

    id = "shifted"
    group: ClassVar[Group] = "image"
    suspects = "translation"
    formula = ("pixel (i, j) shows film position (i+½, j+½)", "pixel (i, j) shows film position (i+½−dx, j+½−dy)")
    parameter = Vector(names=("dx", "dy"), unit="px", step=0.25, neutral=(0.0, 0.0))
    readings: ClassVar[Mapping[str, str]] = {
        "": "the scene goes on beyond the film's borders",
        "wrapped": "what leaves the film comes in on its other side",
        "repeated": "the border's pixels are repeated",
        "mirrored": "the picture is mirrored at its border",
        "black": "black comes in",
        "background": "the scene's background comes in",
        "kept": "what was there stays: the unmoved picture comes in",
    }

    def hypotheses(self, case: Case) -> Sequence[Applied]:
        return [Applied(self.id)]

    def estimates(self, hypothesis: Applied, evidence: Evidence) -> Sequence[Applied]:
        """By phase correlation to whole pixels, from there by least squares through the tracer; near multiples of ¼ these. Of
        whole pixels also the reading that the border speaks for."""
        tracer = Tracer(evidence.case)
        found: dict[tuple[float, float], None] = {}
        for whole in _blank_border(evidence.picture, evidence.truth):
            found[float(whole[0]), float(whole[1])] = None
        for start in _correlated(evidence.picture, evidence.truth):
            dx, dy = _refined(tracer, evidence, start)
            near = round(dx * 4) / 4, round(dy * 4) / 4
            if not (abs(near[0] - dx) < _SNAP_PX and abs(near[1] - dy) < _SNAP_PX):
                found[dx, dy] = None
            found[near] = None
            found[float(start[0]), float(start[1])] = None
        found.pop((0.0, 0.0), None)
        ranked = sorted(found, key=lambda shift: _robust(_residual(tracer, evidence, shift)))
        result = []
        for shift in ranked[:2]:
            reading = self._reading_at_the_border(tracer, evidence, shift)
            result += [Applied(self.id, shift, reading)] + ([Applied(self.id, shift)] if reading else [])
        return result

    def _reading_at_the_border(self, tracer: Tracer, evidence: Evidence, shift: tuple[float, float]) -> str:
        film = evidence.case.scene.film
        if shift != (round(shift[0]), round(shift[1])):
            return ""
        rows, columns = np.mgrid[0 : film.height, 0 : film.width]
        film_xy = np.stack([columns.ravel(), rows.ravel()], axis=1) + 0.5
        border = np.flatnonzero(_beyond(film_xy - np.asarray(shift), evidence.case))
        border = border[:: len(border) // 1000 + 1]
        if not len(border):
            return ""
        asked, shown = film_xy[border], np.asarray(evidence.picture, np.float64).reshape(-1, 3)[border]

        def misfit(reading: str) -> float:
            applied = Applied(self.id, shift, reading)
            looked_at = self.change_film(asked, evidence.case, applied)
            seen = self.change_radiance(tracer.evaluate(looked_at)["radiance"], asked, evidence.case, applied)
            return float(np.nan_to_num(np.abs(shown - seen), nan=1e30).mean())

        return min(self.readings, key=misfit)

    def change_film(self, film_xy: Floats, case: Case, applied: Applied) -> Floats:
        moved = film_xy - _shift(applied)
        size = np.array([case.scene.film.width, case.scene.film.height], dtype=np.float64)
        match applied.reading:
            case "wrapped":
                return np.mod(moved, size)
            case "repeated":
                return np.clip(moved, 0.5, size - 0.5)
            case "mirrored":
                return size - np.abs(size - np.mod(moved, 2 * size))
            case "kept":
                return np.where(_beyond(moved, case)[:, None], film_xy, moved)
            case _:
                return moved

    def change_radiance(self, radiance: Floats, film_xy: Floats, case: Case, applied: Applied) -> Floats:
        if applied.reading not in ("black", "background"):
            return radiance
        environment = case.scene.environment
        background = case.scene.background if environment is None else environment.radiance
        coming_in = np.zeros(3) if applied.reading == "black" else np.asarray(background)
        return np.where(_beyond(film_xy - _shift(applied), case)[:, None], coming_in, radiance)


def _shift(applied: Applied) -> Floats:
    return np.asarray(applied.parameter if isinstance(applied.parameter, tuple) else (0.0, 0.0), dtype=np.float64)


def _beyond(film_xy: Floats, case: Case) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    x, y = film_xy.T
    return np.asarray((x < 0) | (y < 0) | (x > case.scene.film.width) | (y > case.scene.film.height))


def _correlated(picture: np.ndarray, truth: Floats) -> list[tuple[int, int]]:
    """The likeliest displacements in whole pixels, (dx, dy): peaks of the plain and of the whitened correlation."""
    height, width = truth.shape[:2]
    seen, model = (np.nan_to_num(np.asarray(image, np.float64)).sum(axis=2) for image in (picture, truth))
    if seen.shape != model.shape:
        return []
    if not np.ptp(seen) or not np.ptp(model):
        return []
    spectrum = np.fft.rfft2(seen - seen.mean()) * np.conj(np.fft.rfft2(model - model.mean()))
    result: dict[tuple[int, int], None] = {}
    size = np.abs(spectrum)
    for whitened in (spectrum / np.maximum(size, 1e-9 * size.max()), spectrum):
        correlation = np.fft.irfft2(whitened, s=(height, width))
        dy, dx = divmod(int(np.argmax(correlation)), width)
        result[(dx + width // 2) % width - width // 2, (dy + height // 2) % height - height // 2] = None
    return list(result)


def _blank_border(picture: npt.NDArray[np.floating], truth: Floats) -> list[tuple[int, int]]:
    """The displacement that columns and rows of one value along the border speak for, where the model has them not: all there is
    to see of a picture that is uniform otherwise."""

    if picture.shape != truth.shape:
        return []
    seen, model = (np.nan_to_num(np.asarray(image, np.float64)).sum(axis=2) for image in (picture, truth))

    def blank(lines: Floats, true: Floats) -> int:
        same = (
            (np.ptp(lines, axis=1) == 0) & (lines[:, 0] == lines[0, 0]) & ~np.isclose(lines, true, rtol=1e-6, atol=0).all(axis=1)
        )
        return int(np.argmin(same)) if not same.all() else 0

    dx = blank(seen.T, model.T) - blank(seen.T[::-1], model.T[::-1])
    dy = blank(seen, model) - blank(seen[::-1], model[::-1])
    return [(dx, dy)] if dx or dy else []


def _residual(tracer: Tracer, evidence: Evidence, shift: tuple[float, float]) -> Floats:
    """(n, 3): measured − model, in units of B; only of pixels whose place on the true film lies on the film."""
    places = evidence.film_xy - np.asarray(shift)
    inside = ~_beyond(places, evidence.case)
    seen = tracer.evaluate(places[inside])["radiance"]
    result: Floats = (evidence.measured[inside] - seen) / np.maximum(evidence.bound[inside], 1e-300)
    return result


def _refined(tracer: Tracer, evidence: Evidence, start: tuple[float, float]) -> tuple[float, float]:
    """Gauss–Newton from a start in whole pixels; pixels that do not follow (borders, other faults) do not count."""
    step = 1e-3
    best = np.asarray(start, dtype=np.float64)
    # the start may be half a pixel off in either way, and the picture is smooth only between edges: try the halves, too
    grid = [best + np.array([a, b]) / 2 for a in (-1, 0, 1) for b in (-1, 0, 1)]
    best = min(grid, key=lambda shift: _robust(_residual(tracer, evidence, (shift[0], shift[1]))))
    for _ in range(6):
        places = evidence.film_xy - best
        here, right, down = (
            tracer.evaluate(places - offset)["radiance"].ravel()
            for offset in (np.zeros(2), np.array([step, 0]), np.array([0, step]))
        )
        scale = 1 / np.maximum(evidence.bound.ravel(), 1e-300)
        slopes = np.stack([(right - here) / step, (down - here) / step], axis=1) * scale[:, None]
        rest = (evidence.measured.ravel() - here) * scale
        usable = np.isfinite(rest) & slopes.any(axis=1)
        if usable.sum() < 4:
            break
        keep = usable & (np.abs(rest) <= 4 * np.median(np.abs(rest[usable])) + 1)
        change = np.linalg.lstsq(slopes[keep], rest[keep], rcond=1e-9)[0]
        best = best + np.clip(change, -0.5, 0.5)
        if np.abs(change).max() < 1e-9:
            break
    return float(best[0]), float(best[1])


def _robust(residual: Floats) -> float:
    """Logarithms: what is off altogether counts little more than what is off a bit."""
    return float(np.mean(np.log1p(np.nan_to_num(np.abs(residual), nan=1e30)))) if residual.size else np.inf
