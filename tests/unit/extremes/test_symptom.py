"""What breaks is named from the pixels that are wrong, and NaN and Inf are counted by kind and never averaged."""

from __future__ import annotations

import numpy as np
import pytest

from equilux.extremes.symptom import Symptom, clustering, symptom

BLACK = np.zeros(3)
GREY = np.full(3, 0.0625)


def truth() -> np.ndarray:
    """A lit disc with a gradient before a grey background."""
    y, x = np.mgrid[0:36, 0:48]
    inside = (x - 24.3) ** 2 + (y - 17.1) ** 2 < 12**2
    shade = 0.2 + 0.02 * x[..., None] + 0.005 * y[..., None] * np.array([1.0, 1.1, 1.3])
    return np.where(inside[..., None], shade, GREY)


def seen(picture: np.ndarray, wrong: np.ndarray | None = None, background: np.ndarray = GREY) -> Symptom:
    b = truth()
    if wrong is None:
        with np.errstate(invalid="ignore"):
            wrong = ~(np.abs(picture - b) <= 1e-9 * np.abs(b)).all(axis=2)
    found = symptom(picture, b, wrong, background)
    assert found is not None
    return found


@pytest.mark.parametrize(("value", "kind"), [(np.nan, "nan"), (np.inf, "inf"), (-np.inf, "inf")])
def test_not_a_number_is_told_first_however_few(value: float, kind: str):
    picture = 1.5 * truth()
    picture[3, 4, 1] = value
    found = seen(picture)
    assert found.kind == kind
    assert found.counts[found.kind] == 1
    assert found.counts["scaled"] == found.pixels - 1, "the pixel that is no number enters no other statistic"


def test_an_object_that_shows_the_background_vanishes():
    assert seen(np.broadcast_to(GREY, (36, 48, 3)).copy()).kind == "vanishes"


def test_black_is_told_from_the_background():
    picture = np.where(truth() > 0.1, 0.0, truth())
    assert seen(picture).kind == "black"


def test_one_factor_is_recognised():
    found = seen(truth() * np.pi)
    assert found.kind == "scaled"
    assert found.factor == pytest.approx(np.pi, rel=1e-12)
    assert "3.14159" in found.words


def test_a_ceiling_is_recognised():
    found = seen(np.minimum(truth(), 0.5))
    assert found.kind == "saturates"
    assert found.ceiling == 0.5


def test_a_few_levels_are_recognised():
    found = seen(np.round(truth() * 12) / 12 + 1e-4)
    assert found.kind == "quantised"


def test_scattered_pixels_are_acne():
    picture = truth()
    chosen = (picture[..., 0] > 0.1) & (np.random.default_rng(1).random((36, 48)) < 0.4)
    picture[chosen] *= np.random.default_rng(2).uniform(0.1, 0.9, (int(chosen.sum()), 1))
    assert seen(picture).kind == "acne"


def test_a_blob_is_not_acne():
    picture = truth()
    picture[14:20, 20:28] *= np.linspace(0.3, 0.9, 8)[None, :, None]
    assert seen(picture).kind == "dark"


def test_what_lies_behind_is_told_to_be_that():
    b = np.broadcast_to(np.array([0.9, 0.4, 0.1]), (36, 48, 3)).copy()
    a = b.copy()
    b[10:20, 12:30] = (0.1, 0.5, 0.9)
    found = symptom(a, b, (a != b).any(axis=2), GREY)
    assert found is not None
    assert found.kind == "leak"


def test_light_where_shadow_should_be_is_too_bright():
    b = truth()
    b[15:22, 18:30] *= 0.3
    found = symptom(truth(), b, (truth() != b).any(axis=2), GREY)
    assert found is not None
    assert (found.kind, found.factor) == ("scaled", pytest.approx(1 / 0.3))
    b[15:22, 18:30] *= np.linspace(0.2, 0.9, 12)[None, :, None]
    found = symptom(truth(), b, (truth() != b).any(axis=2), GREY)
    assert found is not None
    assert found.kind == "bright"


def test_negative_radiance_is_told():
    assert seen(-truth()).kind == "negative"


def test_a_displaced_outline_is_told():
    picture = np.roll(truth(), 1, axis=1)
    inside = truth()[..., 0] > 0.1
    wrong = (picture[..., 0] > 0.1) != inside
    assert seen(picture, wrong).kind == "outline"


def test_nothing_wrong_has_no_symptom():
    assert symptom(truth(), truth(), np.zeros((36, 48), bool), GREY) is None


def test_clustering_is_0_by_chance_and_1_in_one_piece():
    chance = np.random.default_rng(3).random((200, 200)) < 0.3
    assert abs(clustering(chance)) < 0.05
    blob = np.zeros((20, 20), bool)
    blob[3:9, 4:12] = True
    assert clustering(blob) == 1


@pytest.mark.parametrize("scale", [1e-44, 1e-30, 1e30, 1e37])
def test_symptoms_do_not_depend_on_the_magnitude(scale: float):
    b = truth() * scale
    found = symptom(b * 0.5, b, np.ones((36, 48), bool), GREY * scale)
    assert found is not None
    assert found.kind == "scaled"
    assert found.factor == pytest.approx(0.5)
