"""The arithmetic that all geometry of the oracle stands on, against exact rationals."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp, mpf

from equilux_oracle.doubledouble import DD, cross, direction, dot, unit, vector

# Hida, Li and Bailey's bounds: 2·2^-104 for the sum, 4·2^-104 for the product, 10·2^-104 for quotient and root.
ROUNDOFF = Fraction(10, 2**104)

magnitude = st.floats(min_value=1e-60, max_value=1e60)
signed = st.builds(lambda m, s: m if s else -m, magnitude, st.booleans())
number = st.builds(lambda hi, share: DD(hi, hi * share * 2.0**-53), signed, st.floats(-0.49, 0.49))


def exactly(value: DD) -> Fraction:
    return Fraction(float(value.hi)) + Fraction(float(value.lo))


def assert_close(got: DD, true: Fraction) -> None:
    error = abs(exactly(got) - true)
    assert error <= ROUNDOFF * abs(true), f"got {float(exactly(got))!r}, true {float(true)!r}, apart {float(error / abs(true))}"


@given(number, number)
def test_a_sum_keeps_104_bits_even_when_it_cancels(a, b):
    if exactly(a) + exactly(b) == 0:
        assert float((a + b).hi) == 0.0
    else:
        assert_close(a + b, exactly(a) + exactly(b))
        assert_close(a - (-b), exactly(a) + exactly(b))


@given(number, number)
def test_a_product_keeps_104_bits(a, b):
    assert_close(a * b, exactly(a) * exactly(b))


@given(number, number)
def test_a_quotient_keeps_104_bits(a, b):
    assert_close(a / b, exactly(a) / exactly(b))


@given(magnitude)
def test_a_root_squared_is_the_number(a):
    root = exactly(DD(a).sqrt())
    # (r (1 + e))² = r² (1 + 2e)
    assert abs(root * root - Fraction(a)) <= 2 * ROUNDOFF * Fraction(a), f"root {float(root)} of {a}"


def test_the_root_of_nothing_is_nothing():
    assert DD([0.0, -1.0]).sqrt().hi.tolist() == [0.0, 0.0]


def test_a_difference_of_neighbours_is_exact():
    a, b = DD(1e6, 3e-11), DD(1e6, 1e-11)
    assert exactly(a - b) == Fraction(3e-11) - Fraction(1e-11)


@pytest.mark.parametrize("length", [2.0**-1000, 1.0, 2.0**1000])
def test_a_direction_counts_whatever_its_length(length):
    got = unit(direction([3.0 * length, 0.0, -4.0 * length]))
    assert got.hi.ravel().tolist() == [0.6, 0.0, -0.8]


def test_a_unit_vector_is_one_long_and_a_cross_product_upright():
    a, b = unit(vector([0.1, 0.7, -0.3])), vector([1e6, 2.0, -1e-3])
    with mp.workdps(40):
        length = mpf(dot(a, a).hi.item()) + mpf(dot(a, a).lo.item())
        assert abs(length - 1) < mpf(2) ** -100, length
    upright = dot(cross(a, b), b)
    assert abs(upright.hi.item()) <= 1e6**2 * 2.0**-100, upright.hi.item()


def test_arrays_and_numbers_mix_with_double_doubles():
    a = DD(np.array([1.0, 2.0]))
    assert (2.0 * a).hi.tolist() == [2.0, 4.0]
    assert (np.array([1.0, 1.0]) - a).hi.tolist() == [0.0, -1.0]
    assert (np.array([3.0, 1.0]) * a).hi.tolist() == [3.0, 2.0]
    assert (a < 1.5).tolist() == [True, False]
    assert (a >= np.array([1.0, 3.0])).tolist() == [True, False]
