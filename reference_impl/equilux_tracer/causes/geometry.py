"""Faults of geometry: handedness, normals, tessellation."""

from __future__ import annotations

from collections.abc import Sequence

from equilux_tracer.causes.rule import Rule

RULES: Sequence[Rule] = ()
