"""Pictures of model `raytraced`: rays from the eye, mirrored and refracted, one generation of them after the other.

At every surface that a ray of weight w meets,

    L_1 = Σ_{N·L_i > 0} E_i τ_i (K_diff (N·L_i) + K_spec max(0, R_i·V)^p) + k_refl  L_refl
    L_2 = Σ_{N·L_i < 0} E_i τ_i (K_diff |N·L_i| + K_spec max(0, T_i·V)^p) + k_trans L_trans
    L   = K_emit + K_amb L_amb + (1 − t) L_1 + t L_2

the lights' parts of which are added to the pixel, times w, while L_refl and L_trans become rays of weight w (1 − t) k_refl and
w t k_trans; where the refracted ray is totally reflected instead, one mirrored ray of weight w replaces both. Rays without weight
are not followed. All geometry is in double-double; ray_errors.py says how far that may be off.

The bound of a pixel sums w (bound of local_formula.py, + what geometry does) over its surfaces, 3 u w L for each bounce's
weight, and u L for each of the sums.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from equilux_oracle.camera import Rays, film_rays
from equilux_oracle.doubledouble import DD, Array, Bools, Index, dot, unit
from equilux_oracle.examination import SLICE, Examination
from equilux_oracle.highlight import MIRRORED, ROUNDED_ONCE, mirrored, passed, refracted
from equilux_oracle.lights import Arriving, arriving, cosine_to_light
from equilux_oracle.local_formula import Shading, Surface, shade, surface
from equilux_oracle.ray_errors import RayError, SurfaceError, at_surface, bending, felt
from equilux_oracle.shadows import let_through
from equilux_oracle.shapes.crossing import each_ray
from equilux_oracle.visibility import NOTHING_LEFT, TIE, Visible, first_seen
from equilux_oracle.wave import Indices, Sums, Wave, together
from equilux_oracle.world import World, world_of
from equilux_scenes.case import Case
from equilux_scenes.model import DirectionalLight

WEIGHT = 3.0
"""Roundings of one bounce's weight: 1 − t, its product with k_refl, the product with the weight so far."""

_AT_ONCE = 4 * SLICE


class TooManyRays(Exception):
    """More rays than were allowed."""


@dataclass
class Allowance:
    """How many rays may still be followed."""

    rays: float

    def spend(self, rays: int) -> None:
        self.rays -= rays
        if self.rays < 0:
            raise TooManyRays


def examine_raytraced(case: Case, positions: Array, allowance: Allowance | None = None) -> Examination:
    """Film positions (n, 2) of a scene without meshes. Raises TooManyRays beyond the allowance."""
    world, left = world_of(case.scene), allowance or Allowance(math.inf)
    starts = range(0, max(len(positions), 1), SLICE)
    parts = [_examine_slice(world, positions[start : start + SLICE], left) for start in starts]
    return Examination(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))


def _examine_slice(world: World, positions: Array, left: Allowance) -> tuple[Array, Array, Array, Array, Indices]:
    sums, first = Sums.black(len(positions)), from_eye(world, positions)
    left.spend(len(first))
    seen, children = meet(world, first, sums, generation=0)
    facing = np.where(seen.object_id >= 0, dot(seen.normal, seen.to_viewer).hi, 1.0)
    # The deepest rays first, and not too many at once: so that memory stays bounded however the rays multiply.
    waiting = [(1, together(children))] if children else []
    while waiting:
        generation, wave = waiting.pop()
        left.spend(len(wave))
        children = [child for part in wave.parts(SLICE) for child in meet(world, part, sums, generation)[1]]
        if children:
            waiting += [(generation + 1, part) for part in together(children).parts(_AT_ONCE)]
    return *sums.finish(), facing, seen.object_id


def from_eye(world: World, positions: Array) -> Wave:
    """The camera's rays through film positions (n, 2)."""
    rays, count = film_rays(world.scene.camera, world.scene.film, positions), len(positions)
    rays = Rays(each_ray(rays.offset, count), each_ray(unit(rays.direction), count), count)
    coordinates = world.eye_distance + _length(rays.offset)
    error, left = RayError.of_camera(coordinates), np.full(count, NOTHING_LEFT)
    return Wave(np.arange(count), rays, np.ones((3, count)), np.zeros(count), error, left)


def meet(world: World, wave: Wave, sums: Sums, generation: int) -> tuple[Visible, list[Wave]]:
    """Add what the rays see to the sums; return it, and the rays that go on from there."""
    coordinates = world.eye_distance + (_length(wave.rays.offset) if generation else 0.0)
    seen = first_seen(world.objects, wave.rays, coordinates, TIE * coordinates if generation else 0.0, wave.left)
    sums.doubt(wave.position[seen.undecided])
    missed = wave[np.flatnonzero(seen.object_id < 0)]
    if len(missed) and any(world.scene.background):
        shown = np.broadcast_to(np.asarray(world.scene.background).reshape(3, 1), missed.weight.shape)
        sums.add(missed, shown, np.zeros_like(shown), shown if generation else np.zeros_like(shown))
    hit = np.flatnonzero(seen.object_id >= 0)
    if len(hit) == 0:
        return seen, []
    arriving_wave = wave[hit]
    met = _met_by(world, seen, hit, arriving_wave)
    sums.add(arriving_wave, *_shade(world, met))
    sums.doubt(arriving_wave.position[met.undecided])
    last = generation >= world.scene.recursion_limit
    return seen, [] if last else list(_onward(world, met, arriving_wave))


@dataclass(frozen=True)
class Met:
    """Surfaces that n rays have met: object (n,), geometry as in Visible, indices on both sides of N (n,), and errors.

    undecided: where the shadows turn out to hang on how coincidence is defined, (n,); `_shade` fills it in.
    """

    object_id: Indices
    point: DD
    normal: DD
    to_viewer: DD
    facing: DD
    n_front: DD
    n_behind: DD
    off: SurfaceError
    undecided: Bools


def _met_by(world: World, seen: Visible, hit: Index, wave: Wave) -> Met:
    object_id, outside = seen.object_id[hit], seen.outside[hit]
    normal, to_viewer = seen.normal[:, hit], seen.to_viewer[:, hit]
    ior, facing = world.ior[object_id], dot(normal, to_viewer)
    size = world.size[object_id] + _length(wave.rays.offset) + seen.t[hit]
    off = at_surface(wave.error, seen.t[hit], facing.hi, size, world.curvature[object_id], world.stretch[object_id])
    n_front, n_behind = DD(np.where(outside, 1.0, ior)), DD(np.where(outside, ior, 1.0))
    undecided = np.zeros(len(object_id), dtype=bool)
    return Met(object_id, seen.point[:, hit], normal, to_viewer, facing, n_front, n_behind, off, undecided)


def _shade(world: World, met: Met) -> tuple[Array, Array, Array]:
    """All that is not carried by further rays: radiance, its absolute bound, and the scale, (3, n)."""
    scene, t = world.scene, world.transparency[met.object_id]
    here = surface(world.materials, met.object_id, scene.ambient)
    front, behind = _weighted(here, 1.0 - t), _weighted(here, t)
    shading, by_geometry, scale = Shading.begin(here), np.zeros_like(here.constant), here.constant.copy()
    eta = met.n_behind / met.n_front
    for light in scene.delta_lights.values():
        reaching = arriving(light, scene.camera.eye)(met.point)
        side = cosine_to_light(met.normal, reaching)
        matters = _coefficients(front) & (side > 0.0) | _coefficients(behind) & (side < 0.0)
        scale += np.where(matters, reaching.value * _sum_of(front, behind, side), 0.0)
        finite = not isinstance(light, DirectionalLight)
        reaching = _shadowed(world, met, reaching, np.flatnonzero(matters & np.any(reaching.value > 0.0, axis=0)), finite=finite)
        lit, power = shade(
            front, met.normal, reaching, mirrored(met.normal, reaching.to_light, met.to_viewer, here.exponent), MIRRORED, shading
        )
        by_geometry[:, lit] += felt(front, reaching, lit, power, met.off, 1.0)
        if np.any(t > 0.0):
            transmitted = passed(met.normal, reaching.to_light, met.to_viewer, here.exponent, eta)
            lit, power = shade(behind, -met.normal, reaching, transmitted, ROUNDED_ONCE, shading)
            by_geometry[:, lit] += felt(behind, reaching, lit, power, met.off, _bent(met, reaching, lit, eta))
    radiance, bound = shading.finish()
    return radiance, bound + by_geometry, scale


def _weighted(here: Surface, weight: Array) -> Surface:
    return replace(here, diffuse=here.diffuse * weight, specular=here.specular * weight)


def _coefficients(side: Surface) -> Bools:
    """Whether the surface shows anything of a light on this side, (n,)."""
    shows: Bools = np.any((side.diffuse > 0.0) | (side.specular > 0.0), axis=0)
    return shows


def _sum_of(front: Surface, behind: Surface, side: Array) -> Array:
    return np.where(side > 0.0, front.diffuse + front.specular, behind.diffuse + behind.specular)


def _shadowed(world: World, met: Met, light: Arriving, where_asked: Indices, *, finite: bool) -> Arriving:
    """E τ where it is asked for, 0 elsewhere. Weights 1 − t or t of the surface round thrice more than local_formula.py knows."""
    value, error = np.zeros_like(light.value), light.error + 3.0
    if len(where_asked):
        point, to_light = met.point[:, where_asked], light.to_light[:, where_asked]
        left = met.object_id[where_asked]
        tau, tau_error, doubtful = let_through(
            world.objects, world.shares, point, to_light, world.eye_distance, left, finite=finite
        )
        met.undecided[where_asked] |= doubtful
        value[:, where_asked] = light.value[:, where_asked] * tau
        error[where_asked] += tau_error
    return replace(light, value=value, error=error)


def _bent(met: Met, light: Arriving, lit: Index, eta: DD) -> Array:
    """How much the refraction of the lights' rays magnifies errors of direction, at the points `lit`; 0 where none passes."""
    w = light.to_light.hi[:, lit]
    cosine2 = np.sum(met.normal.hi[:, lit] * w, axis=0) ** 2 / np.sum(w**2, axis=0)
    ratio = eta.hi[lit]
    out2 = 1.0 - ratio**2 * (1.0 - cosine2)
    return np.where(out2 > 0.0, bending(ratio, np.sqrt(cosine2), np.sqrt(np.maximum(out2, 1e-24))), 0.0)


def _onward(world: World, met: Met, wave: Wave) -> Iterator[Wave]:
    """The mirrored and the refracted rays that have any weight."""
    object_id = met.object_id
    t = world.transparency[object_id]
    through = np.flatnonzero(t > 0.0)
    mirror_weight = wave.weight * ((1.0 - t) * world.reflection[:, object_id])
    if len(through):
        eta = met.n_front[through] / met.n_behind[through]
        onward, total = refracted(-met.to_viewer[:, through], -met.normal[:, through], eta)
        mirror_weight[:, through] = np.where(total, wave.weight[:, through], mirror_weight[:, through])
        weight = wave.weight[:, through] * (t[through] * world.transmission[:, object_id[through]])
        go = np.flatnonzero(~total & np.any(weight > 0.0, axis=0))
        if len(go):
            at = through[go]
            cosine = -dot(met.normal[:, at], onward[:, go]).hi
            error = _of(met.off, at).refracted(met.facing.hi[at], eta.hi[go], np.maximum(cosine, 0.0))
            yield Wave(
                wave.position[at],
                Rays(met.point[:, at], onward[:, go], len(at)),
                weight[:, go],
                wave.weight_error[at] + WEIGHT,
                error,
                object_id[at],
            )
    go = np.flatnonzero(np.any(mirror_weight > 0.0, axis=0))
    if len(go):
        normal, to_viewer = met.normal[:, go], met.to_viewer[:, go]
        direction = normal * (met.facing[go] * 2.0) - to_viewer
        rays = Rays(met.point[:, go], direction, len(go))
        error = _of(met.off, go).mirrored()
        yield Wave(wave.position[go], rays, mirror_weight[:, go], wave.weight_error[go] + WEIGHT, error, object_id[go])


def _of(off: SurfaceError, index: Index) -> SurfaceError:
    return SurfaceError(off.lateral[index], off.rounding[index], off.point[index], off.normal[index], off.viewer[index])


def _length(v: DD) -> Array:
    result: Array = np.sqrt(np.sum(v.hi**2, axis=0))
    return result
