"""What rays meet: the nearest crossing of all objects, ties to the first object in file order.

No acceleration structure: every object is crossed with every ray that passes through its bounding sphere.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from equilux_oracle.camera import Rays
from equilux_oracle.doubledouble import DD, Array, Bools, Index, dot, unit, where
from equilux_oracle.placement import Placement, placement
from equilux_oracle.shapes import Primitive, primitive_of
from equilux_oracle.shapes.crossing import Meeting, each_ray
from equilux_scenes.model import Scene
from equilux_scenes.transforms import matrix

TIE = 2.0**-50
"""Crossings nearer to each other than this share of the distance and of the eye's coordinates are one crossing. Surfaces that a
spec makes coincide do so only up to the rounding of the numbers that describe them, and which of them is seen must not depend on
that rounding (Q2 of the oracle adapter's QUIRKS.md). In the same way a crossing that near to the start of a ray that leaves a
surface is the start itself (Q8)."""


@dataclass(frozen=True)
class Visible:
    """For n rays: the object's index (−1: none), the point relative to the eye, N on the viewer's side, and V; both unit.

    outside: whether the viewer's side is that of the outward normal. t: the ray's parameter at the point; both (n,), and
    arbitrary where there is none. undecided: which object is met hangs on how exactly TIE is read, (n,).
    """

    object_id: np.ndarray[tuple[int], np.dtype[np.int64]]
    point: DD
    normal: DD
    to_viewer: DD
    outside: Bools
    t: Array
    undecided: Bools


@dataclass(frozen=True)
class Body:
    """An object ready to be crossed: its closed form, where it stands, and its world bounding sphere relative to the eye.

    curvature: the largest of its surface in the world, 1/m; stretch: the condition of its placement.
    """

    primitive: Primitive
    placement: Placement
    center: Array
    radius: float
    curvature: float
    stretch: float

    def meet(self, rays: Rays) -> Meeting:
        """Where the rays' lines cross it; parameters are the rays' own, normals in object space."""
        return self.primitive.meet(*self.placement.to_object(rays, DD(self.primitive.anchor.reshape(3, 1))))

    def passes(self, rays: Rays, start: Array | float, end: Array | float) -> Bools:
        """Whether the ray between two parameters may meet the bounding sphere, with a generous margin for plain double."""
        if np.isinf(self.radius):
            return np.ones(rays.count, dtype=bool)
        offset, direction = rays.offset.hi, rays.direction.hi
        to_center = self.center[:, np.newaxis] - offset
        length = np.sqrt(np.sum(direction**2, axis=0))
        distance2 = np.sum(np.cross(to_center, direction, axis=0) ** 2, axis=0) / length**2
        reach = self.radius * (1 + 1e-6) + 1e-6 * np.sqrt(np.sum(to_center**2, axis=0))
        along = np.sum(to_center * direction, axis=0) / length
        passes = (distance2 <= reach**2) & (along + reach >= start * length) & (along - reach <= end * length)
        return np.broadcast_to(passes, (rays.count,))


def bodies(scene: Scene) -> list[Body]:
    """All objects of a scene, in file order."""
    result = []
    for shape in scene.objects:
        to_world = matrix(shape)
        primitive, place = primitive_of(shape), placement(to_world, scene.camera.eye)
        around = place.sphere_to_world(primitive.anchor, primitive.bounding_radius, np.asarray(scene.camera.eye))
        stretches = np.linalg.svd(to_world[:3, :3], compute_uv=False)
        # The gradient A⁻ᵀ ∇g of x ↦ g(A⁻¹ x) turns at most by |A⁻¹|² |A| times the curvature in object space.
        curvature = primitive.curvature * float(stretches[0] / stretches[2] ** 2)
        result.append(Body(primitive, place, *around, curvature, float(stretches[0] / stretches[2])))
    return result


NOTHING_LEFT = -1
"""The object that a camera's ray leaves."""


def first_seen(
    objects: list[Body],
    rays: Rays,
    coordinates: Array | float,
    start: Array | float = 0.0,
    left: npt.NDArray[np.int64] | None = None,
) -> Visible:
    """The visible point of each ray beyond the parameter `start`; the rays begin on the objects `left`, if anywhere.

    coordinates: how large the numbers are of which the ray's line is made, in units of its parameter; it says how finely the
    scene is rounded.
    """
    object_id = np.full(rays.count, -1)
    t, normal = DD(np.full(rays.count, np.inf)), DD(np.zeros((3, rays.count)))
    coordinates, start = (np.broadcast_to(value, (rays.count,)) for value in (coordinates, start))
    left = np.full(rays.count, NOTHING_LEFT) if left is None else left
    undecided, at_start = np.zeros((2, rays.count), dtype=bool)
    # A ray that misses leaves Inf and NaN behind in quantities that only hits use.
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        for index, body in enumerate(objects):
            near = np.flatnonzero(body.passes(rays, start, t.hi))
            if len(near) == 0:
                continue
            meeting = body.meet(rays[near])
            crossing = meeting.first(start[near])
            at_start[near] |= meeting.close_to(start[near], left[near] == index)
            apart, tie = (t[near] - crossing.t).hi, TIE * (coordinates[near] + t.hi[near])
            nearer = crossing.hit & ((object_id[near] < 0) | (apart > tie))
            close = crossing.hit & (np.abs(apart) > 0.5 * tie) & (np.abs(apart) < 4.0 * tie)
            chosen = near[nearer]
            undecided[near] = close | (undecided[near] & ~nearer)
            object_id[chosen] = index
            _assign(t, chosen, crossing.t[nearer])
            _assign(normal, np.s_[:, chosen], each_ray(body.placement.normal_to_world(crossing.normal[:, nearer]), len(chosen)))
    return _seen(object_id, rays, t, normal, undecided | at_start)


def _assign(target: DD, index: Index, value: DD) -> None:
    target.hi[index], target.lo[index] = value.hi, value.lo


def _seen(object_id: np.ndarray[tuple[int], np.dtype[np.int64]], rays: Rays, t: DD, normal: DD, undecided: Bools) -> Visible:
    """Points, normals turned to the viewer, and V; arbitrary finite values where nothing was hit."""
    hit = object_id >= 0
    depth = where(hit, t, DD(1.0))
    normal = where(hit, normal, DD(np.ones((3, 1))))
    from_behind = dot(normal, rays.direction).hi > 0.0
    point, to_viewer = rays.offset + rays.direction * depth, each_ray(unit(-rays.direction), rays.count)
    return Visible(object_id, point, unit(where(from_behind, -normal, normal)), to_viewer, ~from_behind, depth.hi, undecided)
