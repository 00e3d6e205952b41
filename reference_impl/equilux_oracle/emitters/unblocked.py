"""Whether a scene has a closed form: whether every lit point that is seen receives each emitter whole, but for its own horizon.

The horizon is part of the closed form, and so is what a body blocks of the environment. What is not is a body partly behind
another. It suffices that, for each lit object O and each body X that covers something for it (an emitter that shines on it; any
body, in an environment), the convex hull of O and X meets no third body: every way from O to X lies in that hull. And O must
not block its own light otherwise than by its horizon: it is flat, or convex and closed and seen from outside. All this is
proven or taken as not so, never sampled. Lights without an extent need none of it: whether one is blocked is a question about
one ray.
"""

from __future__ import annotations

import numpy as np

from equilux_oracle.camera import camera_frame
from equilux_oracle.doubledouble import Array
from equilux_oracle.emitters.convex import Convex, apart, convex, hull
from equilux_oracle.emitters.covers import cover_of
from equilux_scenes.case import Case
from equilux_scenes.model import (
    AreaEmitter,
    Box,
    Cylinder,
    Disc,
    Material,
    Mesh,
    Object,
    PerspectiveCamera,
    Plane,
    Rectangle,
    Scene,
    SphereEmitter,
)
from equilux_scenes.transforms import matrix


def supports(case: Case) -> list[str]:
    """The features of a case that have no closed form, sorted; empty where there is one."""
    return sorted(lacking(case))


def lacking(case: Case) -> dict[str, str]:
    """The same, each with the reason."""
    scene = case.scene
    meshes = [shape for shape in scene.objects if isinstance(shape, Mesh)]
    if meshes:
        return dict.fromkeys(("shape.mesh", *(f"normals.{shape.normals}" for shape in meshes)), "a mesh is data, not a formula")
    return {} if _is_unblocked(scene) else {"occlusion": "something may hide part of an emitter from what it lights"}


def _is_unblocked(scene: Scene) -> bool:
    everything: list[Object | AreaEmitter] = [*scene.objects, *scene.area_emitters.values()]
    sets = [convex(body) for body in everything]
    environment = scene.environment is not None and any(scene.environment.radiance)
    for index, shape in enumerate(scene.objects):
        if not _reflects(scene.materials[shape.material]):
            continue
        others = [other for other in range(len(everything)) if other != index]
        covering = [other for other in others if environment or _lights(everything[other], sets[index])]
        if (covering or environment) and not _receives_freely(shape, sets[index], scene):
            return False
        if environment and any(cover_of(everything[other], scene.camera.eye) is None for other in covering):
            return False
        for other in covering:
            ways = hull([sets[index], sets[other]])
            if not all(apart(ways, sets[third]) for third in others if third != other):
                return False
    return True


def _reflects(material: Material) -> bool:
    return any(material.diffuse) or (any(material.specular) and material.brdf != "lambert")


def _lights(body: Object | AreaEmitter, lit: Convex) -> bool:
    """Whether a body is an emitter that may shine on anything of `lit`."""
    if isinstance(body, SphereEmitter):
        return any(body.radiance)
    if not isinstance(body, AreaEmitter) or not any(body.radiance):
        return False
    (normal,) = convex(body).normals
    return lit.reach(normal) > convex(body).reach(normal)


def _receives_freely(shape: Object, extent: Convex, scene: Scene) -> bool:
    """Whether an object blocks its own light by nothing but the horizon of its points."""
    if isinstance(shape, Plane | Disc | Rectangle):
        return True
    if isinstance(shape, Cylinder) and not shape.capped:
        return False
    camera, eye = scene.camera, np.asarray(scene.camera.eye)
    if isinstance(camera, PerspectiveCamera):
        return not _contains(shape, eye)
    forward: Array = camera_frame(camera)[2].hi[:, 0]
    return extent.reach(-forward) <= -float(forward @ eye)


def _contains(shape: Object, point: Array) -> bool:
    """Whether a closed solid contains a point of the world."""
    x = np.linalg.solve(matrix(shape), np.array([*point, 1.0]))[:3]
    if isinstance(shape, Box):
        return bool(np.all((np.asarray(shape.min) <= x) & (x <= np.asarray(shape.max))))
    if isinstance(shape, Cylinder):
        base = np.asarray(shape.base)
        axis = np.asarray(shape.top) - base
        along = float((x - base) @ axis / (axis @ axis))
        return 0.0 <= along <= 1.0 and float(np.linalg.norm(x - base - along * axis)) <= shape.radius
    center, radius = shape.center, shape.radius  # type: ignore[union-attr]  # what is left is the sphere
    return float(np.linalg.norm(x - np.asarray(center))) <= radius
