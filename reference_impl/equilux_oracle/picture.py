"""The oracle's pictures: camera rays → visible points → local formula, a slice of the film at a time."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from equilux_oracle.camera import film_rays
from equilux_oracle.doubledouble import Array, dot
from equilux_oracle.lights import arriving
from equilux_oracle.local_formula import Shading, shade, surface
from equilux_oracle.visibility import Body, Visible, bodies, first_seen
from equilux_scenes.case import Case
from equilux_scenes.model import Film, Mesh, Scene

_SLICE = 8192  # rays at once: the temporaries of one double-double product then stay in a core's cache


def supports(case: Case) -> list[str]:
    """The features of a case that have no closed form, sorted; empty where the oracle can be evaluated."""
    meshes = [shape for shape in case.scene.objects if isinstance(shape, Mesh)]
    return sorted({"shape.mesh", *(f"normals.{shape.normals}" for shape in meshes)}) if meshes else []


@dataclass(frozen=True)
class Examination:
    """n film positions: what is seen there, and what the error of any evaluation is measured in.

    radiance, W/(m²·sr), (n, 3). bound: hard limit on the absolute error of its arithmetic, (n, 3). scale: K_emit + K_amb L_amb +
    Σ E_i (K_diff + K_spec) over all lights, (n, 3); 0 where nothing is hit. facing: N·V, (n,); 1 where nothing is hit.
    object_id: (n,), −1 where nothing is hit.
    """

    radiance: Array
    bound: Array
    scale: Array
    facing: Array
    object_id: npt.NDArray[np.int64]


def radiance(case: Case) -> Array:
    """The picture of a case: radiance at the pixel centres, W/(m²·sr), (h, w, 3), row 0 on top. Raises ValueError for a mesh."""
    return radiance_with_bound(case)[0]


def radiance_with_bound(case: Case) -> tuple[Array, Array]:
    """The picture, and a hard limit on the absolute error of its arithmetic, both (h, w, 3)."""
    film = case.scene.film
    found = examine(case, pixel_centers(film))
    return found.radiance.reshape(film.height, film.width, 3), found.bound.reshape(film.height, film.width, 3)


def evaluate(case: Case, film_xy: npt.ArrayLike) -> Array:
    """Radiance (n, 3) at film positions (n, 2) in pixels, (0.5, 0.5) being the centre of the top left pixel.

    Positions may lie off the film. Raises ValueError for a mesh.
    """
    return examine(case, film_xy).radiance


def examine(case: Case, film_xy: npt.ArrayLike) -> Examination:
    """Radiance at film positions (n, 2), with its bound and its scale. Raises ValueError for a mesh."""
    lacking = supports(case)
    if lacking:
        raise ValueError(f"{case.name}: no closed form for {', '.join(lacking)}")
    positions = np.asarray(film_xy, dtype=np.float64).reshape(-1, 2)
    objects = bodies(case.scene)
    # At least one slice, so that no positions give empty arrays of the right shape.
    starts = range(0, max(len(positions), 1), _SLICE)
    parts = [_examine_slice(case.scene, objects, positions[start : start + _SLICE]) for start in starts]
    return Examination(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))


def pixel_centers(film: Film) -> Array:
    """Film positions (h·w, 2) of the pixel centres, row by row from the top."""
    y, x = np.mgrid[0 : film.height, 0 : film.width]
    return np.stack([x.ravel() + 0.5, y.ravel() + 0.5], axis=1)


def _examine_slice(
    scene: Scene, objects: list[Body], positions: Array
) -> tuple[Array, Array, Array, Array, npt.NDArray[np.int64]]:
    seen = first_seen(objects, film_rays(scene.camera, scene.film, positions), math.hypot(*scene.camera.eye))
    hit = np.flatnonzero(seen.object_id >= 0)
    value, bound, scale = np.tile(np.asarray(scene.background), (len(positions), 1)), *np.zeros((2, len(positions), 3))
    facing = np.ones(len(positions))
    if len(hit):
        for whole, part in zip((value, bound, scale), _shade_all(scene, seen, hit), strict=True):
            whole[hit] = part.T
        facing[hit] = dot(seen.normal[:, hit], seen.to_viewer[:, hit]).hi
    return value, bound, scale, facing, seen.object_id


def _shade_all(scene: Scene, seen: Visible, hit: npt.NDArray[np.intp]) -> tuple[Array, Array, Array]:
    names = list(scene.materials)
    material_of = np.asarray([names.index(shape.material) for shape in scene.objects])
    here = surface(list(scene.materials.values()), material_of[seen.object_id[hit]], scene.ambient)
    normal, to_viewer, point = seen.normal[:, hit], seen.to_viewer[:, hit], seen.point[:, hit]
    shading = Shading.begin(here)
    for light in scene.delta_lights.values():
        shade(here, normal, to_viewer, arriving(light, scene.camera.eye)(point), shading)
    return *shading.finish(), shading.scale
