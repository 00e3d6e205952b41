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


@dataclass
class View:
    """The camera. half_height: of the film, at distance 1 from the eye, or in metres for parallel rays."""

    eye: Triple
    target: Triple
    up: Triple
    half_height: float
    width: int
    height: int
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
    scene: Any, view: View, samples: int, repeats: int, emission: Mapping[int, Triple], background: Triple = (0, 0, 0)
) -> dict[str, npt.NDArray[Any]]:
    """image: radiance, the mean of the repeats; sigma: standard deviation of that mean (0 for one repeat); position: of the
    point seen, metres; object: its number, -1 for a light, -2 for nothing; facing: the cosine between surface and ray.

    emission: of objects, by number. It is seen and lights nothing, so that it cannot be an emitter of Mitsuba's: it is added
    where the object is seen. background likewise, where nothing is seen.
    """
    origins, directions = view.rays()
    count, block = len(origins), max(2, LANES // samples)
    image, sigma, position = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros((count, 3))
    seen, facing = np.zeros(count, dtype=np.int32), np.zeros(count)
    for start in range(0, count, block):
        part = slice(start, min(start + block, count))
        rays = mi.RayDifferential3f(o=mi.Point3f(as_float32(origins[part])), d=mi.Vector3f(as_float32(directions[part])))
        position[part], seen[part], facing[part] = first_hits(scene, rays)
        seeds = range(start * repeats, (start + 1) * repeats)
        means = np.stack([one_repeat(scene, rays, part.stop - part.start, samples, seed) for seed in seeds])
        image[part] = means.mean(axis=0)
        if repeats > 1:
            sigma[part] = means.std(axis=0, ddof=1) / np.sqrt(repeats)
    for number, radiance in emission.items():
        image[seen == number] += radiance
    image[seen == -2] += background
    shape = (view.height, view.width)
    flat: dict[str, npt.NDArray[Any]] = {"image": image, "sigma": sigma, "position": position, "object": seen, "facing": facing}
    return {name: array.reshape(*shape, *array.shape[1:]) for name, array in flat.items()}


def one_repeat(scene: Any, rays: Any, count: int, samples: int, seed: int) -> Array:
    """(count, 3): the mean radiance of `samples` stratified samples per ray."""
    sampler = mi.load_dict({"type": "multijitter", "sample_count": samples})
    sampler.set_samples_per_wavefront(samples)
    sampler.seed(dr.opaque(mi.UInt32, seed), count * samples)  # opaque: else each seed would be compiled anew
    ray = dr.gather(mi.RayDifferential3f, rays, dr.arange(mi.UInt32, count * samples) // samples)
    radiance = scene.integrator().sample(scene, sampler, ray)[0]
    dr.eval(radiance)  # once, not once per band
    bands = [dr.block_sum(band, samples) / samples for band in (radiance.x, radiance.y, radiance.z)]
    return np.stack([band.numpy() for band in bands], axis=1)


def first_hits(scene: Any, rays: Any) -> tuple[Array, npt.NDArray[np.int32], Array]:
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
    missed = ~hit.is_valid().numpy()
    return np.array(hit.p).T, np.where(missed, -2, table[found]).astype(np.int32), np.abs(hit.wi.z.numpy())


def identity(shape: Any) -> npt.NDArray[np.uint32]:
    """DrJit's numbers of shapes."""
    numbers: Any = dr.reinterpret_array(mi.UInt32, shape)
    return np.asarray(numbers.numpy())


def as_float32(points: Array) -> npt.NDArray[np.float32]:
    """(n, 3) → (3, n)."""
    return np.ascontiguousarray(points.T, dtype=np.float32)
