"""The rule for edges, on a reference that is a formula: a vertical discontinuity at a chosen place."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from equilux import edges
from equilux.budget import Bound, Budget, Geometric
from equilux.compare import RenderedImage, compare_pair
from equilux.uncertainty import stated

Floats = npt.NDArray[np.float64]
WIDTH, HEIGHT = 9, 5


class Step:
    """Black where x < `at`, else `right(x, y)`; one signature each side."""

    def __init__(self, at: float, right: Callable[..., Any] = lambda x, y: 0 * x + 1.0) -> None:
        self.at, self.right = at, right
        self.batches: list[int] = []

    def evaluate(self, film_xy: Floats, channels: Sequence[str]) -> dict[str, npt.NDArray[Any]]:
        self.batches.append(len(film_xy))
        x, y = film_xy.T
        is_left = x < self.at
        value = np.where(is_left, 0.0, self.right(x, y))
        return {"radiance": np.repeat(value[:, None], 3, axis=1), "signature": np.where(is_left, 7, 8).astype(np.uint64)}

    def render(self) -> dict[str, npt.NDArray[Any]]:
        y, x = np.mgrid[:HEIGHT, :WIDTH] + 0.5
        film_xy = np.stack([x.ravel(), y.ravel()], axis=-1)
        return {"radiance": self.evaluate(film_xy, ("radiance",))["radiance"].reshape(HEIGHT, WIDTH, 3)}


def judged(tracer: Step, image: Floats, *, film_px: float = 0.1, bound: float = 1e-3) -> dict[str, Any]:
    """The pair of `image` and the tracer's own picture."""
    truth = tracer.render()["radiance"]
    budget = Budget((Geometric("raster", "", film_px=film_px), Bound("flat", "", abs=bound)))
    a = RenderedImage("vtk", image, stated(budget, image))
    return compare_pair(a, RenderedImage("reference", truth, stated(Budget(), truth)), tracer).json


def column(tracer: Step, x: int, value: float) -> Floats:
    """The tracer's picture with one column replaced."""
    image = tracer.render()["radiance"].copy()
    image[:, x] = value
    return image


def test_delta_is_the_sum_of_both_between_its_limits() -> None:
    assert edges.film_delta_px(0.0, 0.0) == 1e-6
    assert edges.film_delta_px(0.02, 0.03) == 0.05
    assert edges.film_delta_px(0.09, 0.09) == 0.1


def test_samples_are_the_centre_and_sixteen_points_on_two_rings() -> None:
    radii = np.hypot(*edges.sample_offsets(0.08).T)
    np.testing.assert_allclose(radii, [0.0] + [0.04] * 8 + [0.08] * 8, atol=1e-17)
    assert len(np.unique(np.round(edges.sample_offsets(0.08), 12), axis=0)) == 17


def test_any_straight_edge_within_nine_tenths_of_delta_is_seen() -> None:
    offsets = edges.sample_offsets(1.0)
    for angle in np.linspace(0, 2 * np.pi, 361):
        reach = float((offsets @ [np.cos(angle), np.sin(angle)]).max())
        assert reach >= np.cos(np.pi / 8) - 1e-12, f"an edge at {reach} in direction {np.degrees(angle)}° would be missed"


@pytest.mark.parametrize(("distance", "edge_pixels"), [(0.0001, 5), (0.05, 5), (0.09, 5), (0.101, 0), (0.3, 0), (0.5, 0)])
def test_a_renderer_on_the_other_side_is_excused_only_within_delta(distance: float, edge_pixels: int) -> None:
    for at, other_side in ((4.5 + distance, 1.0), (4.5 - distance, 0.0)):
        tracer = Step(at)
        pair = judged(tracer, column(tracer, 4, other_side))
        assert (pair["edge"], pair["diverge"]) == (edge_pixels, 5 - edge_pixels), f"edge {distance} px from the centre"
        assert pair["verdict"] == ("agree" if edge_pixels else "diverge")
        assert pair["edge_max_abs"] == (1.0 if edge_pixels else 0.0)


def test_without_a_tracer_nothing_is_excused() -> None:
    tracer = Step(4.55)
    image, truth = column(tracer, 4, 1.0), tracer.render()["radiance"]
    budget = Budget((Geometric("raster", "", film_px=0.1),))
    pair = compare_pair(
        RenderedImage("vtk", image, stated(budget, image)), RenderedImage("reference", truth, stated(Budget(), truth)), None
    )
    assert (pair.json["edge"], pair.json["diverge"]) == (0, 5)


@pytest.mark.parametrize("value", [0.5, 1.5, 1.002, 0.998, 0.002])
def test_a_value_that_neither_side_has_is_not_excused_at_an_edge(value: float) -> None:
    tracer = Step(4.55)
    pair = judged(tracer, column(tracer, 4, value))
    assert (pair["edge"], pair["diverge"]) == (0, 5), f"{value} passed between sides of 0 and 1"


def test_a_side_may_be_wrong_by_b_and_by_the_range_it_spans_around_the_pixel() -> None:
    tracer = Step(4.53, right=lambda x, y: 1 + 0.5 * (x - 4.5))
    samples = 4.5 + edges.sample_offsets(0.1)[:, 0]
    values = 1 + 0.5 * (samples[samples >= 4.53] - 4.5)
    low, high = values.min(), values.max()
    width, bound = high - low, 1e-3
    reach = width + 0.9 * bound, width + 1.1 * bound
    for value, edge in ((high + reach[0], 5), (high + reach[1], 0), (low - reach[0], 5), (low - reach[1], 0)):
        pair = judged(tracer, column(tracer, 4, value), bound=bound)
        assert pair["edge"] == edge, f"{value} beside samples {low} … {high} and B = {bound}"


def test_all_bands_must_come_from_the_same_side() -> None:
    tracer = Step(4.55)
    image = tracer.render()["radiance"].copy()
    image[:, 4] = [1.0, 0.0, 1.0]
    assert judged(tracer, image)["diverge"] == 5


def test_a_steep_but_smooth_highlight_is_never_an_edge() -> None:
    tracer = Step(-1.0, right=lambda x, y: 50 * np.exp(-0.5 * ((x - 4.5) ** 2 + (y - 2.5) ** 2)))
    pair = judged(tracer, tracer.render()["radiance"] * 1.01)
    assert pair["edge"] == 0
    assert pair["diverge"] > 5


def test_an_invalid_pixel_is_never_an_edge() -> None:
    tracer = Step(4.55)
    pair = judged(tracer, column(tracer, 4, float("nan")))
    assert (pair["edge"], pair["invalid"]) == (0, 5)


def test_edges_leave_the_statistics_and_keep_the_planes() -> None:
    tracer = Step(4.55)
    image = column(tracer, 4, 1.0)
    image[0, 0] += 0.25
    pair = judged(tracer, image)
    assert (pair["max_abs"], pair["edge_max_abs"], pair["scored_values"]) == (0.25, 1.0, 3 * (WIDTH * HEIGHT - 5))
    assert (pair["worst"]["x"], pair["worst"]["y"]) == (0, 0)


def test_candidates_are_asked_in_chunks_with_the_same_result(monkeypatch: pytest.MonkeyPatch) -> None:
    tracer = Step(4.55)
    image = column(tracer, 4, 1.0) + np.linspace(0, 0.01, WIDTH)[None, :, None]
    whole = judged(tracer, image)
    monkeypatch.setattr(edges, "CHUNK_PIXELS", 7)
    tracer.batches.clear()
    assert judged(tracer, image) == whole
    assert max(tracer.batches[1:]) == 7 * 17
