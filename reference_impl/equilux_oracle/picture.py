"""The oracle's pictures: camera rays → visible points → local formula, a slice of the film at a time."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt
from equilux_scenes.case import Case
from equilux_scenes.model import Film, Mesh, Scene

from equilux_oracle.camera import film_rays
from equilux_oracle.doubledouble import Array
from equilux_oracle.lights import arriving
from equilux_oracle.local_formula import Shading, shade, surface
from equilux_oracle.visibility import Visible, bodies, first_seen

_SLICE = 8192  # rays at once: the temporaries of one double-double product then stay in a core's cache


def supports(case: Case) -> list[str]:
    """The features of a case that have no closed form, sorted; empty where the oracle can be evaluated."""
    meshes = [shape for shape in case.scene.objects if isinstance(shape, Mesh)]
    return sorted({"shape.mesh", *(f"normals.{shape.normals}" for shape in meshes)}) if meshes else []


def radiance(case: Case) -> Array:
    """The picture of a case: radiance at the pixel centres, W/(m²·sr), (h, w, 3), row 0 on top. Raises ValueError for a mesh."""
    return radiance_with_bound(case)[0]


def radiance_with_bound(case: Case) -> tuple[Array, Array]:
    """The picture, and a hard limit on the absolute error of its arithmetic, both (h, w, 3)."""
    film = case.scene.film
    values, bounds = evaluate_with_bound(case, pixel_centers(film))
    return values.reshape(film.height, film.width, 3), bounds.reshape(film.height, film.width, 3)


def evaluate(case: Case, film_xy: npt.ArrayLike) -> Array:
    """Radiance (n, 3) at film positions (n, 2) in pixels, (0.5, 0.5) being the centre of the top left pixel. Raises ValueError
    for a mesh."""
    return evaluate_with_bound(case, film_xy)[0]


def evaluate_with_bound(case: Case, film_xy: npt.ArrayLike) -> tuple[Array, Array]:
    """Radiance and the bound on its arithmetic error, both (n, 3), at film positions (n, 2) in pixels."""
    lacking = supports(case)
    if lacking:
        raise ValueError(f"{case.name}: no closed form for {', '.join(lacking)}")
    positions = np.asarray(film_xy, dtype=np.float64).reshape(-1, 2)
    parts = list(_slices(case.scene, positions))
    if not parts:
        return np.zeros((0, 3)), np.zeros((0, 3))
    return np.concatenate([value for value, _ in parts]), np.concatenate([bound for _, bound in parts])


def pixel_centers(film: Film) -> Array:
    """Film positions (h·w, 2) of the pixel centres, row by row from the top."""
    y, x = np.mgrid[0 : film.height, 0 : film.width]
    return np.stack([x.ravel() + 0.5, y.ravel() + 0.5], axis=1)


def _slices(scene: Scene, positions: Array) -> Iterator[tuple[Array, Array]]:
    objects = bodies(scene)
    for start in range(0, len(positions), _SLICE):
        seen = first_seen(objects, film_rays(scene.camera, scene.film, positions[start : start + _SLICE]))
        hit = np.flatnonzero(seen.object_id >= 0)
        value, bound = np.empty((len(seen.object_id), 3)), np.zeros((len(seen.object_id), 3))
        value[:] = scene.background
        if len(hit):
            shaded, error = _shade_all(scene, seen, hit)
            value[hit], bound[hit] = shaded.T, error.T
        yield value, bound


def _shade_all(scene: Scene, seen: Visible, hit: npt.NDArray[np.intp]) -> tuple[Array, Array]:
    names = list(scene.materials)
    material_of = np.asarray([names.index(shape.material) for shape in scene.objects])
    here = surface(list(scene.materials.values()), material_of[seen.object_id[hit]], scene.ambient)
    normal, to_viewer, point = seen.normal[:, hit], seen.to_viewer[:, hit], seen.point[:, hit]
    shading = Shading.begin(here)
    for light in scene.lights.values():
        shade(here, normal, to_viewer, arriving(light, scene.camera.eye)(point), shading)
    return shading.finish()
