"""The scene's lights and materials as the API takes them: said once, for scripts and for budgets."""

from __future__ import annotations

from collections.abc import Sequence

from equilux.adapter import Unsupported
from equilux_adapters.opengl.kit.stage import Light, Surface
from equilux_scenes.model import DeltaLight, DirectionalLight, Material, Scene, SpotLight

MOST = 128.0
"""Of `GL_SHININESS` and `GL_SPOT_EXPONENT` (Q6)."""


def light_of(light: DeltaLight) -> Light:
    """What is multiplied by the light's strength here, the API multiplies no more. Raises Unsupported."""
    strength = light.irradiance if isinstance(light, DirectionalLight) else light.intensity
    ambient, diffuse, specular = (_times(strength, share) for share in (light.ambient, light.diffuse, light.specular))
    if isinstance(light, DirectionalLight):
        return Light(ambient, diffuse, specular, direction=light.direction)
    terms = (light.attenuation.constant, light.attenuation.linear, light.attenuation.quadratic)
    if not isinstance(light, SpotLight):
        return Light(ambient, diffuse, specular, position=light.position, attenuation=terms)
    if light.exponent > MOST:
        raise Unsupported(["light.spot-exponent"], f"spot exponent {light.exponent:g}: OpenGL has 0 to 128")
    return Light(
        ambient, diffuse, specular, position=light.position, direction=light.direction, attenuation=terms,
        cutoff_deg=light.cone_half_angle_deg, exponent=light.exponent,
    )  # fmt: skip


def surface_of(material: Material) -> Surface:
    """What lets light through is drawn opaque, with the share 1 − t of light from the front that is its own (Q8). Raises
    Unsupported."""
    kept = (1 - material.transparency,) * 3
    if not any(material.specular):
        return Surface(material.ambient, _times(kept, material.diffuse), emission=material.emission)
    if material.exponent > MOST:
        raise Unsupported(["material.specular"], f"exponent {material.exponent:g}: OpenGL has 0 to 128")
    return Surface(
        material.ambient, _times(kept, material.diffuse), _times(kept, material.specular), material.emission, material.exponent
    )


def local_viewer(scene: Scene) -> bool:
    """Whether V goes to the eye point: what an `opengl` scene says, and else what the model means by V, minus the view
    direction where rays are parallel."""
    return scene.viewer == "local" if scene.model == "opengl" else scene.camera.projection == "perspective"


def _times(a: Sequence[float], b: Sequence[float]) -> tuple[float, ...]:
    return tuple(x * y for x, y in zip(a, b, strict=True))
