"""Objects that share a surface: which of them must be drawn a hair nearer or farther, so that the first in the file is seen."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Hashable, Iterator

import numpy as np
import numpy.typing as npt

from equilux.adapter import Case
from equilux_adapters._triangles.extent import box_around
from equilux_scenes.model import Box, Cylinder, Disc, Mesh, Object, Plane, Rectangle, Sphere
from equilux_scenes.transforms import matrix

Floats = npt.NDArray[np.float64]

_GRID = 1e-8
"""Planes that agree to this many parts of the scene's size are one."""


def set_backs(case: Case) -> list[int]:
    """Per object, how many steps to draw it farther away (negative: nearer). 0 for an object that shares no surface.

    Of objects in one surface each later one is a step farther than those before it; an infinite plane stays where it is.
    """
    objects = case.scene.objects
    members: dict[Hashable, list[int]] = defaultdict(list)
    for index, obj in enumerate(objects):
        for key in set(_surfaces(case, index, obj)):
            members[key].append(index)
    shared = [indices for indices in members.values() if len(indices) > 1]
    ranks = [0] * len(objects)
    boxes = [box_around(case, index) for index in range(len(objects))]
    for index in range(len(objects)):
        before = {other for indices in shared if index in indices for other in indices if other < index}
        ranks[index] = max((ranks[other] for other in before if _overlap(boxes[index], boxes[other])), default=-1) + 1
    return _with_planes_fixed(ranks, shared, [isinstance(obj, Plane) for obj in objects])


def _overlap(a: tuple[Floats, Floats], b: tuple[Floats, Floats]) -> bool:
    """Whether two boxes have more than an edge in common; that of a plane is infinite, and everything is in it."""
    if not all(np.isfinite(bound).all() for bound in (*a, *b)):
        return True
    common = np.minimum(a[1], b[1]) - np.maximum(a[0], b[0])
    least = 1e-9 * np.max(np.maximum(a[1], b[1]) - np.minimum(a[0], b[0]))
    return bool((common >= -least).all() and (common > least).sum() >= 2)


def _with_planes_fixed(ranks: list[int], shared: list[list[int]], is_plane: list[bool]) -> list[int]:
    """Subtract from the ranks of all that hang together the rank of a plane among them, if there is one."""
    group = list(range(len(ranks)))
    for indices in shared:
        merged = {group[index] for index in indices}
        group = [min(merged) if g in merged else g for g in group]
    result = list(ranks)
    for g in set(group):
        together = [index for index in range(len(ranks)) if group[index] == g]
        fixed = next((ranks[index] for index in together if is_plane[index]), 0)
        for index in together:
            result[index] = ranks[index] - fixed
    return result


def _surfaces(case: Case, index: int, obj: Object) -> Iterator[Hashable]:
    """A key for each surface of an object: equal keys are one surface."""
    placed, eye = matrix(obj), np.asarray(case.scene.camera.eye)
    size = float(np.linalg.norm(np.asarray(case.scene.camera.target) - eye))
    if isinstance(obj, Sphere):
        yield ("sphere", *_rounded(np.array([*obj.center, obj.radius, *placed.ravel()]), size).tolist())
    if isinstance(obj, Cylinder):
        axis = np.subtract(obj.top, obj.base) / np.linalg.norm(np.subtract(obj.top, obj.base))
        foot = np.asarray(obj.base) - axis * (axis @ np.asarray(obj.base))
        axis = axis * _one_way(axis[None])[0]
        yield ("cylinder", *_rounded(np.array([*axis, *foot, obj.radius, *placed.ravel()]), size).tolist())
    points, normals = flats(case, index, obj)
    points = points @ placed[:3, :3].T + (placed[:3, 3] - eye)
    normals = normals @ np.linalg.inv(placed[:3, :3])
    normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    offsets = np.einsum("ij,ij->i", points, normals) / size
    planes = np.concatenate([normals, offsets[:, None]], axis=1) * _one_way(normals)
    for row in np.unique(_rounded(planes, 1.0), axis=0):
        yield ("flat", *row.tolist())


def flats(case: Case, index: int, obj: Object) -> tuple[Floats, Floats]:
    """A point and the normal of each flat face, in object space."""
    if isinstance(obj, Plane):
        return np.array([obj.point]), np.array([obj.normal])
    if isinstance(obj, Disc):
        return np.array([obj.center]), np.array([obj.normal])
    if isinstance(obj, Rectangle):
        return np.array([obj.corner]), np.cross(obj.edge_u, obj.edge_v)[None]
    if isinstance(obj, Box):
        return np.repeat([obj.min, obj.max], 3, axis=0), np.tile(np.eye(3), (2, 1))
    if isinstance(obj, Cylinder) and obj.capped:
        return np.array([obj.base, obj.top]), np.tile(np.subtract(obj.top, obj.base), (2, 1))
    if isinstance(obj, Mesh):
        corners = case.meshes[index].vertices[case.meshes[index].faces]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        proper = np.linalg.norm(across, axis=1) > 0
        return corners[proper, 0], across[proper]
    return np.zeros((0, 3)), np.zeros((0, 3))


def _one_way(vectors: Floats) -> Floats:
    """(n, 1): ±1, the sign of each vector's first component that is not almost zero."""
    first = np.argmax(np.abs(vectors) > 1e-6, axis=1)[:, None]
    return np.where(np.take_along_axis(vectors, first, axis=1) < 0, -1.0, 1.0)


def _rounded(values: Floats, size: float) -> npt.NDArray[np.int64]:
    # an offset that no scene's round numbers hit keeps equal surfaces from falling on either side of a rounding boundary
    steps: npt.NDArray[np.int64] = np.rint(np.asarray(values, dtype=np.float64) / size / _GRID + 0.2718281828).astype(np.int64)
    return steps
