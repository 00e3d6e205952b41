"""What of a scene POV-Ray can express, and how well."""

from __future__ import annotations

from collections.abc import Mapping

from equilux.adapter import Capability

_EXACT = Capability("exact")
_NEAR = Capability("approximate", "small fade_distance d in 2/(1 + (r/d)^p); the error is in the budget")
_MESH = Capability("approximate", "vertices and normals are float32; the error is in the budget")

CAPABILITIES: Mapping[str, Capability] = {
    "model.phong": _EXACT,
    "camera.perspective": _EXACT,
    "camera.orthographic": _EXACT,
    "light.point": _EXACT,
    "light.directional": _EXACT,
    "light.spot": _EXACT,
    "light.spot-exponent": _EXACT,
    "attenuation.constant": _EXACT,
    "attenuation.linear": Capability(
        "approximate", f"{_NEAR.note}; constant, linear and quadratic together need linear² > 4 constant quadratic"
    ),
    "attenuation.quadratic": _NEAR,
    "material.diffuse": _EXACT,
    "material.specular": _EXACT,
    "material.ambient": _EXACT,
    "material.emission": _EXACT,
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
