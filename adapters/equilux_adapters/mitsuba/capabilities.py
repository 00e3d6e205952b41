"""What Mitsuba 3 can express, and how well."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from equilux.adapter import Capability
from equilux.dialect import Declared

_EXACT = Capability("exact")
_SAMPLED = Capability("approximate", "Monte Carlo: the noise is stated, the knobs are `samples` and `repeats`")
_REGISTERED_BSDF = Capability("exact", "a BSDF written in Python, which the script registers (Q6)")
_REGISTERED_LAMP = Capability("exact", "an emitter written in Python, which the script registers (Q8)")

DIALECT: Sequence[Declared] = (
    Declared("normal-side", reading="facing the viewer", quirk="Q12"),
    Declared("shadow-bias", reading="before the light", quirk="Q9"),
)
"""What Mitsuba always does otherwise than the model says. How far before the light a shadow ray ends depends on its length; what
it starts off the surface is in the budget."""

CAPABILITIES: Mapping[str, Capability] = {
    "model.reflection-equation": _EXACT,
    "camera.perspective": _EXACT,
    "camera.orthographic": _EXACT,
    "light.point": _EXACT,
    "light.directional": _EXACT,
    "light.spot": _EXACT,
    "light.spot-exponent": _REGISTERED_LAMP,
    "light.sphere": _SAMPLED,
    "light.disc": _SAMPLED,
    "light.rectangle": _SAMPLED,
    "light.environment": _SAMPLED,
    "attenuation.constant": _REGISTERED_LAMP,
    "attenuation.linear": _REGISTERED_LAMP,
    "attenuation.quadratic": _EXACT,
    "material.diffuse": _EXACT,
    "material.specular": _REGISTERED_BSDF,
    "material.emission": Capability("exact", "added where the object is seen: it lights nothing (Q5)"),
    "brdf.phong-cosine": _REGISTERED_BSDF,
    "occlusion": Capability("approximate", "shadow rays start off the surface and end before the light (Q9)"),
    "background": Capability("exact", "added where nothing is seen: it lights nothing (Q5)"),
    "shape.sphere": _EXACT,
    "shape.plane": Capability("approximate", "a disc, 1e6 times as large as the scene (Q11)"),
    "shape.box": _EXACT,
    "shape.disc": _EXACT,
    "shape.rectangle": _EXACT,
    "shape.cylinder": _EXACT,
    "shape.mesh": _EXACT,
    "normals.flat": _EXACT,
    "normals.smooth": Capability("approximate", "the side of a smooth mesh is that of its shading normal (Q12)"),
    "transform": _EXACT,
}
"""Feature → capability. "exact" is up to single precision, which the budget states."""
