"""The rows of the lecture on the physics of light: what each asks for, where that is, and what a scene must have to show it.

A scene names the rows that it shows (`shows: [constancy-of-radiance]`); `lecture_table` makes the README's table from the corpus.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """One thing the lecture teaches.

    topic: in its words. formula: what is implemented, slips mended. where: files from the project's root. needs: features,
    every one of which a scene that shows the row must require; an entry with | is met by any of its alternatives.
    """

    topic: str
    formula: str
    where: tuple[str, ...]
    needs: tuple[str, ...] = ()


_SPECTRA = "scene_specs/equilux_scenes/spectra.py"
_UNITS = "scene_specs/equilux_scenes/photometry.py"
_LOCAL = "reference_impl/src/phong.h"
_TRANSPORT = "reference_impl/src/transport.h"
_AREA = "reference_impl/src/kernel_emitters.cpp"
_FORMS = "reference_impl/equilux_oracle/emitters/"
_BRDF = "harness/equilux/brdf/"

ROWS: dict[str, Row] = {
    "spectrum": Row("Spectrum: energy per wavelength", "bands = ∫ S(λ) b̄(λ) dλ", (_SPECTRA,), ("input.spectrum",)),
    "photometry": Row(
        "Photometry: eye response, lumen", "Φ_v = K_m ∫ V(λ) P(λ) dλ, K_m = 683.002 lm/W (684 selectable)",
        (_UNITS,), ("input.photometric|input.spectrum",),
    ),
    "luminous-555": Row(
        "Watts to lumens at 555 nm", "K_m V(555 nm) lm/W", (_UNITS, _SPECTRA), ("input.spectrum", "bands.intervals"),
    ),
    "flux": Row("Flux", "Φ = 4π I of an isotropic point light", (_UNITS,), ("input.flux", "light.point")),
    "flux-density": Row("Flux density", "dΦ/dA = E cosθ: the receiver's cosine", (_LOCAL,), ("material.diffuse",)),
    "solid-angle": Row(
        "Solid angle", "Ω = A/R²; cap 2π(1 − cosα), projected π sin²α", (_FORMS,), ("light.sphere|light.disc|light.spot",),
    ),
    "radiance": Row("Radiance", "L, W/(m²·sr): every pixel of every image", ("CONVENTIONS.md",)),
    "constancy-of-radiance": Row("Constancy of radiance along a ray", "L₁ = L₂", ("CONVENTIONS.md",)),
    "brdf": Row(
        "BRDF", "f_r = dL_r / (L_i cosθ_i dω_i), 1/sr; furnace: ρ = π K_diff", (_BRDF, _FORMS),
        ("model.reflection-equation", "material.diffuse|material.specular"),
    ),
    "reflection-equation": Row(
        "Reflection equation", "L_r = ∫ f_r L_i cosθ_i dω_i over the hemisphere, visibility included", (_AREA, _FORMS),
        ("model.reflection-equation", "light.sphere|light.disc|light.rectangle|light.environment"),
    ),
    "reflection-geometry": Row("Reflection geometry", "R = 2 (N·L) N − L", (_LOCAL,), ("material.specular",)),
    "phong-brdf": Row(
        "Phong “BRDF”", "f_r = K_diff + K_spec (R·V)^p, beside what renderers draw, f_r cosθ_i = K_diff cosθ_i + K_spec (R·V)^p",
        (_BRDF, _FORMS, _AREA), ("model.reflection-equation", "material.specular", "brdf.phong-cosine"),
    ),
    "intensity": Row("Intensity of a point light", "I = dΦ/dω, W/sr", (_LOCAL,), ("light.point",)),
    "inverse-square": Row("Light at distance r", "E = I/r² (an irradiance, W/m²)", (_LOCAL,), ("attenuation.quadratic",)),
    "delta-lights": Row(
        "A finite number of directions instead of the integral", "Σ_i over point, directional and spot lights",
        (_LOCAL, _AREA), ("light.point|light.directional|light.spot",),
    ),
    "z-buffer": Row("Phong and Z-buffer rendering", "no occlusion, no shadows", (_LOCAL,), ("model.phong",)),
    "phong": Row(
        "Phong model", "L = K_emit + K_amb L_amb + Σ E_i g_i [K_diff (N·L_i) + K_spec max(0, R_i·V)^p]", (_LOCAL,),
        ("model.phong", "material.diffuse", "material.specular"),
    ),
    "ambient": Row("Ambient term", "K_amb L_amb", (_LOCAL,), ("material.ambient",)),
    "attenuation": Row(
        "Attenuation hack", "I / (d_c + d_l r + d_q r²)", (_LOCAL,), ("attenuation.constant|attenuation.linear",),
    ),
    "directional-plots": Row(
        "Directional plots of the BRDF", "`equilux brdf`: polar plots, ρ(θ), reciprocity, energy", (_BRDF,),
        ("material.specular",),
    ),
    "three-bands": Row("Three colour components, p the same for all", "bands, linear, never gamma-encoded", ("CONVENTIONS.md",)),
    "occlusion": Row("Ray tracing: visible sources", "τ_i of the shadow ray", (_TRANSPORT,), ("model.raytraced", "occlusion")),
    "mirror": Row("Radiance from the reflected ray", "k_refl L_refl", (_TRANSPORT,), ("model.raytraced", "reflection")),
    "refraction": Row(
        "Radiance from the refracted ray", "k_trans L_trans, total internal reflection", (_TRANSPORT,),
        ("model.raytraced", "refraction"),
    ),
    "light-behind": Row(
        "Sources behind", "L_2: K_diff |N·L| + K_spec max(0, T·V)^p", (_TRANSPORT,),
        ("model.raytraced", "transparency", "material.specular"),
    ),
    "transparency": Row(
        "Transparency t", "K_amb L_amb + (1 − t) L_1 + t L_2", (_TRANSPORT,), ("model.raytraced", "transparency"),
    ),
    "transparent-shadows": Row(
        "Occlusion by what is transparent", "t k_trans per crossing, or none", (_TRANSPORT,),
        ("model.raytraced", "shadow.attenuated|shadow.ignored"),
    ),
    "recursion": Row(
        "Classical ray tracing, recursively", "to a recursion limit", (_TRANSPORT,), ("model.raytraced", "reflection|refraction")
    ),
    "opengl": Row(
        "OpenGL model", "e_m + a_m a_global + Σ att spot [a_m a_i + d_m d_i max(0, N·L) + f s_m s_i max(0, N·H)^s]",
        ("reference_impl/src/opengl.h", "adapters/equilux_adapters/opengl/"), ("model.opengl", "material.specular"),
    ),
    "opengl-emission": Row("OpenGL: emission", "e_m", ("reference_impl/src/opengl.h",), ("model.opengl", "material.emission")),
    "opengl-ambient": Row(
        "OpenGL: ambient term per object", "a_m a_global", ("reference_impl/src/opengl.h",), ("model.opengl", "material.ambient")
    ),
    "opengl-light-colours": Row(
        "OpenGL: ambient, diffuse, specular light “intensities”", "a_i, d_i, s_i", ("reference_impl/src/opengl.h",),
        ("model.opengl", "light.ambient-colour", "light.diffuse-colour|light.specular-colour"),
    ),
}  # fmt: skip
"""Row id → row, in the lecture's order."""


def missing_features(row_id: str, features: Iterable[str]) -> list[str]:
    """What of a row's needs these features do not meet."""
    present = set(features)
    return [need for need in ROWS[row_id].needs if present.isdisjoint(need.split("|"))]
