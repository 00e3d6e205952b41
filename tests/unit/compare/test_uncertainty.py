"""From budgets to uncertainties: what adds, what is propagated, what is refused, and how often chance alone raises an alarm."""

from __future__ import annotations

import json
import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from equilux.budget import Bound, Budget, Geometric, Sampled
from equilux.compare import RenderedImage, compare_pair
from equilux.uncertainty import FALSE_ALARM_RATE, Uncertainty, coverage_factor, stated, student_quantile

SHAPE = (6, 8, 3)
RNG = np.random.default_rng(17)
IMAGE = RNG.random(SHAPE)


class FakeTracer:
    """Answers with what it was asked, so that a test can see it."""

    def __init__(self, objects: int = 3, factor: float = 1.0, shape: tuple[int, ...] = SHAPE) -> None:
        self.case = SimpleNamespace(scene=SimpleNamespace(objects=[None] * objects))
        self.asked: list[tuple[Any, Any]] = []
        self.answer = np.full(shape, factor)

    def sensitivity(self, normal: Any, position_m: Any) -> npt.NDArray[np.float64]:
        self.asked.append((normal, position_m))
        return self.answer * (np.max(normal) + np.max(position_m))


def test_bounds_add() -> None:
    varying = RNG.random(SHAPE)
    uncertainty = stated(
        Budget((Bound("one", "", abs=1e-3, rel=0.01), Bound("two", "", abs=2e-3), Bound("map", "", abs=varying))), IMAGE
    )
    assert uncertainty.abs == pytest.approx(3e-3, rel=1e-15)
    assert uncertainty.rel == 0.01
    np.testing.assert_allclose(uncertainty.bound(IMAGE), 3e-3 + 0.01 * IMAGE + varying, rtol=1e-6)


def test_an_empty_budget_of_doubles_is_exact() -> None:
    uncertainty = stated(Budget(), IMAGE)
    assert uncertainty == Uncertainty()


def test_storage_in_float32_is_stated_once() -> None:
    stored = IMAGE.astype(np.float32)
    uncertainty = stated(Budget(), stored)
    assert (uncertainty.rel, uncertainty.abs) == (2.0**-24, 2.0**-150)
    assert [term["name"] for term in uncertainty.terms] == ["storage"]
    assert stated(Budget((Bound("storage", "the adapter's own", rel=2.0**-20),)), stored).rel == 2.0**-20
    assert stated(Budget(), IMAGE).rel == 0


@pytest.mark.parametrize("scale", [1.0, 1e-38, 3e-44, 1e30])
def test_the_bound_of_storage_covers_rounding_to_float32(scale: float) -> None:
    exact = scale * np.concatenate([RNG.random(20000), 2.0 ** RNG.uniform(-1, 1, 9999), [1 + 2.0**-24]]).reshape(100, 100, 3)
    stored = exact.astype(np.float32)
    error, bound = np.abs(stored - exact), stated(Budget(), stored).bound(stored)
    worst = np.unravel_index(np.argmax(error / bound), error.shape)
    assert error[worst] <= bound[worst], f"error {error[worst]}, bound {bound[worst]}"
    assert error[worst] > bound[worst] / 2, "the bound is not approached by the effect it bounds"


def test_geometric_terms_add_object_by_object_and_are_propagated_together() -> None:
    tracer = FakeTracer()
    budget = Budget(
        (
            Geometric("facets", "", normal={0: 0.1, 2: 0.3}, film_px=0.02),
            Geometric("float32 vertices", "", normal=0.01, position_m={1: 2.0}, film_px=0.03),
        )
    )
    uncertainty = stated(budget, IMAGE, tracer)
    ((normal, position),) = tracer.asked
    np.testing.assert_allclose(normal, [0.11, 0.01, 0.31])
    np.testing.assert_allclose(position, [0.0, 2.0, 0.0])
    assert uncertainty.film_px == 0.05
    np.testing.assert_allclose(uncertainty.bound(IMAGE), 2.31, rtol=1e-6)


def test_a_geometric_number_holds_for_all_objects() -> None:
    tracer = FakeTracer()
    stated(Budget((Geometric("all", "", normal=0.1),)), IMAGE, tracer)
    assert tracer.asked == [(0.1, 0.0)]


def test_a_displaced_film_alone_needs_no_tracer() -> None:
    uncertainty = stated(Budget((Geometric("raster", "", film_px=1 / 512),)), IMAGE, None)
    assert (uncertainty.film_px, uncertainty.obstacle, uncertainty.per_pixel) == (1 / 512, None, None)


def test_a_render_that_does_not_fit_the_film_cannot_be_propagated() -> None:
    uncertainty = stated(Budget((Geometric("all", "", normal=0.1),)), IMAGE, FakeTracer(shape=(2, 2, 3)))
    assert uncertainty.obstacle == "the render is 8×6 pixels, the scene's film is 2×2"


@pytest.mark.parametrize(
    ("term", "message"),
    [
        (Bound("x", "", abs=-1.0), "term 'x': abs -1.0, allowed finite and ≥ 0"),
        (Bound("x", "", rel=math.nan), "term 'x': rel nan, allowed finite and ≥ 0"),
        (Bound("x", "", abs=np.full(SHAPE, math.inf)), "term 'x': abs inf, allowed finite and ≥ 0"),
        (Bound("x", "", abs=np.zeros((1, 3))), r"term 'x': abs of shape \(1, 3\), allowed \(6, 8, 3\)"),
        (Geometric("x", "", normal={0: -0.5}), "term 'x': normal -0.5, allowed finite and ≥ 0"),
        (Geometric("x", "", film_px=math.inf), "term 'x': film_px inf, allowed finite and ≥ 0"),
        (Geometric("x", "", normal={7: 0.5}), "names object 7, the scene has 3 objects"),
        (Sampled("x", "", np.zeros((6, 8)), 40), r"term 'x': sigma of shape \(6, 8\), allowed \(6, 8, 3\)"),
        (Sampled("x", "", np.zeros(SHAPE), 0), "term 'x': 0 repeats, allowed ≥ 1"),
        (Bound("x", "", abs=np.full(SHAPE, 1e39)), r"1e\+39 W/\(m²·sr\), allowed at most"),
    ],
)
def test_a_term_that_is_none_is_refused_by_name(term: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        stated(Budget((term,)), IMAGE, FakeTracer())


def test_maps_are_rounded_up_and_survive_a_round_trip_bit_by_bit(tmp_path: Path) -> None:
    exact = RNG.random(SHAPE) * 10.0 ** RNG.uniform(-50, 30, SHAPE)
    exact[0, 0, 0] = 0.0
    budget = Budget((Bound("map", "why", abs=exact), Bound("flat", "", abs=1e-3, rel=1e-4), Sampled("noise", "", exact, 50)))
    uncertainty = stated(budget, IMAGE)
    assert uncertainty.per_pixel is not None
    below = uncertainty.per_pixel.astype(np.float64) < exact
    assert not below.any(), f"{exact[below][:1]} was rounded to {uncertainty.per_pixel[below][:1]}"
    np.testing.assert_array_less(uncertainty.per_pixel, exact * (1 + 2.0**-22) + 2.0**-148)
    assert uncertainty.save_maps(tmp_path / "uncertainty.exr")
    saved = json.loads(json.dumps(uncertainty.to_json(), allow_nan=False))
    loaded = Uncertainty.from_json(saved, tmp_path / "uncertainty.exr")
    np.testing.assert_array_equal(loaded.per_pixel, uncertainty.per_pixel)
    np.testing.assert_array_equal(loaded.sigma, uncertainty.sigma)
    assert loaded.to_json() == uncertainty.to_json()
    assert {key: saved[key] for key in ("abs", "rel", "film_px", "degrees_of_freedom")} == {
        "abs": 1e-3, "rel": 1e-4, "film_px": 0.0, "degrees_of_freedom": 49,
    }  # fmt: skip


def test_an_uncertainty_without_maps_leaves_no_file_and_a_missing_one_is_an_error(tmp_path: Path) -> None:
    path = tmp_path / "uncertainty.exr"
    path.write_bytes(b"of an earlier run")
    flat = stated(Budget((Bound("flat", "", abs=1e-3),)), IMAGE)
    assert not flat.save_maps(path)
    assert not path.exists()
    assert Uncertainty.from_json(flat.to_json(), path) == flat
    varying = stated(Budget((Bound("map", "", abs=IMAGE),)), IMAGE)
    with pytest.raises(OSError, match="cannot be read"):
        Uncertainty.from_json(varying.to_json(), path)
    with pytest.raises(OSError, match="no file of maps"):
        Uncertainty.from_json(varying.to_json())


def test_sigma_is_pooled_over_its_neighbourhood() -> None:
    sigma = np.zeros(SHAPE)
    sigma[2, 3, 1], sigma[5, 7, 0] = 4.0, 2.0
    pooled = stated(Budget((Sampled("noise", "", sigma, 40),)), IMAGE).sigma
    expected = np.zeros(SHAPE)
    expected[1:4, 2:5, 1], expected[4:, 6:, 0] = 4.0, 2.0
    np.testing.assert_array_equal(pooled, expected)


def test_variances_of_independent_terms_add_and_the_fewest_repeats_count() -> None:
    terms = (Sampled("light", "", np.full(SHAPE, 3.0), 40), Sampled("lens", "", np.full(SHAPE, 4.0), 100))
    uncertainty = stated(Budget(terms), IMAGE)
    np.testing.assert_allclose(uncertainty.sigma, 5.0)
    assert uncertainty.degrees_of_freedom == 39


@pytest.mark.parametrize(
    ("upper_tail", "degrees_of_freedom", "expected"),
    [
        (0.025, 10, 2.2281388519649385),  # Abramowitz & Stegun table 26.10: 2.228
        (0.0005, 40, 3.550965761),  # likewise: 3.551
        (1e-14, 1, 1 / math.tan(math.pi * 1e-14)),  # ν = 1: Cauchy's distribution
        (0.3, 1, 1 / math.tan(math.pi * 0.3)),
        (1e-9, 2, (1 - 2e-9) / math.sqrt(2e-9 * (1 - 1e-9))),  # ν = 2: t = (1 − 2p)/√(2 p (1 − p))
        (0.4, 2, 0.2 / math.sqrt(0.8 * 0.6)),
        (0.5, 31, 0.0),
    ],
)
def test_students_quantile_equals_closed_forms_and_tables(upper_tail: float, degrees_of_freedom: int, expected: float) -> None:
    got = student_quantile(upper_tail, degrees_of_freedom)
    assert got == pytest.approx(expected, rel=1e-9), f"t {got!r}, expected {expected!r}"


def test_students_quantile_tends_to_the_normal_distributions() -> None:
    from statistics import NormalDist

    assert student_quantile(1e-6, 10**7) == pytest.approx(-NormalDist().inv_cdf(1e-6), rel=1e-5)


@pytest.mark.parametrize(("upper_tail", "degrees_of_freedom"), [(0.0, 31), (0.6, 31), (math.nan, 31), (0.1, 0)])
def test_students_quantile_refuses_what_is_no_probability(upper_tail: float, degrees_of_freedom: int) -> None:
    with pytest.raises(ValueError, match="Student's quantile"):
        student_quantile(upper_tail, degrees_of_freedom)


def sampled(adapter: str, truth: npt.NDArray[Any], repeats: int, rng: np.random.Generator) -> RenderedImage:
    """The mean of `repeats` noisy renders of the truth, with the σ of that mean."""
    noise = rng.standard_normal((repeats, *truth.shape)) * 0.1
    sigma = noise.std(axis=0, ddof=1) / math.sqrt(repeats)
    return RenderedImage(adapter, truth + noise.mean(axis=0), stated(Budget((Sampled("noise", "", sigma, repeats),)), truth))


def test_the_coverage_factor_is_two_sided_over_all_bands_of_the_pair() -> None:
    a = sampled("mc", 1 + IMAGE, 40, RNG)
    b = sampled("pt", 1 + IMAGE, 64, RNG)
    exact = stated(Budget(), IMAGE)
    assert coverage_factor(exact, exact, 1000) == 0.0
    assert coverage_factor(a.uncertainty, exact, 1000) == student_quantile(FALSE_ALARM_RATE / 2000, 39)
    assert coverage_factor(b.uncertainty, a.uncertainty, 1000) == student_quantile(FALSE_ALARM_RATE / 2000, 39)


def test_chance_alone_raises_an_alarm_as_often_as_the_level_allows(monkeypatch: pytest.MonkeyPatch) -> None:
    """At 5 % per band instead of 1e-6 per pair, so that there is something to count; pixel by pixel, so that nothing is pooled.

    Of n bands, x ~ binomial(n, 0.05) diverge when one side is sampled; five standard deviations of √(n 0.05 0.95) are allowed.
    """
    bands, level = 3 * 1500, 0.05
    monkeypatch.setattr("equilux.uncertainty.FALSE_ALARM_RATE", level * 3)
    rng = np.random.default_rng(23)
    truth = RenderedImage("oracle", np.ones((1, 1, 3)), stated(Budget(), np.ones((1, 1, 3))))
    outside = {"one": 0, "both": 0}
    for _ in range(bands // 3):
        a, b = (sampled(name, np.ones((1, 1, 3)), 32, rng) for name in ("mc", "pt"))
        for sides, other in (("one", truth), ("both", b)):
            pair = compare_pair(a, other, None)
            outside[sides] += sum(abs(float(pair.planes[f"en.{band}"][0, 0])) > 1 for band in "RGB")
    spread = 5 * math.sqrt(bands * level * (1 - level))
    expected = f"of {bands} bands, expected {bands * level} ± {spread:.0f}"
    assert abs(outside["one"] - bands * level) <= spread, f"{outside['one']} {expected}"
    assert outside["both"] <= bands * level + spread, f"{outside['both']} {expected}"
    assert outside["both"] > bands * level / 2, f"{outside['both']} {expected}: the factor for two sampled sides is far too large"


def test_no_alarm_is_raised_by_chance_in_a_picture_and_a_shift_of_the_mean_is_found() -> None:
    rng = np.random.default_rng(29)
    truth = RenderedImage("oracle", 1 + RNG.random((40, 50, 3)), Uncertainty())
    noisy = sampled("mc", truth.image, 32, rng)
    assert compare_pair(noisy, truth, None).json["verdict"] == "agree"
    k = compare_pair(noisy, truth, None).json["coverage_factor"]
    assert 9 < k < 14, f"k = {k}: for 6000 bands at ν = 31"
    shifted = RenderedImage("mc", noisy.image + 3 * k * 0.1 / math.sqrt(32), noisy.uncertainty)
    assert compare_pair(shifted, truth, None).json["diverge"] > 1900
