"""Faults of the picture: where a pixel looks, and how its value is written down."""

from __future__ import annotations

from collections.abc import Sequence

from equilux_tracer.causes.image_film import FlippedX, FlippedY, FovOtherAxis, Transposed
from equilux_tracer.causes.image_values import BandsSwapped, Clamped, GammaEncoded
from equilux_tracer.causes.quantised import Quantised
from equilux_tracer.causes.rule import Rule
from equilux_tracer.causes.scaled import Scaled
from equilux_tracer.causes.shifted import Shifted

RULES: Sequence[Rule] = (
    FlippedX(),
    FlippedY(),
    Transposed(),
    Shifted(),
    GammaEncoded(),
    Clamped(),
    Quantised(),
    BandsSwapped(),
    Scaled(),
    FovOtherAxis(),
)
