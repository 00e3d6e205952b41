"""Numbers and verdicts in words."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from equilux_report import numerals, words
from equilux_report.calibration import calibrations, histogram, rebin
from equilux_report.tree import CaseRecord, Pair, Render, read_run

FACTS = {
    "verdict": "diverge", "judged": "diverge_expected", "pixels": 49152, "agree": 48840, "diverge": 312, "edge": 0, "invalid": 0,
    "en_max": 420.4, "max_abs": 0.462, "reason": "312 of 49152 pixels diverge",
    "worst": {"x": 131, "y": 77, "a": [0.1, 0.812, 0.2], "b": [0.1, 0.35, 0.2]},
}  # fmt: skip


def case(**facts: object) -> CaseRecord:
    return CaseRecord("ball", {"expect": [{"adapter": "vtk", "cause": "exponent-clamped"}], **facts}, {}, ())


def pair(**facts: object) -> Pair:
    return Pair("ball", "vtk", "oracle", None, {**FACTS, **facts})


def test_a_pinned_divergence_is_said_in_one_sentence() -> None:
    assert words.sentence(case(), pair()) == (
        "vtk diverges from oracle on 312 of 49\u202f152 pixels (0.63\u202f%), worst at (131, 77): 0.812 against 0.350 W/(m²·sr), "
        "420\u202f×\u202fthe stated uncertainty; pinned as exponent-clamped."
    )


def test_an_unexpected_divergence_says_so_and_names_no_cause() -> None:
    said = words.sentence(case(), pair(judged="diverge_unexpected"))
    assert said.endswith("not expected.")
    assert "exponent-clamped" not in said


def test_diagnosed_causes_come_before_expected_ones() -> None:
    assert words.causes(case(), pair(causes=[{"id": "scaled"}])) == ["scaled"]


def test_an_agreement_tells_how_close() -> None:
    said = words.sentence(case(), pair(verdict="agree", judged="agree", agree=49152, diverge=0, en_max=0.43, max_abs=7.6e-6))
    assert said == "vtk agrees with oracle on all 49\u202f152 pixels: largest |Eₙ| 0.430, largest difference 7.60e-6 W/(m²·sr)."


def test_a_pin_that_no_longer_shows_asks_to_be_taken_out() -> None:
    assert "take the pin out" in words.sentence(case(), pair(verdict="agree", judged="improved"))


def test_invalid_pixels_are_counted_by_kind_and_side() -> None:
    kinds = {"a": {"nan": 12, "+inf": 2, "-inf": 0, "negative": 0}, "b": {"nan": 0, "+inf": 0, "-inf": 0, "negative": 0}}
    said = words.sentence(case(), pair(diverge=0, invalid=14, invalid_kinds=kinds, judged="diverge_unexpected"))
    assert "14 invalid pixels" in said
    assert "vtk has 12 NaN, 2 +Inf" in said
    assert "worst at" not in said, "the worst of the valid pixels is not what diverges"


def test_a_difference_where_no_uncertainty_is_stated_is_infinite() -> None:
    infinite = pair(en_max=None, en_infinite=3)
    assert words.en_max(infinite) == math.inf
    assert "no uncertainty stated" in words.sentence(case(), infinite)


def test_what_cannot_be_compared_says_why() -> None:
    said = words.sentence(case(), pair(verdict="not-comparable", reason="only 4 repeats"))
    assert said == "vtk cannot be compared with oracle: only 4 repeats."


@pytest.mark.parametrize("facts", [{}, {"worst": None}, {"worst": {"x": 1, "y": 2, "a": [None, None, None], "b": [1, 2, 3]}}])
def test_a_sentence_survives_missing_facts(facts: dict[str, object]) -> None:
    bare = Pair("ball", "vtk", "oracle", None, {"verdict": "diverge", "diverge": 1, "pixels": 4, **facts})
    assert words.sentence(case(), bare).startswith("vtk diverges from oracle on 1 of 4 pixels (25.00\u202f%)")


def test_failed_renders_say_what_happened() -> None:
    crashed = Render("ball", "vtk", Path("."), {"status": "crashed", "signal": 11, "reason": "ended by SIGSEGV"})
    assert words.render_sentence(crashed) == "vtk crashed (signal 11): ended by SIGSEGV."
    lacking = Render("ball", "vtk", Path("."), {"status": "unsupported", "missing_features": ["shape.mesh", "light.spot"]})
    assert words.render_sentence(lacking) == "vtk does not support shape.mesh and light.spot."


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.8123, "0.812"), (420.4, "420"), (7.634e-6, "7.63e-6"), (-3.2e-9, "-3.20e-9"), (1450000.0, "1.45e6"), (0, "0"),
     (None, "–"), (9.999, "10.0"), (math.inf, "∞"), (16500.4, "16500"), (7.006e-46, "7.01e-46")],
)  # fmt: skip
def test_magnitudes_keep_three_digits_and_can_be_read_back(value: float | None, text: str) -> None:
    assert numerals.magnitude(value) == text
    if value and math.isfinite(value):
        assert float(text) == pytest.approx(value, rel=5e-3)


@pytest.mark.parametrize(
    ("part", "whole", "text"),
    [(0, 100, "0\u202f%"), (1, 10**6, "<0.01\u202f%"), (312, 49152, "0.63\u202f%"), (999_999, 10**6, ">99.99\u202f%"),
     (100, 100, "100\u202f%"), (0, 0, "–")],
)  # fmt: skip
def test_percentages_never_hide_a_pixel(part: int, whole: int, text: str) -> None:
    assert numerals.percent(part, whole) == text


def test_durations_have_fitting_units() -> None:
    assert [numerals.seconds(value) for value in (0.0004, 0.052, 0.0999, 1.234, 200.0, None)] == [
        "0.40\u202fms", "52\u202fms", "100\u202fms", "1.23\u202fs", "3\u202fmin 20\u202fs", "–",
    ]  # fmt: skip


def test_values_by_object_are_shown_as_their_range() -> None:
    assert numerals.term({"3": 1e-4, "5": 4e-4}) == "1.00e-4 to 4.00e-4 on 2 objects"
    assert numerals.term({"3": 1e-4}) == "1.00e-4 on 1 object"
    assert numerals.term(0.5) == "0.500"


def test_rebinning_keeps_every_count_and_one_stays_an_edge() -> None:
    edges = [0.0, *(10.0 ** (i / 4) for i in range(-24, 25)), 1.7976931348623157e308]
    counts = list(range(1, len(edges)))
    bins = rebin([pair(en_histogram={"edges": edges, "counts": counts})])
    assert sum(bin.diverging for bin in bins) == sum(counts)
    beyond = sum(count for low, count in zip(edges, counts, strict=False) if low >= 1)
    assert sum(bin.diverging for bin in bins if bin.low >= 0) == beyond


def test_histograms_that_do_not_line_up_are_left_out() -> None:
    for broken in (
        {},
        {"edges": [1, 2], "counts": [1, 2]},
        {"edges": [2, 1], "counts": [1]},
        {"edges": [1, None], "counts": [1]},
    ):
        assert histogram(pair(en_histogram=broken)) == ([], [])


def test_calibration_covers_every_adapter_but_the_truth(tree: Path) -> None:
    found = {item.adapter: item for item in calibrations(read_run(tree))}
    assert sorted(found) == ["povray", "reference", "vtk"]
    assert found["reference"].beyond == 0
    assert found["vtk"].beyond > 0
    assert "Well calibrated" in found["povray"].verdict
