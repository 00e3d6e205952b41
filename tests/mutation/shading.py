"""A light at a surface: what arrives, the cosine, the lobe; with the faults that concern them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from equilux_scenes.case import Case
from equilux_scenes.transforms import matrix
from mutation.faults import Faults

Array = npt.NDArray[np.float64]


@dataclass
class Surface:
    """n shaded points: material of each, N and V unit. first_hit: seen by the camera itself."""

    material: list[Any]
    point: Array
    normal: Array
    to_viewer: Array
    first_hit: bool

    def bands(self, term: str) -> Array:
        """A coefficient of three bands, (n, 3)."""
        return np.array([getattr(m, term) for m in self.material], dtype=float)

    def number(self, term: str) -> Array:
        """(n, 1)."""
        return np.array([[getattr(m, term)] for m in self.material], dtype=float)


@dataclass
class Arrived:
    """One light at n points: irradiance before the cosine (n, 3), N·L (n, 1), the cosine that the diffuse term counts and the
    lobe of the highlight, both 0 for light from behind, unless a fault says otherwise.
    """

    irradiance: Array
    to_light: Array
    cosine: Array
    diffuse: Array
    lobe: Array


def local_light(case: Case, light: Any, surface: Surface, faults: Faults) -> Arrived:
    irradiance, to_light = arriving(light, surface.point)
    normal = surface.normal
    cosine = dot(normal, to_light)
    if faults.two_sided == "normal":
        normal, cosine = np.where(cosine < 0, -normal, normal), np.abs(cosine)
    diffuse = np.abs(cosine) if faults.two_sided else np.maximum(cosine, 0)
    by_half_vector = (case.scene.model == "opengl") != faults.other_lobe
    viewer = view_vector(case, surface, faults)
    along = dot(normal, unit(to_light + viewer)) if by_half_vector else dot(2 * cosine * normal - to_light, viewer)
    lobe = power(np.maximum(along, faults.floor) if faults.floor else along, surface.number("exponent"))
    if case.scene.model == "opengl" and not faults.floor:
        lobe = np.where((along <= 0) & (surface.number("exponent") == 0), 1.0, lobe)  # max(0, N·H)^0 is 1 there
    if faults.gated:
        lobe = np.where(cosine > 0, lobe, 0)
    if faults.lobe_cosine:
        lobe = lobe * np.maximum(cosine, 0)
    return Arrived(irradiance, to_light, cosine, diffuse, lobe)


def arriving(light: Any, point: Array) -> tuple[Array, Array]:
    """Irradiance before the cosine, (n, 3), and the unit vector to the light, (n, 3)."""
    if light.kind == "directional":
        return np.array(light.irradiance) + np.zeros_like(point), unit(-np.array(light.direction)) + np.zeros_like(point)
    toward = np.array(light.position) - point
    r = np.linalg.norm(toward, axis=1, keepdims=True)
    fall = light.attenuation
    irradiance = np.array(light.intensity) / (fall.constant + fall.linear * r + fall.quadratic * r**2)
    if light.kind == "spot":
        off_axis = -dot(toward / r, unit(np.array(light.direction)))
        lit = off_axis >= np.cos(np.radians(light.cone_half_angle_deg))
        irradiance = np.where(lit, irradiance * np.maximum(off_axis, 0) ** light.exponent, 0)
    return irradiance, toward / r


def view_vector(case: Case, surface: Surface, faults: Faults) -> Array:
    """V of the highlight."""
    camera = case.scene.camera
    eye = np.array(camera.eye, dtype=float)
    own = {"local": "eye", "infinite": "axis"}[case.scene.viewer]
    rule = own if case.scene.model == "opengl" else "model"
    if faults.viewer != "model" and (surface.first_hit or "first" not in faults.viewer):
        rule = faults.viewer.split()[0]
    if rule == "eye":
        return unit(eye - surface.point)
    if rule == "axis":
        return unit(eye - np.array(camera.target)) + np.zeros_like(surface.point)
    return surface.to_viewer


def turned_normal(case: Case, geometric: Array, shading: Array, to_viewer: Array, faults: Faults) -> Array:
    """N: unit, on the viewer's side, unless a fault says otherwise."""
    stored = unit(shading)
    if faults.side == "as stored":
        normal = stored
    elif faults.side == "by N·V":
        normal = np.where(dot(stored, to_viewer) < 0, -stored, stored)
    elif case.scene.model == "opengl":
        normal = np.where(dot(geometric, to_viewer) < 0, -stored, stored)
    else:
        facing = np.where(dot(geometric, to_viewer) < 0, -geometric, geometric)
        normal = np.where(dot(stored, facing) < 0, -stored, stored)
    return -normal if faults.reversed_normals else normal


def stored_normal(case: Case, index: int, vertex: npt.NDArray[np.int64], geometric: Array) -> tuple[Array, Array]:
    """World position and normal (as stored) of a mesh's vertices; of a flat mesh the face's."""
    mesh, to_world = case.meshes[index], matrix(case.scene.objects[index])
    point = mesh.vertices[vertex] @ to_world[:3, :3].T + to_world[:3, 3]
    if mesh.vertex_normals is None:
        return point, geometric
    return point, mesh.vertex_normals[vertex] @ np.linalg.inv(to_world)[:3, :3]


def power(cosine: Array, exponent: Array) -> Array:
    return np.where(cosine > 0, np.maximum(cosine, 1e-300) ** exponent, 0.0)


def dot(a: Array, b: Array) -> Array:
    return np.sum(a * b, axis=-1, keepdims=True)


def unit(a: Array) -> Array:
    return a / np.linalg.norm(a, axis=-1, keepdims=True)
