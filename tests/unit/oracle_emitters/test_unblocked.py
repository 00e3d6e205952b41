"""When there is a closed form: decided by proof, and never wrongly in favour of one."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest

from equilux_oracle import emitters
from equilux_oracle.camera import film_rays
from equilux_oracle.doubledouble import DD
from equilux_oracle.emitters.convex import apart, convex, hull
from equilux_oracle.emitters.covers import with_emitters
from equilux_oracle.examination import pixel_centers
from equilux_oracle.shadows import let_through
from equilux_oracle.visibility import bodies, first_seen
from equilux_scenes.loader import corpus_folder, load_scenes
from equilux_scenes.model import Box, Disc, Plane, Rectangle, Sphere
from support.random_emitters import random_direction
from support.random_scenes import case_of

FLOOR = {"kind": "plane", "point": [0, 0, 0], "normal": [0, 1, 0], "material": "m"}
TABLE = {"kind": "rectangle", "corner": [-1, 0, 1], "edge_u": [2, 0, 0], "edge_v": [0, 0, -2], "material": "m"}
BALL = {"kind": "sphere", "center": [0, 0.4, 0], "radius": 0.4, "material": "m"}
BOX = {"kind": "box", "min": [-0.3, 0, -0.3], "max": [0.3, 0.5, 0.3], "material": "m"}
TUBE = {"kind": "cylinder", "base": [0, 0, 0], "top": [0, 0.5, 0], "radius": 0.3, "capped": False, "material": "m"}
EGG = {**BALL, "transform": [{"scale": [1, 0.6, 1]}]}
LAMP = {"kind": "sphere", "center": [0.2, 1.5, 0], "radius": 0.2, "radiance": 1}
SECOND = {"kind": "sphere", "center": [-0.9, 1.5, 0], "radius": 0.2, "radiance": 1}
LOW = {"kind": "sphere", "center": [0.1, 0.7, 0], "radius": 0.2, "radiance": 1}
CEILING = {"kind": "rectangle", "corner": [-1, 2, -1], "edge_u": [0.9, 0, 0], "edge_v": [0, 0, 2], "radiance": 1}
BESIDE = {**CEILING, "corner": [0.1, 2, -1]}
AWAY = {**CEILING, "edge_u": [0, 0, 2], "edge_v": [0.9, 0, 0]}
SUN = {"kind": "directional", "direction": [0, -1, 0.1], "irradiance": 1}
SKY = {"kind": "environment", "radiance": 1}
EYE = [0.5, 1.5, 4]
SCENES = 60


def case(lights, objects, eye=EYE, **more):
    return case_of({
        "equilux": 1,
        "name": "one",
        "model": "reflection-equation",
        "camera": {"projection": "perspective", "eye": list(eye), "target": [0, 0.3, 0], "up": [0, 1, 0], "fov_y_deg": 40},
        "film": {"width": 24, "height": 18},
        "lights": {f"l{k}": light for k, light in enumerate(lights)},
        "materials": {"m": {"diffuse": 0.3, "brdf": "lambert"}, "black": {"brdf": "lambert"}},
        "objects": list(objects),
        **more,
    })  # fmt: skip


@pytest.mark.parametrize(
    ("name", "lights", "objects", "free"),
    [
        ("a lamp over a floor", [LAMP], [FLOOR], True),
        ("a lamp over a ball", [LAMP], [BALL], True),
        ("a ball between lamp and floor", [LAMP], [FLOOR, BALL], False),
        ("a ball and a floor that reflects nothing", [LAMP], [{**FLOOR, "material": "black"}, BALL], True),
        ("a black ball between lamp and floor", [LAMP], [FLOOR, {**BALL, "material": "black"}], False),
        ("two lamps over an endless floor", [LAMP, SECOND], [FLOOR], False),
        ("two lamps over a table", [LAMP, SECOND], [TABLE], True),
        ("a lamp below another over a table", [LAMP, LOW], [TABLE], False),
        ("two panels of one ceiling over a table", [CEILING, BESIDE], [TABLE], True),
        ("two panels of one ceiling over an endless floor", [CEILING, BESIDE], [FLOOR], True),
        ("a panel that turns its back to the table", [AWAY, LOW], [TABLE], True),
        ("a black lamp before a bright one", [LAMP, {**LOW, "radiance": 0}], [TABLE], False),
        ("lights without extent, whatever is in the way", [SUN], [FLOOR, BALL, BOX, TUBE], True),
        ("an open tube", [LAMP], [TUBE], False),
        ("the sky over a box", [SKY], [BOX], True),
        ("the sky over a ball on a floor", [SKY], [FLOOR, BALL], True),
        ("the sky over a box on a floor", [SKY], [FLOOR, BOX], True),
        ("the sky over an egg on a floor", [SKY], [FLOOR, EGG], False),
        ("the sky over an egg", [SKY], [EGG], True),
        ("the sky over two things on a floor", [SKY], [FLOOR, BALL, {**BOX, "min": [1, 0, 0], "max": [2, 1, 1]}], False),
        ("the sky and a lamp over a floor", [SKY, LAMP], [FLOOR], True),
        ("a black sky over two things on a floor", [{**SKY, "radiance": 0}], [FLOOR, BALL, BOX], True),
        ("nothing but emitters", [LAMP, LOW, CEILING, SKY], [], True),
    ],
)
def test_what_has_a_closed_form(name, lights, objects, free):
    assert emitters.supports(case(lights, objects)) == ([] if free else ["occlusion"]), name


def test_a_body_seen_from_inside_has_none():
    room = {"kind": "box", "min": [-3, 0, -5], "max": [3, 3, 5], "material": "m"}
    assert emitters.supports(case([LAMP], [room])) == ["occlusion"]
    assert emitters.supports(case([LAMP], [room], eye=[0.5, 1.5, 6])) == []
    flat = {"projection": "orthographic", "eye": [0, 1, 3], "target": [0, 0, 0], "up": [0, 1, 0], "height_m": 3}
    assert emitters.supports(case([LAMP], [room], camera=flat)) == ["occlusion"]
    assert emitters.supports(case([LAMP], [BALL], camera=flat)) == []


def test_a_mesh_has_none():
    triangle = {"kind": "mesh", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": [[0, 1, 2]], "material": "m"}
    assert emitters.supports(case([LAMP], [triangle])) == ["normals.flat", "shape.mesh"]
    with pytest.raises(ValueError, match=r"one: no closed form for normals\.flat, shape\.mesh"):
        emitters.radiance_with_bound(case([LAMP], [triangle]))


def test_the_corpus_has_both_kinds():
    cases = [c for file in load_scenes([corpus_folder() / "reflection-equation"]) for c in file.cases]
    without = {c.scene_name for c in cases if emitters.supports(c)}
    partly_hidden = {"soft-shadow", "penumbra", "emitter-shadows-emitter", "blocked-environment"}
    expected = partly_hidden | {"normals-of-a-mesh"}
    assert without == expected, f"no closed form for {without}"


def test_convex_bodies_are_told_apart():
    ball = Sphere(kind="sphere", center=(0, 0, 0), radius=1, material="")
    below = Plane(kind="plane", point=(0, -1, 0), normal=(0, 1, 0), material="")
    disc = Disc(kind="disc", center=(1.5, 1.5, 0), normal=(1, 1, 0), radius=0.7, material="")
    box = Box(kind="box", min=(2, -1, -1), max=(3, 1, 1), material="")
    sheet = Rectangle(kind="rectangle", corner=(1.5, -2, -2), edge_u=(0, 4, 0), edge_v=(0, 0, 4), material="")
    shapes = {"ball": ball, "below": below, "disc": disc, "box": box, "sheet": sheet}
    sets = {name: convex(body) for name, body in shapes.items()}
    assert apart(sets["ball"], sets["below"]), "the ball lies on the plane"
    assert apart(sets["ball"], sets["disc"])
    assert apart(sets["ball"], sets["sheet"])
    assert not apart(hull([sets["ball"], sets["box"]]), sets["sheet"]), "the sheet is between ball and box"
    assert apart(hull([sets["ball"], sets["disc"]]), sets["box"])
    assert not apart(sets["ball"], sets["ball"])


def test_nothing_is_in_the_way_where_there_is_a_closed_form():
    """Random scenes: from every point that is seen to random points of every emitter that shines there."""
    rng = random.Random("unblocked")
    free_ways, refused, needlessly = 0, 0, 0
    for _ in range(SCENES):
        found = random_case(rng)
        blocked, ways = count_blocked(found, rng)
        if emitters.supports(found):
            refused, needlessly = refused + 1, needlessly + (blocked == 0)
        else:
            free_ways += ways
            scene = found.scene.model_dump_json(exclude_defaults=True)
            assert blocked == 0, f"{blocked} of {ways} ways are blocked in {scene}"
    print(f"{free_ways} ways in {SCENES - refused} scenes, none blocked; {refused} refused, {needlessly} needlessly")
    assert free_ways > 3000, f"only {free_ways} ways have been tried"
    assert refused - needlessly > 5, f"of {refused} refused scenes only {refused - needlessly} have a blocked way"


def random_case(rng):
    def near(scale):
        return [scale * c for c in random_direction(rng)]

    objects = []
    for kind in rng.sample(["sphere", "box", "rectangle", "disc"], rng.randint(1, 2)):
        center = near(rng.uniform(0.5, 2))
        shape = {
            "sphere": {"center": center, "radius": rng.uniform(0.4, 0.8)},
            "box": {"min": center, "max": [c + rng.uniform(0.5, 1) for c in center]},
            "rectangle": {"corner": center, "edge_u": [rng.uniform(0.3, 1), 0, 0], "edge_v": [0, 0, -rng.uniform(0.3, 1)]},
            "disc": {"center": center, "normal": near(1), "radius": rng.uniform(0.2, 0.7)},
        }[kind]
        objects.append({"kind": kind, "material": "m", **shape})
    lights = []
    for kind in rng.sample(["sphere", "disc", "rectangle"], 2):
        center = near(rng.uniform(1.5, 3))
        shape = {
            "sphere": {"center": center, "radius": rng.uniform(0.1, 0.4)},
            "disc": {"center": center, "normal": near(1), "radius": rng.uniform(0.1, 0.5)},
            "rectangle": {"corner": center, "edge_u": [0, rng.uniform(0.2, 0.8), 0], "edge_v": [rng.uniform(0.2, 0.8), 0, 0]},
        }[kind]
        lights.append({"kind": kind, "radiance": 1, **shape})
    eye = near(6)
    view = {"projection": "perspective", "eye": eye, "target": [0, 0, 0], "up": [0.1, 1, 0.2], "fov_y_deg": 30}
    return case(lights, objects, camera=view)


def count_blocked(found, rng):
    """Ways from lit points to points of emitters in front of both; how many of them something blocks."""
    scene = found.scene
    everything = bodies(with_emitters(scene))
    rays = film_rays(scene.camera, scene.film, pixel_centers(scene.film))
    seen = first_seen(everything, rays, math.hypot(*scene.camera.eye) / np.linalg.norm(rays.direction.hi, axis=0))
    lit = np.flatnonzero((seen.object_id >= 0) & (seen.object_id < len(scene.objects)))
    opaque, blocked, ways = np.zeros((3, len(everything))), 0, 0
    for emitter in scene.area_emitters.values():
        for _ in range(20):
            target, outward = point_of(emitter, rng)
            towards = DD((np.array(target) - scene.camera.eye).reshape(3, 1)) - seen.point[:, lit]
            facing = np.sum(seen.normal.hi[:, lit] * towards.hi, axis=0) > 1e-9
            # The very surface of the emitter is no obstacle: the way ends just before it.
            chosen = np.flatnonzero(facing & (outward @ towards.hi < -1e-9))
            way = towards[:, chosen] * (1 - 1e-9)
            through, *_ = let_through(everything, opaque, seen.point[:, lit[chosen]], way, 10.0, finite=True)
            ways, blocked = ways + len(chosen), blocked + int(np.sum(through[0] == 0.0))
    return blocked, ways


def point_of(emitter, rng):
    """A point on an emitter, and its outward normal."""
    if emitter.kind == "sphere":
        outward = np.array(random_direction(rng))
        return np.array(emitter.center) + emitter.radius * outward, outward
    if emitter.kind == "disc":
        normal = np.array(emitter.normal)
        across = np.cross(normal, random_direction(rng))
        return np.array(emitter.center) + emitter.radius * rng.random() * across / np.linalg.norm(across), normal
    u, v = np.array(emitter.edge_u), np.array(emitter.edge_v)
    return np.array(emitter.corner) + rng.random() * u + rng.random() * v, np.cross(u, v)
