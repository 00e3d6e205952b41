"""Where pixels lie, in numbers and in the scene's own words."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from equilux.diagnose.diagnosis import Region
from equilux.diagnose.evidence import centres
from equilux.diagnose.trials import Workshop
from equilux_scenes.model import DeltaLight, DirectionalLight, SpotLight

Channels = dict[str, npt.NDArray[Any]]
Mask = npt.NDArray[np.bool_]

MOST_PIXELS = 1500
"""Of the region and of the rest: enough to say what most of it has and the rest has not."""
MOST, FEW = 0.8, 0.4
"""A word is said of a region if at least this share of its pixels has the property, and at most that share of the others that
show the same objects."""
OBJECTS = 3
"""Objects that are named before the others are only counted."""
BRIGHT = 0.02
"""Share of the diffuse light from which on a highlight counts as seen."""
CHANNELS = ("object_id", "normal", "position", "diffuse", "specular", "reflected", "transmitted", "signature")


class Regions:
    """Regions of one case's film, described by what the unchanged reference sees there."""

    def __init__(self, workshop: Workshop) -> None:
        self._workshop = workshop

    def region(self, mask: Mask) -> Region | None:
        """None of no pixels."""
        if not mask.any():
            return None
        rows, columns = np.nonzero(mask)
        return Region(
            pixels=len(rows), x0=int(columns.min()), y0=int(rows.min()), x1=int(columns.max()), y1=int(rows.max()),
            words=self._words(mask),
        )  # fmt: skip

    def _words(self, mask: Mask) -> str:
        inside, outside = _some(mask), _some(~mask)
        seen = self._workshop.model.evaluate(centres(np.concatenate([inside, outside]), mask.shape[1]), CHANNELS)
        is_inside = np.arange(len(inside) + len(outside)) < len(inside)
        objects = seen["object_id"]
        comparable = ~is_inside & np.isin(objects, np.unique(objects[is_inside]))
        text = self._objects(objects[is_inside])
        for name, has in self._properties(seen, mask.shape[1], np.concatenate([inside, outside])):
            share = float(has[is_inside].mean())
            other = float(has[comparable].mean()) if comparable.any() else 0.0
            if share >= MOST and other <= FEW:
                text += f", {name}"
        return text

    def _objects(self, seen: npt.NDArray[Any]) -> str:
        objects = self._workshop.case.scene.objects
        parts: list[str] = []
        found, counts = np.unique(seen, return_counts=True)
        for index in found[np.argsort(-counts, kind="stable")]:
            if 0 <= index < len(objects):
                part = f"objects[{index}] ({objects[index].kind}, {objects[index].material})"
            else:
                part = "the background" if index < 0 else "an emitter"
            parts += [part] if part not in parts else []
        more = len(parts) - OBJECTS
        return "on " + ", ".join(parts[:OBJECTS]) + (f" and {more} more" if more > 0 else "")

    def _properties(self, seen: Channels, width: int, pixels: npt.NDArray[np.intp]) -> Iterator[tuple[str, Mask]]:
        """What can be said of a pixel, and of which pixels it is true."""
        scene = self._workshop.case.scene
        yield "at silhouettes", self._at_silhouettes(seen["object_id"], pixels, width)
        yield "where something is seen by reflection", seen["reflected"].max(axis=1) > 0
        yield "where something is seen through it", seen["transmitted"].max(axis=1) > 0
        for index, (name, light) in enumerate(scene.delta_lights.items()):
            lit = seen["diffuse"][:, index].max(axis=1) + seen["specular"][:, index].max(axis=1) > 0
            facing = _cosine(light, seen) > 0
            yield f"in the highlight of light {name}", _has_highlight(seen, index)
            yield f"where light {name} is behind the surface (N·L ≤ 0)", ~facing & (seen["object_id"] >= 0)
            yield f"in the light of {name}", lit
            if isinstance(light, SpotLight):
                inside = _inside_cone(light, seen)
                yield f"outside the cone of light {name}", facing & ~inside
                facing = facing & inside
            if scene.model in ("raytraced", "reflection-equation"):
                yield f"in the shadow of light {name}", facing & ~lit & (seen["object_id"] >= 0)
        for index, name in enumerate(scene.area_emitters, start=len(scene.delta_lights)):
            yield f"in the highlight of emitter {name}", _has_highlight(seen, index)

    def _at_silhouettes(self, objects: npt.NDArray[Any], pixels: npt.NDArray[np.intp], width: int) -> Mask:
        """Whether another object is seen within a pixel's width."""
        here = centres(pixels, width)
        result = np.zeros(len(pixels), np.bool_)
        for offset in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            result |= self._workshop.model.evaluate(here + np.array(offset), ("object_id",))["object_id"] != objects
        return result


def _some(mask: Mask) -> npt.NDArray[np.intp]:
    pixels = np.flatnonzero(mask)
    return pixels[:: len(pixels) // MOST_PIXELS + 1]


def _cosine(light: DeltaLight, seen: Channels) -> npt.NDArray[np.float64]:
    """N·L up to a positive factor; NaN of a miss."""
    if isinstance(light, DirectionalLight):
        toward = np.broadcast_to(-np.asarray(light.direction), seen["normal"].shape)
    else:
        toward = np.asarray(light.position) - seen["position"]
    return np.asarray((toward * seen["normal"]).sum(axis=1))


def _inside_cone(light: SpotLight, seen: Channels) -> Mask:
    away = seen["position"] - np.asarray(light.position)
    axis = np.asarray(light.direction) / np.linalg.norm(light.direction)
    return np.asarray(away @ axis >= np.cos(np.radians(light.cone_half_angle_deg)) * np.linalg.norm(away, axis=1))


def _has_highlight(seen: Channels, light: int) -> Mask:
    if light >= seen["specular"].shape[1]:
        return np.zeros(len(seen["object_id"]), np.bool_)
    highlight = seen["specular"][:, light].max(axis=1)
    return np.asarray((highlight > BRIGHT * seen["diffuse"][:, light].max(axis=1)) & (highlight > 0))
