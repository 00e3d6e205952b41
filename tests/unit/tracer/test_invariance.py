"""What must not change the picture: moving everything, scaling everything, whatever Embree thinks in float."""

from __future__ import annotations

import numpy as np
import pytest

from equilux_tracer import Tracer
from support.random_scenes import case_of, changed, random_spec

SEEDS = range(6)
CHANNELS = ["radiance", "rounding", "object_id", "signature"]


def dyadic(spec):
    """Coordinates cut to 2^-20, so that adding 2^20 or 2^-30-fold scaling is exact."""
    if isinstance(spec, dict):
        return {key: dyadic(value) for key, value in spec.items()}
    if isinstance(spec, list):
        return [dyadic(value) for value in spec]
    return round(spec * 2**20) / 2**20 if isinstance(spec, float) else spec


LENGTHS = {"radius", "height_m"}
PLACES = {"eye", "target", "position", "center", "point", "min", "max", "corner", "base", "top"}
ARROWS = {"edge_u", "edge_v"}


def mapped(spec, place, length):
    """The spec with every place and every length in it mapped; attenuation is left out by the scenes used here."""
    if isinstance(spec, list):
        return [mapped(item, place, length) for item in spec]
    if not isinstance(spec, dict):
        return spec
    result = {}
    for key, value in spec.items():
        if key in PLACES:
            result[key] = [place(c) for c in value]
        elif key in ARROWS:
            result[key] = [length(c) for c in value]
        elif key in LENGTHS:
            result[key] = length(value)
        else:
            result[key] = mapped(value, place, length)
    return result


def scene(seed, **more):
    return dyadic(random_spec(seed, transforms=False, inverse_square=True, film=(40, 30), **more))


def rendered(spec):
    return Tracer(case_of(spec)).render(CHANNELS)


def assert_same(a, b):
    np.testing.assert_array_equal(a["object_id"], b["object_id"])
    np.testing.assert_array_equal(a["signature"], b["signature"])
    np.testing.assert_array_equal(a["radiance"], b["radiance"])


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("fov_deg", [(20.0, 90.0), None], ids=["perspective", "orthographic"])
def test_moving_everything_by_two_to_the_twenty_changes_nothing(seed, fov_deg):
    spec = scene(seed, fov_deg=fov_deg)
    assert_same(rendered(spec), rendered(mapped(spec, lambda c: c + 2.0**20, lambda c: c)))


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("power", [-50, -3, 20, 50])
def test_scaling_everything_by_a_power_of_two_changes_nothing(seed, power):
    """From 1e-15 to 1e15 metres: intensities go by the square, irradiances and radiances stay."""
    spec = scene(seed, fov_deg=None if seed % 2 else (20.0, 90.0))
    s = 2.0**power
    scaled = mapped(spec, lambda c: c * s, lambda c: c * s)
    for light in scaled["lights"].values():
        if "intensity" in light:
            light["intensity"] = [band * s * s for band in light["intensity"]]
    assert_same(rendered(spec), rendered(scaled))


@pytest.mark.parametrize("seed", SEEDS)
def test_an_object_far_behind_or_far_off_does_not_coarsen_the_rest(seed):
    """Embree's float sees boxes of 1e12 m beside boxes of 1 m: candidates may multiply, decisions may not change."""
    spec = scene(seed)
    lone = {"kind": "sphere", "center": [3e12, 1e12, -2e12], "radius": 1.0, "material": "m0"}
    assert_same(rendered(spec), rendered(changed(spec, objects=[*spec["objects"], lone])))


@pytest.mark.parametrize("orthographic", [False, True])
@pytest.mark.parametrize("far", [0.0, 1e6])
def test_embree_loses_none_of_many_spheres(make_case, orthographic, far):
    """Against a search without any acceleration, in double, over sizes of 1e-4 to 1: the boxes are wide enough."""
    rng = np.random.default_rng(3)
    count = 600
    centers = rng.uniform(-4, 4, (count, 3)) * [1, 1, 2]
    radii = 10 ** rng.uniform(-4, -0.5, count)
    moved = (centers + np.array([far, far, 0])).tolist()
    balls = [{"kind": "sphere", "center": c, "radius": r} for c, r in zip(moved, radii.tolist(), strict=True)]
    size = {"projection": "orthographic", "height_m": 8} if orthographic else {"projection": "perspective", "fov_y_deg": 40}
    camera = {"eye": [far, far, 12], "target": [far, far, 0], **size}
    case = make_case(*balls, camera=camera, film={"width": 96, "height": 96})
    # aim at the spheres' own rims as well as at the pixel grid
    scale = 96 / 8 if orthographic else 96 / 2 / np.tan(np.radians(20))
    depth = 1 if orthographic else 12 - centers[:, 2]
    rim = np.stack([48 + scale * (centers[:, 0] + 0.999 * radii) / depth, 48 - scale * centers[:, 1] / depth], axis=1)
    grid = np.stack(np.meshgrid(np.arange(0.5, 96, 6), np.arange(0.5, 96, 6)), axis=-1).reshape(-1, 2)
    film_xy = np.concatenate([rim, grid])
    ids = Tracer(case).evaluate(film_xy, ["object_id"])["object_id"]

    x, y = (film_xy[:, 0] - 48) / scale, (48 - film_xy[:, 1]) / scale
    if orthographic:
        origin, way = np.stack([x, y, np.full_like(x, 12)], axis=1), np.tile([0.0, 0, -1], (len(x), 1))
    else:
        origin, way = np.tile([0.0, 0, 12], (len(x), 1)), np.stack([x, y, np.full_like(x, -1)], axis=1)
        way /= np.linalg.norm(way, axis=1, keepdims=True)
    rounded = np.array([b["center"] for b in balls]) - [far, far, 0]
    toward = rounded[None] - origin[:, None]
    along = np.einsum("rsk,rk->rs", toward, way)
    miss = np.linalg.norm(toward - along[..., None] * way[:, None], axis=-1)
    chord = np.sqrt(np.maximum(radii**2 - miss**2, 0))
    near = np.where(along - chord > 0, along - chord, along + chord)
    near = np.where((miss <= radii) & (near > 0), near, np.inf)
    expected = np.where(np.isfinite(near.min(axis=1)), near.argmin(axis=1), -1)
    sure = np.abs(miss / radii - 1).min(axis=1) > 1e-9  # off every silhouette
    wrong = np.count_nonzero((ids != expected) & sure)
    assert wrong == 0, f"{wrong} of {np.count_nonzero(sure)} rays see another sphere"
    assert np.count_nonzero(expected >= 0) > 550
