"""Faults of where a pixel looks: flips, exchanged axes, the field of view."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np

from equilux_scenes.case import Case
from equilux_scenes.model import PerspectiveCamera
from equilux_tracer.causes.rule import Applied, Floats, Group, Rule


class _FilmRule(Rule):
    group: ClassVar[Group] = "image"
    suspects = "translation"


class FlippedX(_FilmRule):
    """The picture is mirrored left to right: its columns are written backwards, or the camera's right vector points left.

    Known from image formats and from cameras of the other handedness: POV-Ray's default `right` goes with a left-handed world.
    """

    id = "flipped-x"
    formula = ("pixel (i, j) shows film position (i+½, j+½)", "pixel (i, j) shows film position (W−i−½, j+½)")

    def hypotheses(self, case: Case) -> Sequence[Applied]:
        return [Applied(self.id)] if case.scene.film.width > 1 else []

    def change_film(self, film_xy: Floats, case: Case, applied: Applied) -> Floats:
        return np.stack([case.scene.film.width - film_xy[:, 0], film_xy[:, 1]], axis=1)


class FlippedY(_FilmRule):
    """The picture is upside down: row 0 is the bottom row, as OpenGL's and VTK's buffers have it, or `up` points down."""

    id = "flipped-y"
    formula = ("pixel (i, j) shows film position (i+½, j+½)", "pixel (i, j) shows film position (i+½, H−j−½)")

    def hypotheses(self, case: Case) -> Sequence[Applied]:
        return [Applied(self.id)] if case.scene.film.height > 1 else []

    def change_film(self, film_xy: Floats, case: Case, applied: Applied) -> Floats:
        return np.stack([film_xy[:, 0], case.scene.film.height - film_xy[:, 1]], axis=1)


class Transposed(_FilmRule):
    """Rows and columns are exchanged: an array indexed (x, y) is taken for one indexed (y, x).

    Of a picture that is not square, one of another size comes out, which is another matter; or one of the right size, whose
    numbers were filled in in the wrong order, or which was cut, filled up or stretched to fit.
    """

    id = "transposed"
    formula = ("pixel (i, j) shows film position (i+½, j+½)", "pixel (i, j) shows film position (j+½, i+½)")
    readings: ClassVar[Mapping[str, str]] = {
        "": "about the top left corner; the scene goes on where the film ends",
        "other diagonal": "about the other diagonal: (i, j) shows (H−j−½, W−i−½)",
        "about the middle": "about the middle of a film that is not square; the scene goes on where the film ends",
        "black": "about the top left corner; black where the film ends",
        "stretched": "stretched to fit: (i, j) shows ((j+½) W/H, (i+½) H/W)",
        "read by columns": "the numbers of the picture, row by row, are filled in column by column",
        "written by columns": "the numbers of the picture, column by column, are filled in row by row",
    }

    def hypotheses(self, case: Case) -> Sequence[Applied]:
        film = case.scene.film
        if film.width == 1 or film.height == 1:
            return []
        square = ("", "other diagonal")
        return [Applied(self.id, None, name) for name in self.readings if film.width != film.height or name in square]

    def change_film(self, film_xy: Floats, case: Case, applied: Applied) -> Floats:
        width, height = case.scene.film.width, case.scene.film.height
        x, y = film_xy.T
        match applied.reading:
            case "other diagonal":
                x, y = height - y, width - x
            case "about the middle":
                x, y = width / 2 + (y - height / 2), height / 2 + (x - width / 2)
            case "stretched":
                x, y = y * width / height, x * height / width
            case "read by columns":
                number = np.floor(x) * height + np.floor(y)
                x, y = number % width + x % 1, number // width + y % 1
            case "written by columns":
                number = np.floor(y) * width + np.floor(x)
                x, y = number // height + x % 1, number % height + y % 1
            case _:
                x, y = y, x
        return np.stack([x, y], axis=1)

    def change_radiance(self, radiance: Floats, film_xy: Floats, case: Case, applied: Applied) -> Floats:
        if applied.reading != "black":
            return radiance
        film = case.scene.film
        on_film = (film_xy[:, 1] < film.width) & (film_xy[:, 0] < film.height)
        return np.where(on_film[:, None], radiance, 0.0)


class FovOtherAxis(_FilmRule):
    """The field of view is applied to another axis of the film than the vertical one.

    POV-Ray's `angle` and many cameras' `fov` is the horizontal one; of orthographic cameras the width is given in place of the
    height. On a square film they are the same.
    """

    id = "fov-other-axis"
    formula = (
        "y = (1 − 2(j+½)/H) tan(fov/2),  x = (2(i+½)/W − 1) (W/H) tan(fov/2)",
        "x = (2(i+½)/W − 1) tan(fov/2),  y in proportion",
    )
    readings: ClassVar[Mapping[str, str]] = {
        "": "fov is the horizontal angle (height_m the width): everything is W/H times as large",
        "converted": "fov is converted to the horizontal angle, and that is the vertical one: everything is H/W times as large",
        "diagonal": "fov is the angle across the film's diagonal",
        "diagonal by height": "the diagonal's angle is taken as the vertical one",
        "aspect left out": "x = (2(i+½)/W − 1) tan(fov/2), y as it should be: pixels are not square",
        "aspect on the other axis": "x = (2(i+½)/W − 1) (H/W) tan(fov/2), y as it should be",
        "height by width": "x as it should be, y = (1 − 2(j+½)/H) (W/H) tan(fov/2)",
        "by degrees": "fov is the horizontal angle, the vertical one is fov H/W degrees",
        "by degrees, converted": "the vertical angle is fov W/H degrees",
    }

    def hypotheses(self, case: Case) -> Sequence[Applied]:
        if case.scene.film.width == case.scene.film.height:
            return []
        return [Applied(self.id, None, name) for name in self.readings if _zoom(case, name) is not None]

    def change_film(self, film_xy: Floats, case: Case, applied: Applied) -> Floats:
        zoom = _zoom(case, applied.reading)
        middle = np.array([case.scene.film.width, case.scene.film.height]) / 2
        return film_xy if zoom is None else middle + (film_xy - middle) * zoom


def _zoom(case: Case, reading: str) -> tuple[float, float] | None:
    """By how much farther from the middle of the film, along x and y, a pixel looks; None where the reading has no meaning."""
    film = case.scene.film
    aspect, diagonal = film.width / film.height, math.hypot(film.width, film.height) / film.height
    match reading:
        case "converted":
            return aspect, aspect
        case "diagonal":
            return 1 / diagonal, 1 / diagonal
        case "diagonal by height":
            return diagonal, diagonal
        case "aspect left out":
            return 1 / aspect, 1.0
        case "aspect on the other axis":
            return 1 / aspect**2, 1.0
        case "height by width":
            return 1.0, aspect
        case "by degrees" | "by degrees, converted":
            factor = aspect if reading == "by degrees, converted" else 1 / aspect
            return _by_degrees(case, factor)
        case _:
            return 1 / aspect, 1 / aspect


def _by_degrees(case: Case, factor: float) -> tuple[float, float] | None:
    camera = case.scene.camera
    if not isinstance(camera, PerspectiveCamera) or camera.fov_y_deg * factor >= 180:
        return None
    zoom = math.tan(math.radians(camera.fov_y_deg * factor) / 2) / math.tan(math.radians(camera.fov_y_deg) / 2)
    return zoom, zoom
