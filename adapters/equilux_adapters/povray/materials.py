"""What a material does in its scene, term by term as POV-Ray is to show it: weighted, and zero where it cannot show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from equilux_scenes.model import Material, Scene

Triple = Sequence[float]

BLACK = (0.0, 0.0, 0.0)

@dataclass(frozen=True)
class Coefficients:
    """The weights of every term, after the model's (1 − t) and t.

    diffuse: K_diff, the pigment; front and back: its weights for lights in front and behind. specular: with weight (1 − t) in it.
    half_vector: whether the highlight is (N·H)^p instead of (R·V)^p. reflection: (1 − t) k_refl. through: t k_trans where the
    surface is transparent, else None. ior: of the inner side.
    """

    diffuse: Triple
    specular: Triple
    exponent: float
    ambient: Triple
    emission: Triple
    front: float = 1.0
    back: float = 0.0
    half_vector: bool = False
    reflection: Triple = BLACK
    through: Triple | None = None
    ior: float = 1.0

    @property
    def onward(self) -> float:
        """An upper bound of how much of what secondary rays find is added; a total reflection counts 1."""
        if self.through is None:
            return max(self.reflection)
        both = max(r + k for r, k in zip(self.reflection, self.through, strict=True))
        return max(both, 1.0) if self.ior != 1 else both

    @property
    def shine(self) -> float:
        """An upper bound of the radiance per irradiance that lights are reflected with."""
        weight = max(self.front, self.back)
        return max(d * weight + s for d, s in zip(self.diffuse, self.specular, strict=True))


def coefficients(material: Material, scene: Scene) -> Coefficients:
    """The terms of `material` in `scene`."""
    shown = tuple(k if light else 0.0 for k, light in zip(material.ambient, scene.ambient, strict=True))
    t = material.transparency
    return Coefficients(
        diffuse=material.diffuse,
        specular=_weighted(1.0 - t, material.specular),
        exponent=material.exponent,
        ambient=shown,
        emission=material.emission,
        front=1.0 - t,
        back=t,
        half_vector=scene.model == "opengl",
        reflection=_weighted(1.0 - t, material.reflection),
        through=_weighted(t, material.transmission) if t > 0 else None,
        ior=material.ior,
    )


def _weighted(weight: float, bands: Triple) -> Triple:
    return tuple(weight * band for band in bands)
