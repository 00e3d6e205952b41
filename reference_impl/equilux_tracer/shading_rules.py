"""What the tracer can be told to do otherwise than the lighting model says: the part of the causes that no change of the scene
can express.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class ShadingRules:
    """Each field's default is the model's own rule. With all at their defaults the kernels have no code for any of them.

    N, V, L, R, H, T, K, t, k as in lighting_model.md; all directions unit. A field that a scene's model has no use for changes
    nothing. Channels, path signature and sensitivity follow the changed rules; channel `rounding` stays a bound.

    Model reflection-equation: lights without an extent follow the fields as in model phong, shadows included. Of the integrals
    over emitters and environment these fields are known: normal_side, normals_reversed, viewer, occlusion, vertex_lighting,
    diffuse_two_sided, highlight_two_sided and highlight_ungated (both: the hemisphere behind N counts, too), highlight_cosine;
    half_vector, specular_floor and shadow_bias_m leave them as they are.
    """

    normal_side: Literal["model", "as-given", "facing-viewer"] = "model"
    """Which side N is taken on. model: N·N_g > 0, N_g the geometric normal on the viewer's side. as-given: the outward normal,
    a mesh's as stored, however it is seen. facing-viewer: the interpolated normal is turned until N·V ≥ 0."""
    normals_reversed: bool = False
    """N → −N, after the side has been chosen."""
    half_vector: bool = False
    """The highlight is the other one of the two: (N·H)^p in place of (R·V)^p; in model opengl (R·V)^p in place of (N·H)^p."""
    diffuse_two_sided: bool = False
    """|N·L| in place of max(0, N·L) in the diffuse term of light from in front and from behind alike (raytraced: of both L_1
    and L_2's local terms)."""
    two_sided_behind: bool = True
    """raytraced, with `diffuse_two_sided`: False: L_2 keeps to light from behind, only L_1 counts both."""
    highlight_two_sided: bool = False
    """Light from behind makes the highlight that it would make about −N: (−N·H)^p; R about −N is R about N."""
    highlight_ungated: bool = False
    """No gate: K_spec max(0, R·V)^p also where N·L ≤ 0, with R = 2 (N·L) N − L as the formula stands."""
    highlight_cosine: bool = False
    """The highlight is multiplied by max(0, N·L) (from behind, and with `highlight_ungated`: by |N·L|). One of brdf phong-cosine
    has its cosine already and gets no second one."""
    cosine_behind: bool = True
    """raytraced, with `highlight_cosine`: False: the highlight of light from behind is not multiplied."""
    specular_floor: float = 0.0
    """max(floor, R·V)^p (or N·H, T·V) in place of max(0, R·V)^p, wherever the gate is open."""
    transmitted_highlight: bool = True
    """raytraced: False: light from behind makes no highlight."""
    highlight_weighted: bool = True
    """raytraced: False: the highlight of light from in front is not multiplied by 1 − t."""
    viewer: Literal["model", "from-eye", "fixed", "from-eye-first", "fixed-first"] = "model"
    """V in every highlight. from-eye: towards the eye point, in every projection. fixed: minus the view direction. -first: so on
    what the camera's own rays meet; on what mirrored and transmitted rays meet V is the model's."""
    occlusion: bool = True
    """False: nothing stands between a light and a surface."""
    transparent_shadow: Literal["model", "opaque", "t-only", "k-only", "one-minus-t", "once", "ignored"] = "model"
    """How much light a crossing of a transparent object lets through, model: t k_trans (or all, as the scene says). opaque:
    nothing. t-only: t. k-only: k_trans. one-minus-t: 1 − t. once: t k_trans for each object, however often it is crossed.
    ignored: all."""
    shadow_bias_m: float = 0.0
    """Blockers nearer to the surface than this are missed."""
    shadow_bias: Literal[
        "along-ray", "along-normal", "along-lit-normal", "along-lit-face", "not-aimed", "before-light", "both-ends"
    ] = "along-ray"
    """along-ray: what a shadow ray meets before `shadow_bias_m` is missed. before-light: what is nearer than that to the light is
    missed instead. both-ends: both. along-normal: the ray starts that far off the surface along N, and ends in the light as
    always. along-lit-normal: along N or −N, whichever is on the light's side. along-lit-face: the same with N_g. not-aimed: as
    along-lit-normal, but the ray goes on in the surface point's own direction to the light, and as far."""
    weight_cut: float = 0.0
    """Secondary rays whose weight (the whole path's, its largest band) is below are not followed."""
    weight_cut_alone: bool = False
    """What `weight_cut` compares is the weight of the last ray alone."""
    total_reflection: Literal[
        "one", "mirror", "transmitted", "none", "k-refl", "one-minus-t", "through", "k-trans", "t", "mirror-and-t"
    ] = "one"
    """Weight of the mirror ray where light is totally reflected. one: 1. mirror: (1 − t) k_refl. transmitted: t k_trans on top of
    (1 − t) k_refl. none: 0. k-refl: k_refl. one-minus-t: 1 − t. through: t k_trans. k-trans: k_trans. t: t. mirror-and-t: t on
    top of (1 − t) k_refl."""
    transmitted_ray: Literal["model", "none", "straight", "inverted", "entering"] = "model"
    """How the view ray goes on through a transparent surface; T is the model's. none: not at all, but total reflection stays.
    straight: unbent, and never totally reflected. inverted: by the inverse ratio of the indices. entering: by the ratio of
    entering the object, also when leaving it."""
    always_entering: bool = False
    """Whoever leaves an object bends as if entering it: the index on N's side is 1, the object's own beyond, T likewise. Says
    nothing under `nested_media` and `media_counted`."""
    nested_media: bool = False
    """A ray that enters an object inside another one bends from the outer object's index, not from 1, and when it leaves, back
    into it; T likewise. Media are spheres, boxes, capped cylinders and planes with t > 0, and meshes of an index other than 1;
    all else with t > 0 is passed straight. The eye may be in all but meshes."""
    media_counted: bool = False
    """As `nested_media`, but whether a ray enters an object or leaves it is told by counting, not by the side that it meets: it
    is in what it went through once and not a second time. A ray that an interpolated normal sent to the wrong side of its face
    is taken for what it is not. A mesh wound inwards has the inverse index inside."""
    transmission_counted: bool = True
    """False: transmitted rays do not count towards the recursion limit: they go on where it has been reached (at most 256 rays in
    succession are followed). Totally reflected ones count."""
    front_weighted: bool = True
    """raytraced: False: L_1 is not multiplied by 1 − t (local terms and mirror ray)."""
    behind_weighted: bool = True
    """raytraced: False: L_2 is not multiplied by t (local terms and transmitted ray), of surfaces with t > 0."""
    opaque_behind: bool = False
    """With `behind_weighted` False: surfaces with t = 0 have an L_2, too."""
    vertex_lighting: bool = False
    """Meshes: the radiance that leaves each vertex (with the vertex normal; flat meshes: the face normal) is interpolated
    linearly over the triangle (perspective-correct). V goes from the vertex to where the triangle is seen from; shadows are those
    of the vertices; mirrored and transmitted rays are each point's own. Other shapes are shaded as always."""


MODEL_RULES = ShadingRules()
