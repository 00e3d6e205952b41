"""Faults of the picture itself: where a pixel looks, and what is written of what it sees."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Edit = Callable[[Array], Array]


def flipped_x(image: Array) -> Array:
    return image[:, ::-1]


def flipped_y(image: Array) -> Array:
    return image[::-1]


def transposed(image: Array) -> Array:
    return image.swapaxes(0, 1)


def wrapped_by(dx: int, dy: int) -> Edit:
    """The whole picture moved, what leaves on one side comes in on the other."""
    return lambda image: np.roll(image, (dy, dx), axis=(0, 1))


def filled_by(dx: int, dy: int) -> Edit:
    """The whole picture moved, black where nothing comes in."""

    def move(image: Array) -> Array:
        moved = np.zeros_like(image)
        height, width = image.shape[:2]
        to_y, to_x = slice(max(dy, 0), height + min(dy, 0)), slice(max(dx, 0), width + min(dx, 0))
        from_y, from_x = slice(max(-dy, 0), height + min(-dy, 0)), slice(max(-dx, 0), width + min(-dx, 0))
        moved[to_y, to_x] = image[from_y, from_x]
        return moved

    return move


def looks_aside(dx: float, dy: float) -> Callable[[Array, int, int], Array]:
    """Every pixel is sampled elsewhere, so that the picture appears moved by (dx, dy)."""
    return lambda film_xy, width, height: film_xy - np.array([dx, dy])


def power_law(gamma: float) -> Edit:
    return lambda image: np.sign(image) * np.abs(image) ** (1 / gamma)


def srgb(image: Array) -> Array:
    """IEC 61966-2-1, carried on above 1."""
    return np.where(image <= 0.0031308, 12.92 * image, 1.055 * np.maximum(image, 0.0031308) ** (1 / 2.4) - 0.055)


def rec709(image: Array) -> Array:
    """ITU-R BT.709, carried on above 1."""
    return np.where(image < 0.018, 4.5 * image, 1.099 * np.maximum(image, 0.018) ** 0.45 - 0.099)


def clamped_at(value: float) -> Edit:
    return lambda image: np.minimum(image, value)


def rounded_to(bits: int) -> Edit:
    """To the nearest of 2^bits levels from 0 to 1; levels go on above 1."""
    top = 2**bits - 1
    return lambda image: np.floor(image * top + 0.5) / top


def truncated_to(bits: int) -> Edit:
    top = 2**bits - 1
    return lambda image: np.floor(image * top) / top


def half_float(image: Array) -> Array:
    """Eleven significant bits."""
    return image.astype(np.float16).astype(np.float64)


def bands(order: Sequence[int]) -> Edit:
    return lambda image: image[..., list(order)]


def times(k: float) -> Edit:
    return lambda image: k * image
