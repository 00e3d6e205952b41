"""Comparing two renders: what diverges, what is not comparable, what the JSON and the files say."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from equilux import verdict
from equilux.budget import Bound, Budget, Geometric, Sampled
from equilux.compare import COMPARER_VERSION, EN_EDGES, PairResult, RenderedImage, compare_pair, pair_bound, write_pair
from equilux.planes import read_planes
from equilux.uncertainty import Uncertainty, coverage_factor, stated
from support.plain_comparison import plain_comparison

NAN, INF = float("nan"), float("inf")
PAIR_FIELDS = {  # contracts §3
    "a", "b", "verdict", "pixels", "agree", "diverge", "edge", "invalid", "max_abs", "max_rel", "rms", "bias", "p50", "p95",
    "p99", "edge_max_abs", "flip", "worst", "explained", "causes",
}  # fmt: skip

TRUTH = 0.2 + np.random.default_rng(11).random((12, 20, 3))


def rendered(adapter: str, image: npt.NDArray[Any], **bound: Any) -> RenderedImage:
    """A render whose budget is one bound (and float32's own, where it is float32)."""
    return RenderedImage(adapter, image, stated(Budget((Bound("test", "chosen", **bound),)), image))


def compared(image: npt.NDArray[Any], truth: npt.NDArray[Any] = TRUTH, **bound: Any) -> PairResult:
    """`image` against a truth that knows itself to 1e-12, without a tracer."""
    return compare_pair(rendered("vtk", image, **({"abs": 1e-3} | bound)), rendered("reference", truth, rel=1e-12), None)


def altered(**changes: Any) -> npt.NDArray[Any]:
    """The truth with some of its values replaced: name "y_x_band"."""
    image = TRUTH.copy()
    for place, value in changes.items():
        y, x, band = (int(part) for part in place.strip("_").split("_"))
        image[y, x, band] = value
    return image


def test_renders_within_their_uncertainty_agree() -> None:
    pair = compared(TRUTH + 0.9e-3)
    assert (pair.json["verdict"], pair.json["reason"], pair.json["agree"]) == ("agree", None, 240)


def test_one_pixel_of_many_makes_the_pair_diverge() -> None:
    truth = np.tile(TRUTH, (20, 20, 1))
    image = truth.copy()
    image[100, 200, 2] += 1.1e-3
    pair = compared(image, truth)
    assert (pair.json["verdict"], pair.json["diverge"]) == ("diverge", 1)
    assert pair.json["reason"] == "1 of 96000 pixels diverge"
    assert pair.json["worst"] == {
        "x": 200, "y": 100, "a": pytest.approx(image[100, 200].tolist()), "b": truth[100, 200].tolist(),
    }  # fmt: skip


@pytest.mark.parametrize("value", [NAN, INF, -INF, -0.5])
@pytest.mark.parametrize("sides", ["a", "b", "ab"])
def test_a_value_that_is_no_radiance_never_passes_on_either_side_nor_on_both(value: float, sides: str) -> None:
    image, truth = TRUTH.copy(), TRUTH.copy()
    for side, picture in (("a", image), ("b", truth)):
        if side in sides:
            picture[3, 4, 1] = value
    pair = compared(image, truth, abs=1e-3)
    assert (pair.json["verdict"], pair.json["invalid"], pair.json["agree"]) == ("diverge", 1, 239)
    assert "1 of 240 pixels are invalid" in pair.json["reason"]
    assert sum(pair.json["invalid_kinds"]["a"].values()) == ("a" in sides)
    assert sum(pair.json["invalid_kinds"]["b"].values()) == ("b" in sides)


@pytest.mark.parametrize(("left", "right"), [(NAN, NAN), (INF, INF), (INF, -INF), (-INF, -INF), (NAN, INF)])
def test_images_that_are_all_nan_or_inf_never_pass(left: float, right: float) -> None:
    pair = compared(np.full(TRUTH.shape, left), np.full(TRUTH.shape, right), abs=1e300)
    assert (pair.json["verdict"], pair.json["invalid"]) == ("diverge", 240)
    assert pair.json["max_abs"] is pair.json["rms"] is pair.json["en_max"] is None
    assert pair.json["worst"] == {"x": 0, "y": 0, "a": [None] * 3, "b": [None] * 3}
    assert "NaN" not in json.dumps(pair.json, allow_nan=False)


def test_where_only_invalid_pixels_diverge_the_worst_pixel_is_the_first_of_them() -> None:
    image = TRUTH + 1e-9
    image[3, 5] = NAN
    pair = compared(image, abs=1e-6)
    assert (pair.json["diverge"], pair.json["invalid"], pair.json["verdict"]) == (0, 1, "diverge")
    assert (pair.json["worst"]["x"], pair.json["worst"]["y"]) == (5, 3)


@pytest.mark.parametrize("level", [0.0, 0.5])
def test_a_constant_image_never_passes_where_the_truth_is_not_constant(level: float) -> None:
    pair = compared(np.full(TRUTH.shape, level))
    assert pair.json["verdict"] == "diverge"
    assert pair.json["reason"].startswith("the image of vtk is constant where the truth is not; ")


def test_a_blank_image_does_not_pass_even_with_bounds_that_would_cover_everything() -> None:
    pair = compared(np.zeros(TRUTH.shape), abs=100.0)
    assert (pair.json["agree"], pair.json["verdict"]) == (240, "diverge")
    assert pair.json["reason"] == "the image of vtk is constant where the truth is not"


def test_two_blank_peers_do_not_pass_where_the_tracer_sees_a_picture() -> None:
    class Tracer:
        def render(self) -> dict[str, npt.NDArray[Any]]:
            return {"radiance": TRUTH}

        def evaluate(self, film_xy: Any, channels: Any) -> dict[str, npt.NDArray[Any]]:
            raise AssertionError("nothing diverges, so no edge is looked for")

    blank = np.zeros(TRUTH.shape, np.float32)
    pair = compare_pair(rendered("vtk", blank, abs=1e-3), rendered("povray", blank, abs=1e-3), Tracer())
    assert (pair.json["verdict"], pair.json["reason"]) == ("diverge", "the image of vtk is constant where the truth is not")


def test_a_constant_image_of_a_constant_truth_agrees() -> None:
    truth = np.full(TRUTH.shape, 0.25) * (1 + 1e-13 * TRUTH)  # constant as far as the truth knows itself
    assert compared(np.full(TRUTH.shape, 0.25), truth).json["verdict"] == "agree"
    black = np.zeros(TRUTH.shape)
    assert compared(black, black).json["verdict"] == "agree"


def test_a_level_that_is_resolved_may_hide_a_variation_below_the_resolution() -> None:
    truth = 0.25 + 1e-6 * TRUTH  # 16-bit steps show it as one level
    assert compared(np.full(TRUTH.shape, 0.25), truth, abs=1e-5).json["verdict"] == "agree"


def test_images_of_different_size_diverge_and_have_no_planes(tmp_path: Path) -> None:
    pair = compared(TRUTH[:, :-1])
    assert (pair.json["verdict"], pair.planes) == ("diverge", {})
    assert pair.json["reason"] == "the images differ in size: vtk is 19×12, reference is 20×12 pixels"
    write_pair(tmp_path, compared(TRUTH + 0.1))
    write_pair(tmp_path, pair)
    assert sorted(path.name for path in (tmp_path / "pairs").iterdir()) == ["vtk--reference.json"]


def test_an_uncertainty_that_cannot_be_told_makes_the_pair_not_comparable() -> None:
    truth = rendered("reference", TRUTH, rel=1e-12)
    few = Sampled("noise", "repeats", np.full(TRUTH.shape, 1e-3), repeats=31)
    pair = compare_pair(RenderedImage("mc", TRUTH, stated(Budget((few,)), TRUTH)), truth, None)
    assert pair.json["verdict"] == "not-comparable"
    assert pair.json["reason"] == "mc: sampled uncertainty 'noise' rests on 31 repeats, needed 32"
    bent = Geometric("facets", "coarse", normal=0.1)
    pair = compare_pair(RenderedImage("vtk", TRUTH, stated(Budget((bent,)), TRUTH)), truth, None)
    assert pair.json["verdict"] == "not-comparable"
    assert pair.json["reason"] == "vtk: geometric uncertainty (facets) cannot be propagated without the reference tracer"
    with_nan = altered(_1_1_1=NAN)
    pair = compare_pair(RenderedImage("mc", with_nan, stated(Budget((few,)), with_nan)), truth, None)
    assert pair.json["verdict"] == "diverge", "NaN must not hide behind an uncertainty that cannot be told"


def test_permuting_the_sides_flips_the_sign_and_nothing_else() -> None:
    rng = np.random.default_rng(1)
    image = (TRUTH + 2e-3 * rng.standard_normal(TRUTH.shape)).astype(np.float32)
    a, b = rendered("vtk", image, abs=1e-3, rel=1e-4), rendered("povray", TRUTH, abs=1e-5)
    one, other = compare_pair(a, b, None), compare_pair(b, a, None)
    alike = ("verdict", "agree", "diverge", "invalid", "max_abs", "rms", "p50", "p95", "p99", "en_max", "en_histogram")
    for name in alike:
        assert one.json[name] == other.json[name], f"{name}: {one.json[name]} and {other.json[name]}"
    assert one.json["bias"] == -other.json["bias"]
    assert (one.json["worst"]["a"], one.json["worst"]["b"]) == (other.json["worst"]["b"], other.json["worst"]["a"])
    for name in ("R", "G", "B", "en.R", "en.G", "en.B"):
        np.testing.assert_array_equal(one.planes[name], -other.planes[name])


def test_float32_images_carry_the_bound_of_their_storage_and_float64_images_do_not() -> None:
    exact = rendered("reference", TRUTH)
    stored = TRUTH.astype(np.float32)
    assert compare_pair(rendered("povray", stored), exact, None).json["verdict"] == "agree"
    assert compare_pair(rendered("povray", stored.astype(np.float64)), exact, None).json["verdict"] == "diverge"


def test_statistics_are_those_of_the_plain_definition() -> None:
    rng = np.random.default_rng(2)
    image = TRUTH + 1e-3 * rng.standard_normal(TRUTH.shape)
    image[0, 0, 0] = NAN
    pair = compared(image)
    plain = plain_comparison(image, TRUTH, 1e-3, 1e-12 * TRUTH)
    scored = plain["scored_values"]
    assert pair.json["scored_values"] == scored == 717
    assert pair.json["bias"] == pytest.approx(plain["sum"] / scored, rel=1e-12, abs=1e-18)
    assert pair.json["rms"] == pytest.approx((plain["sum_of_squares"] / scored) ** 0.5, rel=1e-12)
    for name in ("max_abs", "max_rel", "p50", "p95", "p99", "en_max"):
        assert pair.json[name] == plain[name], f"{name}: {pair.json[name]!r}, plain {plain[name]!r}"
    assert sum(pair.json["en_histogram"]["counts"]) == scored
    assert len(pair.json["en_histogram"]["counts"]) == len(EN_EDGES) - 1
    np.testing.assert_array_equal(pair.planes["class"], plain["classes"])


def test_the_histogram_has_an_edge_where_agreement_ends() -> None:
    pair = compared(TRUTH + np.where(np.arange(20)[None, :, None] < 5, 2e-3, 0.5e-3))
    counts, edges = pair.json["en_histogram"]["counts"], pair.json["en_histogram"]["edges"]
    assert sum(counts[edges.index(1.0) :]) == 5 * 12 * 3
    assert pair.json["diverge"] == 5 * 12


@pytest.mark.parametrize("scale", [1e-30, 1e30])
def test_huge_and_tiny_radiances_are_judged_as_any_other(scale: float) -> None:
    for factor, expected in ((1 + 0.9e-3, "agree"), (1 + 2.1e-3, "diverge")):
        image = (scale * factor * TRUTH).astype(np.float32)
        pair = compare_pair(rendered("vtk", image, rel=1e-3), rendered("reference", scale * TRUTH), None)
        assert pair.json["verdict"] == expected, f"a = {factor} b at scale {scale}"
        assert pair.json["rms"] == pytest.approx(scale * (factor - 1) * np.sqrt((TRUTH**2).mean()), rel=1e-3)


def test_an_infinite_normalised_error_is_null_in_json_and_infinite_in_the_plane() -> None:
    pair = compare_pair(rendered("oracle", altered(_2_2_2=9.0)), rendered("reference", TRUTH), None)
    assert (pair.json["en_max"], pair.json["en_infinite"], pair.json["verdict"]) == (None, 1, "diverge")
    assert pair.planes["en.B"][2, 2] == INF
    json.dumps(pair.json, allow_nan=False)


def test_images_that_do_not_lie_in_order_in_memory_are_compared_as_they_read() -> None:
    image = altered(_3_5_0=7.0)
    expected = compared(image).json
    strided = np.empty((24, 40, 6))[::2, ::2, ::2]
    strided[:] = image
    views = (strided, np.asfortranarray(image), image[::-1].copy()[::-1], image.astype(">f8"), image[..., ::-1].copy()[..., ::-1])
    for view in views:
        assert compared(view).json == expected
    assert compared(image[:, ::-1]).json["diverge"] > 1


def test_an_image_of_one_pixel_is_judged() -> None:
    one = TRUTH[:1, :1]
    assert compared(one.copy(), one).json["verdict"] == "agree"
    assert compared(one + 0.1, one).json["diverge"] == 1


def test_an_array_that_is_no_image_is_refused() -> None:
    fine = Uncertainty()
    for image in (np.zeros((4, 4)), np.zeros((4, 4, 4)), np.zeros((0, 4, 3))):
        with pytest.raises(ValueError, match=r"vtk: image of shape .*, allowed \(height ≥ 1, width ≥ 1, 3\)"):
            compare_pair(RenderedImage("vtk", image, fine), rendered("reference", TRUTH), None)
    with pytest.raises(ValueError, match="int64, allowed float32 or float64"):
        compare_pair(RenderedImage("vtk", np.ones(TRUTH.shape, np.int64), fine), rendered("reference", TRUTH), None)


def test_the_bound_at_single_pixels_is_the_bound_of_the_image() -> None:
    rng = np.random.default_rng(8)
    terms = (Bound("map", "", abs=rng.random(TRUTH.shape), rel=0.1), Sampled("noise", "", rng.random(TRUTH.shape), repeats=50))
    a, b = stated(Budget(terms), TRUTH), stated(Budget(terms[:1]), TRUTH)
    whole = pair_bound(TRUTH, TRUTH, a, b, 7.0)
    picked = np.array([0, 21, 239])
    some = TRUTH.reshape(-1, 3)[picked]
    np.testing.assert_array_equal(pair_bound(some, some, a, b, 7.0, picked), whole.reshape(-1, 3)[picked])
    assert coverage_factor(a, b, TRUTH.size) > 5


def test_files_of_a_pair_hold_what_was_computed(tmp_path: Path) -> None:
    pair = compared(altered(_3_4_1=NAN, _5_6_0=INF, _7_8_2=3.0).astype(np.float32))
    write_pair(tmp_path, pair)
    assert json.loads((tmp_path / "pairs/vtk--reference.json").read_text()) == pair.json
    planes = read_planes(tmp_path / "pairs/vtk--reference.exr")
    assert set(planes) == {"R", "G", "B", "en.R", "en.G", "en.B", "class"}
    for name, plane in planes.items():
        np.testing.assert_array_equal(plane, pair.planes[name], err_msg=name)
    assert (planes["class"][3, 4], planes["class"][7, 8], planes["class"][0, 0]) == (3, 1, 0)
    assert planes["B"][7, 8] == np.float32(np.float64(np.float32(3.0)) - TRUTH[7, 8, 2])
    assert np.isnan(planes["en.G"][3, 4])
    assert {path.name for path in (tmp_path / "pairs").iterdir()} == {"vtk--reference.json", "vtk--reference.exr"}


def test_the_json_of_a_pair_has_the_fields_of_the_contract() -> None:
    for pair in (compared(TRUTH + 0.1), compared(TRUTH[:-1]), compared(np.full(TRUTH.shape, NAN))):
        assert pair.json.keys() >= PAIR_FIELDS
        assert pair.json["worst"] is None or set(pair.json["worst"]) == {"x", "y", "a", "b"}
        assert (pair.json["explained"], pair.json["causes"], pair.json["flip"]) == (None, [], None)
        assert pair.json["comparer"] == COMPARER_VERSION


def test_flip_is_computed_on_request_and_null_where_it_has_no_meaning() -> None:
    truth = rendered("reference", TRUTH)
    pair = compare_pair(rendered("vtk", TRUTH * 1.5, abs=1e-3), truth, None, flip=True)
    assert 0.01 < pair.json["flip"] < 1
    pair = compare_pair(rendered("vtk", altered(_0_0_0=NAN), abs=1e-3), truth, None, flip=True)
    assert pair.json["flip"] is None
    # flip-evaluator ends its process on a black reference; ours must go on.
    black = rendered("reference", np.zeros(TRUTH.shape))
    assert compare_pair(rendered("vtk", TRUTH, abs=1e-3), black, None, flip=True).json["flip"] is None


def test_the_reason_names_kinds_and_sides() -> None:
    pair = compared(altered(_1_1_1=NAN, _2_2_2=INF, _3_3_0=-4.0), altered(_1_1_1=NAN))
    assert pair.json["reason"] == (
        "3 of 240 pixels are invalid (vtk: 1 nan, vtk: 1 +inf, vtk: 1 negative beyond its own uncertainty, reference: 1 nan)"
    )


def test_variation_is_what_the_truths_own_uncertainty_cannot_explain() -> None:
    truth = np.array([[[1.0, 1.0, 1.0], [1.2, 1.0, 1.3]]])
    bound = np.array([[[0.1, 0.0, 0.1], [0.1, 0.0, 0.1]]])
    assert verdict.varies(truth, bound).tolist() == [False, False, True]
