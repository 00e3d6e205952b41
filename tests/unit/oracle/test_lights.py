"""Spot cones and attenuation laws."""

from __future__ import annotations

import math

import numpy as np
import pytest

import equilux_oracle
from equilux_oracle.constants import cos_deg, tan_half_angle
from equilux_oracle.doubledouble import DD
from equilux_oracle.lights import spot_factor

FLOOR = {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}


@pytest.mark.parametrize(("degrees", "cosine"), [(60.0, 0.5), (90.0, 0.0), (45.0, math.sqrt(0.5))])
def test_the_cosine_of_a_cone_is_the_nearest_double(degrees, cosine):
    assert cos_deg(degrees).hi.item() == cosine


def test_tangents_of_right_angles_and_of_small_ones():
    assert tan_half_angle(90.0).hi.item() == 1.0
    assert tan_half_angle(1.0).hi.item() == math.tan(math.radians(0.5))


def test_the_cone_includes_its_border():
    factor, _ = spot_factor(DD([0.5, 0.5, 0.5], [0.0, 1e-30, -1e-30]), DD(0.5), 0.0)
    assert factor.tolist() == [1.0, 1.0, 0.0]


def test_a_half_angle_of_90_degrees_lights_the_whole_half_space_and_its_border():
    factor, _ = spot_factor(DD([1e-20, 0.0, -1e-20]), cos_deg(90.0), 0.0)
    assert factor.tolist() == [1.0, 1.0, 0.0]
    factor, _ = spot_factor(DD([1.0, 0.0]), cos_deg(90.0), 2.0)
    assert factor.tolist() == [1.0, 0.0]


@pytest.mark.parametrize("exponent", [0.3, 1.0, 20.0, 128.0])
def test_a_spot_weakens_by_the_power_of_the_cosine(make_case, exponent):
    spot = {"kind": "spot", "position": [0, 0, 2], "direction": [0, 0, -3], "intensity": 4, "cone_half_angle_deg": 50}
    spot["exponent"] = exponent
    value = equilux_oracle.evaluate(make_case(FLOOR, {"diffuse": 1}, spot), [[4, 4], [5.5, 4]])[:, 0]
    true = [1.0, 4 / 6.25 * 0.8**exponent * 0.8]  # 1.5 m off the axis and 2 m below: r = 2.5, both cosines 0.8
    assert np.allclose(value, true, rtol=1e-13, atol=0), f"oracle {value}, by hand {true}"


def test_the_cone_ends_where_its_half_angle_says(make_case):
    spot = {"kind": "spot", "position": [0, 0, 2], "direction": [0, 0, -1], "intensity": 4, "cone_half_angle_deg": 30}
    edge = 4 + 2 * math.tan(math.radians(30))
    inside, outside = equilux_oracle.evaluate(make_case(FLOOR, {"diffuse": 1}, spot), [[edge - 1e-9, 4], [edge + 1e-9, 4]])[:, 0]
    assert inside > 0.5, inside
    assert outside == 0, outside


def test_a_light_exactly_on_the_surface_adds_nothing(make_case):
    lamp = {"kind": "point", "position": [0, 0, 0], "intensity": 1}
    value = equilux_oracle.evaluate(make_case(FLOOR, {"diffuse": 1, "emission": 0.5}, lamp), [[4, 4]])[0]
    assert value.tolist() == [0.5] * 3
