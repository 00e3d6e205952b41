"""Two faults at once, of different kinds, as they do come together: a translation slip and a rule of the renderer's own."""

from __future__ import annotations

from mutation.mutant import Mutant, pair
from mutation.single_faults import SINGLE_FAULTS

_BY_NAME = {mutant.name: mutant for mutant in SINGLE_FAULTS}

_PAIRS = (
    ("flipped-y", "gamma-encoded: sRGB"),
    ("flipped-x", "scaled: 1/π"),
    ("flipped-y", "half-vector"),
    ("bands-swapped: B G R", "gamma-encoded: 2.2"),
    ("clamped: 0.25", "highlight-missing"),
    ("scaled: π", "exponent-clamped: 64"),
    ("scaled: 1/π", "ambient-missing: the scene's"),
    ("scaled: 683.002", "emission-missing"),
    ("shifted: half a pixel both ways", "scaled: 255/256"),
    ("shifted: 1 px down, black above", "attenuation-ignored"),
    ("fov-other-axis", "flipped-x"),
    ("fov-other-axis", "exponent-scaled: 4"),
    ("half-vector", "attenuation-ignored"),
    ("half-vector", "exponent-scaled: 4"),
    ("exponent-clamped: 128", "light-missing: the first"),
    ("exponent-clamped: 64", "spot-exponent-clamped: 8"),
    ("highlight-cosine", "ambient-tinted"),
    ("highlight-tinted", "emission-tinted"),
    ("highlight-ungated", "spot-cone-doubled"),
    ("diffuse-two-sided: |N·L|", "attenuation-term-missing: linear"),
    ("diffuse-missing", "emission-missing"),
    ("light-missing: the last", "faceted-normals"),
    ("reversed-normals", "ambient-missing: the scene's"),
    ("normal-side: as stored", "exponent-scaled: 4"),
    ("vertex-lighting", "spot-ignored"),
    ("view-vector-fixed", "specular-floored: 0.5"),
    ("spot-exponent-ignored", "light-colours-ignored: ambient"),
    ("light-colours-ignored: specular, as if 1", "background-missing: black"),
    ("background-missing: black", "gamma-encoded: sRGB"),
    ("occlusion-ignored", "recursion-cut: 1"),
    ("recursion-cut: 2", "exponent-clamped: 10"),
    ("reflection-missing", "half-vector"),
    ("index-inverted: view rays", "scaled: π"),
    ("transparent-shadow-rule: opaque", "transmitted-highlight-missing"),
    ("weight-cut: 0.05", "ambient-missing: the scene's"),
    ("tir-weight: none", "spot-ignored"),
    ("transparency-weight-ignored: both", "flipped-y"),
    ("refraction-missing: not bent", "attenuation-ignored"),
)

PAIRED_FAULTS: tuple[Mutant, ...] = tuple(pair(_BY_NAME[a], _BY_NAME[b]) for a, b in _PAIRS)
