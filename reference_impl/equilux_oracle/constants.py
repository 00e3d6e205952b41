"""The few transcendental constants of a scene, from mpmath, which also knows that cos 90° is 0 and cos 60° is one half."""

from __future__ import annotations

from mpmath import mp, mpf

from equilux_oracle.doubledouble import DD

_DIGITS = 50


def tan_half_angle(angle_deg: float) -> DD:
    """tan(angle / 2) of an angle in degrees, to double-double precision."""
    with mp.workdps(_DIGITS):
        value = mp.sinpi(mpf(angle_deg) / 360) / mp.cospi(mpf(angle_deg) / 360)
        hi = float(value)
        return DD(hi, float(value - hi))


def cos_deg(angle_deg: float) -> DD:
    """Cosine of an angle in degrees, to double-double precision, exactly 0 at 90°."""
    with mp.workdps(_DIGITS):
        value = mp.cospi(mpf(angle_deg) / 180)
        hi = float(value)
        return DD(hi, float(value - hi))
