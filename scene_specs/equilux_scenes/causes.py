"""The named rules by which a renderer departs from a scene's model.

The ids are fixed: reports, specs and scripts rely on them.
"""

from __future__ import annotations

import re

CAUSES: dict[str, str] = {
    # image
    "flipped-x": "the picture is mirrored left to right",
    "flipped-y": "the picture is upside down",
    "transposed": "rows and columns of the picture are exchanged",
    "shifted": "the picture is displaced by [dx, dy] pixels",
    "gamma-encoded": "pixels are encoded by a [curve] instead of linear",
    "clamped": "radiance is cut off at a [value]",
    "quantised": "radiance is rounded to a number of [bits]",
    "bands-swapped": "the three bands are in another [order]",
    "scaled": "radiance is multiplied by a constant [k]",
    "fov-other-axis": "the field of view is applied to the other axis of the film",
    # geometry
    "mirrored-handedness": "the world is taken to be left-handed",
    "faceted-normals": "smooth normals are replaced by face normals",
    "smoothed-normals": "face normals are replaced by smooth ones",
    "reversed-normals": "normals point the other way",
    "normal-side": "the normal is not taken on the viewer's side",
    "tessellated": "a curved shape is replaced by triangles",
    "vertex-lighting": "lighting is evaluated at vertices and interpolated",
    # diffuse and highlight
    "diffuse-missing": "the diffuse term is left out",
    "diffuse-two-sided": "light from behind the surface is counted as from the front",
    "half-vector": "the highlight is (N·H)^p instead of (R·V)^p",
    "exponent-clamped": "the highlight's exponent is cut off at a [max]",
    "exponent-scaled": "the highlight's exponent is multiplied by [k]",
    "specular-floored": "R·V is raised to a [floor] before the power",
    "highlight-ungated": "the highlight shows where N·L ≤ 0 too",
    "highlight-cosine": "the highlight is multiplied by N·L",
    "highlight-tinted": "the highlight is multiplied by the diffuse colour",
    "highlight-missing": "the highlight is left out",
    "transmitted-highlight-missing": "the highlight of light from behind is left out",
    "transparent-highlight-unweighted": "the highlight of a transparent surface is not weighted by 1 − t",
    "view-vector-from-eye": "V is taken to the eye point where the rays are parallel",
    "view-vector-fixed": "V is minus the view direction at every pixel",
    # light
    "light-missing": "the light [name] is left out",
    "attenuation-ignored": "light does not fall off with distance",
    "attenuation-term-missing": "one [term] of the attenuation is left out",
    "spot-ignored": "a spot light shines in all directions",
    "spot-cone-doubled": "the spot's half-angle is taken twice as wide",
    "spot-cone-halved": "the spot's half-angle is taken half as wide",
    "spot-exponent-ignored": "the spot's exponent is taken as 0",
    "spot-exponent-clamped": "the spot's exponent is cut off at a [max]",
    "spot-cone-ignored": "the spot's cone has no effect [from °]",
    "light-colours-ignored": "a light's colour, or its separate ambient, diffuse or specular one, has no effect",
    "ambient-missing": "the ambient term is left out",
    "ambient-tinted": "the ambient term is multiplied by the diffuse colour",
    "emission-missing": "the emission is left out",
    "emission-tinted": "the emission is multiplied by the diffuse colour",
    # transport
    "occlusion-ignored": "light passes through objects",
    "transparent-shadow-rule": "transparent objects cast shadows by another rule",
    "reflection-missing": "mirror reflection is left out",
    "refraction-missing": "transmitted light is left out or not bent",
    "recursion-cut": "reflections end after [n] of them",
    "weight-cut": "rays below a weight [w] are not followed",
    "index-inverted": "the refractive index is taken the other way round",
    "tir-weight": "total internal reflection has another weight than 1",
    "nested-media": "the index of an enclosing medium enters the refraction",
    "transmission-uncounted": "transmitted rays do not count towards the recursion limit",
    "shadow-bias": "blockers nearer than a [length] are missed",
    "transparency-weight-ignored": "the weights t and 1 − t are left out",
    "background-missing": "rays that miss show another radiance than the background",
    #
    "unexplained": "none of the named rules accounts for the divergence",
}
"""Cause id → what the renderer does instead; a parameter stands in brackets."""

_THIRD_PARTY = re.compile(r"[a-z0-9][a-z0-9_.-]*:[a-z0-9][a-z0-9_.-]*\Z")


def is_known(cause: str) -> bool:
    """Whether `cause` is one of `CAUSES`, or a third party's own, written `name:cause`."""
    return cause in CAUSES or _THIRD_PARTY.match(cause) is not None
