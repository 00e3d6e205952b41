"""Pictures of the local models `phong` and `opengl`: camera rays → visible points → local formula, a slice of the film at a time.

Of `opengl`, with att and spot in E_i as everywhere:

    L = e_m + a_m a_global + Σ_i E_i [ a_m a_i + g_i (d_m d_i (N·L_i) + s_m s_i max(0, N·H_i)^s) ],     H_i = unit(L_i + V)

V goes to the eye point, in orthographic views too, or everywhere against the view direction (`viewer: infinite`); the side of N
is that which the camera's ray meets, whatever V is.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from equilux_oracle.camera import Rays, camera_frame, film_rays
from equilux_oracle.doubledouble import DD, Array, dot, unit
from equilux_oracle.examination import SLICE, Examination
from equilux_oracle.highlight import MIRRORED, ROUNDED_ONCE, halfway, mirrored
from equilux_oracle.lights import Arriving, arriving
from equilux_oracle.local_formula import Shading, Surface, shade, surface
from equilux_oracle.ray_errors import RayError, SurfaceError, at_surface, felt
from equilux_oracle.shapes.crossing import each_ray
from equilux_oracle.visibility import Visible, first_seen
from equilux_oracle.world import World, world_of
from equilux_scenes.case import Case
from equilux_scenes.model import DeltaLight, Scene


def examine_local(case: Case, positions: Array) -> Examination:
    """Film positions (n, 2) of a scene without meshes."""
    world = world_of(case.scene)
    # At least one slice, so that no positions give empty arrays of the right shape.
    starts = range(0, max(len(positions), 1), SLICE)
    parts = [_examine_slice(case.scene, world, positions[start : start + SLICE]) for start in starts]
    return Examination(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))


def _examine_slice(
    scene: Scene, world: World, positions: Array
) -> tuple[Array, Array, Array, Array, npt.NDArray[np.int64]]:
    rays = film_rays(scene.camera, scene.film, positions)
    spread = np.linalg.norm(rays.direction.hi, axis=0)
    seen = first_seen(world.objects, rays, world.eye_distance / spread)
    hit = np.flatnonzero(seen.object_id >= 0)
    value, bound, scale = np.tile(np.asarray(scene.background), (len(positions), 1)), *np.zeros((2, len(positions), 3))
    facing = np.ones(len(positions))
    if len(hit):
        facing[hit] = dot(seen.normal[:, hit], seen.to_viewer[:, hit]).hi
        distance = seen.t[hit] * np.broadcast_to(spread, (len(positions),))[hit]
        off = _off_by(world, rays, seen.object_id[hit], distance, facing[hit])
        for whole, part in zip((value, bound, scale), _shade_all(scene, seen, hit, off), strict=True):
            whole[hit] = part.T
    bound[seen.undecided] = np.inf
    return value, bound, scale, facing, seen.object_id


def _off_by(world: World, rays: Rays, object_id: npt.NDArray[np.int64], distance: Array, facing: Array) -> SurfaceError:
    """How far double-double geometry is off where camera rays meet the objects: nothing, unless lengths are 2^40 apart."""
    aside = np.sqrt(np.sum(rays.offset.hi**2, axis=0)).max()
    camera = RayError.of_camera(np.full(len(object_id), world.eye_distance + aside))
    size = world.size[object_id] + aside + distance
    return at_surface(camera, distance, facing, size, world.curvature[object_id], world.stretch[object_id])


def _shade_all(
    scene: Scene, seen: Visible, hit: npt.NDArray[np.intp], off: SurfaceError
) -> tuple[Array, Array, Array]:
    names = list(scene.materials)
    material_of = np.asarray([names.index(shape.material) for shape in scene.objects])
    here = surface(list(scene.materials.values()), material_of[seen.object_id[hit]], scene.ambient)
    normal, to_viewer, point = seen.normal[:, hit], seen.to_viewer[:, hit], seen.point[:, hit]
    if scene.model == "opengl":
        to_viewer = _fixed_function_viewer(scene, point)
    shading, scale, by_geometry = Shading.begin(here), here.constant.copy(), np.zeros_like(here.constant)
    for light in scene.delta_lights.values():
        arrives = arriving(light, scene.camera.eye)(point)
        if scene.model == "opengl":
            lit_by = _ambient_share(here, light, arrives, shading, scale)
            highlight = halfway(normal, arrives.to_light, to_viewer, here.exponent)
            # The products with the light's colours round once more.
            lit, power = shade(lit_by, normal, replace(arrives, error=arrives.error + 1.0), highlight, ROUNDED_ONCE, shading)
        else:
            lit_by = here
            highlight = mirrored(normal, arrives.to_light, to_viewer, here.exponent)
            lit, power = shade(here, normal, arrives, highlight, MIRRORED, shading)
        by_geometry[:, lit] += felt(lit_by, arrives, lit, power, off, 1.0)
        scale += arrives.value * (lit_by.diffuse + lit_by.specular)
    radiance, bound = shading.finish()
    return radiance, bound + by_geometry, scale


def _fixed_function_viewer(scene: Scene, point: DD) -> DD:
    """V of `opengl`: unit, (3, n), for points relative to the eye."""
    if scene.viewer == "local":
        return unit(-point)
    return each_ray(-camera_frame(scene.camera)[2], point.hi.shape[1])


def _ambient_share(here: Surface, light: DeltaLight, arrives: Arriving, into: Shading, scale: Array) -> Surface:
    """Add the light's ambient share; return the surface as the light's other two colours see it."""
    ambient, diffuse, specular = (np.asarray(share).reshape(3, 1) for share in (light.ambient, light.diffuse, light.specular))
    if np.any(ambient):
        share = here.ambient * ambient
        with np.errstate(invalid="ignore"):  # at the light itself nothing is added
            term = np.where(np.isfinite(arrives.value), arrives.value * share, 0.0)
        into.add(term)
        into.bound += term * (arrives.error + 4.0)
        scale += term
    return Surface(here.constant, here.diffuse * diffuse, here.specular * specular, here.exponent, here.ambient)
