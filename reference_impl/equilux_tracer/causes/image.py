"""Faults of the picture: where a pixel looks, and how its value is written down."""

from __future__ import annotations

from collections.abc import Sequence

from equilux_tracer.causes.rule import Rule

RULES: Sequence[Rule] = ()
