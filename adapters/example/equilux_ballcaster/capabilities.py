"""What ballcaster can draw, feature by feature. A feature that is not listed is one it lacks."""

from __future__ import annotations

from equilux.adapter import Capability

CAPABILITIES = {
    feature: Capability("exact")
    for feature in (
        "model.phong",
        "camera.perspective",
        "light.point",
        "attenuation.quadratic",
        "material.diffuse",
        "background",
        "shape.sphere",
    )
}
