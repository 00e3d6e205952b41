"""What of a scene POV-Ray can express, and how well."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from equilux.adapter import Capability
from equilux.dialect import Declared

_EXACT = Capability("exact")
_NEAR = Capability("approximate", "small fade_distance d in 2/(1 + (r/d)^p); the error is in the budget")
_MESH = Capability("approximate", "vertices and normals are float32; the error is in the budget")

_NO_HIGHLIGHT = Capability("approximate", "light from behind makes no highlight: the term T·V is missing (Q39)")

DIALECT: Sequence[Declared] = (
    Declared("normal-side", reading="facing the viewer", quirk="Q19"),
    Declared("transmitted-highlight-missing", quirk="Q39"),
    Declared("nested-media", reading="counted", quirk="Q43"),
    Declared("shadow-bias", quirk="Q37"),
)
"""What POV-Ray always does otherwise than the model says. How long the bias is depends on the unit that a scene is written
in."""

CAPABILITIES: Mapping[str, Capability] = {
    "model.phong": _EXACT,
    "model.opengl": Capability("approximate", "where V is minus the ray's direction and a light needs one colour (Q40)"),
    "model.raytraced": _EXACT,
    "model.reflection-equation": Capability("approximate", "lights without an extent, by the model of ray tracing"),
    "camera.perspective": _EXACT,
    "camera.orthographic": _EXACT,
    "light.point": _EXACT,
    "light.directional": _EXACT,
    "light.spot": _EXACT,
    "light.spot-exponent": _EXACT,
    "light.diffuse-colour": _EXACT,
    "light.specular-colour": _EXACT,
    "light.ambient-colour": Capability("approximate", "only where no material shows it (Q40)"),
    "viewer.infinite": Capability("approximate", "orthographic views, or no highlight (Q40)"),
    "attenuation.constant": _EXACT,
    "attenuation.linear": Capability(
        "approximate", f"{_NEAR.note}; constant, linear and quadratic together need linear² > 4 constant quadratic"
    ),
    "attenuation.quadratic": _NEAR,
    "material.diffuse": _EXACT,
    "material.specular": _EXACT,
    "material.ambient": _EXACT,
    "material.emission": _EXACT,
    "occlusion": Capability("approximate", "blockers within 1e-3 of POV-Ray's units of the point or the light are missed (Q37)"),
    "reflection": _EXACT,
    "transparency": _NO_HIGHLIGHT,
    "refraction": Capability("approximate", "indices of refraction are float32; the error is in the budget (Q35)"),
    "shadow.attenuated": _EXACT,
    "shadow.ignored": _EXACT,
    "background": _EXACT,
    "shape.sphere": _EXACT,
    "shape.plane": _EXACT,
    "shape.box": _EXACT,
    "shape.disc": _EXACT,
    "shape.rectangle": _EXACT,
    "shape.cylinder": _EXACT,
    "shape.mesh": _MESH,
    "normals.flat": _MESH,
    "normals.smooth": Capability("approximate", "a normal interpolated to face away from the viewer is turned over (Q19)"),
    "transform": _EXACT,
}
