"""The kernel against the plain way of computing the same, and at the places where arithmetic is awkward."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from equilux import _compare
from equilux.compare import EN_EDGES
from support.plain_comparison import order_statistic, plain_comparison

NAN, INF = float("nan"), float("inf")


def kernel(a: npt.NDArray[Any], b: npt.NDArray[Any], **options: Any) -> dict[str, Any]:
    """All outputs of the kernel, the planes among them."""
    difference, normalised_error = np.empty(a.shape, np.float32), np.empty(a.shape, np.float32)
    scores = _compare.compare(a, b, en_edges=EN_EDGES, difference=difference, normalised_error=normalised_error, **options)
    return {**scores, "difference": difference, "normalised_error": normalised_error}


def one_value(value: float, dtype: type = np.float64) -> npt.NDArray[Any]:
    """A picture of one pixel whose middle band has the value."""
    image = np.zeros((1, 1, 3), dtype)
    image[0, 0, 1] = value
    return image


AWKWARD = [0.0, -0.0, 1.0, 1e-30, 1e30, -1e-9, -1.0, 2.0**-149, 3.4e38, NAN, INF, -INF]


@st.composite
def images(draw: st.DrawFn) -> dict[str, Any]:
    """Two images of some size and type, mostly sane, with bounds, a mask of edges, and some awkward values strewn in."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    height, width = draw(st.integers(1, 40)), draw(st.integers(1, 90))
    scale = draw(st.sampled_from([1.0, 1e-30, 1e30, 1e-3]))
    shape = (height, width, 3)
    truth = scale * rng.random(shape) * (rng.random(shape) < 0.7)
    spread = draw(st.sampled_from([0.0, 1e-3, 1.0]))
    pair = []
    for image in (truth + spread * 1e-3 * scale * rng.standard_normal(shape), truth):
        stored = np.abs(image).astype(draw(st.sampled_from([np.float32, np.float64])))
        strewn = rng.random(shape) < draw(st.sampled_from([0.0, 0.02]))
        stored[strewn] = rng.choice(AWKWARD, int(strewn.sum())).astype(np.float32)
        pair.append(stored)
    return {
        "a": pair[0],
        "b": pair[1],
        "abs": [scale * draw(st.sampled_from([0.0, 1e-4])) for _ in range(2)],
        "rel": [draw(st.sampled_from([0.0, 2.0**-11])) for _ in range(2)],
        "per_pixel": [(scale * 1e-3 * rng.random(shape)).astype(np.float32) if draw(st.booleans()) else None for _ in range(2)],
        "edge": (rng.random((height, width)) < 0.2) if draw(st.booleans()) else None,
    }


@settings(max_examples=150, deadline=None)
@given(images())
def test_kernel_equals_plain_numpy(given_: dict[str, Any]) -> None:
    a, b, edge = given_["a"], given_["b"], given_["edge"]
    (abs_a, abs_b), (rel_a, rel_b), (map_a, map_b) = given_["abs"], given_["rel"], given_["per_pixel"]
    bounds = [
        abs_ + rel * np.abs(np.where(np.isfinite(image), image.astype(np.float64), 0.0)) + (0 if per_pixel is None else per_pixel)
        for image, abs_, rel, per_pixel in ((a, abs_a, rel_a, map_a), (b, abs_b, rel_b, map_b))
    ]
    expected = plain_comparison(a, b, bounds[0], bounds[1], edge=edge)
    got = kernel(
        a, b, abs_a=abs_a, rel_a=rel_a, per_pixel_a=map_a, abs_b=abs_b, rel_b=rel_b, per_pixel_b=map_b,
        edge=None if edge is None else edge.astype(np.uint8),
    )  # fmt: skip

    np.testing.assert_array_equal(got["classes"], expected["classes"])
    assert [got[name] for name in ("agree", "diverge", "edge", "invalid")] == np.bincount(
        expected["classes"].ravel(), minlength=4
    ).tolist()
    with np.errstate(over="ignore"):
        np.testing.assert_array_equal(got["difference"], expected["difference"].astype(np.float32))
        np.testing.assert_allclose(got["normalised_error"], expected["en"].astype(np.float32), rtol=2.0**-23)
    exact = (
        "scored_values", "edge_max_abs", "max_abs", "max_rel", "p50", "p95", "p99", "en_max", "worst_pixel", "farthest_pixel",
    )  # fmt: skip
    for name in exact:
        if name in expected:
            assert got[name] == expected[name], f"{name}: kernel {got[name]!r}, plain {expected[name]!r}"
    if expected["scored_values"]:
        # Both round: |error| ≤ n u Σ|x| bounds any order of summation (Higham 2002, 4.2).
        values = expected["scored_values"]
        scored = np.isin(expected["classes"], (0, 1))
        total = float(np.abs(expected["difference"][scored]).sum())
        assert abs(got["sum"] - expected["sum"]) <= 2 * values * 2.0**-53 * total
        assert got["sum_of_squares"] == pytest.approx(expected["sum_of_squares"], rel=2 * (values + 2) * 2.0**-53, abs=1e-300)
        errors = np.abs(expected["en"][scored]).ravel()
        counts = np.histogram(np.minimum(errors, EN_EDGES[-1]), bins=[-1.0, *np.nextafter(EN_EDGES[1:-1], INF), INF])[0]
        assert got["en_counts"] == counts.tolist()


def test_result_does_not_depend_on_the_number_of_threads() -> None:
    rng = np.random.default_rng(5)
    b = rng.random((200, 301, 3))
    a = (b + 1e-3 * rng.standard_normal(b.shape)).astype(np.float32)
    a[7, 9, 1], a[150, 2, 0] = NAN, -5.0
    one, *others = [kernel(a, b, abs_a=1e-3, threads=threads) for threads in (1, 2, 3, 16)]
    for other in others:
        for name, value in one.items():
            np.testing.assert_array_equal(value, other[name], err_msg=name)


@pytest.mark.parametrize("bound", [1e-3, 1.0, 0.1, 3e-7, 1e30, 1e-30, 1.7e-300])
def test_difference_of_exactly_b_agrees_and_one_ulp_more_diverges(bound: float) -> None:
    for side, sign in (("a", 1), ("b", -1)):
        for magnitude, expected in ((bound, 0), (np.nextafter(bound, 0), 0), (np.nextafter(bound, INF), 1)):
            values = {"a": one_value(0.0), "b": one_value(0.0), side: one_value(float(magnitude))}
            got = kernel(values["a"], values["b"], abs_a=bound)
            assert got["classes"].item() == expected, f"|a − b| {magnitude!r}, B {bound!r}: class {got['classes'].item()}"
            en = got["normalised_error"][0, 0, 1]
            assert (abs(en) <= 1) == (expected == 0), f"E_n {en!r} of class {expected}"
            assert np.sign(en) == sign, f"E_n {en} of {side} = {magnitude}"
            assert got["en_counts"][EN_EDGES.index(1.0)] == expected


def test_equal_values_without_uncertainty_agree_and_different_ones_are_infinitely_apart() -> None:
    same = kernel(one_value(0.25), one_value(0.25))
    assert (same["agree"], same["en_max"], same["normalised_error"].tolist()) == (1, 0.0, [[[0.0, 0.0, 0.0]]])
    for a, b, en in ((0.5, 0.25, INF), (0.25, 0.5, -INF)):
        apart = kernel(one_value(a), one_value(b))
        assert (apart["diverge"], apart["en_infinite"], apart["worst_pixel"]) == (1, 1, 0)
        assert apart["normalised_error"][0, 0, 1] == en
        assert apart["en_counts"][-1] == 1


@pytest.mark.parametrize(
    ("value", "kind"), [(NAN, "nan"), (INF, "+inf"), (-INF, "-inf"), (-1e-3, "negative"), (-3e30, "negative")]
)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_values_that_are_no_radiance_are_invalid_on_either_side_and_on_both(value: float, kind: str, dtype: type) -> None:
    bad, good = one_value(value, dtype), one_value(0.5, dtype)
    for a, b, sides in ((bad, good, "a"), (good, bad, "b"), (bad, bad, "ab")):
        got = kernel(a, b, abs_a=1e-4, abs_b=1e-4)
        assert got["invalid"] == 1, f"{kind} on {sides}: {got['invalid']} invalid"
        for side in "ab":
            expected = {name: int(side in sides and name == kind) for name in ("nan", "+inf", "-inf", "negative")}
            assert got[f"invalid_{side}"] == expected
        assert (got["scored_values"], got["worst_pixel"], got["farthest_pixel"], got["first_invalid"]) == (0, -1, -1, 0)


def test_opposite_infinities_are_invalid() -> None:
    got = kernel(one_value(INF), one_value(-INF), abs_a=1e30)
    assert (got["invalid"], got["invalid_a"]["+inf"], got["invalid_b"]["-inf"]) == (1, 1, 1)


def test_a_value_negative_by_no_more_than_its_own_bound_is_judged_like_any_other() -> None:
    at_bound = kernel(one_value(-1e-3), one_value(0.0), abs_a=1e-3)
    assert at_bound["agree"] == 1
    beyond = kernel(one_value(float(np.nextafter(-1e-3, -1))), one_value(0.0), abs_a=1e-3)
    assert (beyond["invalid"], beyond["invalid_a"]["negative"]) == (1, 1)
    # The other side's bound does not make a negative radiance believable.
    others = kernel(one_value(-1e-4), one_value(0.0), abs_b=1e-3)
    assert (others["invalid"], others["invalid_a"]["negative"]) == (1, 1)


def test_bounds_are_relative_to_each_sides_own_radiance() -> None:
    a, b = one_value(1.0), one_value(2.0)
    assert kernel(a, b, rel_a=0.75)["diverge"] == 1  # B = 0.75
    assert kernel(a, b, rel_b=0.5)["agree"] == 1  # B = 1
    assert kernel(a, b, rel_a=0.5, rel_b=0.25)["agree"] == 1


def test_sampled_terms_add_in_quadrature_times_the_coverage_factor() -> None:
    sigma_a, sigma_b = np.full((1, 1, 3), 3e-3, np.float32), np.full((1, 1, 3), 4e-3, np.float32)
    expected = 2 * np.hypot(np.float64(sigma_a[0, 0, 0]), np.float64(sigma_b[0, 0, 0]))  # k = 2
    for factor, diverging in ((1 - 1e-12, 0), (1 + 1e-12, 1)):
        got = kernel(one_value(factor * expected), one_value(0.0), sigma_a=sigma_a, sigma_b=sigma_b, coverage_factor=2.0)
        assert got["diverge"] == diverging, f"|a − b| = {factor} B"


def test_one_bad_band_makes_the_pixel_bad() -> None:
    b = np.ones((1, 3, 3))
    a = b.copy()
    a[0, 1, 2] = 1.5
    a[0, 2, 0] = NAN
    a[0, 2, 1] = 1.5
    assert kernel(a, b, abs_a=0.1)["classes"].tolist() == [[0, 1, 3]]


def test_edges_excuse_divergence_only() -> None:
    b = np.ones((1, 3, 3))
    a = b.copy()
    a[0, 0, 0], a[0, 1, 0], a[0, 2, 0] = 1.5, 1.0, NAN
    got = kernel(a, b, abs_a=0.1, edge=np.ones((1, 3), np.uint8))
    assert got["classes"].tolist() == [[2, 0, 3]]
    assert (got["edge_max_abs"], got["max_abs"], got["scored_values"]) == (0.5, 0.0, 3)


def test_worst_pixel_is_by_normalised_error_and_the_first_of_equals() -> None:
    b = np.zeros((9, 9, 3))
    a = b.copy()
    bounds = np.full(b.shape, 1.0, np.float32)
    a[2, 3, 1], a[4, 4, 0], a[6, 1, 2] = 0.5, 0.5, 0.7
    bounds[6, 1, 2] = 100.0
    got = kernel(a, b, per_pixel_a=bounds)
    assert divmod(got["worst_pixel"], 9) == (2, 3)
    assert divmod(got["farthest_pixel"], 9) == (6, 1)


def test_percentiles_are_order_statistics_even_of_a_million_equal_differences() -> None:
    rng = np.random.default_rng(3)
    b = rng.random((400, 400, 3)).astype(np.float32)
    for a in (b + np.float32(0.25), b, np.where(rng.random(b.shape) < 0.4, b, b * np.float32(1.001))):
        got = kernel(a, b)
        magnitude = np.abs(a.astype(np.float64) - b)
        for percent in (50, 95, 99):
            expected = order_statistic(magnitude, percent)
            assert got[f"p{percent}"] == expected, f"p{percent}: kernel {got[f'p{percent}']!r}, plain {expected!r}"


def test_percentiles_are_exact_where_most_differences_share_their_leading_bits() -> None:
    """Sixteen bits at a time are told apart: of equal values, of values that differ in the last bits, of denormal ones."""
    rng = np.random.default_rng(4)
    b = np.zeros((150, 200, 3))
    for step in (0.25, 2.0**-52, 2.0**-1074):
        base = 1.0 if step == 2.0**-52 else 0.0
        a = base + step * rng.integers(0, 5, b.shape) * (rng.random(b.shape) < 0.8)
        got = kernel(a, b)
        for percent in (50, 95, 99):
            expected = order_statistic(np.abs(a - b), percent)
            assert got[f"p{percent}"] == expected, f"step {step}: p{percent}: kernel {got[f'p{percent}']!r}, plain {expected!r}"


@settings(max_examples=60, deadline=None)
@given(images())
def test_the_quick_way_and_the_careful_way_give_the_same_bits(given_: dict[str, Any]) -> None:
    """Where anything was sampled every block is scored with care; a standard deviation of zero adds nothing to B."""
    options = {f"{name}_{side}": given_[name][index] for name in ("abs", "rel", "per_pixel") for index, side in enumerate("ab")}
    tall = [np.concatenate([given_[side]] * 3, axis=0) for side in "ab"]  # several blocks, awkward and plain ones
    for side in "ab":
        if options[f"per_pixel_{side}"] is not None:
            options[f"per_pixel_{side}"] = np.concatenate([options[f"per_pixel_{side}"]] * 3, axis=0)
    quick = kernel(*tall, **options)
    careful = kernel(*tall, **options, sigma_a=np.zeros(tall[0].shape, np.float32), coverage_factor=5.0)
    for name, value in careful.items():
        np.testing.assert_array_equal(quick[name], value, err_msg=name)


def test_sums_keep_to_their_error_bound_where_adding_up_in_order_does_not() -> None:
    a, b = np.full((1024, 512, 3), 0.1), np.zeros((1024, 512, 3))
    got, exact = kernel(a, b)["sum"], math.fsum(a.ravel())
    allowed = (32 + math.log2(a.size)) * 2.0**-53 * exact  # 24 values per lane, 8 lanes, then halving (Higham 2002, 4.2)
    assert abs(got - exact) <= allowed, f"Σ(a − b): kernel {got!r}, exact {exact!r}"
    in_order = float(np.cumsum(a.ravel())[-1])
    assert abs(in_order - exact) > allowed, "the test does not tell the two apart"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"abs_a": -1.0}, "finite and not negative"),
        ({"rel_b": NAN}, "finite and not negative"),
        ({"abs_b": INF}, "finite and not negative"),
        ({"coverage_factor": NAN}, "coverage factor"),
        ({"per_pixel_a": np.full((1, 1, 3), NAN, np.float32)}, "negative, NaN or infinite"),
        ({"per_pixel_b": np.full((1, 1, 3), INF, np.float32)}, "negative, NaN or infinite"),
        ({"per_pixel_b": np.full((1, 1, 3), -1.0, np.float32)}, "negative, NaN or infinite"),
        ({"per_pixel_b": np.zeros((1, 2, 3), np.float32)}, "size of the image"),
        ({"sigma_a": np.zeros((2, 1, 3), np.float32)}, "size of the image"),
        ({"edge": np.zeros((2, 1), np.uint8)}, "size of the image"),
    ],
)
def test_an_uncertainty_that_is_none_is_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        kernel(one_value(0.5), one_value(0.5), **options)


def test_images_of_different_size_or_type_are_refused() -> None:
    with pytest.raises(ValueError, match="same size"):
        _compare.compare(np.zeros((2, 3, 3)), np.zeros((3, 2, 3)), en_edges=EN_EDGES)
    with pytest.raises(ValueError, match="float32 or float64"):
        _compare.compare(np.zeros((2, 3, 3), np.int32), np.zeros((2, 3, 3)), en_edges=EN_EDGES)
    with pytest.raises(ValueError, match="height, width, 3"):
        _compare.compare(np.zeros((2, 3, 4)), np.zeros((2, 3, 4)), en_edges=EN_EDGES)
    with pytest.raises(ValueError, match="at least one pixel"):
        _compare.compare(np.zeros((0, 3, 3)), np.zeros((0, 3, 3)), en_edges=EN_EDGES)


def test_bins_closer_than_the_kernel_can_tell_are_refused() -> None:
    with pytest.raises(ValueError, match="ascend by an eighth"):
        _compare.compare(one_value(1.0), one_value(1.0), en_edges=[0.0, 1.0, 1.1, 2.0])
