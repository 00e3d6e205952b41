"""The tracer evaluates the lighting model itself, so it has every feature of it, exactly."""

from __future__ import annotations

from equilux.adapter import Capability

FEATURES = (
    "model.phong",
    "camera.perspective", "camera.orthographic",
    "light.point", "light.directional", "light.spot", "light.spot-exponent",
    "attenuation.constant", "attenuation.linear", "attenuation.quadratic",
    "material.diffuse", "material.specular", "material.ambient", "material.emission",
    "background",
    "shape.sphere", "shape.plane", "shape.box", "shape.disc", "shape.rectangle", "shape.cylinder", "shape.mesh",
    "normals.flat", "normals.smooth",
    "transform",
)  # fmt: skip

CAPABILITIES = {feature: Capability("exact") for feature in FEATURES}
