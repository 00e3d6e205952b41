"""Faults of geometry: handedness, normals, tessellation."""

from __future__ import annotations

from collections.abc import Sequence

from equilux_tracer.causes.handedness import MirroredHandedness
from equilux_tracer.causes.normals import NormalSide, ReversedNormals, SmoothedNormals
from equilux_tracer.causes.rule import Rule
from equilux_tracer.causes.tessellated import FacetedNormals, Tessellated, VertexLighting

RULES: Sequence[Rule] = (
    MirroredHandedness(),
    FacetedNormals(),
    SmoothedNormals(),
    ReversedNormals(),
    NormalSide(),
    Tessellated(),
    VertexLighting(),
)
