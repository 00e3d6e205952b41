"""What VTK's OpenGL back end can express, and how well."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from equilux.adapter import Capability
from equilux.dialect import Declared

_EXACT = Capability("exact")
_TESSELLATED = Capability("approximate", "tessellated; how finely is the knob `tessellation`")

LACK_CAUSES: Mapping[str, str] = {
    "model.opengl": "half-vector",
    "light.ambient-colour": "light-colours-ignored",
    "light.diffuse-colour": "light-colours-ignored",
    "light.specular-colour": "light-colours-ignored",
    "viewer.infinite": "view-vector-from-eye",
    "occlusion": "occlusion-ignored",
    "shadow.attenuated": "occlusion-ignored",
    "reflection": "reflection-missing",
    "transparency": "refraction-missing",
    "refraction": "refraction-missing",
}
"""Feature that VTK lacks → the cause it shows as. Scenes that expect the cause are rendered as VTK would (contracts, "as is")."""

DIALECT: Sequence[Declared] = (
    Declared("exponent-clamped", 128.0, quirk="Q5"),
    Declared("specular-floored", 1e-5, quirk="Q6"),
    Declared("spot-exponent-clamped", 128.0, quirk="Q7"),
    Declared("spot-cone-ignored", 90.0, quirk="Q8"),
    Declared("view-vector-from-eye", quirk="Q9"),
    Declared("occlusion-ignored"),
    Declared("reflection-missing", quirk="Q16"),
    Declared("refraction-missing", reading="opaque, 1 − t of its own", quirk="Q17"),
    Declared("light-colours-ignored", reading="diffuse for the highlight", quirk="Q18"),
    Declared("half-vector", models=("opengl",)),
)
"""What VTK always does otherwise than the model says. In model opengl its highlight is Phong's: `half-vector`."""

CAPABILITIES: Mapping[str, Capability] = {
    "model.phong": _EXACT,
    "model.opengl": Capability("none", "the highlight is (R·V)^p, per pixel"),
    "model.raytraced": Capability("exact", "light from in front, emission and ambient; the rest are features of their own"),
    "model.reflection-equation": Capability("none"),
    "camera.perspective": _EXACT,
    "camera.orthographic": Capability("approximate", "highlights take the direction to the eye point, not against the view (Q9)"),
    "light.point": _EXACT,
    "light.directional": _EXACT,
    "light.spot": Capability("approximate", "a half-angle of 90° makes a point light (Q8)"),
    "light.spot-exponent": Capability("approximate", "clamped to 128 (Q7); lost at a half-angle of 90° (Q8)"),
    "light.sphere": Capability("none"),
    "light.disc": Capability("none"),
    "light.rectangle": Capability("none"),
    "light.environment": Capability("none"),
    "light.ambient-colour": Capability("none", "has no effect (Q18)"),
    "light.diffuse-colour": Capability("none", "colours the highlight too (Q18)"),
    "light.specular-colour": Capability("none", "has no effect (Q18)"),
    "viewer.infinite": Capability("none", "V is taken to the eye point"),
    "attenuation.constant": _EXACT,
    "attenuation.linear": _EXACT,
    "attenuation.quadratic": _EXACT,
    "material.diffuse": _EXACT,
    "material.specular": Capability("approximate", "exponents are clamped to 128 (Q5), R·V is raised to 1e-5 (Q6)"),
    "material.ambient": _EXACT,
    "material.emission": _EXACT,
    "brdf.phong-cosine": Capability("none"),
    "occlusion": Capability("none", "light passes through objects"),
    "reflection": Capability("none", "left out"),
    "transparency": Capability("none", "drawn opaque, with the share 1 − t of its own (Q17)"),
    "refraction": Capability("none", "left out"),
    "shadow.attenuated": Capability("none", "no shadows"),
    "shadow.ignored": Capability("exact", "no shadows"),
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
