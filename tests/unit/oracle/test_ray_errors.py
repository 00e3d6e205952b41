"""How far rays are off after many bounces, against fifty digits: never more than their stated bounds."""

from __future__ import annotations

import numpy as np
import pytest
from mpmath import mp, mpf

from equilux_oracle import precise
from equilux_oracle.doubledouble import DD
from equilux_oracle.transport import from_eye, meet
from equilux_oracle.wave import Sums, together
from equilux_oracle.world import world_of
from support.random_scenes import case_of

POSITIONS = np.array([[2.3, 3.1], [8.2, 6.7], [12.6, 9.1], [5.5, 7.7], [10.1, 2.2], [7.3, 10.9]])


def case_with(objects, material, limit):
    return case_of(
        {
            "equilux": 1,
            "name": "billiard",
            "model": "raytraced",
            "camera": {"projection": "perspective", "eye": [0, 0.3, 2], "target": [0.1, 0, 0], "fov_y_deg": 50},
            "film": {"width": 16, "height": 12},
            "materials": {"m": material, "wall": {"reflection": 1}},
            "objects": objects,
            "recursion_limit": limit,
        }
    )


def ball(center, radius, material="m", **more):
    return {"kind": "sphere", "center": center, "radius": radius, "material": material, **more}


ROOM = ball([0, 0, 0], 3, "wall")
PAIR = [ball([-0.9, 0, 0], 0.7), ball([0.9, -0.2, 0.1], 0.8)]
TURNED = {"transform": [{"scale": [1, 0.5, 1.3]}, {"rotate": {"axis": [1, 2, 3], "degrees": 40}}]}
SCENES = {
    "mirrors": ([ROOM, *PAIR], {"reflection": 1}),
    "ellipsoids": ([ROOM, ball([-0.9, 0, 0], 0.7, **TURNED), ball([0.9, -0.2, 0.1], 0.8, **TURNED)], {"reflection": 1}),
    "glass": ([ROOM, *PAIR], {"transparency": 1, "transmission": 1, "ior": 1.7}),
    "bubbles": ([ROOM, *PAIR], {"transparency": 1, "transmission": 1, "ior": 0.6}),
    "flat": (
        [
            {"kind": "box", "min": [-3, -2, -4], "max": [3.1, 2.2, 4], "material": "wall"},
            {"kind": "box", "min": [-0.5, -0.5, -0.5], "max": [0.5, 0.6, 0.7], "material": "m", **TURNED},
        ],
        {"transparency": 1, "transmission": 1, "ior": 1.5},
    ),
}


def onward(scene, origin, direction, start):
    """The one ray of weight 1 that leaves the surface met: refracted where the material lets through, else mirrored."""
    seen = precise.first_seen(scene, origin, direction, start)
    assert seen is not None
    material = scene.materials[scene.objects[seen.index].material]
    n, v = seen.normal, seen.to_viewer
    cosine = precise.dot(n, v)
    eta = 1 / mpf(material.ior) if seen.outside else mpf(material.ior)
    s2 = eta**2 * (1 - cosine**2)
    if material.transparency == 0 or s2 > 1:
        return seen.point, precise.unit(precise.minus(precise.times(2 * cosine, n), v))
    bent = precise.times(eta * cosine - mp.sqrt(1 - s2), n)
    return seen.point, precise.unit(precise.minus(bent, precise.times(eta, v)))


@pytest.mark.parametrize("name", SCENES)
def test_rays_stay_within_their_stated_bounds(name):
    bounces, worst, magnified = 14, 0.0, 0.0
    case = case_with(*SCENES[name], bounces)
    scene, world = case.scene, world_of(case.scene)
    eye = precise.exact(scene.camera.eye)
    with mp.workdps(50):
        true = [ray_of(scene, *xy) for xy in POSITIONS]
        wave = from_eye(world, POSITIONS)
        first = wave.error.angle.copy()
        for bounce in range(bounces):
            wave = together(meet(world, wave, Sums.black(len(POSITIONS)), bounce)[1])
            assert sorted(wave.position) == list(range(len(POSITIONS))), "one ray per position goes on"
            start = mpf(0) if bounce == 0 else mpf(2) ** -50 * 5
            true = [onward(scene, origin, direction, start) for origin, direction in true]
            for k, position in enumerate(wave.position):
                origin, direction = true[position]
                turned = precise.length(precise.minus(vector(wave.rays.direction, k), direction))
                aside = precise.minus(precise.plus(vector(wave.rays.offset, k), eye), origin)
                across = precise.length(precise.minus(aside, precise.times(precise.dot(aside, direction), direction)))
                for what, off, stated in (("angle", turned, wave.error.angle[k]), ("lateral", across, wave.error.lateral[k])):
                    assert off <= stated, (
                        f"{name}, bounce {bounce + 1}, ray {position}: {what} {mp.nstr(off, 3)}, stated {stated}"
                    )
                    worst = max(worst, float(off / stated))
                magnified = max(magnified, float(wave.error.angle[k] / first[0]))
    print(f"\n{name}: worst error ÷ stated {worst:.2g}, stated angle grown by {magnified:.2g} in {bounces} bounces")
    assert worst >= 1e-12, f"{name}: the bounds say nothing: the worst error is {worst} of them"


def ray_of(scene, x, y):
    """The camera's ray at fifty digits, unit."""
    camera, film = scene.camera, scene.film
    eye, target, up = (precise.exact(v) for v in (camera.eye, camera.target, camera.up))
    forward = precise.unit(precise.minus(target, eye))
    right = precise.unit(precise.cross(forward, up))
    half = mp.tan(mp.radians(mpf(camera.fov_y_deg)) / 2)
    a = (2 * mpf(x) / film.width - 1) * film.width / film.height * half
    b = (1 - 2 * mpf(y) / film.height) * half
    across = precise.plus(precise.times(a, right), precise.times(b, precise.cross(right, forward)))
    return eye, precise.unit(precise.plus(forward, across))


def vector(v: DD, k: int):
    return tuple(mpf(v.hi[c, k]) + mpf(v.lo[c, k]) for c in range(3))
