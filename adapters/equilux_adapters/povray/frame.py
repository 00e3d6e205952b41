"""The coordinates a scene is written in: the world's, unless POV-Ray's absolute tolerances or float32 boxes call for others."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from equilux.adapter import Unsupported
from equilux_adapters._bounds import distances
from equilux_scenes.case import Case
from equilux_scenes.model import Box, Camera, Object, PerspectiveCamera, Plane, Rectangle, Sphere
from equilux_scenes.transforms import matrix, unit

Vector = npt.NDArray[np.float64]

NEAREST_HIT = 1e-3  # units; ten times MIN_ISECT_DEPTH (Q14)
FARTHEST_HIT = 1e6  # units; a tenth of MAX_DISTANCE (Q14)
SQUARED_CHORD = 1e-10  # units²; a sphere hit with a shorter half-chord is a miss (Q15)
BOX_CORNER = 1e-6  # units of depth; nearer to an edge of a box the face may be taken wrongly (Q15)
PLANE_DEPTH = 1e7  # units; a plane farther along the ray is a miss (Q14)
BOX_ROUNDING = 3 * 2.0**-24  # radians; see _object_error (Q16)
LEAST_PX = 1e-6  # double rounding of rays and crossings
REMOTE = 16.0  # an eye farther from the origin than this many extents of the scene becomes the origin
SHADOW_BIAS = 1e-3  # units; blockers nearer to the point or to the light are missed (SHADOW_TOLERANCE, Q37)
OBLIQUE = 10.0  # 1/sin of the angle between surfaces down to which the strip without shadow is that narrow: 6°
# A shadow ray that clips an edge of glass crosses it once instead of twice in such a strip: neither lit nor shaded, and no edge.
SLIVER = 0.06  # what such a strip counts against a displaced edge, per pixel of the film's sides: its edges are about as long
SCALES = [1.0] + [10.0**n for n in range(-24, 25) if n]  # units per metre, the plainest first
TOLERABLE_PX = 0.01  # beyond this the unit is chosen for accuracy instead of readability


@dataclass(frozen=True)
class View:
    """The camera's frame: unit vectors, right = forward × up; full extents of the film at unit distance (else metres)."""

    eye: Vector
    forward: Vector
    right: Vector
    up: Vector
    width: float
    height: float
    perspective: bool
    pixel: float  # radians at the middle of the film, or metres

    def film_px(self, error: float) -> float:
        """How far, in pixels, an error of a ray's direction (radians; orthographic: place, metres) moves a point on the film."""
        # an angle counts most in the corners
        spread = 1.0 + (self.width**2 + self.height**2) / 4.0 if self.perspective else 1.0
        return error * spread / self.pixel


@dataclass(frozen=True)
class Frame:
    """written = (world − origin) · scale. film_px: how far POV-Ray's tolerances may displace a discontinuity, in pixels."""

    origin: Vector
    scale: float
    film_px: float

    def point(self, world: npt.ArrayLike) -> Vector:
        return (np.asarray(world, dtype=np.float64) - self.origin) * self.scale

    def matrix(self, to_world: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Object → world for lengths in units on both sides: only the translation differs from the scene's own matrix."""
        result = to_world.copy()
        result[:3, 3] = self.point(to_world[:3, 3])
        return result

    @property
    def is_world(self) -> bool:
        return self.scale == 1.0 and not self.origin.any()


def view(case: Case) -> View:
    camera, film = case.scene.camera, case.scene.film
    eye: Vector = np.array(camera.eye, dtype=np.float64)
    forward: Vector = np.array(unit(tuple(np.array(camera.target) - eye)))
    right: Vector = np.array(unit(tuple(np.cross(forward, unit(camera.up)))))
    height = _film_height(camera)
    width = height * film.width / film.height
    up = np.cross(right, forward)
    return View(eye, forward, right, up, width, height, isinstance(camera, PerspectiveCamera), height / film.height)


def _film_height(camera: Camera) -> float:
    if isinstance(camera, PerspectiveCamera):
        return 2.0 * math.tan(math.radians(camera.fov_y_deg) / 2.0)
    return camera.height_m


@dataclass(frozen=True)
class _Seen:
    """An object as the eye sees it: a lower bound of its distance (orthographic: 1); points that enclose it if it is finite.

    height: of a plane, the largest distance from it of any part of the scene that it may be seen from.
    """

    obj: Object
    distance: float
    hull: Vector | None
    height: float


def choose(case: Case) -> Frame:
    """The world's own frame where it is good enough, else one shifted to the eye and scaled by a power of ten.

    Raises Unsupported when the scene spans more lengths than POV-Ray's absolute tolerances leave room for.
    """
    camera = view(case)
    objects = [_seen(case, camera, index) for index in range(len(case.scene.objects))]
    near, far = _hit_range(camera, objects)
    fitting = [s for s in SCALES if near * s >= NEAREST_HIT and far * s <= FARTHEST_HIT]
    if not fitting:
        shapes = sorted({f"shape.{obj.kind}" for obj in case.scene.objects})
        span = f"from {near:g} m to {far:g} m in front of the eye"
        raise Unsupported(shapes, f"surfaces {span}: POV-Ray sees {NEAREST_HIT:g} to {FARTHEST_HIT:g} of its units")
    origin = _origin(camera, far)
    secondary = bool({"occlusion", "reflection", "transparency"} & set(case.requires))
    rims = {s: max([LEAST_PX] + [_silhouette_error(camera, origin, s, seen, secondary) for seen in objects]) for s in fitting}
    strips = {s: max([0.0] + [_strip(camera, s, seen) for seen in objects]) if secondary else 0.0 for s in fitting}
    film = case.scene.film
    weight = 1.0 + (SLIVER * (film.width + film.height) if "shadow.attenuated" in case.requires else 0.0)
    errors = {s: rims[s] + weight * strips[s] for s in fitting}
    if errors.get(1.0, math.inf) <= TOLERABLE_PX:
        return Frame(origin, 1.0, rims[1.0] + strips[1.0])
    # the smallest error; among equals, the middle of the range of lengths that POV-Ray is at ease with
    middle = math.sqrt(NEAREST_HIT * FARTHEST_HIT / near / far)
    best = min(fitting, key=lambda s: (errors[s], abs(math.log(s / middle))))
    return Frame(origin, best, rims[best] + strips[best])


def _seen(case: Case, camera: View, index: int) -> _Seen:
    distance = distances.nearest(case, index, camera.eye) if camera.perspective else 1.0
    obj = case.scene.objects[index]
    height = _height(case, index, camera.eye) if isinstance(obj, Plane) else 0.0
    return _Seen(obj, distance, distances.extremes(case, index), height)


def _height(case: Case, plane: int, eye: Vector) -> float:
    hulls = [distances.extremes(case, index) for index in range(len(case.scene.objects))]
    points = np.concatenate([eye[None], *(hull for hull in hulls if hull is not None)])
    return max(distances.nearest(case, plane, point) for point in points)


def _hit_range(camera: View, objects: Sequence[_Seen]) -> tuple[float, float]:
    """Bounds of the depths at which finite objects can be hit. A surface that the eye lies on counts not."""
    near, far = math.inf, 0.0
    for seen in objects:
        if camera.perspective and seen.distance > 0:
            near = min(near, seen.distance)
        if seen.hull is None:
            continue
        offsets = seen.hull - camera.eye
        depths = np.linalg.norm(offsets, axis=1) if camera.perspective else offsets @ camera.forward
        far = max(far, float(depths.max()))
        if not camera.perspective and depths.min() > 0:
            near = min(near, float(depths.min()))
    return (near, max(near, far)) if math.isfinite(near) else (1.0, max(1.0, far))


def _origin(camera: View, far: float) -> Vector:
    """Zero, unless the scene lies so far from it that float32 bounding boxes would be coarse: then the eye (Q16)."""
    extent = far if camera.perspective else max(far, camera.height, camera.width)
    return camera.eye.copy() if float(np.abs(camera.eye).max()) > REMOTE * extent else np.zeros(3)


def _distance(camera: View, scale: float, seen: _Seen) -> float:
    """What turns a length at an object into an angle at the eye; 1 where there are no angles."""
    return max(seen.distance, NEAREST_HIT / scale) if camera.perspective else 1.0


def _strip(camera: View, scale: float, seen: _Seen) -> float:
    """How wide, in pixels, the strips are where a blocker or a mirrored surface is too near to be found (Q37)."""
    return camera.film_px(OBLIQUE * SHADOW_BIAS / scale / _distance(camera, scale, seen))


def _silhouette_error(camera: View, origin: Vector, scale: float, seen: _Seen, secondary: bool) -> float:
    """A bound, in pixels, on how far POV-Ray's tolerances displace the silhouettes and edges of one object."""
    obj, distance = seen.obj, _distance(camera, scale, seen)
    if isinstance(obj, Rectangle):
        return 0.0
    if isinstance(obj, Sphere):
        # the rim moves inwards by δ where δ (2 r − δ) = SQUARED_CHORD, in the sphere's own space
        stretch = float(np.linalg.svd(matrix(obj)[:3, :3], compute_uv=False)[0])
        return camera.film_px(SQUARED_CHORD / (2.0 * obj.radius * scale**2) * stretch / distance)
    if isinstance(obj, Box):
        return camera.film_px(BOX_CORNER / scale / distance)
    if isinstance(obj, Plane):
        # beyond PLANE_DEPTH the plane ends, before the horizon; the angle left is at most height / depth. Of parallel rays only
        # mirrored ones see a horizon, and that angle moves what they see by as many metres as it lies off
        angle = (seen.height if secondary else distance) * scale / PLANE_DEPTH
        return camera.film_px(angle) if camera.perspective or secondary else 0.0
    # every other shape is clipped by a float32 bounding box: of two slabs each distance (b − o)/d takes three roundings, 6 in
    # all, and b and o themselves are rounded; distances differing by a share ε tilt the ray by ½ sin 2θ ε ≤ ε/2
    assert seen.hull is not None
    remote = float(max(np.abs(seen.hull - origin).max(), np.abs(camera.eye - origin).max()))
    return camera.film_px(BOX_ROUNDING * (1.0 + remote / distance))
