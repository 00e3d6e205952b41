"""What a renderer can get wrong: the settings of the plain renderer (renderer.py). The defaults are the lighting model.

Written from the lighting model and the words of the cause ids alone: nothing here knows how causes are diagnosed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
SceneEdit = Callable[[Any], Any]
"""A Case as it should be read → the Case that the renderer believes it was given."""
FilmEdit = Callable[[Array, int, int], Array]
"""Film positions (n, 2), width, height → where the renderer looks instead."""
PictureEdit = Callable[[Array], Array]
"""(h, w, 3) → the picture that is written."""


@dataclass(frozen=True)
class Faults:
    """N, V, L, R, H, T, t, k as in the lighting model."""

    case: tuple[SceneEdit, ...] = ()
    film: tuple[FilmEdit, ...] = ()
    picture: tuple[PictureEdit, ...] = ()
    field_of_view: Literal["vertical", "horizontal"] = "vertical"

    side: Literal["by facet", "as stored", "by N·V"] = "by facet"
    """How N is turned to the viewer."""
    reversed_normals: bool = False
    """−N, after it has been turned."""
    at_vertices: bool = False
    """Meshes are lit at their vertices, and what comes out is interpolated. Local models only."""

    two_sided: Literal["", "diffuse", "normal"] = ""
    """Light from behind: |N·L| in the diffuse term; or N turned to the light, so that there is a highlight too."""
    other_lobe: bool = False
    """N·H where the model has R·V, and the other way round."""
    floor: float = 0.0
    """R·V (or N·H) is raised to it before the power."""
    gated: bool = True
    lobe_cosine: bool = False
    """The highlight times N·L."""
    viewer: Literal["model", "eye", "eye at the first hit", "axis", "axis at the first hit"] = "model"
    """Where V of the highlight points: to the eye point, or against the view direction."""

    ambient_of_lights: bool = True
    """opengl: the lights' own ambient counts."""
    blockers: bool = True
    """Objects cast shadows."""
    through: Literal["model", "nothing", "all", "t", "k", "once"] = "model"
    """What light a crossing of a transparent object lets through. once: t k, but once per object."""
    bias_m: float = 0.0
    """Blockers nearer than this to the surface are missed."""
    bias_along: Literal["ray", "normal"] = "ray"
    """normal: shadow rays start that far above the surface."""
    mirrors: Literal["model", "none", "not even total"] = "model"
    glass: Literal["model", "opaque", "opaque, total too", "straight"] = "model"
    """The transmitted ray: left out (with or without the totally reflected one), or not bent."""
    inverted_index: Literal["", "view", "all"] = ""
    """η upside down: for the view ray alone, or for the highlight of light from behind too."""
    nested: bool = False
    """The index on the outer side is that of the medium the ray comes from."""
    count_transmitted: bool = True
    least_weight: float = 0.0
    """Rays of a smaller weight are not followed."""
    weighed: Literal["product", "alone"] = "product"
    """Which weight: of the whole path or of the last ray."""
    total: Literal["one", "k_refl", "(1-t) k_refl", "t k_trans", "none"] = "one"
    """Weight of the mirror ray where there is total reflection."""
    lobe_behind: bool = True
    """Light from behind makes a highlight."""
    lobe_weighted: bool = True
    """The highlight of light from in front is weighted by 1 − t."""
    front_weighted: bool = True
    """L_1 is weighted by 1 − t."""
    behind_weighted: bool = True
    """L_2 is weighted by t."""
    background: Literal["model", "black for the eye", "black in mirrors"] = "model"


NONE = Faults()


def together(a: Faults, b: Faults) -> Faults:
    """Both faults in one renderer, a's before b's. Raises ValueError where they want one setting in two ways."""
    changed = {}
    for field in fields(Faults):
        of_a, of_b, right = (getattr(x, field.name) for x in (a, b, NONE))
        if isinstance(right, tuple):
            changed[field.name] = of_a + of_b
        elif right not in (of_a, of_b) and of_a != of_b:
            raise ValueError(f"{field.name}: one fault wants {of_a!r}, the other {of_b!r}")
        else:
            changed[field.name] = of_b if of_a == right else of_a
    return replace(NONE, **changed)
