"""A correct renderer, slow and plain, that can be given faults: models phong, opengl and raytraced, in NumPy, double precision.

It shares no code with the tracer, the oracle or the rules of the causes.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from equilux_scenes.case import Case
from mutation import transport
from mutation.crossings import Hits, nearest
from mutation.faults import NONE, Faults
from mutation.shading import Surface, local_light, stored_normal, turned_normal, unit
from support.plain_phong import rays

Array = npt.NDArray[np.float64]


def picture(case: Case, faults: Faults = NONE) -> Array:
    """(h, w, 3) radiance as this renderer writes it; of another size where a fault turns the film."""
    for edit in faults.case:
        case = edit(case)
    film = case.scene.film
    rows, columns = np.mgrid[0 : film.height, 0 : film.width]
    film_xy = np.stack([columns.ravel() + 0.5, rows.ravel() + 0.5], axis=1)
    for move in faults.film:
        film_xy = move(film_xy, film.width, film.height)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        image = radiance(case, film_xy, faults).reshape(film.height, film.width, 3)
    for edit in faults.picture:
        image = edit(image)
    return image


def radiance(case: Case, film_xy: Array, faults: Faults) -> Array:
    """At film positions (n, 2), pixels → (n, 3)."""
    if faults.field_of_view == "horizontal":
        # the same angle (or height) across instead of upwards: the film's other side is what it is stretched to
        film = case.scene.film
        middle = np.array([film.width, film.height]) / 2
        film_xy = middle + (film_xy - middle) * film.height / film.width
    origin, direction = rays(case, film_xy)
    direction = unit(direction)
    if case.scene.model == "raytraced":
        return transport.traced(case, origin, direction, faults)
    return _local(case, origin, direction, faults)


def _local(case: Case, origin: Array, direction: Array, faults: Faults) -> Array:
    scene = case.scene
    hits = nearest(case, origin, direction, 0.0)
    result = np.tile(np.array(scene.background), (len(origin), 1))
    if faults.background == "black for the eye":
        result[:] = 0
    at = np.flatnonzero(hits.object_id >= 0)
    if len(at) == 0:
        return result
    surface = _surface(case, hits, at, origin, direction, faults)
    result[at] = _lit(case, surface, faults)
    if faults.at_vertices:
        meshed = np.flatnonzero(hits.triangle >= 0)
        if len(meshed):
            result[meshed] = _lit_at_vertices(case, hits, meshed, origin, direction, faults)
    return result


def _lit(case: Case, surface: Surface, faults: Faults) -> Array:
    scene = case.scene
    value = surface.bands("emission") + surface.bands("ambient") * np.array(scene.ambient)
    k_diff, k_spec = surface.bands("diffuse"), surface.bands("specular")
    for light in scene.lights.values():
        arrived = local_light(case, light, surface, faults)
        if scene.model == "opengl":
            ambient = surface.bands("ambient") * np.array(light.ambient)
            value += arrived.irradiance * ambient if faults.ambient_of_lights else 0
            k_d, k_s = k_diff * np.array(light.diffuse), k_spec * np.array(light.specular)
        else:
            k_d, k_s = k_diff, k_spec
        value += arrived.irradiance * (k_d * arrived.diffuse + k_s * arrived.lobe)
    return value


def _surface(case: Case, hits: Hits, at: npt.NDArray[np.intp], origin: Array, direction: Array, faults: Faults) -> Surface:
    point = origin[at] + hits.t[at, None] * direction[at]
    normal = turned_normal(case, hits.geometric[at], hits.shading[at], -direction[at], faults)
    return Surface(_materials(case, hits.object_id[at]), point, normal, -direction[at], first_hit=True)


def _materials(case: Case, object_id: npt.NDArray[np.int64]) -> list[Any]:
    return [case.scene.materials[case.scene.objects[k].material] for k in object_id]


def _lit_at_vertices(case: Case, hits: Hits, at: npt.NDArray[np.intp], origin: Array, direction: Array, faults: Faults) -> Array:
    """The radiance that leaves the triangle's three corners, interpolated."""
    result = np.zeros((len(at), 3))
    for corner in range(3):
        point, normal = np.zeros((len(at), 3)), np.zeros((len(at), 3))
        for index in np.unique(hits.object_id[at]):
            here = np.flatnonzero(hits.object_id[at] == index)
            vertex = case.meshes[index].faces[hits.triangle[at][here], corner]
            point[here], normal[here] = stored_normal(case, index, vertex, hits.geometric[at][here])
        to_viewer = -direction[at]
        if case.scene.camera.projection == "perspective":
            to_viewer = unit(np.array(case.scene.camera.eye) - point)
        facet = np.sum(hits.geometric[at] * -direction[at], axis=1, keepdims=True)
        geometric = np.where(facet < 0, -hits.geometric[at], hits.geometric[at])
        turned = np.where(np.sum(normal * geometric, axis=1, keepdims=True) < 0, -normal, normal)
        surface = Surface(_materials(case, hits.object_id[at]), point, unit(turned), to_viewer, first_hit=True)
        result += hits.weights[at, corner, None] * _lit(case, surface, faults)
    return result
