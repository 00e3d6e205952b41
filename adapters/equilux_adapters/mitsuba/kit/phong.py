"""The Phong lobes, which Mitsuba does not have, as a BSDF written in Python and registered."""

# Mitsuba's stubs say how plug-ins are called, not how they are written in Python.
# mypy: ignore-errors

from __future__ import annotations

from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

Triple = tuple[float, float, float]


def phong(law: str, k_diff: Triple, k_spec: Triple, exponent: float) -> dict[str, Any]:
    """law: phong-classic or phong-cosine; on both faces."""
    mi.register_bsdf(law, PhongClassic if law == "phong-classic" else PhongCosine)
    coefficients = {"k_diff": mi.ScalarColor3f(*k_diff), "k_spec": mi.ScalarColor3f(*k_spec), "exponent": exponent}
    return {"type": "twosided", "bsdf": {"type": law, **coefficients}}


class PhongClassic(mi.BSDF):
    """f_r cosθ = K_diff cosθ + K_spec (R·V)^p for L and V above the surface; 0 where R·V ≤ 0.

    Mitsuba's wi is V and wo is L, in the frame whose z is N; R·V of L is R·L of V. Directions are drawn from a mixture of
    the cosine and of the lobe around the mirror direction of V, in proportion to what they reflect at normal incidence.
    """

    lobe_has_cosine = False

    def __init__(self, props: mi.Properties) -> None:
        mi.BSDF.__init__(self, props)
        diffuse, specular, exponent = props["k_diff"], props["k_spec"], float(props["exponent"])
        self.k_diff, self.k_spec, self.exponent = mi.Color3f(diffuse), mi.Color3f(specular), mi.Float(exponent)
        flat, lobe = np.pi * max(diffuse), 2 * np.pi / (exponent + 1) * max(specular)
        self.flat_share = mi.Float(flat / (flat + lobe) if flat + lobe > 0 else 1.0)
        dr.make_opaque(self.k_diff, self.k_spec, self.exponent, self.flat_share)  # one compiled kernel for all materials
        self.m_flags = mi.BSDFFlags.DiffuseReflection | mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
        self.m_components = [self.m_flags]

    def eval(self, ctx: Any, si: Any, wo: Any, active: Any) -> Any:
        """f_r cosθ."""
        cosine, mirrored = mi.Frame3f.cos_theta(wo), dr.dot(mi.reflect(wo), si.wi)
        lobe = dr.select(mirrored > 0, dr.maximum(mirrored, 0) ** self.exponent, 0)
        if self.lobe_has_cosine:
            lobe *= cosine
        return dr.select(active & above(si, wo), self.k_diff * cosine + self.k_spec * lobe, 0)

    def pdf(self, ctx: Any, si: Any, wo: Any, active: Any) -> Any:
        """Of `sample`, per solid angle."""
        mirrored = dr.maximum(dr.dot(mi.reflect(wo), si.wi), 0)
        lobe = dr.select(mirrored > 0, mirrored**self.exponent, 0) * (self.exponent + 1) * dr.inv_two_pi
        mixed = dr.lerp(lobe, mi.Frame3f.cos_theta(wo) * dr.inv_pi, self.flat_share)
        return dr.select(active & above(si, wo), mixed, 0)

    def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any) -> Any:
        """Both at once."""
        return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

    def sample(self, ctx: Any, si: Any, choice: Any, point: Any, active: Any) -> Any:
        """A direction to the light, and f_r cosθ / pdf."""
        cosine = point.x ** (1 / (self.exponent + 1))
        sine, azimuth = dr.safe_sqrt(1 - cosine * cosine), 2 * np.pi * point.y
        around_mirror = mi.Vector3f(sine * dr.cos(azimuth), sine * dr.sin(azimuth), cosine)
        lobe = mi.Frame3f(mi.reflect(si.wi)).to_world(around_mirror)
        found = mi.BSDFSample3f()
        found.wo = dr.select(choice < self.flat_share, mi.warp.square_to_cosine_hemisphere(point), lobe)
        found.pdf = self.pdf(ctx, si, found.wo, active)
        found.eta = 1
        found.sampled_type = mi.UInt32(+self.m_flags)
        found.sampled_component = mi.UInt32(0)
        drawn = active & (found.pdf > 0)
        return found, dr.select(drawn, self.eval(ctx, si, found.wo, drawn) / found.pdf, 0)

    def traverse(self, callback: Any) -> None:
        """Nothing to be changed from outside."""

    def to_string(self) -> str:
        """For Mitsuba's messages."""
        return f"{type(self).__name__}[k_diff={self.k_diff}, k_spec={self.k_spec}, exponent={self.exponent}]"


class PhongCosine(PhongClassic):
    """f_r = K_diff + K_spec (R·V)^p."""

    lobe_has_cosine = True


def above(si: Any, wo: Any) -> Any:
    """Whether V and L are on N's side."""
    return (mi.Frame3f.cos_theta(si.wi) > 0) & (mi.Frame3f.cos_theta(wo) > 0)
