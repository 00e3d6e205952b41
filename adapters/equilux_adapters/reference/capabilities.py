"""The tracer evaluates the lighting model itself, so it has every feature of it, exactly."""

from __future__ import annotations

from equilux.adapter import Capability

FEATURES = (
    "model.phong", "model.opengl", "model.raytraced", "model.reflection-equation",
    "camera.perspective", "camera.orthographic",
    "light.point", "light.directional", "light.spot", "light.spot-exponent",
    "attenuation.constant", "attenuation.linear", "attenuation.quadratic",
    "light.sphere", "light.disc", "light.rectangle", "light.environment", "brdf.phong-cosine",
    "light.ambient-colour", "light.diffuse-colour", "light.specular-colour", "viewer.infinite",
    "occlusion", "reflection", "transparency", "refraction", "shadow.attenuated", "shadow.ignored",
    "material.diffuse", "material.specular", "material.ambient", "material.emission",
    "background",
    "shape.sphere", "shape.plane", "shape.box", "shape.disc", "shape.rectangle", "shape.cylinder", "shape.mesh",
    "normals.flat", "normals.smooth",
    "transform",
)  # fmt: skip

CAPABILITIES = {feature: Capability("exact") for feature in FEATURES}
