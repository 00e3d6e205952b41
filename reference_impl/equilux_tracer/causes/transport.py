"""Faults of what light meets on its way: shadows, mirrors, glass."""

from __future__ import annotations

from collections.abc import Sequence

from equilux_tracer.causes.rule import Rule

RULES: Sequence[Rule] = ()
