"""Models `raytraced` and `opengl` in plain NumPy double precision: straight from the formulas, slow, recursive, and good to
about 1e-11 per bounce.

It shares no code with the tracer or the oracle. Every object is tried for every ray. No tie rules, no care about edges: the path
signature tells where a film position is so near to one that tests leave it out (`on_edge`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from equilux_scenes.case import Case
from equilux_scenes.transforms import matrix
from support.plain_phong import CROSSINGS, _cap, _mesh, arriving, rays

Array = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]
Signature = npt.NDArray[np.uint64]

OWN_CROSSING = 1e-9
"""Crossings nearer to a ray's start than this share of the scene's coordinates are the start itself."""

TRANSMITTED_HIGHLIGHT = 1.0
"""Weight of the highlight of lights behind a surface; a test sets it to 0 for renderers that have no such term."""


@dataclass
class Hits:
    """Nearest crossings of n rays: parameter (inf: none), outward geometric and shading normal, object (−1: none), face."""

    t: Array
    geometric: Array
    shading: Array
    object_id: npt.NDArray[np.int64]
    face: npt.NDArray[np.int64]


def radiance(case: Case, film_xy: npt.ArrayLike) -> tuple[Array, Signature]:
    """Radiance (n, 3) and path signature (n,) at film positions (n, 2) in pixels. For models `raytraced` and `opengl`.

    Two positions with the same signature see the same objects from the same sides along all paths, through the same gates.
    """
    positions = np.asarray(film_xy, dtype=float).reshape(-1, 2)
    origin, direction = rays(case, positions)
    direction = direction / np.linalg.norm(direction, axis=1, keepdims=True)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        if case.scene.model == "opengl":
            return _opengl(case, origin, direction)
        return _trace(case, origin, direction, case.scene.recursion_limit, 0.0)


def on_edge(case: Case, film_xy: npt.ArrayLike, delta_px: float = 1e-6, around: int = 8) -> Bools:
    """Whether the signature changes within δ: at `around` points each on rings of radius δ/2 and δ. (n, 2) pixels → (n,)."""
    center = np.asarray(film_xy, dtype=float).reshape(-1, 2)
    here = radiance(case, center)[1]
    differs = np.zeros(len(center), dtype=bool)
    for r in (delta_px / 2, delta_px):
        for k in range(around):
            angle = 2 * math.pi * (k + 0.5) / around
            aside = np.array([r * math.cos(angle), r * math.sin(angle)])
            differs |= radiance(case, center + aside)[1] != here
    return differs


# --- raytraced --------------------------------------------------------------------------------------------------------


def _trace(case: Case, origin: Array, direction: Array, remaining: int, start: float) -> tuple[Array, Signature]:
    """Radiance along rays of unit direction, of which `remaining` more may follow in succession."""
    scene, n = case.scene, len(origin)
    hits = _nearest(case, origin, direction, start)
    result, signature = np.tile(np.array(scene.background), (n, 1)), _mixed(np.zeros(n, dtype=np.uint64), hits.object_id)
    at = np.flatnonzero(hits.object_id >= 0)
    if len(at) == 0:
        return result, signature
    material = [scene.materials[scene.objects[k].material] for k in hits.object_id[at]]
    k_emit, k_amb = _bands(material, "emission"), _bands(material, "ambient")
    k_refl, k_trans = _bands(material, "reflection"), _bands(material, "transmission")
    transparency = np.array([[m.transparency] for m in material])

    d, v = direction[at], -direction[at]
    point = origin[at] + hits.t[at, None] * d
    outside = _dot(hits.geometric[at], v) > 0  # the viewer is on the side of the outward normal
    geometric = np.where(outside, hits.geometric[at], -hits.geometric[at])
    shading = hits.shading[at]
    normal = _unit(np.where(_dot(shading, geometric) < 0, -shading, shading))
    ior = np.array([[m.ior] for m in material])
    n_front, n_behind = np.where(outside, 1.0, ior), np.where(outside, ior, 1.0)
    sign = _mixed(_mixed(signature[at], outside[:, 0]), hits.face[at])

    front, behind, sign = _local(case, material, point, normal, v, n_front, n_behind, sign)
    value = k_emit + k_amb * np.array(scene.ambient) + (1 - transparency) * front + transparency * behind

    eta, cosine = n_front / n_behind, _dot(normal, v)
    sine2 = eta**2 * (1 - cosine**2)
    total = (sine2 > 1) & (transparency > 0)
    sign = _mixed(sign, total[:, 0])
    mirrored = 2 * cosine * normal - v
    onward = np.where(cosine < 0, -1.0, 1.0)  # a shading normal may look away from the viewer: the ray goes on to its own side
    refracted = eta * d + (eta * cosine - onward * np.sqrt(np.maximum(1 - sine2, 0))) * normal
    mirror_weight = np.where(total, 1.0, (1 - transparency) * k_refl)
    through_weight = np.where(total, 0.0, transparency * k_trans)
    if remaining > 0:
        for weight, onward in ((mirror_weight, mirrored), (through_weight, refracted)):
            follow = np.flatnonzero(weight.any(axis=1))
            if len(follow):
                start_here = OWN_CROSSING * _size(case)
                found, path = _trace(case, point[follow], onward[follow], remaining - 1, start_here)
                value[follow] += weight[follow] * found
                sign[follow] = _mixed(sign[follow], path)
            sign = _mixed(sign, np.full(len(sign), 7))
    result[at], signature[at] = value, sign
    return result, signature


def _local(
    case: Case, material: list[Any], point: Array, n: Array, v: Array, n_front: Array, n_behind: Array, sign: Signature
) -> tuple[Array, Array, Signature]:
    """The lights' parts of L_1 and L_2."""
    k_diff, k_spec = _bands(material, "diffuse"), _bands(material, "specular")
    exponent = np.array([[m.exponent] for m in material])
    eta = n_behind / n_front
    front, behind = np.zeros_like(point), np.zeros_like(point)
    for light in case.scene.lights.values():
        irradiance, to_light = arriving(light, point)
        tau, crossed = _shadow(case, light, point, to_light)
        cosine = _dot(n, to_light)
        mirrored = 2 * cosine * n - to_light
        c, s2 = -cosine, eta**2 * (1 - cosine**2)
        passed = -eta * to_light + (np.sqrt(np.maximum(1 - s2, 0)) - eta * c) * n
        r_v, t_v = _dot(mirrored, v), np.where(s2 > 1, 0.0, _dot(passed, v))
        front += np.where(cosine > 0, irradiance * tau * (k_diff * cosine + k_spec * _power(r_v, exponent)), 0)
        highlight = TRANSMITTED_HIGHLIGHT * k_spec * _power(t_v, exponent)
        behind += np.where(cosine < 0, irradiance * tau * (k_diff * -cosine + highlight), 0)
        for gate in (cosine > 0, irradiance > 0, np.where(cosine > 0, r_v, t_v) > 0, s2 > 1):
            sign = _mixed(sign, gate.any(axis=1))
        sign = _mixed(sign, crossed)
    return front, behind, sign


def _shadow(case: Case, light: Any, point: Array, to_light: Array) -> tuple[Array, Signature]:
    """τ (n, 3): what of the light comes through all crossings strictly between; and a number that says which these are."""
    scene = case.scene
    near = OWN_CROSSING * _size(case)
    far = np.full(len(point), np.inf)
    if light.kind != "directional":
        far = np.linalg.norm(np.array(light.position) - point, axis=1) - near
    tau, crossed = np.ones_like(point), np.zeros(len(point), dtype=np.uint64)
    for index, obj in enumerate(scene.objects):
        m = scene.materials[obj.material]
        through = m.transparency * np.array(m.transmission)
        if m.transparency > 0 and scene.transparent_shadows == "ignore":
            through = np.ones(3)
        for t, *_ in _crossings(case, index, point, to_light):
            crosses = (t > near) & (t < far)
            tau = np.where(crosses[:, None], tau * through, tau)
            crossed = _mixed(crossed, crosses)
    return tau, crossed


# --- opengl -----------------------------------------------------------------------------------------------------------


def _opengl(case: Case, origin: Array, direction: Array) -> tuple[Array, Signature]:
    scene, n = case.scene, len(origin)
    hits = _nearest(case, origin, direction, 0.0)
    result, signature = np.tile(np.array(scene.background), (n, 1)), _mixed(np.zeros(n, dtype=np.uint64), hits.object_id)
    at = np.flatnonzero(hits.object_id >= 0)
    if len(at) == 0:
        return result, signature
    material = [scene.materials[scene.objects[k].material] for k in hits.object_id[at]]
    a_m, d_m, s_m = (_bands(material, term) for term in ("ambient", "diffuse", "specular"))
    shininess = np.array([[m.exponent] for m in material])
    point = origin[at] + hits.t[at, None] * direction[at]
    facing = _dot(hits.geometric[at], direction[at]) < 0
    normal = _unit(np.where(facing, hits.shading[at], -hits.shading[at]))
    eye, target = np.array(scene.camera.eye, dtype=float), np.array(scene.camera.target, dtype=float)
    to_viewer = _unit(eye - point) if scene.viewer == "local" else _unit(eye - target) + np.zeros_like(point)
    value, sign = _bands(material, "emission") + a_m * np.array(scene.ambient), _mixed(signature[at], facing[:, 0])
    sign = _mixed(sign, hits.face[at])
    for light in scene.lights.values():
        e, to_light = arriving(light, point)  # att and spot included
        cosine = _dot(normal, to_light)
        n_h = np.maximum(_dot(normal, _unit(to_light + to_viewer)), 0)
        highlight = np.where(cosine > 0, s_m * np.array(light.specular) * n_h**shininess, 0)
        value += e * (a_m * np.array(light.ambient) + d_m * np.array(light.diffuse) * np.maximum(cosine, 0) + highlight)
        for gate in (cosine > 0, e > 0, n_h > 0):
            sign = _mixed(sign, gate.any(axis=1))
    result[at], signature[at] = value, sign
    return result, signature


# --- crossings --------------------------------------------------------------------------------------------------------


def _nearest(case: Case, origin: Array, direction: Array, start: float) -> Hits:
    n = len(origin)
    hits = Hits(np.full(n, np.inf), np.zeros((n, 3)), np.zeros((n, 3)), np.full(n, -1), np.zeros(n, dtype=np.int64))
    for index in range(len(case.scene.objects)):
        for face, (t, geometric, shading) in enumerate(_crossings(case, index, origin, direction)):
            nearer = (t > start) & (t < hits.t)
            hits.t = np.where(nearer, t, hits.t)
            hits.geometric = np.where(nearer[:, None], geometric, hits.geometric)
            hits.shading = np.where(nearer[:, None], shading, hits.shading)
            hits.object_id, hits.face = np.where(nearer, index, hits.object_id), np.where(nearer, face, hits.face)
    return hits


def _crossings(case: Case, index: int, origin: Array, direction: Array) -> list[tuple[Array, Array, Array]]:
    """All crossings of the rays' lines with one object: t (inf where there is none), outward geometric and shading normal."""
    obj, mesh = case.scene.objects[index], case.meshes.get(index)
    to_object = np.linalg.inv(matrix(obj))
    linear = to_object[:3, :3]
    o, d = origin @ linear.T + to_object[:3, 3], direction @ linear.T
    found = _mesh(mesh, o, d) if mesh is not None else OUTWARD.get(obj.kind, CROSSINGS[obj.kind])(obj, o, d)
    return [(t, normal @ linear, (shading[0] if shading else normal) @ linear) for t, normal, *shading in found]


def _box(s: Any, o: Array, d: Array) -> list[tuple[Array, Array]]:
    low, high, found = np.array(s.min), np.array(s.max), []
    for axis in range(3):
        others = [k for k in range(3) if k != axis]
        for bound, sign in ((low, -1.0), (high, 1.0)):
            t = (bound[axis] - o[:, axis]) / d[:, axis]
            p = (o + t[:, None] * d)[:, others]
            inside = np.all((p >= low[others]) & (p <= high[others]), axis=1) & np.isfinite(t)
            found.append((np.where(inside, t, np.inf), sign * np.eye(3)[axis] + np.zeros_like(o)))
    return found


def _cylinder(s: Any, o: Array, d: Array) -> list[tuple[Array, Array]]:
    base, top = np.array(s.base), np.array(s.top)
    axis = (top - base) / np.linalg.norm(top - base)
    across = np.eye(3) - np.outer(axis, axis)
    found = CROSSINGS["cylinder"](s, o, d)
    tube = [(t, (o + t[:, None] * d - base) @ across) for t, _ in found[:2]]
    return tube + ([_cap(o, d, base, -axis, s.radius), _cap(o, d, top, axis, s.radius)] if s.capped else [])


OUTWARD = {"box": _box, "cylinder": _cylinder}
"""Crossings whose normals point outward, where those of plain_phong are on any side."""


# --- small things -----------------------------------------------------------------------------------------------------


def _size(case: Case) -> float:
    """A length that the scene's coordinates have about."""
    camera = case.scene.camera
    return float(np.linalg.norm(camera.eye) + np.linalg.norm(np.subtract(camera.eye, camera.target)))


def _bands(materials: list[Any], term: str) -> Array:
    return np.array([getattr(m, term) for m in materials], dtype=float)


def _power(cosine: Array, exponent: Array) -> Array:
    return np.where(cosine > 0, np.maximum(cosine, 1e-300) ** exponent, 0.0)


def _mixed(signature: Signature, part: npt.ArrayLike) -> Signature:
    """The signature with one more number in it (FNV-1a's multiplier, and a shift against regularities)."""
    number = np.asarray(part).astype(np.int64).astype(np.uint64)
    mixed = (signature ^ number) * np.uint64(1099511628211) + np.uint64(0x9E3779B97F4A7C15)
    result: Signature = mixed ^ (mixed >> np.uint64(29))
    return result


def _dot(a: Array, b: Array) -> Array:
    result: Array = np.sum(a * b, axis=-1, keepdims=True)
    return result


def _unit(a: Array) -> Array:
    result: Array = a / np.linalg.norm(a, axis=-1, keepdims=True)
    return result
