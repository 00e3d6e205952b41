"""The exposures → linear radiance with its uncertainty budget."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from equilux.adapter import Bound, Budget, Geometric, Program, RawRender, Reading
from equilux.budget import Term, pixel_mean
from equilux_adapters.povray.exposures import HALF_STEP, Floats, merge
from equilux_adapters.povray.float_files import half_step, read_floats
from equilux_adapters.povray.knobs import PovrayKnobs
from equilux_adapters.povray.png import read_codes

FLOAT32 = 2.0**-24  # relative, one rounding
LIGHT_CUT = 1e-10  # irradiance × Exposure in every band below which POV-Ray drops a light (Q13)


STORED = {
    "png16": "PNG of 16 bits: half a step of the exposure the value was read from (Q22)",
    "exr": "OpenEXR of half floats: half a unit in the last place of 11 bits (Q22)",
    "hdr": "Radiance picture: a step of 8 bits under the exponent of the largest band, cut off (Q22)",
}


class _Picture(NamedTuple):
    """radiance; the full scale it was read at; how far what was written may be off what POV-Ray computed: (h, w, 3) each."""

    radiance: Floats
    used: Floats
    step: Floats


def read(raw: RawRender, program: Program, knobs: PovrayKnobs) -> Reading:
    """(h, w, 3) float32. Raises RendererFailed for files that are not what POV-Ray was asked to write."""
    facts = program.data
    picture = _picture(raw, raw.data["full_scales"], facts, knobs)
    centres = _picture(raw, raw.data["centres"], facts, knobs) if knobs.antialias else picture
    terms = tuple(_terms(facts, centres, knobs))
    if knobs.antialias:
        terms = (*terms, pixel_mean(picture.radiance, centres.radiance, terms))
    return Reading(picture.radiance.astype(np.float32), Budget(terms))


def _picture(raw: RawRender, scales: Mapping[str, float], facts: Any, knobs: PovrayKnobs) -> _Picture:
    size = (facts["width"], facts["height"])
    if knobs.channel == "png16":
        radiance, used = merge({scale: read_codes(raw.files[name], *size) for name, scale in scales.items()})
        return _Picture(radiance, used, used * HALF_STEP)
    ((name, scale),) = scales.items()
    stored = read_floats(raw.files[name], *size)
    step = np.where(np.isfinite(stored), half_step(knobs.channel, stored), 0.0)
    return _Picture(stored * scale, np.full(stored.shape, scale), step * scale)


def _terms(facts: Any, picture: _Picture, knobs: PovrayKnobs) -> Iterator[Term]:
    radiance, used, step = picture
    yield Bound("quantisation", STORED[knobs.channel], abs=step)
    yield _arithmetic(facts)
    if facts["level_cut"]:
        reason = "rays beyond max_trace_level: the largest weights of so many bounces (Q38)"
        yield Bound("level-cut", reason, abs=facts["level_cut"])
    if facts["weight_cut"]:
        reason = "rays that count less than adc_bailout, times what a ray may bring (Q45)"
        yield Bound("weight-cut", reason, abs=facts["weight_cut"])
    yield Bound("storage", "the merged image is float32", rel=FLOAT32)
    if facts["sources"]:
        reason = f"a light whose irradiance × Exposure is below {LIGHT_CUT:g} in every band is dropped (Q13)"
        yield Bound("light-cut", reason, abs=used * (LIGHT_CUT * facts["sources"] * facts["strength"]))
    if facts["fading"]:
        yield Bound("fade-distance", "a pure power law is 2/(1 + (r/d)^p) with a small d: (d/r)^p at the nearest lit point (Q9)",
                    rel=facts["fading"])
    if facts["cancelled"]:
        yield Bound("cancellation", "three attenuation terms are two lights of opposite sign (Q10)", abs=facts["cancelled"])
    yield Geometric("film", "absolute tolerances and float32 bounding boxes (Q14, Q15, Q16)", film_px=facts["film_px"])
    if facts["meshes"]:
        yield Geometric(
            "mesh-storage", "mesh2 keeps vertices and normals in float32 (Q20)",
            normal={int(index): mesh["normal"] for index, mesh in facts["meshes"].items()},
            position_m={int(index): mesh["position_m"] for index, mesh in facts["meshes"].items()},
        )


    if facts["refraction"]:
        yield Geometric("refraction", "an index of refraction is float32; as the tilt that turns a refracted ray as far (Q35)",
                        normal={int(index): tilt for index, tilt in facts["refraction"].items()})
    if facts["turned_px"]:
        yield Bound("straight-through", "where crossings count, index 1 is 1 − 2^-24 and turns rays: by the slope (Q34)",
                    abs=facts["turned_px"] * _slope(radiance))
        yield Geometric("horizon", "index 1 − 2^-24 reflects totally at grazing angles (Q34)", film_px=facts["horizon_px"])


def _slope(radiance: Floats) -> Floats:
    """The largest difference of each value from its four neighbours': per pixel, what a displacement on the film may do."""
    padded = np.pad(radiance, ((1, 1), (1, 1), (0, 0)), mode="edge")
    middle = padded[1:-1, 1:-1]
    neighbours = (padded[:-2, 1:-1], padded[2:, 1:-1], padded[1:-1, :-2], padded[1:-1, 2:])
    slope: Floats = np.max([np.abs(neighbour - middle) for neighbour in neighbours], axis=0)
    return slope


def _arithmetic(facts: Any) -> Bound:
    """Colours are float32 (Q5). Every partial sum is positive, so the relative errors of its parts and of its additions add up.

    A light's colour (1) and its attenuation (1), pigment (1), finish (1), their products (2), the encoding to 16 bits (2); the
    weights of layers (2); ambient light or Exposure times what glows (1); one addition per light; per surface that filters a
    shadow ray its filter (1), the product of the layers' (1) and that with the light (1). Per bounce k_refl (1) and its blend
    over angles (2), or the filters of two layers (2) and their product (1); the product with what the ray found (1); the sum (1),
    and one more where a ray may go either way.

    phong_size in float32, if that rounds, turns s = (R·V)^p into s^(1 + 2⁻²⁴): |ln s| roundings, at most 10 where s ≥ e⁻¹⁰, below
    that 10 e⁻¹⁰ of the brightest. An exponent kept as roughness is rounded three times (Q40).
    """
    of_exponent = (3 if facts["half_vector"] else 1) * 10
    roundings = 8 + 2 * facts["layered"] + facts["glowing"] + facts["sources"] + of_exponent * bool(facts["rounded_highlight"])
    roundings += 3 * facts["filters"] + (5 + facts["lets_through"]) * facts["bounces"]
    return Bound("float32-colours", "POV-Ray computes colours in float32 (Q5)", rel=roundings * FLOAT32,
                 abs=of_exponent * float(np.exp(-10.0)) * FLOAT32 * facts["rounded_highlight"])
