"""What VTK's OpenGL back end can express, and how well."""

from __future__ import annotations

from collections.abc import Mapping

from equilux.adapter import Capability

_EXACT = Capability("exact")
_TESSELLATED = Capability("approximate", "tessellated; how finely is the knob `tessellation`")

CAPABILITIES: Mapping[str, Capability] = {
    "model.phong": _EXACT,
    "camera.perspective": _EXACT,
    "camera.orthographic": Capability("approximate", "highlights take the direction to the eye point, not against the view (Q9)"),
    "light.point": _EXACT,
    "light.directional": _EXACT,
    "light.spot": Capability("approximate", "a half-angle of 90° makes a point light (Q8)"),
    "light.spot-exponent": Capability("approximate", "clamped to 128 (Q7); lost at a half-angle of 90° (Q8)"),
    "attenuation.constant": _EXACT,
    "attenuation.linear": _EXACT,
    "attenuation.quadratic": _EXACT,
    "material.diffuse": _EXACT,
    "material.specular": Capability("approximate", "exponents are clamped to 128 (Q5), R·V is raised to 1e-5 (Q6)"),
    "material.ambient": _EXACT,
    "material.emission": _EXACT,
    "background": _EXACT,
    "shape.sphere": _TESSELLATED,
    "shape.plane": Capability("exact", "cut to what the film sees"),
    "shape.box": _EXACT,
    "shape.disc": _TESSELLATED,
    "shape.rectangle": _EXACT,
    "shape.cylinder": _TESSELLATED,
    "shape.mesh": _EXACT,
    "normals.flat": _EXACT,
    "normals.smooth": _EXACT,
    "transform": _EXACT,
}
"""Feature → capability. "exact" is up to single precision, which the budget states."""
