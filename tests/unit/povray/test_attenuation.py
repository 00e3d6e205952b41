"""The distance laws: POV-Ray's sums against 1 / (d_c + d_l r + d_q r²)."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from equilux.adapter import Unsupported
from equilux_adapters.povray.attenuation import Law, law
from equilux_scenes.model import Attenuation

NEAREST = 0.5
terms = st.one_of(st.just(0.0), st.floats(1e-3, 1e3))
scales = st.sampled_from([1e-3, 1.0, 1e4])


def povray_sum(found: Law, r: float) -> float:
    """What POV-Ray's lights of unit colour add up to at distance r, in written units, double precision."""
    fades = [2.0 / (1.0 + (r / t.fade_distance) ** t.fade_power) if t.fade_power else 1.0 for t in found.terms]
    return math.fsum(t.factor * fade for t, fade in zip(found.terms, fades, strict=True))


@given(terms, terms, terms, scales, st.floats(NEAREST, 100.0))
def test_the_sum_is_the_law_within_what_is_stated(c, linear, q, scale, r):
    if c == linear == q == 0:
        return
    try:
        found = law(Attenuation(constant=c, linear=linear, quadratic=q), scale, NEAREST, fade_ratio=1e-5)
    except Unsupported:
        assert linear**2 <= 4.1 * c * q, f"refused {c} + {linear} r + {q} r² although it has two distinct real roots"
        return
    truth = 1.0 / (c + linear * r + q * r * r)
    got = povray_sum(found, r * scale)
    rounding = 1e-14 * sum(abs(t.factor) for t in found.terms) if len(found.terms) == 1 else 1e-13 * found.cancelled * 2**24
    allowed = truth * (found.relative + 1e-12) + found.cancelled + (rounding if len(found.terms) > 1 else 0.0)
    assert abs(got - truth) <= allowed, f"sum {got!r}, law {truth!r} at r = {r}, allowed {allowed}"


def test_the_stated_relative_error_is_reached_at_the_nearest_distance():
    found = law(Attenuation(quadratic=1.0), 1.0, NEAREST, fade_ratio=0.1)
    error = abs(povray_sum(found, NEAREST) * NEAREST**2 - 1.0)
    assert found.relative * 0.5 <= error <= found.relative, f"error {error}, stated {found.relative}"


@pytest.mark.parametrize("scale", [1.0, 1e3])
def test_a_double_root_is_refused(scale):
    with pytest.raises(Unsupported, match="linear² ≤ 4 constant quadratic"):
        law(Attenuation(constant=1.0, linear=2.0, quadratic=1.0), scale, NEAREST, fade_ratio=1e-5)


def test_nearly_a_double_root_is_refused_for_its_cancellation():
    with pytest.raises(Unsupported, match="nearly a double root"):
        law(Attenuation(constant=1.0, linear=2.0000001, quadratic=1.0), 1.0, NEAREST, fade_ratio=1e-5)
