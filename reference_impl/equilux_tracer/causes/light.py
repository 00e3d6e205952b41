"""Faults of lights, ambient and emission."""

from __future__ import annotations

from collections.abc import Sequence

from equilux_tracer.causes.rule import Rule

RULES: Sequence[Rule] = ()
