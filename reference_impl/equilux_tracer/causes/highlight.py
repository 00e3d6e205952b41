"""Faults of the diffuse term and of the highlight."""

from __future__ import annotations

from collections.abc import Sequence

from equilux_tracer.causes.rule import Rule

RULES: Sequence[Rule] = ()
