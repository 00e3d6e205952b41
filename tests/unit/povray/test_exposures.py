"""Which exposures are taken, and what merging them gives: POV-Ray replaced by the quantiser it ends in."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from equilux_adapters.povray.exposures import CLIPPED, HALF_STEP, Plan, factor, merge


def quantised(radiance, full_scale):
    """What a 16-bit file shows: clipped at 1, rounded to the nearest code."""
    return np.floor(np.clip(radiance * float(factor(full_scale)), 0, 1) * CLIPPED + 0.5).astype(np.uint16)


def taken(radiance, *, limit=12, precision=1e-4, darkest=1e-3, ceiling=None):
    """The finished plan, and how many waves it took."""
    plan = Plan(limit, precision, darkest, float(np.max(radiance)) * 1.5 if ceiling is None else ceiling)
    waves = 0
    while wave := plan.next_wave():
        waves += 1
        assert waves < 50, f"no end: {plan.looked.keys()}"
        for scale in wave:
            assert scale not in plan.looked, f"full scale {scale} twice"
            plan.looked[scale] = quantised(radiance, scale)
    return plan, waves


def image(*values):
    return np.array(values, dtype=np.float64).reshape(1, -1, 1) * np.ones(3)


def test_six_decades_are_merged_to_the_relative_precision():
    radiance = np.geomspace(1e-3, 1e3, 30000).reshape(100, 100, 3)
    plan, _ = taken(radiance)
    merged, used = merge(plan.chosen())
    relative = np.abs(merged - radiance) / radiance
    assert relative.max() <= 1e-4, f"relative error {relative.max()}"
    assert np.all(np.abs(merged - radiance) <= used * HALF_STEP * (1 + 1e-9))
    assert len(plan.looked) == 6, f"{len(plan.looked)} exposures"


@given(st.lists(st.floats(1e-3, 1e3), min_size=1, max_size=20), st.floats(1.0, 1e4))
def test_the_relative_precision_holds_whatever_the_picture_and_the_guess(values, looseness):
    radiance = image(*values)
    plan, _ = taken(radiance, ceiling=max(values) * looseness)
    merged, _ = merge(plan.chosen())
    relative = np.abs(merged - radiance) / radiance
    assert relative.max() <= 1e-4, f"relative error {relative.max()} with {list(plan.looked)}"


def test_a_usual_picture_takes_one_look_of_three_exposures():
    radiance = np.linspace(0, 1.9, 3000).reshape(10, 100, 3)
    plan, waves = taken(radiance)
    assert (len(plan.looked), waves) == (3, 1)


def test_a_flat_bright_picture_takes_no_more_than_it_needs():
    plan, waves = taken(image(50.0, 60.0), ceiling=70.0)
    assert waves <= 2
    assert len(plan.chosen()) == 1


def test_a_clipped_value_always_triggers_a_darker_exposure():
    radiance = image(5e4, 1e-2)
    plan, _ = taken(radiance, ceiling=1.0)  # a wrong guess
    merged, _ = merge(plan.chosen())
    assert abs(merged[0, 0, 0] - 5e4) <= 5.0, f"merged {merged[0, 0, 0]}, true 5e4"


def test_a_value_on_the_last_code_counts_as_clipped():
    codes = {1.0: np.array([[[CLIPPED]]], dtype=np.uint16), 4.0: np.array([[[16384]]], dtype=np.uint16)}
    merged, used = merge(codes)
    assert used[0, 0, 0] == 4.0
    assert merged[0, 0, 0] == pytest.approx(1.0, abs=4.0 * HALF_STEP)


def test_bands_are_merged_on_their_own():
    radiance = np.array([[[1.5, 0.1, 0.001]]])
    plan, _ = taken(radiance)
    _, used = merge(plan.chosen())
    assert used[0, 0, 0] > used[0, 0, 1] > used[0, 0, 2]


def test_one_exposure_has_full_scale_one():
    plan, _ = taken(image(0.9, 0.1), limit=1)
    assert list(plan.chosen()) == [1.0]


def test_one_exposure_of_a_bright_picture_is_the_first_that_does_not_clip():
    plan, _ = taken(image(9.0, 0.1), limit=1)
    (scale,) = plan.chosen()
    assert 9.0 < scale < 9.0 * 13


def test_with_too_few_exposures_the_dark_end_gives_way():
    radiance = np.geomspace(1e-3, 20.0, 3000).reshape(10, 100, 3)
    plan, _ = taken(radiance, limit=2)
    merged, used = merge(plan.chosen())
    assert len(plan.chosen()) == 2
    assert np.all(np.abs(merged - radiance) <= used * HALF_STEP * (1 + 1e-9)), "clipped"


def test_a_dark_picture_gets_full_precision_at_its_brightest():
    radiance = np.geomspace(1e-9, 1e-6, 300).reshape(10, 10, 3)
    plan, _ = taken(radiance, ceiling=2e-6)
    merged, _ = merge(plan.chosen())
    error = abs(merged.max() - 1e-6) / 1e-6
    assert error <= 1e-4, f"relative error {error}"


def test_a_picture_that_looks_black_is_looked_into():
    plan, _ = taken(image(0.0, 3e-9), ceiling=1.0)
    merged, _ = merge(plan.chosen())
    assert merged[0, 1, 0] == pytest.approx(3e-9, rel=1e-4)


def test_a_black_picture_comes_to_an_end():
    assert len(taken(image(0.0), ceiling=0.0)[0].looked) == 1
    assert len(taken(image(0.0), ceiling=1.0)[0].looked) == 3 + 2


def test_factors_have_the_six_digits_that_a_command_line_keeps():
    plan, _ = taken(np.geomspace(1e-3, 1e3, 300).reshape(10, 10, 3))
    for scale in plan.looked:
        assert float(f"{float(factor(scale)):.6g}") == float(factor(scale))
        assert 1.0 / float(factor(scale)) == pytest.approx(scale, rel=1e-15)
