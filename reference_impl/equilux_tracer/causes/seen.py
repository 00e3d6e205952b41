"""What the camera's own rays see of emitters and background: what a renderer may show, or not, apart from the rest."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from equilux_scenes.case import Case
from equilux_scenes.model import AreaEmitter, Emitter, PointLight, SphereEmitter, SpotLight
from equilux_scenes.units import OTHER_THAN_BANDS
from equilux_tracer.causes.rewrite import BLACK, WHITE, with_lights, with_materials, with_scene
from equilux_tracer.causes.rule import Floats
from equilux_tracer.tracer import Tracer


def emitters_seen(case: Case, names: Collection[str], film_xy: Floats) -> Floats:
    """(n, 3): the radiance of these emitters where they are seen, 0 elsewhere; film_xy (n, 2)."""
    black = with_materials(case, lambda _: {"diffuse": BLACK, "specular": BLACK, "emission": BLACK})
    only = with_lights(black, lambda name, light: {"radiance": BLACK} if isinstance(light, Emitter) and name not in names else {})
    return np.asarray(Tracer(with_scene(_without_delta_lights(only), background=BLACK)).evaluate(film_xy)["radiance"], np.float64)


def background_seen(case: Case, film_xy: Floats) -> Floats:
    """(n, 3): background or environment where the camera's rays miss everything, 0 elsewhere; film_xy (n, 2)."""
    scene = case.scene
    black = with_materials(case, lambda _: {"diffuse": BLACK, "specular": BLACK, "ambient": BLACK, "emission": BLACK})
    if scene.model == "reflection-equation":
        only = with_lights(black, lambda _, light: {"radiance": BLACK} if isinstance(light, AreaEmitter) else {})
        only = _without_delta_lights(only)
    else:
        only = with_scene(black, lights={}, model="phong")
    return np.asarray(Tracer(only).evaluate(film_xy)["radiance"], np.float64)


def weight_at_depth(case: Case, depth: int, film_xy: Floats) -> Floats:
    """(n, 3): of all rays that are the depth-th mirrored or refracted one in succession, the weights in the pixel summed up."""
    glowing = with_materials(case, lambda _: {"diffuse": BLACK, "specular": BLACK, "ambient": BLACK, "emission": WHITE})
    glowing = with_scene(glowing, lights={}, background=WHITE)
    up_to, before = (
        np.asarray(Tracer(with_scene(glowing, recursion_limit=limit)).evaluate(film_xy)["radiance"], np.float64)
        for limit in (depth, depth - 1)
    )
    return np.maximum(up_to - before, 0)


def _without_delta_lights(case: Case) -> Case:
    return with_scene(case, lights={name: light for name, light in case.scene.lights.items() if isinstance(light, Emitter)})


def absent_emitter(case: Case) -> SphereEmitter:
    """An emitter in place of one that is not there: a black speck far behind the eye. Its solid angle is below 1e-18 sr."""
    eye, target = np.asarray(case.scene.camera.eye), np.asarray(case.scene.camera.target)
    backward = (eye - target) / np.linalg.norm(eye - target)
    size = reach(case)
    center = eye + 1e3 * size * backward
    return SphereEmitter(kind="sphere", center=tuple(center.tolist()), radius=1e-7 * size, radiance=BLACK)


def reach(case: Case) -> float:
    """A length, m: nothing bounded in the scene is farther from the origin, neither eye nor lights nor corners."""
    scene = case.scene
    places = [scene.camera.eye, scene.camera.target]
    places += [light.position for light in scene.lights.values() if isinstance(light, PointLight | SpotLight)]
    numbers = [light.model_dump(exclude={*OTHER_THAN_BANDS, "radiance"}) for light in scene.area_emitters.values()]
    numbers += [obj.model_dump(exclude={"transform"}) for obj in scene.objects]
    numbers += [step.model_dump(exclude={"rotate"}) for obj in scene.objects for step in obj.transform]
    sizes = [float(np.abs(mesh.vertices).max(initial=0)) for mesh in case.meshes.values()]
    return max(_largest([places, numbers, sizes]), 1e-30)


def _largest(value: object) -> float:
    if isinstance(value, dict):
        return max((_largest(part) for part in value.values()), default=0.0)
    if isinstance(value, list | tuple):
        return max((_largest(part) for part in value), default=0.0)
    return abs(value) if isinstance(value, float) else 0.0
