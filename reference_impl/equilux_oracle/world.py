"""A `raytraced` scene made ready: its objects, and what their materials do to rays, one array entry per object."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from equilux_oracle.doubledouble import Array
from equilux_oracle.shadows import share_per_crossing
from equilux_oracle.visibility import Body, bodies
from equilux_scenes.model import Material, Scene


@dataclass(frozen=True)
class World:
    """A scene made ready. The arrays have one entry per object."""

    scene: Scene
    objects: list[Body]
    materials: list[Material]
    eye_distance: float
    size: Array
    curvature: Array
    stretch: Array
    transparency: Array
    reflection: Array
    transmission: Array
    ior: Array
    shares: Array


def world_of(scene: Scene) -> World:
    objects = bodies(scene)
    materials = [scene.materials[shape.material] for shape in scene.objects]
    eye_distance = math.hypot(*scene.camera.eye)
    return World(
        scene,
        objects,
        materials,
        eye_distance,
        np.array(
            [eye_distance + np.linalg.norm(body.center) + (0.0 if np.isinf(body.radius) else body.radius) for body in objects]
        ),
        np.array([body.curvature for body in objects]),
        np.array([body.stretch for body in objects]),
        np.array([m.transparency for m in materials]),
        np.array([m.reflection for m in materials]).T,
        np.array([m.transmission for m in materials]).T,
        np.array([m.ior for m in materials]),
        share_per_crossing(scene),
    )
