"""Which features a scene requires, computed from its content and never declared by hand.

They select the adapters that can take part, and what each of them emits: a scene without a spot light has no spot statement in
any program.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from equilux_scenes.model import (
    Box,
    DirectionalLight,
    Disc,
    Emitter,
    Light,
    LightColours,
    Material,
    Mesh,
    Object,
    Plane,
    Rectangle,
    Scene,
    Sphere,
    SpotLight,
    Strength,
)
from equilux_scenes.transforms import matrix
from equilux_scenes.units import OTHER_THAN_BANDS

FEATURES: dict[str, str] = {
    "model.phong": "the local Phong model: no occlusion, both faces lit alike",
    "model.opengl": "the fixed-function model: half-vector highlight, light by light an ambient share",
    "model.raytraced": "the model of classical ray tracing: what is seen, mirrored and refracted, to a recursion limit",
    "model.reflection-equation": "the reflected radiance as an integral over the hemisphere, direct light only",
    "camera.perspective": "a pinhole camera",
    "camera.orthographic": "a camera with parallel rays",
    "light.point": "a light at a point",
    "light.directional": "a light at infinity",
    "light.spot": "a point light with a hard cone",
    "light.spot-exponent": "a spot light that weakens away from its axis by cos^e",
    "light.sphere": "an emitting sphere",
    "light.disc": "an emitting disc",
    "light.rectangle": "an emitting rectangle",
    "light.environment": "uniform radiance from all directions that nothing else fills",
    "light.ambient-colour": "a light with an ambient share",
    "light.diffuse-colour": "a light whose diffuse share is not 1",
    "light.specular-colour": "a light whose share in the highlight is not 1",
    "viewer.infinite": "the half vector taken with V = minus the view direction everywhere",
    "attenuation.constant": "a constant term in a light's attenuation",
    "attenuation.linear": "a linear term in a light's attenuation",
    "attenuation.quadratic": "a quadratic term in a light's attenuation",
    "material.diffuse": "a diffuse coefficient",
    "material.specular": "a highlight",
    "material.ambient": "an ambient coefficient in a scene with ambient radiance",
    "material.emission": "an emission",
    "brdf.phong-cosine": "a highlight that is a BRDF of its own, so that it carries the receiver's cosine",
    "occlusion": "objects that may stand between a light and a surface",
    "reflection": "mirror reflection",
    "transparency": "surfaces that let through what lies behind them",
    "refraction": "transparent surfaces that bend the ray",
    "shadow.attenuated": "shadows of transparent objects, weakened by what they let through",
    "shadow.ignored": "transparent objects that cast no shadow",
    "background": "radiance of rays that miss every object",
    "shape.sphere": "a sphere",
    "shape.plane": "an infinite plane",
    "shape.box": "a box",
    "shape.disc": "a disc",
    "shape.rectangle": "a rectangle",
    "shape.cylinder": "a cylinder, capped or not",
    "shape.mesh": "a triangle mesh",
    "normals.flat": "a mesh shaded with its face normals",
    "normals.smooth": "a mesh shaded with interpolated vertex normals",
    "transform": "an object with a transform",
}
"""Feature id → what it is."""

RESOLVED_FEATURES: dict[str, str] = {
    "input.flux": "a light given by its flux",
    "input.photometric": "a light given in candelas, lux, lumens or cd/m²",
    "input.spectrum": "a light given by a spectrum",
    "bands.intervals": "bands that are intervals of wavelengths",
}
"""Features that are dealt with while a scene is read, so that no renderer needs them."""


def required_features(scene: Scene) -> tuple[str, ...]:
    """The feature ids that rendering `scene` needs, sorted. Materials that no object uses do not count."""
    used = [scene.materials[name] for name in {obj.material: None for obj in scene.objects}]
    found = {f"model.{scene.model}", f"camera.{scene.camera.projection}"}
    if scene.bands is not None:
        found.add("bands.intervals")
    if any(scene.background):
        found.add("background")
    if scene.viewer == "infinite":
        found.add("viewer.infinite")
    for light in scene.lights.values():
        found.update(_light_features(light))
    for obj in scene.objects:
        found.update(_object_features(obj))
    for material in used:
        found.update(_material_features(material, scene))
    if scene.model == "raytraced":
        found.update(_transport_features(scene, used))
    elif scene.model == "reflection-equation" and scene.lights and _may_occlude(scene):
        found.add("occlusion")
    return tuple(sorted(found))


def _light_features(light: Light) -> Iterator[str]:
    yield f"light.{light.kind}"
    yield from _input_features(light)
    if isinstance(light, LightColours):
        yield from _colour_features(light)
    if isinstance(light, DirectionalLight | Emitter):
        return
    if isinstance(light, SpotLight) and light.exponent > 0:
        yield "light.spot-exponent"
    for term in ("constant", "linear", "quadratic"):
        if getattr(light.attenuation, term) > 0:
            yield f"attenuation.{term}"


def _input_features(light: Strength) -> Iterator[str]:
    given = {key for key in OTHER_THAN_BANDS if getattr(light, key, None) is not None}
    if given & {"flux", "luminous_flux"}:
        yield "input.flux"
    if given - {"flux", "spectrum"}:
        yield "input.photometric"
    if "spectrum" in given:
        yield "input.spectrum"


def _colour_features(light: LightColours) -> Iterator[str]:
    for term, default in (("ambient", 0.0), ("diffuse", 1.0), ("specular", 1.0)):
        if any(share != default for share in getattr(light, term)):
            yield f"light.{term}-colour"


def _object_features(obj: Object) -> Iterator[str]:
    yield f"shape.{obj.kind}"
    if obj.transform:
        yield "transform"
    if isinstance(obj, Mesh):
        yield f"normals.{obj.normals}"


def _material_features(material: Material, scene: Scene) -> Iterator[str]:
    for term in ("diffuse", "specular", "emission"):
        if any(getattr(material, term)):
            yield f"material.{term}"
    if any(a * b for a, b in zip(material.ambient, scene.ambient, strict=True)):
        yield "material.ambient"
    if material.brdf == "phong-cosine" and any(material.specular):
        yield "brdf.phong-cosine"


def _transport_features(scene: Scene, used: list[Material]) -> Iterator[str]:
    """What ray tracing adds. With a recursion limit of 0 nothing is mirrored or let through: that needs nothing but black."""
    if scene.lights and _may_occlude(scene):
        yield "occlusion"
    for material in used:
        if material.transparency > 0:
            yield "transparency"
            if material.ior != 1:
                yield "refraction"
            if scene.lights:
                yield "shadow.attenuated" if scene.transparent_shadows == "attenuate" else "shadow.ignored"
        if any(material.reflection) and material.transparency < 1:
            yield "reflection"


def _may_occlude(scene: Scene) -> bool:
    """Whether anything can stand between a light and a surface that is seen from the light's side.

    A flat object alone never does so, nor does a sphere or a box alone that is seen from outside; what lets light through might,
    and so might any two surfaces, an emitter's included.
    """
    if len(scene.objects) + len(scene.area_emitters) > 1:
        return True
    return any(scene.materials[obj.material].transparency > 0 or not _faces_lights_freely(obj, scene) for obj in scene.objects)


def _faces_lights_freely(obj: Object, scene: Scene) -> bool:
    if isinstance(obj, Plane | Disc | Rectangle):
        return True
    if not isinstance(obj, Sphere | Box) or scene.camera.projection != "perspective":
        return False
    x, y, z, _ = np.linalg.solve(matrix(obj), (*scene.camera.eye, 1.0))
    if isinstance(obj, Sphere):
        return math.dist((x, y, z), obj.center) > obj.radius
    return any(not low <= value <= high for low, value, high in zip(obj.min, (x, y, z), obj.max, strict=True))
