"""The local Phong model once more, in plain NumPy double precision: straight from the formulas, slow, and good to about 1e-11.

It shares no code with the tracer or the oracle. No tie rules, no care about edges: tests leave those out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from equilux_scenes.case import Case
from equilux_scenes.transforms import matrix

Array = npt.NDArray[np.float64]


@dataclass
class Hits:
    """Nearest crossings of n rays: ray parameter (inf: none), world normals (any side, any length), object.

    geometric: of the surface; normal: the one to shade with, another only for smooth meshes.
    """

    t: Array
    normal: Array
    geometric: Array
    object_id: npt.NDArray[np.int64]


def radiance(case: Case, film_xy: Array) -> tuple[Array, npt.NDArray[np.int64]]:
    """Radiance (n, 3) and object (n,), −1 for a miss, at film positions in pixels."""
    origin, direction = rays(case, film_xy)
    n = len(film_xy)
    hits = Hits(np.full(n, np.inf), np.zeros((n, 3)), np.zeros((n, 3)), np.full(n, -1))
    for index, obj in enumerate(case.scene.objects):
        _nearer(hits, index, obj, case.meshes.get(index), origin, direction)
    seen = hits.object_id >= 0
    result = np.broadcast_to(np.array(case.scene.background), (len(film_xy), 3)).copy()
    with np.errstate(invalid="ignore"):
        point = origin + hits.t[:, None] * direction
    for index in np.unique(hits.object_id[seen]):
        here = hits.object_id == index
        material = case.scene.materials[case.scene.objects[index].material]
        to_viewer = -_unit(direction[here])
        geometric = turned(hits.geometric[here], to_viewer)
        result[here] = shade(case, material, point[here], _unit(turned(hits.normal[here], geometric)), to_viewer)
    return result, hits.object_id


def rays(case: Case, film_xy: Array) -> tuple[Array, Array]:
    """Origins and directions (not unit), (n, 3) each."""
    camera, film = case.scene.camera, case.scene.film
    forward = _unit(np.subtract(camera.target, camera.eye))
    right = _unit(np.cross(forward, camera.up))
    up = np.cross(right, forward)
    perspective = camera.projection == "perspective"
    half = np.tan(np.radians(camera.fov_y_deg) / 2) if perspective else camera.height_m / 2
    x = (2 * film_xy[:, :1] / film.width - 1) * film.width / film.height * half
    y = (1 - 2 * film_xy[:, 1:] / film.height) * half
    sideways = x * right + y * up
    eye = np.array(camera.eye, dtype=float)
    if perspective:
        return np.broadcast_to(eye, sideways.shape), forward + sideways
    return eye + sideways, np.broadcast_to(forward, sideways.shape)


def film_positions_of(case: Case, points: Array) -> Array:
    """Where world points (n, 3) in front of a perspective camera appear on its film, pixels, (n, 2)."""
    camera, film = case.scene.camera, case.scene.film
    forward = _unit(np.subtract(camera.target, camera.eye))
    right = _unit(np.cross(forward, camera.up))
    up = np.cross(right, forward)
    v = points - np.array(camera.eye)
    scale = film.height / 2 / np.tan(np.radians(camera.fov_y_deg) / 2) / (v @ forward)
    return np.stack([film.width / 2 + scale * (v @ right), film.height / 2 - scale * (v @ up)], axis=1)


def turned(normal: Array, side: Array) -> Array:
    """The normal, or its opposite, whichever is on that side."""
    return np.where(_dot(normal, side) < 0, -normal, normal)


def shade(case: Case, material: Any, point: Array, normal: Array, to_viewer: Array) -> Array:
    """The formula, N and V unit and already on the same side."""
    result = np.array(material.emission) + np.array(material.ambient) * np.array(case.scene.ambient) + np.zeros_like(point)
    for light in case.scene.lights.values():
        irradiance, to_light = arriving(light, point)
        cosine = _dot(normal, to_light)
        mirrored = _dot(2 * cosine * normal - to_light, to_viewer)
        highlight = np.where(mirrored > 0, np.maximum(mirrored, 1e-300) ** material.exponent, 0)
        reflected = np.array(material.diffuse) * cosine + np.array(material.specular) * highlight
        result += np.where(cosine > 0, irradiance * reflected, 0)
    return result


def arriving(light: Any, point: Array) -> tuple[Array, Array]:
    """Irradiance before the cosine, (n, 3), and the unit vector to the light, (n, 3)."""
    if light.kind == "directional":
        return np.array(light.irradiance) + np.zeros_like(point), -_unit(np.array(light.direction)) + np.zeros_like(point)
    toward = np.array(light.position) - point
    r = np.linalg.norm(toward, axis=1, keepdims=True)
    fall = light.attenuation
    irradiance = np.array(light.intensity) / (fall.constant + fall.linear * r + fall.quadratic * r * r)
    if light.kind == "spot":
        cosine = -_dot(toward / r, _unit(np.array(light.direction)))
        inside = cosine >= np.cos(np.radians(light.cone_half_angle_deg))
        irradiance = np.where(inside, irradiance * np.maximum(cosine, 0) ** light.exponent, 0)
    return irradiance, toward / r


# --- crossings --------------------------------------------------------------------------------------------------------


def _nearer(hits: Hits, index: int, obj: Any, mesh: Any, origin: Array, direction: Array) -> None:
    to_world = matrix(obj)
    to_object = np.linalg.inv(to_world)
    o = origin @ to_object[:3, :3].T + to_object[:3, 3]
    d = direction @ to_object[:3, :3].T
    with np.errstate(divide="ignore", invalid="ignore"):
        found = _mesh(mesh, o, d) if mesh is not None else CROSSINGS[obj.kind](obj, o, d)
        for t, geometric, *shading in found:
            normal = shading[0] if shading else geometric
            nearer = (t > 0) & (t < hits.t)
            hits.t = np.where(nearer, t, hits.t)
            hits.normal = np.where(nearer[:, None], normal @ to_object[:3, :3], hits.normal)
            hits.geometric = np.where(nearer[:, None], geometric @ to_object[:3, :3], hits.geometric)
            hits.object_id = np.where(nearer, index, hits.object_id)


def _sphere(s: Any, o: Array, d: Array) -> list[tuple[Array, Array]]:
    center = np.array(s.center)
    return [(t, o + t[:, None] * d - center) for t in _quadratic(o - center, d, s.radius)]


def _plane(s: Any, o: Array, d: Array) -> list[tuple[Array, Array]]:
    normal = np.array(s.normal)
    return [(_to_plane(o, d, np.array(s.point), normal), normal + np.zeros_like(o))]


def _disc(s: Any, o: Array, d: Array) -> list[tuple[Array, Array]]:
    return [_cap(o, d, np.array(s.center), np.array(s.normal), s.radius)]


def _rectangle(s: Any, o: Array, d: Array) -> list[tuple[Array, Array]]:
    corner, u, v = np.array(s.corner), np.array(s.edge_u), np.array(s.edge_v)
    normal = np.cross(u, v)
    t = _to_plane(o, d, corner, normal)
    p = o + t[:, None] * d - corner
    along_u, along_v = p @ u / (u @ u), p @ v / (v @ v)
    inside = (along_u >= 0) & (along_u <= 1) & (along_v >= 0) & (along_v <= 1)
    return [(np.where(inside, t, np.inf), normal + np.zeros_like(o))]


def _box(s: Any, o: Array, d: Array) -> list[tuple[Array, Array]]:
    found = []
    for axis in range(3):
        others = [k for k in range(3) if k != axis]
        for bound in (s.min, s.max):
            t = (bound[axis] - o[:, axis]) / d[:, axis]
            p = o + t[:, None] * d
            inside = np.all((p[:, others] >= np.array(s.min)[others]) & (p[:, others] <= np.array(s.max)[others]), axis=1)
            found.append((np.where(inside, t, np.inf), np.eye(3)[axis] + np.zeros_like(o)))
    return found


def _cylinder(s: Any, o: Array, d: Array) -> list[tuple[Array, Array]]:
    base, top = np.array(s.base), np.array(s.top)
    height = np.linalg.norm(top - base)
    axis = (top - base) / height
    across = np.eye(3) - np.outer(axis, axis)
    found = []
    for t in _quadratic((o - base) @ across, d @ across, s.radius):
        p = o + t[:, None] * d - base
        along = p @ axis
        found.append((np.where((along >= 0) & (along <= height), t, np.inf), p @ across))
    if s.capped:
        found += [_cap(o, d, end, axis, s.radius) for end in (base, top)]
    return found


def _mesh(mesh: Any, o: Array, d: Array) -> list[tuple[Array, Array, Array]]:
    found = []
    for face in mesh.faces:
        a, b, c = mesh.vertices[face]
        normal = np.cross(b - a, c - a)
        t = _to_plane(o, d, a, normal)
        p = o + t[:, None] * d
        weight = [np.cross(q - p, r - p) @ normal / (normal @ normal) for q, r in ((b, c), (c, a), (a, b))]
        inside = np.all(np.array(weight) >= 0, axis=0)
        shading = normal
        if mesh.vertex_normals is not None:
            shading = sum(w[:, None] * mesh.vertex_normals[k] for w, k in zip(weight, face, strict=True))
        found.append((np.where(inside, t, np.inf), normal + np.zeros_like(o), shading + np.zeros_like(o)))
    return found


CROSSINGS = {"sphere": _sphere, "plane": _plane, "disc": _disc, "rectangle": _rectangle, "box": _box, "cylinder": _cylinder}


def _quadratic(o: Array, d: Array, radius: float) -> list[Array]:
    a, b, c = _dot(d, d)[:, 0], _dot(o, d)[:, 0], _dot(o, o)[:, 0] - radius**2
    rest = b * b - a * c
    root = np.sqrt(np.where(rest >= 0, rest, np.nan))
    return [np.nan_to_num((-b + sign * root) / a, nan=np.inf) for sign in (-1, 1)]


def _to_plane(o: Array, d: Array, point: Array, normal: Array) -> Array:
    return np.nan_to_num((point - o) @ normal / (d @ normal), nan=np.inf)


def _cap(o: Array, d: Array, center: Array, normal: Array, radius: float) -> tuple[Array, Array]:
    t = _to_plane(o, d, center, normal)
    outside = np.linalg.norm(o + t[:, None] * d - center, axis=1) > radius
    return np.where(outside, np.inf, t), normal + np.zeros_like(o)


def _dot(a: Array, b: Array) -> Array:
    return np.sum(a * b, axis=-1, keepdims=True)


def _unit(v: Array) -> Array:
    return v / np.linalg.norm(v, axis=-1, keepdims=True)
