"""Model `raytraced` at fifty digits: the recursion of lighting_model.md as it stands, one ray at a time.

Its rules for shadow and media are told once more here, apart from transport.py and shadows.py; the crossings are precise.py's.
"""

from __future__ import annotations

from mpmath import mp, mpf

from equilux_oracle.precise import (
    Bands,
    Evaluation,
    Seen,
    Vector,
    arriving,
    bands,
    crossings_with,
    dot,
    exact,
    first_seen,
    length,
    minus,
    plus,
    times,
    unit,
)
from equilux_scenes.model import DeltaLight, DirectionalLight, Material, Scene

_SAME = mpf(2) ** -50


def trace(scene: Scene, origin: Vector, direction: Vector) -> Evaluation:
    """What a camera ray sees. Raises TypeError for a mesh."""
    radiance, scale, seen = _along(scene, origin, unit(direction), scene.recursion_limit, mpf(0))
    return Evaluation(radiance, scale if seen else None, seen)


def _along(scene: Scene, origin: Vector, direction: Vector, further: int, start: mpf) -> tuple[Bands, Bands, Seen | None]:
    """L along a ray of which `further` more may follow in succession; the scale of its errors; what it sees."""
    seen = first_seen(scene, origin, direction, start)
    if seen is None:
        return exact(scene.background), exact(scene.background), None
    material = scene.materials[scene.objects[seen.index].material]
    t, k_refl, k_trans = mpf(material.transparency), exact(material.reflection), exact(material.transmission)
    n, v = seen.normal, seen.to_viewer
    radiance, scale = _lights(scene, material, seen)
    eta = _ratio(material, seen)  # n_front / n_behind
    bent2 = eta**2 * (1 - dot(n, v) ** 2)
    total = t > 0 and bent2 > 1
    if further > 0:
        mirror = mpf(1) if total else None
        weight = bands(lambda b: mirror if mirror is not None else (1 - t) * k_refl[b])
        reflected = minus(times(2 * dot(n, v), n), v)
        radiance, scale = _with(scene, seen.point, reflected, weight, further, radiance, scale)
        if not total:
            weight = bands(lambda b: t * k_trans[b])
            onward = minus(times(eta * dot(n, v) - mp.sqrt(1 - bent2), n), times(eta, v)) if t > 0 else v
            radiance, scale = _with(scene, seen.point, onward, weight, further, radiance, scale)
    return radiance, scale, seen


def _with(
    scene: Scene, point: Vector, direction: Vector, weight: Bands, further: int, radiance: Bands, scale: Bands
) -> tuple[Bands, Bands]:
    """Both with a secondary ray's share added."""
    if not any(weight):
        return radiance, scale
    found, felt, _ = _along(scene, point, unit(direction), further - 1, _start(scene, point))
    return bands(lambda b: radiance[b] + weight[b] * found[b]), bands(lambda b: scale[b] + weight[b] * felt[b])


def _start(scene: Scene, point: Vector) -> mpf:
    """How near to a point a crossing is the point itself."""
    eye = exact(scene.camera.eye)
    return _SAME * (length(eye) + length(minus(point, eye)))


def _ratio(material: Material, seen: Seen) -> mpf:
    return 1 / mpf(material.ior) if seen.outside else mpf(material.ior)


def _lights(scene: Scene, material: Material, seen: Seen) -> tuple[Bands, Bands]:
    """K_emit + K_amb L_amb + the lights' parts of (1 − t) L_1 + t L_2."""
    ambient, emission, k_amb = exact(scene.ambient), exact(material.emission), exact(material.ambient)
    k_diff, k_spec, p, t = exact(material.diffuse), exact(material.specular), mpf(material.exponent), mpf(material.transparency)
    n, v = seen.normal, seen.to_viewer
    radiance = scale = bands(lambda b: emission[b] + k_amb[b] * ambient[b])
    for light in scene.delta_lights.values():
        to_light, e = arriving(light, seen.point)
        n_l = dot(n, to_light)
        if n_l == 0:
            continue
        tau = _let_through(scene, light, seen.point, to_light)
        share = 1 - t if n_l > 0 else t
        if n_l > 0:
            leaving: Vector | None = minus(times(2 * n_l, n), to_light)
        else:
            leaving = _passed(n, times(mpf(-1), to_light), 1 / _ratio(material, seen))
        cosine = dot(leaving, v) if leaving is not None else mpf(0)
        power = mp.power(cosine, p) if cosine > 0 else mpf(0)
        strength = [share * e[b] * tau[b] for b in range(3)]
        lit = [strength[b] * (k_diff[b] * abs(n_l) + k_spec[b] * power) for b in range(3)]
        radiance = bands(lambda b, whole=radiance, lit=lit: whole[b] + lit[b])
        scale = bands(lambda b, whole=scale, e=e, s=share: whole[b] + s * e[b] * (k_diff[b] + k_spec[b]))
    return radiance, scale


def _passed(n: Vector, d: Vector, eta: mpf) -> Vector | None:
    """T = η d + (√(1 − s²) − η c) N of light that travels along d from behind; None where s² > 1. η = n_behind / n_front."""
    c = dot(n, d)
    s2 = eta**2 * (1 - c**2)
    return None if s2 > 1 else plus(times(eta, d), times(mp.sqrt(1 - s2) - eta * c, n))


def _let_through(scene: Scene, light: DeltaLight, point: Vector, to_light: Vector) -> Bands:
    """τ: the product over all crossings strictly between."""
    near = _start(scene, point)
    far = mp.inf
    if not isinstance(light, DirectionalLight):
        far = length(minus(exact(light.position), point)) * (1 - _SAME) - near
    tau = bands(lambda b: mpf(1))
    for index, shape in enumerate(scene.objects):
        material = scene.materials[shape.material]
        if material.transparency > 0 and scene.transparent_shadows == "ignore":
            continue
        t, k_trans = mpf(material.transparency), exact(material.transmission)
        for distance, _ in crossings_with(scene, index, point, to_light):
            if near < distance < far:
                tau = bands(lambda b, tau=tau, t=t, k=k_trans: tau[b] * t * k[b])
    return tau
