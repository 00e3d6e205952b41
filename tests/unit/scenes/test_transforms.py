"""The one definition of object → world: order of steps, right-handed rotations, exactness where it can be had."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from equilux_scenes.model import Rotation, Sphere, TransformStep
from equilux_scenes.transforms import matrix, matrix_of, sin_cos_deg, unit


def _rotate(axis: tuple[float, float, float], degrees: float) -> TransformStep:
    return TransformStep(rotate=Rotation(axis=axis, degrees=degrees))


def test_an_object_without_a_transform_stays_where_it_is() -> None:
    assert np.array_equal(matrix(Sphere(kind="sphere", center=(0, 0, 0), radius=1, material="m")), np.eye(4))


def test_steps_are_applied_in_the_order_they_are_written() -> None:
    scale, move, turn = TransformStep(scale=(2.0, 2.0, 2.0)), TransformStep(translate=(1.0, 0.0, 0.0)), _rotate((0, 0, 1), 90)
    point = np.array([1.0, 0.0, 0.0, 1.0])
    assert (matrix_of([scale, move, turn]) @ point).tolist() == [0, 3, 0, 1]
    assert (matrix_of([turn, move, scale]) @ point).tolist() == [2, 2, 0, 1]
    assert (matrix_of([move, turn, scale]) @ point).tolist() == [0, 4, 0, 1]


def test_scale_takes_one_number_or_three(load: Callable[..., Any], edited: Callable[..., str]) -> None:
    one = load(edited("{scale: 2}", "{scale: 2}")).scene.objects[6].transform[0]
    three = load(edited("{scale: 2}", "{scale: [2, 3, -4]}")).scene.objects[6].transform[0]
    assert np.diag(matrix_of([one])).tolist() == [2, 2, 2, 1]
    assert np.diag(matrix_of([three])).tolist() == [2, 3, -4, 1]


def test_a_matrix_is_written_row_by_row_and_acts_on_columns() -> None:
    rows = ((1.0, 2.0, 3.0, 4.0), (0.0, 1.0, 0.0, 5.0), (0.0, 0.0, 1.0, 6.0), (0.0, 0.0, 0.0, 1.0))
    assert (matrix_of([TransformStep(matrix=rows)]) @ [1, 1, 1, 1]).tolist() == [10, 6, 7, 1]


def test_rotations_are_right_handed() -> None:
    x, y, z = np.eye(4)[:3]
    for axis, start, end in (((1, 0, 0), y, z), ((0, 1, 0), z, x), ((0, 0, 1), x, y)):
        assert np.array_equal(matrix_of([_rotate(axis, 90)]) @ start, end), axis


@pytest.mark.parametrize("degrees", [0, 90, 180, 270, 360, -90, 450, 36000, -720])
def test_quarter_turns_about_the_axes_are_exact(degrees: float) -> None:
    for axis in ((1, 0, 0), (0, 2, 0), (0, 0, -3)):
        turned = matrix_of([_rotate(axis, degrees)])
        assert np.array_equal(turned, np.round(turned)), turned


def test_sine_and_cosine_of_degrees_agree_with_radians() -> None:
    for degrees in np.linspace(-1000, 1000, 777):
        sine, cosine = sin_cos_deg(float(degrees))
        # the reduction here is exact; radians() rounds, by at most half an ulp of 18 radians
        assert abs(sine - math.sin(math.radians(degrees))) < 4e-15
        assert abs(cosine - math.cos(math.radians(degrees))) < 4e-15


finite = st.floats(-1e3, 1e3)


@settings(max_examples=100, deadline=None, derandomize=True)
@given(st.tuples(finite, finite, finite).filter(lambda axis: max(map(abs, axis)) > 1e-3), finite)
def test_a_rotation_keeps_lengths_and_handedness(axis: tuple[float, float, float], degrees: float) -> None:
    turn = matrix_of([_rotate(axis, degrees)])[:3, :3]
    assert np.abs(turn @ turn.T - np.eye(3)).max() < 1e-14
    assert np.linalg.det(turn) == pytest.approx(1, abs=1e-14)
    assert np.abs(turn @ unit(axis) - unit(axis)).max() < 1e-14


@pytest.mark.parametrize("length", [5e-324, 1e-200, 1.0, 1e200, 1.7e308])
def test_directions_of_any_length_can_be_made_unit(length: float) -> None:
    assert unit((0.0, -length, 0.0)) == (0, -1, 0)
    assert math.hypot(*unit((length, length, length))) == pytest.approx(1, abs=1e-15)
