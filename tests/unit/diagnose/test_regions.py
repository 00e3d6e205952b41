"""Regions in the scene's own words."""

from __future__ import annotations

import numpy as np

from equilux.diagnose.regions import Regions
from equilux.diagnose.trials import Workshop
from equilux_tracer import Tracer
from support.faults import RULES, two_balls

CASE = two_balls()
MODEL = Tracer(CASE)
SEEN = MODEL.render(("object_id", "specular", "diffuse"))
REGIONS = Regions(Workshop(case=CASE, rules=RULES, model=MODEL))


def test_a_region_has_its_pixels_and_box() -> None:
    mask = np.zeros((48, 64), np.bool_)
    mask[10:12, 20:25] = True
    region = REGIONS.region(mask)
    assert region is not None
    assert (region.pixels, region.x0, region.y0, region.x1, region.y1) == (10, 20, 10, 24, 11)


def test_no_pixels_are_no_region() -> None:
    assert REGIONS.region(np.zeros((48, 64), np.bool_)) is None


def test_a_highlight_is_called_one() -> None:
    region = REGIONS.region(SEEN["specular"][:, :, 0].max(axis=2) > 0.05)
    assert region is not None
    assert region.words == "on objects[0] (sphere, clay), in the highlight of light key"


def test_what_faces_away_from_a_light_is_called_so() -> None:
    region = REGIONS.region((SEEN["diffuse"][:, :, 1].max(axis=2) == 0) & (SEEN["object_id"] == 0))
    assert region is not None
    assert "where light fill is behind the surface (N·L ≤ 0)" in region.words


def test_the_background_is_called_so() -> None:
    region = REGIONS.region(SEEN["object_id"] < 0)
    assert region is not None
    assert region.words.startswith("on the background")


def test_silhouettes_are_called_so() -> None:
    objects = SEEN["object_id"]
    mask = np.zeros(objects.shape, np.bool_)
    mask[:, 1:] |= objects[:, 1:] != objects[:, :-1]
    mask[1:] |= objects[1:] != objects[:-1]
    region = REGIONS.region(mask)
    assert region is not None
    assert "at silhouettes" in region.words
