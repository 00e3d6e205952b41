"""What the tracer can tell about each sample, and how it is stored."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True)
class Channel:
    """One output. `per_light` channels have shape (…, lights, 3), others (…, *trailing)."""

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
    "emission": Channel("K_emit, W/(m²·sr)", np.float64),
    "ambient": Channel("K_amb L_amb, W/(m²·sr)", np.float64),
    "diffuse": Channel("E_i g_i K_diff (N·L_i) of each light, W/(m²·sr)", np.float64, per_light=True),
    "specular": Channel("E_i g_i K_spec max(0, R_i·V)^p of each light, W/(m²·sr)", np.float64, per_light=True),
    "rounding": Channel("bound on the arithmetic error of the radiance, W/(m²·sr); derived in phong.h", np.float64),
    "object_id": Channel("index in scene.objects, −1 where the ray misses", np.int32, ()),
    "depth": Channel("distance along the unit ray, m; inf where the ray misses", np.float64, ()),
    "normal": Channel("N, unit, world, on the viewer's side; 0 where the ray misses", np.float64),
    "position": Channel("P, world, m; NaN where the ray misses", np.float64),
    "signature": Channel("hash of object, face, side, and gate and cone of each light; 0 where the ray misses", np.uint64, ()),
}
