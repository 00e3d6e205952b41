"""The uncertainty budget of a script's picture. u = 2^-24, half a unit in the last place of single precision.

Constants are derived, not fitted: each says from what; tests show that none is exceeded. Lengths are in the script's unit.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from equilux.adapter import Bound, Budget, Case, Geometric, Sampled, Unsupported
from equilux_adapters.mitsuba.geometry import curvature_of, enclosure_of, reach_of, thinness_of
from equilux_adapters.mitsuba.shapes import PLANE_RADIUS, plane_in_world
from equilux_scenes.model import DeltaLight, DirectionalLight, Emitter, Material, Plane, Scene, SphereEmitter, SpotLight

Floats = npt.NDArray[np.float64]

U = 2.0**-24

RAY_EPSILON = 1500 * U
"""By how much, times 1 + the largest coordinate, Mitsuba moves a shadow ray's origin along the normal (Q9)."""

POSITION_ROUNDINGS = 8
"""Of a point seen, relative to the scene's reach: the ray's origin and direction (2), the distance (3), going there (1), putting
the point back onto the surface (2)."""

DIRECTION_ROUNDINGS = 8
"""Of a cosine between directions: three differences, products and sums made unit (2 each for two vectors), in a rounded
frame (2 more), and their sum of products (2)."""

VALUE_ROUNDINGS = 14
"""Of what one light brings: coefficient and π (4), radiance or intensity (2), attenuation (6), products (2)."""

SAMPLE_ROUNDINGS = 20
"""Of an estimate, on top: density and weight of both ways of sampling (12), the mean of up to 2^16 samples by halves (8)."""

DENSITY_ROUNDINGS = 2
"""Of 1 − cos α: sin² α (1), the root (1/2), the difference (1/2)."""

NO_SURFACE = {"diffuse": [0.0] * 3, "specular": [0.0] * 3, "exponent": 0.0, "curvature": 0.0, "thinness": 0.0}

STEEPEST = 4.0
"""Tangent of the incidence up to which the shift of shadows by the moved origin is stated: 76°, beyond which less than a
quarter of the light arrives."""

IN_PLANE = 2.0**-44
"""Of the scene's reach: the eye as near to a plane lies in it. Its place was rounded to 2^-53 by whoever wrote it down."""

__all__ = ["budget_of", "facts_of", "near_of", "reach_of"]


def near_of(case: Case) -> float:
    """What a ray of the camera meets before is taken to be where it starts, and is not seen (Q17).

    Nearer than POSITION_ROUNDINGS nobody can say on which side of it the eye is. Where the eye lies in a plane, it is as far as
    shadow rays start off theirs, so that little of the plane is seen although it is edge on. Raises Unsupported where the eye is
    beside a plane, and nearer than can be told.
    """
    largest = float(np.abs(case.scene.camera.eye).max())
    rounded, apart = POSITION_ROUNDINGS * U * (1 + largest), _plane_apart(case)
    if apart <= IN_PLANE * reach_of(case):
        return RAY_EPSILON * (1 + largest)
    if apart < rounded:
        reason = f"the eye is {apart:.2g} units beside a plane: in single precision, Mitsuba cannot tell on which side"
        raise Unsupported(["shape.plane"], reason)
    return rounded


def _plane_apart(case: Case) -> float:
    """The eye's distance from the nearest plane; of parallel rays, few start in a plane."""
    if case.scene.camera.projection == "orthographic":
        return math.inf
    planes = [plane_in_world(obj) for obj in case.scene.objects if isinstance(obj, Plane)]
    return min((abs(float(np.dot(case.scene.camera.eye - point, normal))) for point, normal in planes), default=math.inf)


def facts_of(case: Case) -> dict[str, Any]:
    """JSON: what `budget_of` needs to know of the case; it travels with the program."""
    scene = case.scene
    cones = [light.cone_half_angle_deg for light in scene.lights.values() if isinstance(light, SpotLight)]
    return {
        "reach": reach_of(case),
        "delta_lights": [_delta(light) for light in scene.delta_lights.values()],
        "emitters": [_extended(light) for light in scene.lights.values() if isinstance(light, Emitter)],
        "environment": list(scene.environment.radiance) if scene.environment else [0.0, 0.0, 0.0],
        "surfaces": [_surface(case, index) for index in range(len(scene.objects))],
        "view": {"near": near_of(case)} | _view(scene),
        "occlusion": "occlusion" in case.requires,
        "plane": any(isinstance(obj, Plane) for obj in scene.objects),
        "sine_of_cone": math.sin(math.radians(min(cones))) if cones else None,
    }


def _delta(light: DeltaLight) -> dict[str, Any]:
    """At a point, or (position null) at infinity, where the strength is the irradiance."""
    if isinstance(light, DirectionalLight):
        return {"position": None, "strength": list(light.irradiance), "attenuation": [1.0, 0.0, 0.0], "exponent": 0.0}
    terms = light.attenuation
    return {
        "position": list(light.position),
        "strength": list(light.intensity),
        "attenuation": [terms.constant, terms.linear, terms.quadratic],
        "exponent": light.exponent if isinstance(light, SpotLight) else 0.0,
    }


def _extended(light: Emitter) -> dict[str, Any]:
    """A sphere around it; around (centre null) the environment all else."""
    center, radius = enclosure_of(light)
    is_sphere = isinstance(light, SphereEmitter)
    return {"center": center, "radius": radius, "radiance": list(light.radiance), "is_sphere": is_sphere}


def _surface(case: Case, index: int) -> dict[str, Any]:
    material: Material = case.scene.materials[case.scene.objects[index].material]
    shines = material.brdf != "lambert" and any(material.specular)
    return {
        "diffuse": list(material.diffuse),
        "specular": list(material.specular) if shines else [0.0, 0.0, 0.0],
        "exponent": material.exponent if shines else 0.0,
        "curvature": curvature_of(case, index),
        "thinness": thinness_of(case, index),
    }


def _view(scene: Scene) -> dict[str, Any]:
    camera, film = scene.camera, scene.film
    parallel = camera.projection == "orthographic"
    half_height = camera.height_m / 2 if camera.projection == "orthographic" else math.tan(math.radians(camera.fov_y_deg) / 2)
    return {"eye": list(camera.eye), "parallel": parallel, "pixels_per_unit": film.height / (2 * half_height)}


def budget_of(facts: Mapping[str, Any], picture: Mapping[str, npt.NDArray[Any]], repeats: int) -> Budget:
    """The terms, from the facts of the case and from what the picture shows where."""
    seen = _Seen(facts, picture)
    terms: list[Bound | Geometric | Sampled] = []
    if facts["emitters"]:
        reason = f"{repeats} independent repeats of a stratified estimate by emitter and BSDF sampling (Q2, Q3)"
        terms.append(Sampled("sampling", reason, sigma=_known(picture["sigma"]), repeats=repeats))
    roundings = VALUE_ROUNDINGS + SAMPLE_ROUNDINGS * bool(facts["emitters"]) + len(facts["delta_lights"])
    reason = "single precision: of factors (relative) and of the cosines of the directions in them (Q1)"
    terms.append(Bound("arithmetic", reason, abs=_of_cosines(facts, seen), rel=roundings * U))
    if spheres := [light for light in facts["emitters"] if light["is_sphere"]]:
        reason = "directions to a small sphere are weighted by 1 − cos α in single precision (Q4)"
        densities = [_of_density(light, seen, picture["image"]) for light in spheres]
        terms.append(Bound("density", reason, abs=np.sum(densities, axis=0)))
    if "offset" in picture:
        reason = "shadow rays start RayEpsilon off the surface: twice what starting twice as far off changes (Q9)"
        terms.append(Bound("ray offset", reason, abs=2 * _largest_around(_known(picture["offset"]), picture["object"])))
    if facts["plane"] and any(facts["environment"]):
        reason = "the disc in place of the plane ends, and light comes from beyond it (Q11)"
        strip = 2 * math.pi / PLANE_RADIUS * (seen.diffuse + seen.specular) * facts["environment"]
        terms.append(Bound("finite plane", reason, abs=strip))
    reason = "rays and shapes in single precision (Q1), hard shadows displaced (Q9)"
    terms.append(Geometric("film", reason, film_px=_film_px(facts, seen)))
    return Budget(tuple(terms))


def _known(array: Floats) -> Floats:
    """A budget must be finite; where the picture is not, the pixel counts as invalid whatever the budget says."""
    return np.where(np.isfinite(array), array, 0.0)


class _Seen:
    """What each pixel shows: arrays (h, w) or (h, w, 3); 0 where it is not an object."""

    def __init__(self, facts: Mapping[str, Any], picture: Mapping[str, npt.NDArray[Any]]) -> None:
        number = picture["object"]
        self.is_object = number >= 0
        self.position: Floats = np.where(self.is_object[..., None], _known(picture["position"]), 0.0)
        surfaces = [*facts["surfaces"], NO_SURFACE]
        index = np.where(self.is_object, number, len(surfaces) - 1)

        def of_surface(key: str) -> Floats:
            return np.array([surface[key] for surface in surfaces], dtype=np.float64)[index]

        self.diffuse, self.specular, self.exponent = of_surface("diffuse"), of_surface("specular"), of_surface("exponent")
        largest = np.abs(self.position).max(axis=-1)
        view = facts["view"]
        away = np.linalg.norm(self.position - view["eye"], axis=-1)
        self.away = np.where(self.is_object, np.maximum(away, view["near"]), math.inf)
        self.has_passed = "passed" in picture and bool(np.any(picture["passed"]))
        self.misplaced = POSITION_ROUNDINGS * U * np.maximum(largest, facts["reach"])
        # seen at a grazing angle, an error across the ray moves the point along it by 1/cos as much
        slide = self.misplaced / np.maximum(_known(picture["facing"]), math.sqrt(U))
        of_corners = 2 * U * facts["reach"] * of_surface("thinness")
        self.normal = DIRECTION_ROUNDINGS * U + slide * of_surface("curvature") + of_corners
        self.pixels_per_length = view["pixels_per_unit"] / (1.0 if view["parallel"] else self.away)
        self.shadow_px = np.where(self.is_object, RAY_EPSILON * (1 + largest) * STEEPEST * self.pixels_per_length, 0.0)


def _of_cosines(facts: Mapping[str, Any], seen: _Seen) -> Floats:
    """(h, w, 3), W/(m²·sr): the light that arrives, times what an error of its direction or of the normal does to K cosθ and to
    K (R·V)^p; the lobe's slope is at most p, and R turns twice as far as N."""
    total = np.zeros(seen.diffuse.shape)
    for light in facts["delta_lights"]:
        constant, linear, quadratic = light["attenuation"]
        if light["position"] is None:
            away = np.full(seen.away.shape, math.inf)
            strength = np.ones(seen.away.shape)
        else:
            away = np.maximum(np.linalg.norm(seen.position - light["position"], axis=-1), np.finfo(float).tiny)
            strength = 1 / (constant + away * (linear + away * quadratic))
        turn = seen.normal + DIRECTION_ROUNDINGS * U + seen.misplaced / away
        turn_of_lobe = np.minimum(seen.exponent * (2 * turn + seen.misplaced / seen.away), 1.0)
        nearer = (2 + light["exponent"]) * (seen.misplaced / away + DIRECTION_ROUNDINGS * U * (light["exponent"] > 0))
        effect = seen.diffuse * (turn + nearer)[..., None] + seen.specular * (turn_of_lobe + turn + nearer)[..., None]
        total += effect * strength[..., None] * light["strength"]
    for light in facts["emitters"]:
        turn = seen.normal + DIRECTION_ROUNDINGS * U
        angle = _solid_angle(light, seen)
        # over the hemisphere the lobe's slope p (R·V)^(p-1) integrates to 2π
        of_lobe = 2 * np.minimum(2 * math.pi, angle * np.maximum(seen.exponent, 1.0))
        total += (seen.diffuse * angle[..., None] + seen.specular * of_lobe[..., None]) * turn[..., None] * light["radiance"]
    return np.where(seen.is_object[..., None], total, 0.0)


def _solid_angle(light: Mapping[str, Any], seen: _Seen) -> Floats:
    """(h, w), sr: of the sphere around an emitter, at most a hemisphere."""
    if light["center"] is None:
        return np.full(seen.away.shape, 2 * math.pi)
    away = np.linalg.norm(seen.position - light["center"], axis=-1)
    sine = np.minimum(light["radius"] / np.maximum(away, light["radius"]), 1.0)
    return np.asarray(2 * math.pi * sine**2 / (1 + np.sqrt(1 - sine**2)))


def _of_density(light: Mapping[str, Any], seen: _Seen, image: Floats) -> Floats:
    """(h, w, 3), W/(m²·sr): 1 − cos α, from which a sphere's directions get their weight, is off by DENSITY_ROUNDINGS u (Q4).

    The sphere brings at most 2π (1 − cos α) K L, and not more than all the light that is seen. Below α = 2^-11, where the share
    that is off reaches a half, all that it brings may be missing from the picture.
    """
    share = DENSITY_ROUNDINGS * U * 2 * math.pi / np.maximum(_solid_angle(light, seen), np.finfo(float).tiny)
    at_most = DENSITY_ROUNDINGS * U * 2 * math.pi * (seen.diffuse + seen.specular) * light["radiance"]
    of_seen = np.where(share < 0.5, share / (1 - np.minimum(share, 0.5)), math.inf)[..., None]
    with np.errstate(invalid="ignore"):  # none of nothing: no bound
        tighter = np.nan_to_num(of_seen * np.abs(_known(image)), nan=math.inf)
    return np.where(seen.is_object[..., None], np.minimum(tighter, at_most), 0.0)


def _largest_around(image: Floats, number: npt.NDArray[Any]) -> Floats:
    """(h, w, 3): the maximum over the 3×3 pixels around, as far as they show the same object."""
    height, width = number.shape
    framed = np.pad(image, ((1, 1), (1, 1), (0, 0)), mode="edge")
    numbers = np.pad(number, 1, mode="edge")
    largest = image
    for row, column in np.ndindex(3, 3):
        part = np.s_[row : row + height, column : column + width]
        largest = np.maximum(largest, np.where((numbers[part] == number)[..., None], framed[part], 0.0))
    return largest


def _film_px(facts: Mapping[str, Any], seen: _Seen) -> float:
    """How far a silhouette, a hard shadow or the border of a cone may be displaced on the film."""
    view = facts["view"]
    scale = view["pixels_per_unit"]
    shown = np.where(seen.is_object, seen.misplaced * seen.pixels_per_length, 0.0)
    rays = float(np.max(shown, initial=0.0)) + (0.0 if view["parallel"] else DIRECTION_ROUNDINGS * U * scale)
    horizon = scale / PLANE_RADIUS if facts["plane"] and not view["parallel"] else 0.0
    shadows = float(np.max(seen.shadow_px, initial=0.0)) if facts["occlusion"] and facts["delta_lights"] else 0.0
    # a surface in which the eye lies, up to rounding, is seen edge on up to this angle
    edge_on = float(np.max(seen.misplaced)) / view["near"] * scale if seen.has_passed else 0.0
    return rays + horizon + shadows + edge_on + _cone_px(facts, seen)


def _cone_px(facts: Mapping[str, Any], seen: _Seen) -> float:
    """The cosine is off by some u, the angle by that over its sine, the border by that times the light's distance."""
    if facts["sine_of_cone"] is None:
        return 0.0
    angle = DIRECTION_ROUNDINGS * U / facts["sine_of_cone"]
    spots = [np.linalg.norm(seen.position - light["position"], axis=-1) for light in facts["delta_lights"] if light["position"]]
    return max(float(np.max(np.where(seen.is_object, angle * away * seen.pixels_per_length, 0.0), initial=0.0)) for away in spots)
