"""What the tracer can tell about each sample, and how it is stored."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True)
class Channel:
    """One output. `per_light` channels have shape (…, lights, 3), others (…, *trailing).

    lights: those without an extent, in scene.delta_lights' order; then scene.area_emitters; last the environment, if any.
    """

    meaning: str
    dtype: type[np.generic]
    trailing: tuple[int, ...] = (3,)
    per_light: bool = False

    def shape(self, lights: int) -> tuple[int, ...]:
        """The shape of one sample."""
        return (lights, *self.trailing) if self.per_light else self.trailing

    def empty(self, leading: tuple[int, ...], lights: int) -> npt.NDArray[np.generic]:
        """An array for samples of shape `leading`."""
        return np.empty((*leading, *self.shape(lights)), dtype=self.dtype)


CHANNELS: dict[str, Channel] = {
    "radiance": Channel("L(V), W/(m²·sr); the background where the ray misses", np.float64),
    "emission": Channel("K_emit of the first surface, W/(m²·sr)", np.float64),
    "ambient": Channel("K_amb L_amb of the first surface (opengl: a_m a_global), W/(m²·sr)", np.float64),
    "light_ambient": Channel("opengl: att_i spot_i a_m a_i of each light, W/(m²·sr); else 0", np.float64, per_light=True),
    "diffuse": Channel(
        "E_i g_i K_diff (N·L_i) of each light; raytraced: times its shadow τ_i and 1 − t in front, t behind; "
        "reflection-equation: L_e K_diff ∫ cosθ dω of an emitter; W/(m²·sr)",
        np.float64,
        per_light=True,
    ),
    "specular": Channel(
        "E_i g_i K_spec max(0, R_i·V)^p of each light (opengl: the half vector's; raytraced: weighted as diffuse, T_i·V behind; "
        "reflection-equation: the integral over an emitter), W/(m²·sr)",
        np.float64,
        per_light=True,
    ),
    "reflected": Channel(
        "raytraced: (1 − t) k_refl L_refl at the first surface, or what total internal reflection shows there, W/(m²·sr); else 0",
        np.float64,
    ),
    "transmitted": Channel("raytraced: t k_trans L_trans at the first surface, W/(m²·sr); else 0", np.float64),
    "rounding": Channel(
        "bound on the arithmetic error of the radiance, W/(m²·sr); derived in phong.h, opengl.h and raytraced.h", np.float64
    ),
    "quadrature": Channel(
        "reflection-equation: bound on the error of the integrals over the emitters, W/(m²·sr); derived in quadrature.h; else 0",
        np.float64,
    ),
    "object_id": Channel(
        "index in scene.objects; an emitter counts on from there: len(scene.objects) + its place in scene.area_emitters; −1 "
        "where the ray misses",
        np.int32,
        (),
    ),
    "depth": Channel("distance along the unit ray, m; inf where the ray misses", np.float64, ()),
    "normal": Channel("N, unit, world, on the viewer's side; 0 where the ray misses", np.float64),
    "position": Channel("P, world, m; NaN where the ray misses", np.float64),
    "signature": Channel(
        "hash of object, face, side, and gate and cone of each light; reflection-equation: and visibility of each light without "
        "an extent; raytraced: at every hit, with visibility of each light and total reflection; 0 where the first ray misses",
        np.uint64,
        (),
    ),
}
"""What may be asked for. On a hit, emission + ambient + Σ (light_ambient + diffuse + specular) + reflected + transmitted is the
radiance."""
