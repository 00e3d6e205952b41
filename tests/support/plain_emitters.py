"""Model `reflection-equation` in plain NumPy: the integrals over the emitters by randomised lattices of light rays, one film
position at a time, with a standard error.

It shares no code with the tracer or the oracle: nothing is cut, culled or skipped. Unbiased, so that what disagrees by many
standard errors is wrong.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from equilux_scenes.case import Case
from equilux_scenes.model import Disc, DiscEmitter, EnvironmentEmitter, Rectangle, RectangleEmitter, Sphere
from support.plain_phong import Hits, _nearer, arriving, rays, turned

Array = npt.NDArray[np.float64]

OWN_CROSSING = 1e-9
"""Crossings nearer to a light ray's start than this, in metres, are the start itself: scenes here are about 1 m in size."""


@dataclass
class Estimate:
    """Radiance at one film position, its standard error, and which object is seen (emitters count on from the objects; −1)."""

    radiance: Array
    sigma: Array
    object_id: int


def radiance(case: Case, film_xy: tuple[float, float], *, points: int = 1021, shifts: int = 16, seed: int = 0) -> Estimate:
    """`shifts` independent lattices of `points` light rays for each emitter."""
    scene = case.scene
    origin, direction = rays(case, np.array([film_xy]))
    hits = nearest(case, origin, direction, 0.0)
    seen = int(hits.object_id[0])
    if seen < 0:
        return Estimate(np.array(scene.environment.radiance if scene.environment else scene.background), np.zeros(3), seen)
    to_viewer = -_unit(direction)
    outside = float(np.sum(hits.geometric * to_viewer)) > 0
    if seen >= len(scene.objects):
        emitter = list(scene.area_emitters.values())[seen - len(scene.objects)]
        return Estimate(np.array(emitter.radiance) * outside, np.zeros(3), seen)
    point = origin + hits.t[:, None] * direction
    geometric = turned(hits.geometric, to_viewer)
    normal = _unit(turned(hits.normal, geometric))
    material = scene.materials[scene.objects[seen].material]

    rng = np.random.default_rng(seed)
    value, variance = np.array(material.emission, dtype=float), np.zeros(3)
    for light in scene.lights.values():
        if hasattr(light, "radiance"):
            means = [_integral(case, material, point, normal, to_viewer, light, _lattice(points, rng)) for _ in range(shifts)]
            value += np.mean(means, axis=0)
            variance += np.var(means, axis=0, ddof=1) / shifts
        else:
            value += _delta(case, material, point, normal, to_viewer, light)
    return Estimate(value, np.sqrt(variance), seen)


def nearest(case: Case, origin: Array, direction: Array, start: float) -> Hits:
    """The first crossing of n rays beyond t = start with objects and emitters, the latter numbered on from the former."""
    n = len(origin)
    hits = Hits(np.full(n, np.inf), np.zeros((n, 3)), np.zeros((n, 3)), np.full(n, -1))
    ahead = origin + start * direction
    everything = [*case.scene.objects, *(_shape(emitter) for emitter in case.scene.area_emitters.values())]
    for index, obj in enumerate(everything):
        _nearer(hits, index, obj, case.meshes.get(index), ahead, direction)
    hits.t = hits.t + start
    return hits


def _integral(case: Case, material: Any, point: Array, normal: Array, to_viewer: Array, light: Any, uv: Array) -> Array:
    """∫ f_r L cosθ dω by one lattice: the mean of integrand over density."""
    if isinstance(light, EnvironmentEmitter):
        direction, density = _hemisphere(normal[0], uv)
    else:
        direction, density = _towards(light, point[0], uv)
    cosine = direction @ normal[0]
    useful = (cosine > 0) & (density > 0)
    if not useful.any():
        return np.zeros(3)
    direction, density, cosine = direction[useful], density[useful], cosine[useful]
    hits = nearest(case, np.broadcast_to(point, direction.shape), direction, OWN_CROSSING)
    if isinstance(light, EnvironmentEmitter):
        reached = hits.object_id < 0
    else:
        index = len(case.scene.objects) + list(case.scene.area_emitters.values()).index(light)
        faces = np.sum(hits.geometric * direction, axis=1) < 0
        reached = (hits.object_id == index) & faces
    weight = _reflected(material, normal, to_viewer, direction, cosine) * (reached / density)[:, None]
    return np.array(light.radiance) * weight.sum(axis=0) / len(uv)


def _delta(case: Case, material: Any, point: Array, normal: Array, to_viewer: Array, light: Any) -> Array:
    irradiance, direction = arriving(light, point)
    cosine = direction @ normal[0]
    if cosine[0] <= 0:
        return np.zeros(3)
    distance = math.inf if light.kind == "directional" else float(np.linalg.norm(np.array(light.position) - point[0]))
    if nearest(case, point, direction, OWN_CROSSING).t[0] < distance:
        return np.zeros(3)
    return (irradiance * _reflected(material, normal, to_viewer, direction, cosine))[0]


def _reflected(material: Any, normal: Array, to_viewer: Array, direction: Array, cosine: Array) -> Array:
    """f_r cosθ, (n, 3)."""
    result = np.array(material.diffuse) * cosine[:, None]
    if material.brdf == "lambert":
        return result
    mirrored = (2 * cosine[:, None] * normal - direction) @ to_viewer[0]
    lobe = np.where(mirrored > 0, np.maximum(mirrored, 1e-300) ** material.exponent, 0)
    if material.brdf == "phong-cosine":
        lobe = lobe * cosine
    return result + np.array(material.specular) * lobe[:, None]


# --- light rays -------------------------------------------------------------------------------------------------------


def _lattice(points: int, rng: np.random.Generator) -> Array:
    """A rank-1 lattice in the unit square, randomly shifted."""
    k = np.arange(points)[:, None]
    return np.asarray((k * np.array([1.0, round(points * 0.6180339887)]) / points + rng.random(2)) % 1.0)


def _hemisphere(normal: Array, uv: Array) -> tuple[Array, Array]:
    """Uniform over the hemisphere."""
    u, v = _frame(normal)
    z, phi = uv[:, 0], 2 * np.pi * uv[:, 1]
    r = np.sqrt(1 - z**2)
    direction = np.outer(r * np.cos(phi), u) + np.outer(r * np.sin(phi), v) + np.outer(z, normal)
    return direction, np.full(len(uv), 1 / (2 * np.pi))


def _towards(light: Any, point: Array, uv: Array) -> tuple[Array, Array]:
    """Directions to points of the emitter, and their density over solid angle; 0 where it does not shine."""
    if light.kind == "sphere":
        axis = np.array(light.center) - point
        distance = float(np.linalg.norm(axis))
        if distance <= light.radius:
            return np.zeros((len(uv), 3)), np.zeros(len(uv))
        versine = 1 - math.sqrt(1 - (light.radius / distance) ** 2)
        u, v = _frame(axis / distance)
        z, phi = 1 - versine * uv[:, 0], 2 * np.pi * uv[:, 1]
        r = np.sqrt(1 - z**2)
        direction = np.outer(r * np.cos(phi), u) + np.outer(r * np.sin(phi), v) + np.outer(z, axis / distance)
        return direction, np.full(len(uv), 1 / (2 * np.pi * versine))
    if isinstance(light, DiscEmitter):
        normal = np.array(light.normal) / np.linalg.norm(light.normal)
        u, v = _frame(normal)
        r, phi = light.radius * np.sqrt(uv[:, 0]), 2 * np.pi * uv[:, 1]
        at = np.array(light.center) + np.outer(r * np.cos(phi), u) + np.outer(r * np.sin(phi), v)
        area = np.pi * light.radius**2
    else:
        at = np.array(light.corner) + uv[:, :1] * np.array(light.edge_u) + uv[:, 1:] * np.array(light.edge_v)
        normal = np.cross(light.edge_u, light.edge_v)
        area = float(np.linalg.norm(normal))
        normal = normal / area
    toward = at - point
    distance2 = np.sum(toward**2, axis=1)
    direction = toward / np.sqrt(distance2)[:, None]
    facing = -(direction @ normal)
    with np.errstate(divide="ignore"):
        return direction, np.where(facing > 0, distance2 / (area * np.maximum(facing, 1e-300)), 0.0)


def _shape(emitter: Any) -> Any:
    if isinstance(emitter, DiscEmitter):
        return Disc(kind="disc", material="", center=emitter.center, normal=emitter.normal, radius=emitter.radius)
    if isinstance(emitter, RectangleEmitter):
        return Rectangle(kind="rectangle", material="", corner=emitter.corner, edge_u=emitter.edge_u, edge_v=emitter.edge_v)
    return Sphere(kind="sphere", material="", center=emitter.center, radius=emitter.radius)


def _frame(n: Array) -> tuple[Array, Array]:
    axis = np.eye(3)[int(np.argmin(np.abs(n)))]
    u = np.cross(axis, n)
    u /= np.linalg.norm(u)
    return u, np.cross(n, u)


def _unit(v: Array) -> Array:
    return np.asarray(v / np.linalg.norm(v, axis=-1, keepdims=True))
