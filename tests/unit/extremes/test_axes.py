"""Every axis writes valid specs at all its values, and pushes nothing but what it says."""

from __future__ import annotations

import numpy as np
import pytest

from equilux.extremes.axes import AXES, BY_NAME
from equilux.extremes.axis import Axis, decades, shown

NAMES = [axis.name for axis in AXES]


@pytest.mark.parametrize("axis", [axis for axis in AXES if axis.name != "light-count"], ids=lambda axis: axis.name)
def test_every_value_has_a_valid_scene_in_every_model(axis: Axis):
    for model in axis.models:
        for value in axis.values_in(model):
            case = axis.case(value, model)
            assert case.scene.model == model
            assert case.name == axis.case_name(value, model)


def test_lights_are_as_many_as_the_value_says():
    for value in (1.0, 10.0, 100.0):
        assert len(BY_NAME["light-count"].case(value, "phong").scene.lights) == value


@pytest.mark.parametrize("axis", AXES, ids=NAMES)
def test_values_go_outward_from_the_benign_one(axis: Axis):
    assert list(axis.values) == sorted(axis.values)
    assert axis.benign in axis.values
    assert len(set(axis.values)) == len(axis.values)
    assert axis.down or axis.up


@pytest.mark.parametrize("axis", AXES, ids=NAMES)
def test_no_decade_is_left_out(axis: Axis):
    positive = [value for value in axis.values if value > 0]
    steps = np.diff(np.log10(positive))
    assert steps.max() <= 1 + 1e-9, dict(zip(positive, steps, strict=False))


def test_case_names_are_unique():
    names = [axis.case_name(value, model) for axis in AXES for model in axis.models for value in axis.values]
    assert len(set(names)) == len(names)


@pytest.mark.parametrize("name", ["scale", "coefficient", "mirror-weight", "light-count", "grazing-view"])
def test_what_is_compensated_leaves_the_picture_as_it_is(name: str):
    """The truth's picture, a decade and two away from the benign value, is that of the benign value."""
    from equilux_tracer import Tracer

    axis = BY_NAME[name]
    model = axis.models[0]
    pictures = {
        value: Tracer(axis.case(value, model)).render()["radiance"]
        for value in (axis.benign, *axis.down[1:3], *axis.up[:2])
        if name != "light-count" or value <= 100
    }
    first = pictures[axis.benign]
    if name == "light-count":  # the lamps stand elsewhere, their sum does not
        for value, picture in pictures.items():
            assert 0.3 < picture.sum() / first.sum() < 3, value
        return
    for value, picture in pictures.items():
        same = np.isclose(picture, first, rtol=1e-6, atol=1e-9).all(axis=2).mean()
        assert same > 0.97, f"{name} = {value}: {same:.1%} of the pixels are as at {axis.benign}"


def test_numbers_are_written_shortest():
    assert [shown(value) for value in (1.0, 1e-6, 179.99, 1e18, 30.0)] == ["1", "1e-06", "179.99", "1e+18", "30"]


def test_decades_are_the_nearest_doubles():
    assert decades(-1, -3) == (0.1, 0.01, 0.001)
    assert decades(1, 3) == (10.0, 100.0, 1000.0)
