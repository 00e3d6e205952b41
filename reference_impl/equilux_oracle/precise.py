"""One film position at fifty digits, straight from the formulas.

Written apart from the rest of the package and without any of its care: world-space textbook formulas, the mirror direction as
R = 2 (N·L) N − L, the cosine as R·V, every object tried, in mpmath. What it takes from elsewhere is the scene and the
object-to-world matrix (whose doubles are the definition). It is what the fast oracle is checked against.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

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
    Object,
    OrthographicCamera,
    PerspectiveCamera,
    Plane,
    Rectangle,
    Scene,
    Sphere,
    SpotLight,
)
from equilux_scenes.transforms import matrix

DIGITS = 50

Vector = tuple[mpf, mpf, mpf]
Bands = tuple[mpf, mpf, mpf]
Crossings = Iterator[tuple[mpf, Vector]]
"""Parameters t of a ray's crossings with a shape, and the normal at each, in object space."""


@dataclass(frozen=True)
class Seen:
    """What a film position sees: point, unit normal on the viewer's side, unit to-viewer, and the object's index."""

    index: int
    point: Vector
    normal: Vector
    to_viewer: Vector


@dataclass(frozen=True)
class Evaluation:
    """Radiance, and the scale K_emit + K_amb L_amb + Σ E_i (K_diff + K_spec) of errors, None where nothing is hit."""

    radiance: Bands
    scale: Bands | None
    seen: Seen | None


def radiance_at(case: Case, x: float, y: float) -> Bands:
    """Radiance of each band at a film position in pixels, to about 40 digits."""
    return evaluate_at(case, x, y).radiance


def evaluate_at(case: Case, x: float, y: float) -> Evaluation:
    """Radiance at a film position, with the point seen there. Raises TypeError for a mesh."""
    with mp.workdps(DIGITS):
        scene = case.scene
        seen = _first_seen(scene, *_ray(scene.camera, scene.film, mpf(x), mpf(y)))
        if seen is None:
            return Evaluation(_exact(scene.background), None, None)
        material = scene.materials[scene.objects[seen.index].material]
        return Evaluation(*_shade(scene, material, seen), seen)


# --- camera -----------------------------------------------------------------------------------------------------------


def _ray(camera: PerspectiveCamera | OrthographicCamera, film: Film, x: mpf, y: mpf) -> tuple[Vector, Vector]:
    eye, target, up = _exact(camera.eye), _exact(camera.target), _exact(camera.up)
    forward = _unit(_minus(target, eye))
    right = _unit(_cross(forward, up))
    above = _cross(right, forward)
    perspective = isinstance(camera, PerspectiveCamera)
    half = mp.tan(mp.radians(mpf(camera.fov_y_deg)) / 2) if isinstance(camera, PerspectiveCamera) else mpf(camera.height_m) / 2
    a = (2 * x / film.width - 1) * mpf(film.width) / film.height * half
    b = (1 - 2 * y / film.height) * half
    on_film = _plus(_times(a, right), _times(b, above))
    return (eye, _plus(forward, on_film)) if perspective else (_plus(eye, on_film), forward)


# --- visibility -------------------------------------------------------------------------------------------------------


def _first_seen(scene: Scene, origin: Vector, direction: Vector) -> Seen | None:
    best: tuple[mpf, int, Vector] | None = None
    coordinates = _length(_exact(scene.camera.eye)) / _length(direction)
    for index, shape in enumerate(scene.objects):
        m = mp.matrix(matrix(shape).tolist())
        inverse = m**-1
        local_origin, local_direction = _apply(inverse, origin, 1), _apply(inverse, direction, 0)
        for t, normal in _crossings(shape, local_origin, local_direction):
            if t > 0 and (best is None or best[0] - t > (best[0] + coordinates) * mpf(2) ** -50):
                best = (t, index, _apply(inverse.T, normal, 0))
    if best is None:
        return None
    t, index, normal = best
    normal, to_viewer = _unit(normal), _unit(_times(mpf(-1), direction))
    if _dot(normal, to_viewer) < 0:
        normal = _times(mpf(-1), normal)
    return Seen(index, _plus(origin, _times(t, direction)), normal, to_viewer)


def _crossings(shape: Object, o: Vector, d: Vector) -> Crossings:
    match shape:
        case Sphere():
            yield from _sphere(_exact(shape.center), mpf(shape.radius), o, d)
        case Plane():
            yield from _flat(_exact(shape.point), _exact(shape.normal), o, d, lambda p: True)
        case Disc():
            c, r = _exact(shape.center), mpf(shape.radius)
            yield from _flat(c, _exact(shape.normal), o, d, lambda p: _length(_minus(p, c)) <= r)
        case Rectangle():
            yield from _rectangle(_exact(shape.corner), _exact(shape.edge_u), _exact(shape.edge_v), o, d)
        case Box():
            yield from _box(_exact(shape.min), _exact(shape.max), o, d)
        case Cylinder():
            yield from _cylinder(_exact(shape.base), _exact(shape.top), mpf(shape.radius), shape.capped, o, d)
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
    q = _minus(o, center)
    for t in _quadratic(_dot(d, d), _dot(q, d), _dot(q, q) - radius**2):
        yield t, _plus(q, _times(t, d))


def _flat(point: Vector, normal: Vector, o: Vector, d: Vector, inside: Callable[[Vector], bool]) -> Crossings:
    towards = _dot(d, normal)
    if towards != 0:
        t = _dot(_minus(point, o), normal) / towards
        if inside(_plus(o, _times(t, d))):
            yield t, normal


def _rectangle(corner: Vector, u: Vector, v: Vector, o: Vector, d: Vector) -> Crossings:
    def inside(p: Vector) -> bool:
        q = _minus(p, corner)
        return bool(0 <= _dot(q, u) / _dot(u, u) <= 1 and 0 <= _dot(q, v) / _dot(v, v) <= 1)

    yield from _flat(corner, _cross(u, v), o, d, inside)


def _box(low: Vector, high: Vector, o: Vector, d: Vector) -> Crossings:
    """Six faces, each a rectangle between the other two axes' limits."""
    for axis in range(3):
        others = [k for k in range(3) if k != axis]
        for corner, sign in ((low, -1), (high, 1)):
            normal = tuple(mpf(sign if k == axis else 0) for k in range(3))
            yield from _flat(corner, normal, o, d, lambda p, others=others: all(low[k] <= p[k] <= high[k] for k in others))  # type: ignore[misc]


def _cylinder(base: Vector, top: Vector, radius: mpf, capped: bool, o: Vector, d: Vector) -> Crossings:
    axis = _minus(top, base)
    height = _length(axis)
    along = _times(1 / height, axis)
    q = _minus(o, base)
    q_across, d_across = _minus(q, _times(_dot(q, along), along)), _minus(d, _times(_dot(d, along), along))
    for t in _quadratic(_dot(d_across, d_across), _dot(q_across, d_across), _dot(q_across, q_across) - radius**2):
        if 0 <= _dot(_plus(q, _times(t, d)), along) <= height:
            yield t, _plus(q_across, _times(t, d_across))
    if capped:
        for center, normal in ((base, _times(mpf(-1), along)), (top, along)):
            yield from _flat(center, normal, o, d, lambda p, center=center: bool(_length(_minus(p, center)) <= radius))  # type: ignore[misc]


# --- lights and the formula -------------------------------------------------------------------------------------------


def _arriving(light: DeltaLight, point: Vector) -> tuple[Vector, Bands]:
    """Unit vector to the light, and E."""
    if isinstance(light, DirectionalLight):
        return _unit(_times(mpf(-1), _exact(light.direction))), _exact(light.irradiance)
    to_light = _minus(_exact(light.position), point)
    r = _length(to_light)
    to_light = _times(1 / r, to_light)
    law = light.attenuation
    weight = 1 / (mpf(law.constant) + mpf(law.linear) * r + mpf(law.quadratic) * r**2)
    if isinstance(light, SpotLight):
        cosine = -_dot(to_light, _unit(_exact(light.direction)))
        inside = cosine >= mp.cos(mp.radians(mpf(light.cone_half_angle_deg)))
        weight *= mp.power(cosine, mpf(light.exponent)) if inside else mpf(0)
    return to_light, _times(weight, _exact(light.intensity))


def _shade(scene: Scene, material: Material, seen: Seen) -> tuple[Bands, Bands]:
    ambient, emission = _exact(scene.ambient), _exact(material.emission)
    k_amb, k_diff, k_spec = _exact(material.ambient), _exact(material.diffuse), _exact(material.specular)
    n, v = seen.normal, seen.to_viewer
    radiance = scale = _bands(lambda b: emission[b] + k_amb[b] * ambient[b])
    for light in scene.delta_lights.values():
        to_light, e = _arriving(light, seen.point)
        n_l = _dot(n, to_light)
        scale = _bands(lambda b, s=scale, e=e: s[b] + e[b] * (k_diff[b] + k_spec[b]))
        if n_l > 0:
            mirror = _minus(_times(2 * n_l, n), to_light)
            r_v = _dot(mirror, v)
            power = mp.power(r_v, mpf(material.exponent)) if r_v > 0 else mpf(0)
            radiance = _bands(lambda b, s=radiance, e=e, c=n_l, h=power: s[b] + e[b] * (k_diff[b] * c + k_spec[b] * h))
    return radiance, scale


# --- vectors ----------------------------------------------------------------------------------------------------------


def _exact(values: Sequence[float]) -> Vector:
    x, y, z = (mpf(value) for value in values)
    return x, y, z


def _bands(of_band: Callable[..., mpf]) -> Bands:
    return of_band(0), of_band(1), of_band(2)


def _plus(a: Vector, b: Vector) -> Vector:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def _minus(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _times(k: mpf, a: Vector) -> Vector:
    return k * a[0], k * a[1], k * a[2]


def _dot(a: Vector, b: Vector) -> mpf:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _length(a: Vector) -> mpf:
    return mp.sqrt(_dot(a, a))


def _unit(a: Vector) -> Vector:
    return _times(1 / _length(a), a)


def _apply(m: mpmath.matrix, a: Vector, w: int) -> Vector:
    """The upper three rows of a 4×4 matrix on (a, w)."""
    x, y, z = (m[row, 0] * a[0] + m[row, 1] * a[1] + m[row, 2] * a[2] + m[row, 3] * w for row in range(3))
    return x, y, z
