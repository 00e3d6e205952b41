"""What of the fixed-function model POV-Ray has: its half vector, and one POV-Ray light where the colours of a light allow it."""

from __future__ import annotations

from equilux.adapter import Unsupported
from equilux_scenes.case import Case
from equilux_scenes.model import DeltaLight, DirectionalLight, OrthographicCamera


def check_viewer(case: Case) -> None:
    """Raise Unsupported where V of the half vector is not minus the direction of the ray, and the scene shows it (Q40)."""
    orthographic = isinstance(case.scene.camera, OrthographicCamera)
    if case.scene.model != "opengl" or "material.specular" not in case.requires:
        return
    if case.scene.viewer == "infinite" and not orthographic:
        raise Unsupported(["viewer.infinite"], "in a perspective view POV-Ray takes V to the eye")
    if case.scene.viewer == "local" and orthographic:
        raise Unsupported(["camera.orthographic"], "viewer local: POV-Ray takes V against the direction of an orthographic view")


def shown_light(light: DeltaLight, case: Case) -> DeltaLight:
    """`light` with the share of its diffuse or specular colour that the scene's surfaces show.

    A POV-Ray light has one colour for the diffuse term and the highlight, and none that ignores N·L. Raises Unsupported, naming
    the features, where the scene shows more.
    """
    if case.scene.model != "opengl":
        return light
    used = [case.scene.materials[obj.material] for obj in case.scene.objects]
    if any(share and any(m.ambient[k] for m in used) for k, share in enumerate(light.ambient)):
        raise Unsupported(["light.ambient-colour"], "POV-Ray has no light that adds to a surface whatever side it faces")
    share = []
    for k, (diffuse, specular) in enumerate(zip(light.diffuse, light.specular, strict=True)):
        shines = any(m.specular[k] for m in used)
        if diffuse != specular and shines and any(m.diffuse[k] for m in used):
            features = ["light.diffuse-colour" if diffuse != 1 else "light.specular-colour"]
            raise Unsupported(features, "a POV-Ray light has one colour for the diffuse term and the highlight")
        share.append(specular if shines else diffuse)
    key = "irradiance" if isinstance(light, DirectionalLight) else "intensity"
    bands = tuple(value * part for value, part in zip(getattr(light, key), share, strict=True))
    return light.model_copy(update={key: bands})
