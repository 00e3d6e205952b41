"""Values of the BRDFs, 1/sr, never with the receiver's cosine in them.

    lambert        f_r = K_diff
    phong-cosine   f_r = K_diff + K_spec max(0, R·V)^p                 the lecture's BRDF
    phong-classic  f_r = K_diff + K_spec max(0, R·V)^p / (N·L)         what every renderer's Phong draws: f_r cosθ_i has no cosine
    half-vector    f_r = K_diff + K_spec max(0, N·H)^p / (N·L)         what fixed-function OpenGL draws

with R = 2 (N·L) N − L and H = unit(L + V). Nothing below the surface, on either side.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from equilux_scenes.model import Material, Scene

Floats = npt.NDArray[np.float64]

KINDS = ("lambert", "phong-classic", "phong-cosine", "half-vector")


@dataclass(frozen=True)
class Brdf:
    """One material's reflection in one band. diffuse, specular: K_diff, K_spec, 1/sr. exponent: p."""

    kind: str
    diffuse: float
    specular: float
    exponent: float

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise ValueError(f"kind of BRDF: got {self.kind!r}, allowed {', '.join(KINDS)}")

    def value(self, to_light: Floats, to_viewer: Floats) -> Floats:
        """f_r, 1/sr, (…,), for unit directions (…, 3) in the surface's frame, N = (0, 0, 1). 0 where either is not above it.

        phong-classic and half-vector tend to infinity as the light grazes; at N·L = 0 nothing arrives, and the value is 0.
        """
        cos_in, cos_out = to_light[..., 2], to_viewer[..., 2]
        above = (cos_in > 0) & (cos_out > 0)
        lobe = self.lobe(to_light, to_viewer)
        if self.kind in ("phong-classic", "half-vector"):
            lobe = np.divide(lobe, cos_in, out=np.zeros_like(lobe), where=above)
        return np.where(above, self.diffuse + self.specular * lobe, 0.0)

    def lobe(self, to_light: Floats, to_viewer: Floats) -> Floats:
        """max(0, R·V)^p or max(0, N·H)^p, 0 where the cosine is not above 0 for every p."""
        if self.kind == "lambert":
            return np.zeros(np.broadcast_shapes(to_light.shape[:-1], to_viewer.shape[:-1]))
        if self.kind == "half-vector":
            half = to_light + to_viewer
            length = np.linalg.norm(half, axis=-1)
            cosine = np.divide(half[..., 2], length, out=np.zeros_like(length), where=length > 0)
        else:
            cosine = 2 * to_light[..., 2] * to_viewer[..., 2] - np.sum(to_light * to_viewer, axis=-1)
        return np.where(cosine > 0, np.maximum(cosine, 1e-300) ** self.exponent, 0.0)


def brdf_of(material: Material, scene: Scene, band: int) -> Brdf:
    """The reflection of a scene's material in one band (0, 1, 2), by the scene's model."""
    kind = {"phong": "phong-classic", "raytraced": "phong-classic", "opengl": "half-vector"}.get(scene.model, material.brdf)
    return Brdf(kind, material.diffuse[band], material.specular[band], material.exponent)


def direction(polar_rad: npt.ArrayLike, azimuth_rad: npt.ArrayLike = 0.0) -> Floats:
    """Unit directions (…, 3) at these angles from N = (0, 0, 1) and about it."""
    polar, azimuth = np.broadcast_arrays(np.asarray(polar_rad, np.float64), np.asarray(azimuth_rad, np.float64))
    return np.stack([np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)], axis=-1)
