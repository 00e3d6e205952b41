"""Model `raytraced`: shadows, mirrors, glass, recursively; with the faults that concern them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from equilux_scenes.case import Case
from mutation.crossings import all_crossings, nearest
from mutation.faults import Faults
from mutation.shading import Surface, dot, local_light, power, turned_normal, unit, view_vector

Array = npt.NDArray[np.float64]

OWN_CROSSING = 1e-9
"""Crossings nearer to a ray's start than this share of the scene's size are the start itself."""
DEEPEST = 24
"""Where transmitted rays do not count, this many in all end a path."""


@dataclass
class Rays:
    """n rays of one generation. weight: (n, 3), of the path so far. remaining: how many may follow in succession. media: indices
    of the media the ray is in, outermost first, (n, levels), and how many levels are in use.
    """

    origin: Array
    direction: Array
    weight: Array
    remaining: int
    generation: int
    media: Array
    level: npt.NDArray[np.int64]

    def part(self, rows: Any) -> tuple[Array, npt.NDArray[np.int64]]:
        return self.media[rows].copy(), self.level[rows].copy()


def traced(case: Case, origin: Array, direction: Array, faults: Faults) -> Array:
    n = len(origin)
    media = np.ones((n, DEEPEST + 2))
    first = Rays(origin, direction, np.ones((n, 3)), case.scene.recursion_limit, 0, media, np.zeros(n, dtype=np.int64))
    return _trace(case, first, faults)


def _trace(case: Case, rays: Rays, faults: Faults) -> Array:
    scene, n = case.scene, len(rays.origin)
    hits = nearest(case, rays.origin, rays.direction, OWN_CROSSING * _size(case) if rays.generation else 0.0)
    result = np.tile(np.array(scene.background), (n, 1))
    if faults.background == ("black in mirrors" if rays.generation else "black for the eye"):
        result[:] = 0
    at = np.flatnonzero(hits.object_id >= 0)
    if len(at) == 0:
        return result
    material = [scene.materials[scene.objects[k].material] for k in hits.object_id[at]]
    d, v = rays.direction[at], -rays.direction[at]
    point = rays.origin[at] + hits.t[at, None] * d
    outside = dot(hits.geometric[at], v) > 0
    normal = turned_normal(case, hits.geometric[at], hits.shading[at], v, faults)
    surface = Surface(material, point, normal, v, first_hit=rays.generation == 0)
    media, level = rays.part(at)
    n_front, n_behind = _indices(surface, outside, media, level, faults)

    t = surface.number("transparency")
    front_weight = 1 - t if faults.front_weighted else np.ones_like(t)
    behind_weight = t if faults.behind_weighted else np.where(t > 0, 1.0, 0.0)
    front, lobe, behind = _local(case, surface, n_front, n_behind, faults)
    value = surface.bands("emission") + surface.bands("ambient") * np.array(scene.ambient)
    value += front_weight * front + (front_weight if faults.lobe_weighted else 1) * lobe + behind_weight * behind

    eta = n_behind / n_front if faults.inverted_index else n_front / n_behind
    if faults.glass == "straight":
        eta = np.ones_like(eta)
    cosine = dot(normal, v)
    rest = 1 - eta**2 * (1 - cosine**2)
    total = (rest < 0) & (t > 0)
    onward = np.where(cosine < 0, -1.0, 1.0)
    refracted = eta * d + (eta * cosine - onward * np.sqrt(np.maximum(rest, 0))) * normal
    k_refl, k_trans = surface.bands("reflection"), surface.bands("transmission")
    mirror = front_weight * (k_refl if faults.mirrors == "model" else 0 * k_refl)
    of_total = {
        "one": np.ones_like(k_refl), "k_refl": k_refl, "(1-t) k_refl": (1 - t) * k_refl, "t k_trans": t * k_trans,
        "none": 0 * k_refl,
    }[faults.total]  # fmt: skip
    if faults.mirrors == "not even total" or faults.glass == "opaque, total too":
        of_total = 0 * of_total
    mirror = np.where(total, of_total, mirror)
    through = np.where(total | (faults.glass.startswith("opaque")), 0.0, behind_weight * k_trans)

    if rays.generation < DEEPEST:
        ahead = unit(2 * cosine * normal - v)
        value += _followed(case, rays, at, point, ahead, mirror, media, level, faults, counts=True)
        inner = _crossed(surface, outside, media, level)
        value += _followed(case, rays, at, point, unit(refracted), through, *inner, faults, counts=faults.count_transmitted)
    result[at] = value
    return result


def _followed(
    case: Case, rays: Rays, at: Any, point: Array, direction: Array, weight: Array, media: Array, level: Any, faults: Faults,
    *, counts: bool,
) -> Array:  # fmt: skip
    value = np.zeros_like(point)
    if counts and rays.remaining <= 0:
        return value
    whole = rays.weight[at] * weight
    judged = whole if faults.weighed == "product" else weight
    follow = np.flatnonzero(weight.any(axis=1) & (judged.max(axis=1) >= faults.least_weight))
    if len(follow):
        remaining = rays.remaining - 1 if counts else rays.remaining
        onward = Rays(
            point[follow], direction[follow], whole[follow], remaining, rays.generation + 1, media[follow], level[follow]
        )
        value[follow] = weight[follow] * _trace(case, onward, faults)
    return value


# --- media ------------------------------------------------------------------------------------------------------------


def _indices(surface: Surface, outside: Array, media: Array, level: Any, faults: Faults) -> tuple[Array, Array]:
    """n_front and n_behind, (n, 1)."""
    ior = surface.number("ior")
    rows = np.arange(len(ior))
    if not faults.nested:
        around = np.ones_like(ior)
    else:
        around = np.where(outside, media[rows, level][:, None], media[rows, np.maximum(level - 1, 0)][:, None])
    return np.where(outside, around, ior), np.where(outside, ior, around)


def _crossed(surface: Surface, outside: Array, media: Array, level: Any) -> tuple[Array, Any]:
    """The media once the surface is crossed: one more, or one less."""
    media, rows = media.copy(), np.arange(len(level))
    inward = outside[:, 0]
    after = np.where(inward, level + 1, np.maximum(level - 1, 0))
    media[rows[inward], after[inward]] = surface.number("ior")[inward, 0]
    return media, after


# --- lights -----------------------------------------------------------------------------------------------------------


def _local(case: Case, surface: Surface, n_front: Array, n_behind: Array, faults: Faults) -> tuple[Array, Array, Array]:
    """The lights' parts: L_1's diffuse part, its highlight, and L_2's."""
    k_diff, k_spec, exponent = surface.bands("diffuse"), surface.bands("specular"), surface.number("exponent")
    eta = n_front / n_behind if faults.inverted_index == "all" else n_behind / n_front
    front, lobe, behind = (np.zeros_like(surface.point) for _ in range(3))
    viewer = view_vector(case, surface, faults)
    for light in case.scene.lights.values():
        arrived = local_light(case, light, surface, faults)
        energy = arrived.irradiance * _shadow(case, light, surface, arrived.to_light, faults)
        front += energy * k_diff * arrived.diffuse
        lobe += energy * k_spec * arrived.lobe
        cosine = dot(surface.normal, arrived.to_light)
        s2 = eta**2 * (1 - cosine**2)
        passed = -eta * arrived.to_light + (np.sqrt(np.maximum(1 - s2, 0)) + eta * cosine) * surface.normal
        glint = np.where(s2 > 1, 0.0, power(dot(passed, viewer), exponent)) if faults.lobe_behind else np.zeros_like(cosine)
        behind += np.where(cosine < 0, energy * (k_diff * -cosine + k_spec * glint), 0)
    return front, lobe, behind


def _shadow(case: Case, light: Any, surface: Surface, to_light: Array, faults: Faults) -> Array:
    """τ, (n, 3)."""
    scene, near = case.scene, OWN_CROSSING * _size(case)
    tau = np.ones_like(surface.point)
    if not faults.blockers:
        return tau
    start = surface.point
    if faults.bias_along == "normal":
        side = np.where(dot(surface.normal, to_light) < 0, -1.0, 1.0)
        start = start + faults.bias_m * side * surface.normal
        to_light = to_light if light.kind == "directional" else unit(np.array(light.position) - start)
    else:
        near = max(near, faults.bias_m)
    far = np.full(len(start), np.inf)
    if light.kind != "directional":
        far = np.linalg.norm(np.array(light.position) - start, axis=1) - OWN_CROSSING * _size(case)
    for index, obj in enumerate(scene.objects):
        material = scene.materials[obj.material]
        through = _let_through(scene, material, faults)
        t = all_crossings(case, index, start, to_light)
        count = np.sum((t > near) & (t < far[:, None]), axis=1, keepdims=True)
        tau = tau * through ** (np.minimum(count, 1) if faults.through == "once" else count)
    return tau


def _let_through(scene: Any, material: Any, faults: Faults) -> Array:
    t, k = material.transparency, np.array(material.transmission)
    if t == 0:
        return np.zeros(3)
    if faults.through in ("nothing", "all", "t", "k"):
        return {"nothing": np.zeros(3), "all": np.ones(3), "t": np.full(3, t), "k": k}[faults.through]
    return np.ones(3) if scene.transparent_shadows == "ignore" else t * k


def _size(case: Case) -> float:
    """A length that the scene's coordinates have about."""
    camera = case.scene.camera
    return float(np.linalg.norm(camera.eye) + np.linalg.norm(np.subtract(camera.eye, camera.target)))
