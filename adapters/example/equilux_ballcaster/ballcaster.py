"""Ballcaster, the renderer: `python -m equilux_ballcaster.ballcaster SCENE.json PICTURE.pfm`.

It stands for *your* renderer, a program that knows nothing of equilux: it reads its own scene file and writes its own
picture, here a PFM (linear float32, bottom row first).
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


def unit(vector: Any) -> Array:
    array = np.asarray(vector, dtype=np.float64)
    return array / np.linalg.norm(array, axis=-1, keepdims=True)


def rays(camera: dict[str, Any], width: int, height: int) -> Array:
    """Unit directions through the pixel centres, (height, width, 3), row 0 on top."""
    forward = unit(np.subtract(camera["target"], camera["eye"]))
    right = unit(np.cross(forward, camera["up"]))
    up = np.cross(right, forward)
    tangent = np.tan(np.radians(camera["fov_y_deg"]) / 2)
    x = (2 * (np.arange(width) + 0.5) / width - 1) * width / height * tangent
    y = (1 - 2 * (np.arange(height) + 0.5) / height) * tangent
    return unit(forward + x[None, :, None] * right + y[:, None, None] * up)


def shade(scene: dict[str, Any]) -> Array:
    """Linear radiance, (height, width, 3)."""
    direction = rays(scene["camera"], scene["width"], scene["height"])
    eye = np.asarray(scene["camera"]["eye"], dtype=np.float64)
    picture = np.broadcast_to(np.asarray(scene["background"], dtype=np.float64), direction.shape).copy()
    nearest = np.full(direction.shape[:2], np.inf)
    for ball in scene["balls"]:
        to_center = np.asarray(ball["center"]) - eye
        along = direction @ to_center
        miss = to_center - along[..., None] * direction
        half_chord_squared = ball["radius"] ** 2 - np.einsum("...i,...i", miss, miss)
        half_chord = np.sqrt(np.maximum(half_chord_squared, 0))
        near, far = along - half_chord, along + half_chord
        distance = np.where(near > 0, near, far)  # the eye may be inside the ball
        hit = (half_chord_squared > 0) & (distance > 0) & (distance < nearest)
        nearest = np.where(hit, distance, nearest)
        point = eye + distance[..., None] * direction
        normal = unit(point - ball["center"])
        normal *= -np.sign(np.einsum("...i,...i", normal, direction))[..., None]  # the viewer's side
        radiance = np.zeros_like(picture)
        for light in scene["lights"]:
            to_light = np.asarray(light["position"]) - point
            squared = np.einsum("...i,...i", to_light, to_light)
            cosine = np.maximum(np.einsum("...i,...i", normal, to_light) / np.sqrt(squared), 0)
            radiance += (cosine / squared)[..., None] * np.asarray(light["intensity"]) * np.asarray(ball["brdf"])
        picture = np.where(hit[..., None], radiance, picture)
    return picture


def main() -> None:
    scene_path, picture_path = map(Path, sys.argv[1:])
    picture = shade(json.loads(scene_path.read_text()))
    header = f"PF\n{picture.shape[1]} {picture.shape[0]}\n-1.0\n".encode()  # negative: little-endian
    picture_path.write_bytes(header + picture[::-1].astype("<f4").tobytes())


if __name__ == "__main__":
    main()
