"""Point and spot lights beyond Mitsuba's own, as an emitter written in Python and registered."""

# Mitsuba's stubs say how plug-ins are called, not how they are written in Python.
# mypy: ignore-errors

from __future__ import annotations

from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

Triple = tuple[float, float, float]


def lamp(
    position: Triple,
    intensity: Triple,
    attenuation: Triple = (0, 0, 1),
    direction: Triple = (0, 0, 1),
    half_angle_deg: float = 180,
    exponent: float = 0,
) -> dict[str, Any]:
    """E = I cos^e / (d_c + d_l r + d_q r²) within the cone."""
    mi.register_emitter("lamp", Lamp)
    axis = np.asarray(direction, dtype=float) / np.max(np.abs(direction))
    return {
        "type": "lamp",
        "position": mi.ScalarPoint3f(*position),
        "axis": mi.ScalarVector3f(*(axis / np.linalg.norm(axis))),
        "intensity": mi.ScalarColor3f(*intensity),
        "attenuation": mi.ScalarVector3f(*attenuation),
        "cos_half_angle": float(np.cos(np.radians(half_angle_deg))),
        "exponent": float(exponent),
    }


class Lamp(mi.Emitter):
    """A light at a point."""

    def __init__(self, props: mi.Properties) -> None:
        mi.Emitter.__init__(self, props)
        self.position, self.axis = mi.Point3f(props["position"]), mi.Vector3f(props["axis"])
        self.intensity, self.attenuation = mi.Color3f(props["intensity"]), mi.Vector3f(props["attenuation"])
        self.cos_half_angle, self.exponent = mi.Float(props["cos_half_angle"]), mi.Float(props["exponent"])
        dr.make_opaque(self.position, self.axis, self.intensity, self.attenuation, self.cos_half_angle, self.exponent)
        self.m_flags = mi.EmitterFlags.DeltaPosition

    def sample_direction(self, ref: Any, sample: Any, active: Any) -> Any:
        """The direction to the light, and the irradiance it brings before the cosine."""
        found = mi.DirectionSample3f()
        found.p, found.n, found.uv, found.time = self.position, 0, 0, ref.time
        found.pdf, found.delta, found.emitter = 1, True, mi.EmitterPtr(self)
        found.d = found.p - ref.p
        found.dist = dr.norm(found.d)
        found.d /= found.dist
        off_axis = -dr.dot(found.d, self.axis)
        power = dr.select(self.exponent > 0, dr.maximum(off_axis, 0) ** self.exponent, 1)
        terms = self.attenuation
        weakened = power / (terms.x + found.dist * (terms.y + found.dist * terms.z))
        return found, dr.select(active & (off_axis >= self.cos_half_angle), self.intensity * weakened, 0)

    def pdf_direction(self, ref: Any, found: Any, active: Any) -> Any:
        """No other way of sampling finds it."""
        return mi.Float(0)

    def eval(self, si: Any, active: Any) -> Any:
        """It is not seen."""
        return mi.Color3f(0)

    def bbox(self) -> Any:
        """Empty."""
        return mi.ScalarBoundingBox3f()

    def traverse(self, callback: Any) -> None:
        """Nothing to be changed from outside."""

    def to_string(self) -> str:
        """For Mitsuba's messages."""
        return f"Lamp[position={self.position}, intensity={self.intensity}]"
