"""The local frame of a shaded point: z = N, and the view in the x z plane.

The highlight's axis is M = 2 (N·V) N − V, the mirror direction of the view, because R·V = L·M for every L. With a = N·V and
b = √(1 − a²) it is M = (b, 0, a). The frame is also that of M's own horizon: with T = (−a, 0, b), N = a M + b T.
Found in double-double and rounded once, so that x keeps its digits however small b is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equilux_oracle.doubledouble import DD, Array, Index, dot


@dataclass(frozen=True)
class Frame:
    """n frames: the axes in the world (3, n), a = N·V and b = √(1 − a²), (n,)."""

    x: Array
    y: Array
    z: Array
    a: Array
    b: Array

    @classmethod
    def of(cls, normal: DD, to_viewer: DD) -> Frame:
        """From unit N and V, (3, n), N·V ≥ 0. Seen along the normal, x is any direction across it."""
        cosine = dot(normal, to_viewer)
        across = (normal * cosine - to_viewer).hi
        z, b = normal.hi, np.sqrt(np.sum(across**2, axis=0))
        away = b > 0.0
        x = np.where(away, across / np.where(away, b, 1.0), _across(z))
        return cls(x, np.cross(z, x, axis=0), z, np.maximum(cosine.hi, 0.0), b)

    def local(self, v: Array) -> Array:
        """World vectors (3, n) or (3, 1) in the frames' own coordinates, (3, n)."""
        return np.stack([np.sum(axis * v, axis=0) for axis in (self.x, self.y, self.z)])

    def __len__(self) -> int:
        return len(self.a)

    def __getitem__(self, chosen: Index) -> Frame:
        return Frame(self.x[:, chosen], self.y[:, chosen], self.z[:, chosen], self.a[chosen], self.b[chosen])

    @property
    def mirror(self) -> Array:
        """M in local coordinates, (3, n)."""
        return np.stack([self.b, np.zeros_like(self.b), self.a])


def _across(z: Array) -> Array:
    """Some unit vector orthogonal to each z."""
    least = np.argmin(np.abs(z), axis=0)
    axis = np.zeros_like(z)
    axis[least, np.arange(z.shape[1])] = 1.0
    v = np.cross(axis, z, axis=0)
    result: Array = v / np.sqrt(np.sum(v**2, axis=0))
    return result
