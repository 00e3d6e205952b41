"""The picture: Mitsuba's integrator, asked at the pixels' centres, in independent repeats."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np
import numpy.typing as npt

Triple = tuple[float, float, float]
Array = npt.NDArray[np.float64]

LANES = 1 << 20
"""Light paths computed at once."""

OFFSET_REPEATS = 4
"""Repeats in which the offset of shadow rays is varied."""


@dataclass
class View:
    """The camera. half_height: of the film, at distance 1 from the eye, or itself, for parallel rays. near: what a ray meets
    before is taken to be where it starts, and is not seen."""

    eye: Triple
    target: Triple
    up: Triple
    half_height: float
    width: int
    height: int
    near: float
    parallel: bool = False

    def rays(self) -> tuple[Array, Array]:
        """Origins and unit directions through the pixels' centres, (height × width, 3), row 0 on top."""
        forward = np.subtract(self.target, self.eye, dtype=np.float64)
        forward /= np.linalg.norm(forward)
        right = np.cross(forward, np.asarray(self.up) / np.max(np.abs(self.up)))
        right /= np.linalg.norm(right)
        up = np.cross(right, forward)
        x = (2 * (np.arange(self.width) + 0.5) / self.width - 1) * (self.width / self.height) * self.half_height
        y = (1 - 2 * (np.arange(self.height) + 0.5) / self.height) * self.half_height
        across = (x[None, :, None] * right + y[:, None, None] * up).reshape(-1, 3)
        if self.parallel:
            return self.eye + across, np.broadcast_to(forward, across.shape)
        directions = forward + across
        return np.broadcast_to(self.eye, across.shape), directions / np.linalg.norm(directions, axis=1, keepdims=True)


def render(
    scene: Any,
    view: View,
    samples: int,
    repeats: int,
    emission: Mapping[int, Triple],
    background: Triple = (0, 0, 0),
    soft_shadows: bool = False,
) -> dict[str, npt.NDArray[Any]]:
    """image: radiance, the mean of the repeats; sigma: standard deviation of that mean (0 for one repeat); position: of the
    point seen, in the script's unit; object: its number, -1 for a light, -2 for nothing; facing: the cosine between surface and
    ray; offset: what the offset of shadow rays may change in soft shadows; passed: whether the ray starts in a surface.

    emission: of objects, by number. It is seen and lights nothing, so that it cannot be an emitter of Mitsuba's: it is added
    where the object is seen. background likewise, where nothing is seen.
    """
    origins, directions = view.rays()
    count, block = len(origins), max(2, LANES // samples)
    parts = []
    for start in range(0, count, block):
        part = slice(start, min(start + block, count))
        rays, passed = seen_from(scene, origins[part], directions[part], view.near)
        seeds = [start * (repeats + OFFSET_REPEATS) + index for index in range(repeats + OFFSET_REPEATS)]
        shown = first_hits(scene, rays) | {"passed": passed}
        shown |= scatter(np.stack([one_repeat(scene, rays, samples, seed) for seed in seeds[:repeats]]))
        if soft_shadows:
            changes = [change_by_offset(scene, rays, samples, seed) for seed in seeds[repeats:]]
            shown["offset"] = np.abs(np.mean(changes, axis=0))
        parts.append(shown)
    whole = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    for number, radiance in emission.items():
        whole["image"][whole["object"] == number] += radiance
    whole["image"][whole["object"] == -2] += background
    return {name: array.reshape(view.height, view.width, *array.shape[1:]) for name, array in whole.items()}


def seen_from(scene: Any, origins: Array, directions: Array, near: float) -> tuple[Any, npt.NDArray[np.bool_]]:
    """Rays, and which of them start in a surface; those start off it."""
    rays = rays_along(origins, directions)
    passed = np.asarray(scene.ray_intersect_preliminary(rays).t.numpy() < near)
    if passed.any():
        rays = rays_along(origins + 2 * near * passed[:, None] * directions, directions)
    return rays, passed


def rays_along(origins: Array, directions: Array) -> Any:
    """In single precision."""
    return mi.RayDifferential3f(o=mi.Point3f(as_float32(origins)), d=mi.Vector3f(as_float32(directions)))


def scatter(means: Array) -> dict[str, Array]:
    """The mean of the repeats, (repeats, n, 3), and its standard deviation."""
    sigma = means.std(axis=0, ddof=1) / np.sqrt(len(means)) if len(means) > 1 else np.zeros(means.shape[1:])
    return {"image": means.mean(axis=0), "sigma": sigma}


def one_repeat(scene: Any, rays: Any, samples: int, seed: int) -> Array:
    """(n, 3): the mean radiance of `samples` stratified samples per ray."""
    sampler, ray = stratified(rays, samples, seed)
    return mean_of(scene.integrator().sample(scene, sampler, ray)[0], samples)


def stratified(rays: Any, samples: int, seed: int) -> tuple[Any, Any]:
    """A sampler, and each ray `samples` times."""
    count = dr.width(rays) * samples
    sampler = mi.load_dict({"type": "multijitter", "sample_count": samples})
    sampler.set_samples_per_wavefront(samples)
    sampler.seed(dr.opaque(mi.UInt32, seed), count)  # opaque: else each seed would be compiled anew
    return sampler, dr.gather(mi.RayDifferential3f, rays, dr.arange(mi.UInt32, count) // samples)


def mean_of(radiance: Any, samples: int) -> Array:
    """(n, 3), over each ray's samples."""
    dr.eval(radiance)  # once, not once per band
    bands = [dr.block_sum(band, samples) / samples for band in (radiance.x, radiance.y, radiance.z)]
    return np.stack([band.numpy() for band in bands], axis=1).astype(np.float64)


def change_by_offset(scene: Any, rays: Any, samples: int, seed: int) -> Array:
    """(n, 3): how radiance from emitters with an extent changes when shadow rays start twice as far off the surface."""
    sampler, ray = stratified(rays, samples, seed)
    hit = scene.ray_intersect(ray)
    seen = hit.is_valid()
    to_light, arriving = scene.sample_emitter_direction(hit, sampler.next_2d(seen), False, seen)
    seen &= (to_light.pdf > 0) & ~to_light.delta
    reflected = hit.bsdf(ray).eval(mi.BSDFContext(), hit, hit.to_local(to_light.d), seen) * arriving
    blocked = scene.ray_test(hit.spawn_ray_to(to_light.p), seen)
    step = mi.math.RayEpsilon * (1 + dr.max(dr.abs(hit.p)))
    hit.p += dr.select(dr.dot(hit.n, to_light.d) < 0, -step, step) * hit.n
    blocked_farther_off = scene.ray_test(hit.spawn_ray_to(to_light.p), seen)
    change = dr.select(blocked, reflected, -reflected)
    return mean_of(dr.select(seen & (blocked != blocked_farther_off), change, 0), samples)


def first_hits(scene: Any, rays: Any) -> dict[str, npt.NDArray[Any]]:
    """Where the rays end, (n, 3), on what, (n,), and how steeply, (n,)."""
    hit = scene.ray_intersect(rays)
    numbers = {0: -2}
    for shape in scene.shapes():
        kind, _, rest = shape.id().partition("_")
        numbers[identity(mi.ShapePtr(shape))[0]] = int(rest.partition("_")[0]) if kind == "object" else -1
    table = np.full(max(numbers) + 1, -1, dtype=np.int32)
    table[list(numbers)] = list(numbers.values())
    instance, shape = identity(hit.instance), identity(hit.shape)
    found = np.where(instance > 0, instance, np.where(shape < len(table), shape, 0))
    seen = np.where(hit.is_valid().numpy(), table[found], -2).astype(np.int32)
    return {"position": np.array(hit.p).T, "object": seen, "facing": np.abs(hit.wi.z.numpy())}


def identity(shape: Any) -> npt.NDArray[np.uint32]:
    """DrJit's numbers of shapes."""
    numbers: Any = dr.reinterpret_array(mi.UInt32, shape)
    return np.asarray(numbers.numpy())


def as_float32(points: Array) -> npt.NDArray[np.float32]:
    """(n, 3) → (3, n)."""
    return np.ascontiguousarray(points.T, dtype=np.float32)
