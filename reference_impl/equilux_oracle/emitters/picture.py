"""Pictures of model `reflection-equation`: camera rays → what they see → everything that each lit point receives.

    L = K_emit + L_env ∫_hemisphere + Σ_bodies (L_body − L_env) ∫_region + Σ_delta lights E_i τ_i f_r cosθ

where ∫ is that of f_r cosθ over directions (received.py), and a body's region what it covers (covers.py). The camera sees
emitters, discs and rectangles black behind, and the environment where it misses everything.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from equilux_oracle.camera import film_rays
from equilux_oracle.doubledouble import DD, Array, dot
from equilux_oracle.emitters.covers import Cover, Covered, cover_of, with_emitters
from equilux_oracle.emitters.delta import from_light
from equilux_oracle.emitters.frame import Frame
from equilux_oracle.emitters.lambert import UNIT_ROUNDOFF
from equilux_oracle.emitters.received import Reflecting, from_everywhere, from_region
from equilux_oracle.emitters.unblocked import lacking
from equilux_oracle.examination import SLICE, Examination, pixel_centers
from equilux_oracle.lights import arriving
from equilux_oracle.shadows import let_through
from equilux_oracle.visibility import Body, Visible, bodies, first_seen
from equilux_scenes.case import Case
from equilux_scenes.model import AreaEmitter, DirectionalLight, Object, Scene

Index = npt.NDArray[np.intp]


def radiance_with_bound(case: Case) -> tuple[Array, Array]:
    """The picture, W/(m²·sr), and a hard limit on its absolute error, both (h, w, 3), row 0 on top. Raises as `examine`."""
    film = case.scene.film
    found = examine(case, pixel_centers(film))
    return found.radiance.reshape(film.height, film.width, 3), found.bound.reshape(film.height, film.width, 3)


def evaluate(case: Case, film_xy: npt.ArrayLike) -> Array:
    """Radiance (n, 3) at film positions (n, 2) in pixels, (0.5, 0.5) being the centre of the top left pixel. Raises as
    `examine`."""
    return examine(case, film_xy).radiance


def examine(case: Case, film_xy: npt.ArrayLike) -> Examination:
    """Radiance at film positions (n, 2), with its bound and its scale. Raises ValueError where there is no closed form.

    scale: K_emit + Σ E_i (K_diff + K_spec) over delta lights + Σ L_j (π K_diff + 2π/(p+1) K_spec) over emitters and
    environment. object_id counts emitters that are surfaces after the objects.
    """
    missing = lacking(case)
    if missing:
        raise ValueError(f"{case.name}: no closed form for {', '.join(sorted(missing))} ({'; '.join(set(missing.values()))})")
    positions = np.asarray(film_xy, dtype=np.float64).reshape(-1, 2)
    picture = _Picture(case.scene)
    starts = range(0, max(len(positions), 1), SLICE)
    parts = [picture.examine(positions[start : start + SLICE]) for start in starts]
    return Examination(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))


class _Picture:
    """A scene, ready to be evaluated slice by slice."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        everything = with_emitters(scene)
        self.bodies: list[Body] = bodies(everything)
        self.emitters = list(scene.area_emitters.values())
        self.emitted: list[Array] = [np.zeros(3)] * len(scene.objects) + [np.asarray(e.radiance) for e in self.emitters]
        self.environment = np.asarray(scene.environment.radiance if scene.environment else (0.0, 0.0, 0.0))
        self.missed = np.asarray(scene.environment.radiance if scene.environment else scene.background)
        self.covers = [self._cover(index, shape) for index, shape in enumerate((*scene.objects, *self.emitters))]

    def _cover(self, index: int, body: Object | AreaEmitter) -> Cover | None:
        """None where what the body covers makes no difference."""
        if not np.any(self.emitted[index]) and not np.any(self.environment):
            return None
        return cover_of(body, self.scene.camera.eye)

    def examine(self, positions: Array) -> tuple[Array, Array, Array, Array, npt.NDArray[np.int64]]:
        count, objects = len(positions), len(self.scene.objects)
        rays = film_rays(self.scene.camera, self.scene.film, positions)
        coordinates = math.hypot(*self.scene.camera.eye) / np.linalg.norm(rays.direction.hi, axis=0)
        seen = first_seen(self.bodies, rays, coordinates)
        value, bound, scale = np.tile(self.missed, (count, 1)), *np.zeros((2, count, 3))
        facing = np.ones(count)
        hit = np.flatnonzero(seen.object_id >= 0)
        facing[hit] = dot(seen.normal[:, hit], seen.to_viewer[:, hit]).hi
        for index, emitter in enumerate(self.emitters):
            there = np.flatnonzero(seen.object_id == objects + index)
            # Outside is the side of the normal: that is where discs and rectangles shine, too.
            value[there] = scale[there] = np.where(seen.outside[there, np.newaxis], np.asarray(emitter.radiance), 0.0)
        for index in range(objects):
            there = np.flatnonzero(seen.object_id == index)
            if len(there):
                for whole, part in zip((value, bound, scale), self._shade(index, seen, there), strict=True):
                    whole[there] = part.T
        bound[seen.undecided] = np.inf
        return value, bound, scale, facing, seen.object_id

    def _shade(self, index: int, seen: Visible, there: Index) -> tuple[Array, Array, Array]:
        """Radiance, bound and scale, (3, k), of the points of one object."""
        material = self.scene.materials[self.scene.objects[index].material]
        here = Reflecting.of([material], np.zeros(len(there), dtype=np.intp))
        point, normal, to_viewer = seen.point[:, there], seen.normal[:, there], seen.to_viewer[:, there]
        total = _Sum(np.tile(np.reshape(material.emission, (3, 1)), (1, len(there))))
        if not np.any(here.diffuse) and not np.any(here.specular):
            return total.finish()
        most = np.pi * here.diffuse + 2 * np.pi / (here.exponent + 1) * here.specular
        frame = Frame.of(normal, to_viewer)
        if np.any(self.environment):
            environment = self.environment.reshape(3, 1)
            total.add(environment, *from_everywhere(frame, here), np.arange(len(there)))
            total.scale += environment * most
        for other, cover in enumerate(self.covers):
            if cover is not None and other != index:
                for piece in cover(point, frame):
                    self._add_piece(piece, other, frame, here, total)
                total.scale += self.emitted[other].reshape(3, 1) * most
        self._add_delta_lights(point, normal, to_viewer, here, total)
        return total.finish()

    def _add_piece(self, piece: Covered, body: int, frame: Frame, here: Reflecting, total: _Sum) -> None:
        excess = np.where(piece.front, self.emitted[body].reshape(3, 1), 0.0) - self.environment.reshape(3, 1)
        matters = np.any(excess != 0.0, axis=0)
        if not matters.any():
            return
        if piece.region is None:
            where = piece.where[matters]
            total.add(excess[:, matters], *from_everywhere(frame[where], here[where]), where)
            return
        value, error = from_region(piece.region, frame[piece.where], here[piece.where])
        total.add(excess[:, matters], value[:, matters], error[:, matters], piece.where[matters])

    def _add_delta_lights(self, point: DD, normal: DD, to_viewer: DD, here: Reflecting, total: _Sum) -> None:
        eye_distance = math.hypot(*self.scene.camera.eye)
        opaque = np.zeros((3, len(self.bodies)))
        for light in self.scene.delta_lights.values():
            arrives = arriving(light, self.scene.camera.eye)(point)
            value, error = from_light(arrives, normal, to_viewer, here)
            lit = np.flatnonzero(np.any(value > 0.0, axis=0))
            finite = not isinstance(light, DirectionalLight)
            through, *_ = let_through(self.bodies, opaque, point[:, lit], arrives.to_light[:, lit], eye_distance, finite=finite)
            total.add(through, value[:, lit], error[:, lit], lit)
            total.scale += np.where(np.isfinite(arrives.value), arrives.value, 0.0) * (here.diffuse + here.specular)


class _Sum:
    """Radiance (3, n) with a bound on its error: that of the terms, and u for each addition."""

    def __init__(self, emission: Array) -> None:
        self.value, self.bound, self.scale = emission.copy(), np.zeros_like(emission), emission.copy()

    def add(self, weight: Array, value: Array, error: Array, where: Index) -> None:
        """Add weight × value at some of the points."""
        term = weight * value
        self.value[:, where] += term
        self.bound[:, where] += np.abs(weight) * error + 2 * UNIT_ROUNDOFF * (np.abs(term) + np.abs(self.value[:, where]))

    def finish(self) -> tuple[Array, Array, Array]:
        """What blocks the environment may take all of it, but for rounding: never less than 0."""
        return np.maximum(self.value, 0.0), 1.1 * self.bound, self.scale
