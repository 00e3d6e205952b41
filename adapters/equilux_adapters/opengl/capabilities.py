"""What the fixed-function API can express, and how well."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from equilux.adapter import Capability
from equilux.dialect import Declared

_EXACT = Capability("exact")
_CORNERS = Capability("approximate", "lit at the corners of triangles; how small these are is the knob `triangle_px`")

LACK_CAUSES: Mapping[str, str] = {
    "model.phong": "half-vector",
    "model.raytraced": "half-vector",
    "occlusion": "occlusion-ignored",
    "shadow.attenuated": "occlusion-ignored",
    "reflection": "reflection-missing",
    "transparency": "refraction-missing",
    "refraction": "refraction-missing",
}
"""Feature that OpenGL lacks → the cause it shows as. Scenes that expect the cause are rendered as OpenGL would."""

DIALECT: Sequence[Declared] = (
    Declared("half-vector", quirk="Q7", models=("phong", "raytraced")),
    Declared("occlusion-ignored", quirk="Q8"),
    Declared("reflection-missing", quirk="Q8"),
    Declared("refraction-missing", reading="opaque, 1 − t of its own", quirk="Q8"),
    Declared("mesa:shininess-zero", quirk="Q10"),
)
"""What OpenGL always does otherwise than the model says. Light at corners (Q4) is no part of it: the triangles are made so
small that what is left of it is in the budget."""

CAPABILITIES: Mapping[str, Capability] = {
    "model.phong": Capability("none", "the highlight is (N·H)^s (Q7)"),
    "model.opengl": _CORNERS,
    "model.raytraced": Capability("none", "the highlight is (N·H)^s (Q7), and light is local"),
    "model.reflection-equation": Capability("none"),
    "camera.perspective": _EXACT,
    "camera.orthographic": _EXACT,
    "light.point": _EXACT,
    "light.directional": _EXACT,
    "light.spot": _EXACT,
    "light.spot-exponent": Capability("exact", "from 0 to 128 (Q6)"),
    "light.sphere": Capability("none"),
    "light.disc": Capability("none"),
    "light.rectangle": Capability("none"),
    "light.environment": Capability("none"),
    "light.ambient-colour": _EXACT,
    "light.diffuse-colour": _EXACT,
    "light.specular-colour": _EXACT,
    "viewer.infinite": _EXACT,
    "attenuation.constant": _EXACT,
    "attenuation.linear": _EXACT,
    "attenuation.quadratic": _EXACT,
    "material.diffuse": _EXACT,
    "material.specular": Capability("exact", "exponents from 0 to 128 (Q6)"),
    "material.ambient": _EXACT,
    "material.emission": _EXACT,
    "brdf.phong-cosine": Capability("none"),
    "occlusion": Capability("none", "light passes through objects"),
    "reflection": Capability("none", "left out"),
    "transparency": Capability("none", "drawn opaque, with the share 1 − t of its own (Q8)"),
    "refraction": Capability("none", "left out"),
    "shadow.attenuated": Capability("none", "no shadows"),
    "shadow.ignored": Capability("exact", "no shadows"),
    "background": _EXACT,
    "shape.sphere": _CORNERS,
    "shape.plane": Capability("exact", "cut to what the film sees"),
    "shape.box": _EXACT,
    "shape.disc": Capability("approximate", "a polygon; of how many sides is the knob `tessellation`"),
    "shape.rectangle": _EXACT,
    "shape.cylinder": _CORNERS,
    "shape.mesh": _EXACT,
    "normals.flat": _EXACT,
    "normals.smooth": _EXACT,
    "transform": _EXACT,
}
"""Feature → capability. "exact" is up to single precision and interpolation, which the budget states."""
