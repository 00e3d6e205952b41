"""Which features a scene requires, computed from its content and never declared by hand.

They select the adapters that can take part, and what each of them emits: a scene without a spot light has no spot statement in
any program.
"""

from __future__ import annotations

from collections.abc import Iterator

from equilux_scenes.model import DirectionalLight, Light, Material, Mesh, Object, Scene, SpotLight

FEATURES: dict[str, str] = {
    "model.phong": "the local Phong model: no occlusion, both faces lit alike",
    "camera.perspective": "a pinhole camera",
    "camera.orthographic": "a camera with parallel rays",
    "light.point": "a light at a point",
    "light.directional": "a light at infinity",
    "light.spot": "a point light with a hard cone",
    "light.spot-exponent": "a spot light that weakens away from its axis by cos^e",
    "attenuation.constant": "a constant term in a light's attenuation",
    "attenuation.linear": "a linear term in a light's attenuation",
    "attenuation.quadratic": "a quadratic term in a light's attenuation",
    "material.diffuse": "a diffuse coefficient",
    "material.specular": "a highlight",
    "material.ambient": "an ambient coefficient in a scene with ambient radiance",
    "material.emission": "an emission",
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


def required_features(scene: Scene) -> tuple[str, ...]:
    """The feature ids that rendering `scene` needs, sorted. Materials that no object uses do not count."""
    found = {f"model.{scene.model}", f"camera.{scene.camera.projection}"}
    if any(scene.background):
        found.add("background")
    for light in scene.lights.values():
        found.update(_light_features(light))
    for obj in scene.objects:
        found.update(_object_features(obj))
        found.update(_material_features(scene.materials[obj.material], scene))
    return tuple(sorted(found))


def _light_features(light: Light) -> Iterator[str]:
    yield f"light.{light.kind}"
    if isinstance(light, DirectionalLight):
        return
    if isinstance(light, SpotLight) and light.exponent > 0:
        yield "light.spot-exponent"
    for term in ("constant", "linear", "quadratic"):
        if getattr(light.attenuation, term) > 0:
            yield f"attenuation.{term}"


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
