"""Faults of a renderer that shares no code with the tracer, named by the real catalogue."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from equilux.compare import RenderedImage, compare_pair
from equilux.diagnose.diagnosis import Diagnosis
from equilux.diagnose.search import diagnose
from equilux.uncertainty import Uncertainty
from equilux_tracer import Tracer
from support import plain_phong
from support.faults import truth_of, two_balls

STATED = 1e-8
"""Relative: plain NumPy is good to 1e-11 and its worst cancellations to 1e-9."""

CASE = two_balls()
HEIGHT, WIDTH = CASE.scene.film.height, CASE.scene.film.width
Floats = Any


def picture() -> Floats:
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    film_xy = np.stack([columns.ravel() + 0.5, rows.ravel() + 0.5], axis=-1)
    return plain_phong.radiance(CASE, film_xy)[0].reshape(HEIGHT, WIDTH, 3)


def diagnosis(shown: Floats) -> Diagnosis:
    side, truth = RenderedImage("lab", shown, Uncertainty(rel=STATED, abs=1e-12)), truth_of(CASE)
    return diagnose(CASE, side, truth, compare_pair(side, truth, Tracer(CASE)), restate=None)


def shaded(term: Callable[..., Floats]) -> Callable[..., Floats]:
    """The local formula with another highlight: term(cosine, N, L, V, p)."""

    def shade(case: Any, material: Any, point: Floats, normal: Floats, to_viewer: Floats) -> Floats:
        result = np.array(material.emission) + np.array(material.ambient) * np.array(case.scene.ambient) + np.zeros_like(point)
        for light in case.scene.lights.values():
            irradiance, to_light = plain_phong.arriving(light, point)
            cosine = (normal * to_light).sum(axis=1, keepdims=True)
            highlight = np.array(material.specular) * term(cosine, normal, to_light, to_viewer, material.exponent)
            diffuse = np.where(cosine > 0, np.array(material.diffuse) * cosine, 0)
            result += irradiance * (diffuse + highlight)
        return result

    return shade


def reflected(cosine: Floats, normal: Floats, to_light: Floats, to_viewer: Floats) -> Floats:
    return np.maximum(((2 * cosine * normal - to_light) * to_viewer).sum(axis=1, keepdims=True), 1e-300)


def half_vector(cosine: Floats, normal: Floats, to_light: Floats, to_viewer: Floats, p: float) -> Floats:
    half = to_light + to_viewer
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    return np.where(cosine > 0, np.maximum((normal * half).sum(axis=1, keepdims=True), 1e-300) ** p, 0)


def with_cosine(cosine: Floats, normal: Floats, to_light: Floats, to_viewer: Floats, p: float) -> Floats:
    return np.where(cosine > 0, cosine * reflected(cosine, normal, to_light, to_viewer) ** p, 0)


def clamped_at_20(cosine: Floats, normal: Floats, to_light: Floats, to_viewer: Floats, p: float) -> Floats:
    return np.where(cosine > 0, reflected(cosine, normal, to_light, to_viewer) ** min(p, 20.0), 0)


@pytest.mark.parametrize(
    ("term", "cause", "parameter"),
    [(half_vector, "half-vector", None), (with_cosine, "highlight-cosine", None), (clamped_at_20, "exponent-clamped", 20.0)],
)
def test_another_highlight_is_named(monkeypatch: pytest.MonkeyPatch, term: Any, cause: str, parameter: Any) -> None:
    monkeypatch.setattr(plain_phong, "shade", shaded(term))
    found = diagnosis(picture())
    assert [(one.id, one.parameter) for one in found.causes] == [(cause, parameter)], found


@pytest.mark.parametrize(
    ("shown", "cause", "parameter"),
    [
        (lambda right: right[:, ::-1], "flipped-x", None),
        (lambda right: right[::-1], "flipped-y", None),
        (lambda right: right / np.pi, "scaled", 1 / np.pi),
        (lambda right: right[:, :, ::-1], "bands-swapped", "bgr"),
        (lambda right: np.minimum(right, 0.5), "clamped", 0.5),
    ],
    ids=["flipped-x", "flipped-y", "scaled", "bands-swapped", "clamped"],
)
def test_a_fault_of_the_picture_is_named(shown: Callable[[Floats], Floats], cause: str, parameter: Any) -> None:
    found = diagnosis(np.ascontiguousarray(shown(picture())))
    assert [(one.id, one.parameter) for one in found.causes] == [(cause, parameter)], found


def test_three_faults_are_named_together(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plain_phong, "shade", shaded(half_vector))
    found = diagnosis(np.ascontiguousarray(picture()[::-1] * 2))
    ids = {cause.id for cause in found.causes}
    assert found.explained == 1.0, found
    assert {"half-vector", "flipped-y", "scaled"} == ids, found
