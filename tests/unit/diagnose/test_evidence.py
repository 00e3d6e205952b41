"""The sample: something of everything."""

from __future__ import annotations

import numpy as np

from equilux.diagnose.evidence import AGREEING, DIVERGING, gather
from equilux_tracer import Tracer
from equilux_tracer.causes import Applied
from support.faults import Faulty, faulty, two_balls


def sampled(wrong: Faulty) -> np.ndarray:  # type: ignore[type-arg]
    sample = gather(wrong.case, wrong.side, wrong.truth, wrong.scored, Tracer(wrong.case))
    assert sample is not None
    return sample.pixels


def test_a_sample_is_small_sorted_and_without_repetition() -> None:
    pixels = sampled(faulty(two_balls(), Applied("light-missing", "key")))
    assert len(pixels) <= DIVERGING + AGREEING + 10
    assert (np.diff(pixels) > 0).all()


def test_a_sample_does_not_depend_on_chance() -> None:
    wrong = faulty(two_balls(), Applied("scaled", 2.0))
    assert (sampled(wrong) == sampled(wrong)).all()


def test_every_object_and_every_light_are_seen() -> None:
    wrong = faulty(two_balls(), Applied("scaled", 2.0))
    sample = gather(wrong.case, wrong.side, wrong.truth, wrong.scored, Tracer(wrong.case))
    assert sample is not None
    model = sample.evidence.model
    assert set(np.unique(model["object_id"])) == {-1, 0, 1}
    assert (model["diffuse"].max(axis=(0, 2)) > 0).all()
    assert (model["specular"].max(axis=(0, 2)) > 0).all()


def test_few_wrong_pixels_are_all_looked_at() -> None:
    case = two_balls()
    picture = Tracer(case).render()["radiance"].copy()
    picture[20, 30] *= 1.5
    picture[5, 60] += 0.1
    wrong = faulty(case, picture=picture)
    assert {20 * 64 + 30, 5 * 64 + 60} <= set(sampled(wrong).tolist())
