"""One film position at fifty digits, straight from the formulas: the local models here, `raytraced` in precise_transport.py.

Written apart from the rest of the package and without any of its care: world-space textbook formulas, the mirror direction as
R = 2 (N·L) N − L, the cosine as R·V, every object tried, in mpmath. What it takes from elsewhere is the scene and the
object-to-world matrix (whose doubles are the definition). It is what the fast oracle and the tracer are checked against. Fifty
digits are many for scenes of ordinary size; textbook formulas lose twice the decades between the largest and the smallest
length of a scene, so that the extremes ask for more (`digits`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

import mpmath
from mpmath import mp, mpf

from equilux_scenes.case import Case
from equilux_scenes.model import (
    Box,
    Cylinder,
    DeltaLight,
    DirectionalLight,
    Disc,
    Film,
    Material,
    Mesh,
    Object,
    OrthographicCamera,
    PerspectiveCamera,
    Plane,
    Rectangle,
    Scene,
    Sphere,
    SpotLight,
    TransformStep,
)
from equilux_scenes.transforms import matrix_of

DIGITS = 50

Vector = tuple[mpf, mpf, mpf]
Bands = tuple[mpf, mpf, mpf]
Crossings = Iterator[tuple[mpf, Vector]]
"""Parameters t of a ray's crossings with a shape, and the normal at each, in object space."""


@dataclass(frozen=True)
class Seen:
    """What a ray sees: point, unit normal on the viewer's side, unit to-viewer, the object's index, and whether the viewer's side
    is that of the outward normal."""

    index: int
    point: Vector
    normal: Vector
    to_viewer: Vector
    outside: bool


@dataclass(frozen=True)
class Evaluation:
    """Radiance, and the scale of errors (`equilux_oracle.Examination`), None where nothing is hit."""

    radiance: Bands
    scale: Bands | None
    seen: Seen | None


def radiance_at(case: Case, x: float, y: float, digits: int = DIGITS) -> Bands:
    """Radiance of each band at a film position in pixels, to about `digits` − 10 digits."""
    return evaluate_at(case, x, y, digits).radiance


def evaluate_at(case: Case, x: float, y: float, digits: int = DIGITS) -> Evaluation:
    """Radiance at a film position, with the point seen there. Raises TypeError for a mesh that is smooth or comes from a file."""
    with mp.workdps(digits):
        scene = case.scene
        ray = _ray(scene.camera, scene.film, mpf(x), mpf(y))
        if scene.model == "raytraced":
            from equilux_oracle.precise_transport import trace

            return trace(scene, *ray)
        seen = first_seen(scene, *ray)
        if seen is None:
            return Evaluation(exact(scene.background), None, None)
        material = scene.materials[scene.objects[seen.index].material]
        formula = _fixed_function if scene.model == "opengl" else _shade
        return Evaluation(*formula(scene, material, seen), seen)


# --- camera -----------------------------------------------------------------------------------------------------------


def _ray(camera: PerspectiveCamera | OrthographicCamera, film: Film, x: mpf, y: mpf) -> tuple[Vector, Vector]:
    eye, target, up = exact(camera.eye), exact(camera.target), exact(camera.up)
    forward = unit(minus(target, eye))
    right = unit(cross(forward, up))
    above = cross(right, forward)
    perspective = isinstance(camera, PerspectiveCamera)
    half = mp.tan(mp.radians(mpf(camera.fov_y_deg)) / 2) if isinstance(camera, PerspectiveCamera) else mpf(camera.height_m) / 2
    a = (2 * x / film.width - 1) * mpf(film.width) / film.height * half
    b = (1 - 2 * y / film.height) * half
    on_film = plus(times(a, right), times(b, above))
    return (eye, plus(forward, on_film)) if perspective else (plus(eye, on_film), forward)


# --- visibility -------------------------------------------------------------------------------------------------------


def first_seen(scene: Scene, origin: Vector, direction: Vector, start: mpf | int = 0) -> Seen | None:
    """The nearest crossing with t > start; the first in file order of those that lie within 2^-50 of each other."""
    best: tuple[mpf, int, Vector] | None = None
    coordinates = length(exact(scene.camera.eye)) / length(direction)
    if start:
        coordinates += length(minus(origin, exact(scene.camera.eye)))
    for index in range(len(scene.objects)):
        ahead = [(t, normal) for t, normal in crossings_with(scene, index, origin, direction) if t > start]
        if not ahead:
            continue
        t, normal = min(ahead, key=lambda crossing: crossing[0])
        if best is None or best[0] - t > (best[0] + coordinates) * mpf(2) ** -50:
            best = (t, index, normal)
    if best is None:
        return None
    t, index, normal = best
    normal, to_viewer = unit(normal), unit(times(mpf(-1), direction))
    outside = bool(dot(normal, to_viewer) >= 0)
    return Seen(index, plus(origin, times(t, direction)), normal if outside else times(mpf(-1), normal), to_viewer, outside)


def crossings_with(scene: Scene, index: int, origin: Vector, direction: Vector) -> Crossings:
    """All crossings of a line with one object, with outward normals in the world, not unit."""
    shape = scene.objects[index]
    if not shape.transform:
        yield from _crossings(shape, origin, direction)
        return
    inverse = _to_object(shape.transform, mp.prec)
    for t, normal in _crossings(shape, _apply(inverse, origin, 1), _apply(inverse, direction, 0)):
        yield t, _apply(inverse.T, normal, 0)


@lru_cache(maxsize=256)
def _to_object(steps: tuple[TransformStep, ...], bits: int) -> mpmath.matrix:
    """World → object, with so many bits."""
    return mp.matrix(matrix_of(steps).tolist()) ** -1


def _crossings(shape: Object, o: Vector, d: Vector) -> Crossings:
    match shape:
        case Sphere():
            yield from _sphere(exact(shape.center), mpf(shape.radius), o, d)
        case Plane():
            yield from _flat(exact(shape.point), exact(shape.normal), o, d, lambda p: True)
        case Disc():
            c, r = exact(shape.center), mpf(shape.radius)
            yield from _flat(c, exact(shape.normal), o, d, lambda p: length(minus(p, c)) <= r)
        case Rectangle():
            yield from _rectangle(exact(shape.corner), exact(shape.edge_u), exact(shape.edge_v), o, d)
        case Box():
            yield from _box(exact(shape.min), exact(shape.max), o, d)
        case Cylinder():
            yield from _cylinder(exact(shape.base), exact(shape.top), mpf(shape.radius), shape.capped, o, d)
        case Mesh(vertices=tuple(vertices), faces=tuple(faces), normals="flat"):
            for face in faces:
                a, b, c = (exact(vertices[k]) for k in face)
                yield from _triangle(a, b, c, o, d)
        case _:
            raise TypeError(f"no closed form for {shape.kind}")


def _quadratic(a: mpf, b: mpf, c: mpf) -> list[mpf]:
    """Real roots of a t² + 2 b t + c."""
    discriminant = b * b - a * c
    if a == 0 or discriminant < 0:
        return []
    root = mp.sqrt(discriminant)
    return [(-b - root) / a, (-b + root) / a]


def _sphere(center: Vector, radius: mpf, o: Vector, d: Vector) -> Crossings:
    q = minus(o, center)
    for t in _quadratic(dot(d, d), dot(q, d), dot(q, q) - radius**2):
        yield t, plus(q, times(t, d))


def _flat(point: Vector, normal: Vector, o: Vector, d: Vector, inside: Callable[[Vector], bool]) -> Crossings:
    towards = dot(d, normal)
    if towards != 0:
        t = dot(minus(point, o), normal) / towards
        if inside(plus(o, times(t, d))):
            yield t, normal


def _rectangle(corner: Vector, u: Vector, v: Vector, o: Vector, d: Vector) -> Crossings:
    def inside(p: Vector) -> bool:
        q = minus(p, corner)
        return bool(0 <= dot(q, u) / dot(u, u) <= 1 and 0 <= dot(q, v) / dot(v, v) <= 1)

    yield from _flat(corner, cross(u, v), o, d, inside)


def _triangle(a: Vector, b: Vector, c: Vector, o: Vector, d: Vector) -> Crossings:
    """Inside, all three edges have the point on their left."""
    normal = cross(minus(b, a), minus(c, a))

    def inside(p: Vector) -> bool:
        return all(dot(cross(minus(q, r), minus(p, r)), normal) >= 0 for r, q in ((a, b), (b, c), (c, a)))

    yield from _flat(a, normal, o, d, inside)


def _box(low: Vector, high: Vector, o: Vector, d: Vector) -> Crossings:
    """Six faces, each a rectangle between the other two axes' limits."""
    for axis in range(3):
        others = [k for k in range(3) if k != axis]
        for corner, sign in ((low, -1), (high, 1)):
            normal = tuple(mpf(sign if k == axis else 0) for k in range(3))
            yield from _flat(corner, normal, o, d, lambda p, others=others: all(low[k] <= p[k] <= high[k] for k in others))  # type: ignore[misc]


def _cylinder(base: Vector, top: Vector, radius: mpf, capped: bool, o: Vector, d: Vector) -> Crossings:
    axis = minus(top, base)
    height = length(axis)
    along = times(1 / height, axis)
    q = minus(o, base)
    q_across, d_across = minus(q, times(dot(q, along), along)), minus(d, times(dot(d, along), along))
    for t in _quadratic(dot(d_across, d_across), dot(q_across, d_across), dot(q_across, q_across) - radius**2):
        if 0 <= dot(plus(q, times(t, d)), along) <= height:
            yield t, plus(q_across, times(t, d_across))
    if capped:
        for center, normal in ((base, times(mpf(-1), along)), (top, along)):
            yield from _flat(center, normal, o, d, lambda p, center=center: bool(length(minus(p, center)) <= radius))  # type: ignore[misc]


# --- lights and the formula -------------------------------------------------------------------------------------------


def arriving(light: DeltaLight, point: Vector) -> tuple[Vector, Bands]:
    """Unit vector to the light, and E."""
    if isinstance(light, DirectionalLight):
        return unit(times(mpf(-1), exact(light.direction))), exact(light.irradiance)
    to_light = minus(exact(light.position), point)
    r = length(to_light)
    to_light = times(1 / r, to_light)
    law = light.attenuation
    weight = 1 / (mpf(law.constant) + mpf(law.linear) * r + mpf(law.quadratic) * r**2)
    if isinstance(light, SpotLight):
        cosine = -dot(to_light, unit(exact(light.direction)))
        inside = cosine >= mp.cos(mp.radians(mpf(light.cone_half_angle_deg)))
        weight *= mp.power(cosine, mpf(light.exponent)) if inside else mpf(0)
    return to_light, times(weight, exact(light.intensity))


def _shade(scene: Scene, material: Material, seen: Seen) -> tuple[Bands, Bands]:
    ambient, emission = exact(scene.ambient), exact(material.emission)
    k_amb, k_diff, k_spec = exact(material.ambient), exact(material.diffuse), exact(material.specular)
    n, v = seen.normal, seen.to_viewer
    radiance = scale = bands(lambda b: emission[b] + k_amb[b] * ambient[b])
    for light in scene.delta_lights.values():
        to_light, e = arriving(light, seen.point)
        n_l = dot(n, to_light)
        scale = bands(lambda b, s=scale, e=e: s[b] + e[b] * (k_diff[b] + k_spec[b]))
        if n_l > 0:
            mirror = minus(times(2 * n_l, n), to_light)
            r_v = dot(mirror, v)
            power = mp.power(r_v, mpf(material.exponent)) if r_v > 0 else mpf(0)
            radiance = bands(lambda b, s=radiance, e=e, c=n_l, h=power: s[b] + e[b] * (k_diff[b] * c + k_spec[b] * h))
    return radiance, scale


def _fixed_function(scene: Scene, material: Material, seen: Seen) -> tuple[Bands, Bands]:
    """e_m + a_m a_global + Σ att_i spot_i [a_m a_i + d_m d_i max(0, N·L_i) + f_i s_m s_i max(0, N·H_i)^s]."""
    a_global, e_m, a_m = exact(scene.ambient), exact(material.emission), exact(material.ambient)
    d_m, s_m, s, n = exact(material.diffuse), exact(material.specular), mpf(material.exponent), seen.normal
    eye, target = exact(scene.camera.eye), exact(scene.camera.target)
    v = unit(minus(eye, seen.point)) if scene.viewer == "local" else unit(minus(eye, target))
    radiance = scale = bands(lambda b: e_m[b] + a_m[b] * a_global[b])
    for light in scene.delta_lights.values():
        to_light, e = arriving(light, seen.point)
        a_i, d_i, s_i = exact(light.ambient), exact(light.diffuse), exact(light.specular)
        n_l, n_h = dot(n, to_light), dot(n, unit(plus(to_light, v)))
        cosine = n_l if n_l > 0 else mpf(0)
        power = mp.power(n_h if n_h > 0 else mpf(0), s) if n_l > 0 else mpf(0)
        terms = [(a_m[b] * a_i[b], d_m[b] * d_i[b], s_m[b] * s_i[b]) for b in range(3)]
        lit = [e[b] * (terms[b][0] + terms[b][1] * cosine + terms[b][2] * power) for b in range(3)]
        radiance = bands(lambda b, whole=radiance, lit=lit: whole[b] + lit[b])
        scale = bands(lambda b, whole=scale, terms=terms, e=e: whole[b] + e[b] * sum(terms[b]))
    return radiance, scale


# --- vectors ----------------------------------------------------------------------------------------------------------


def exact(values: Sequence[float]) -> Vector:
    x, y, z = (mpf(value) for value in values)
    return x, y, z


def bands(of_band: Callable[..., mpf]) -> Bands:
    return of_band(0), of_band(1), of_band(2)


def plus(a: Vector, b: Vector) -> Vector:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def minus(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def times(k: mpf, a: Vector) -> Vector:
    return k * a[0], k * a[1], k * a[2]


def dot(a: Vector, b: Vector) -> mpf:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def length(a: Vector) -> mpf:
    return mp.sqrt(dot(a, a))


def unit(a: Vector) -> Vector:
    return times(1 / length(a), a)


def _apply(m: mpmath.matrix, a: Vector, w: int) -> Vector:
    """The upper three rows of a 4×4 matrix on (a, w)."""
    x, y, z = (m[row, 0] * a[0] + m[row, 1] * a[1] + m[row, 2] * a[2] + m[row, 3] * w for row in range(3))
    return x, y, z
