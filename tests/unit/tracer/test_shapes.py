"""Where a ray meets each shape, and which way the normal points: values worked out by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from equilux_scenes.mesh import TriangleMesh
from equilux_scenes.transforms import matrix
from equilux_tracer import Tracer
from support.plain_phong import film_positions_of

SPHERE = {"kind": "sphere", "center": [0, 0, 0], "radius": 2}
BOX = {"kind": "box", "min": [-1, -2, -3], "max": [1, 2, 3]}
CAPPED = {"kind": "cylinder", "base": [0, 0, 0], "top": [0, 0, 4], "radius": 1}
OPEN = {**CAPPED, "capped": False}
DISC = {"kind": "disc", "center": [0, 0, 1], "normal": [0, 0, 5], "radius": 2}
CARD = {"kind": "rectangle", "corner": [0, 0, 1], "edge_u": [2, 0, 0], "edge_v": [0, 3, 0]}
PLANE = {"kind": "plane", "point": [7, 7, 1], "normal": [0, 0, 1]}
TRIANGLE = {"kind": "mesh", "vertices": [[0, 0, 1], [3, 0, 1], [0, 3, 1]], "faces": [[0, 1, 2]]}

ALONG_X, ALONG_Y, ALONG_Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
BACK_X, BACK_Y, BACK_Z = (-1, 0, 0), (0, -1, 0), (0, 0, -1)
MISS = None


@pytest.mark.parametrize(
    ("shape", "eye", "way", "depth", "normal"),
    [
        (SPHERE, (0, 0, 5), BACK_Z, 3, ALONG_Z),
        (SPHERE, (0, 0, 0), ALONG_Y, 2, BACK_Y),  # from inside, N is on the viewer's side
        (SPHERE, (0, 0, 5), ALONG_Z, MISS, None),  # behind
        (SPHERE, (0, 0, 2), ALONG_Z, MISS, None),  # the crossing at the eye itself does not count
        (SPHERE, (0, 0, 2), BACK_Z, 4, ALONG_Z),
        (BOX, (5, 0.5, 0), BACK_X, 4, ALONG_X),
        (BOX, (-5, 0.5, 0), ALONG_X, 4, BACK_X),
        (BOX, (0.5, 5, 0), BACK_Y, 3, ALONG_Y),
        (BOX, (0.5, -5, 0), ALONG_Y, 3, BACK_Y),
        (BOX, (0.5, 0, 5), BACK_Z, 2, ALONG_Z),
        (BOX, (0.5, 0, -5), ALONG_Z, 2, BACK_Z),
        (BOX, (0.5, 0, 1), ALONG_Z, 2, BACK_Z),  # from inside
        (BOX, (1, 0, 5), BACK_Z, 2, ALONG_Z),  # along an edge: it belongs to the box
        (CAPPED, (5, 0, 1), BACK_X, 4, ALONG_X),
        (CAPPED, (0.5, 0, 9), BACK_Z, 5, ALONG_Z),
        (CAPPED, (0.5, 0, -9), ALONG_Z, 9, BACK_Z),
        (CAPPED, (0.5, 0, 1), ALONG_Z, 3, BACK_Z),  # from inside, the cap
        (CAPPED, (0, 0, 1), ALONG_X, 1, BACK_X),  # from inside, the side
        (CAPPED, (1, 0, 9), BACK_Z, 5, ALONG_Z),  # along the side: the rim belongs to the cap
        (CAPPED, (5, 0, 4), BACK_X, 4, ALONG_X),  # along the cap: the rim belongs to the side
        (OPEN, (5, 0, 1), BACK_X, 4, ALONG_X),
        (OPEN, (0.5, 0, 9), BACK_Z, MISS, None),  # through both ends
        (OPEN, (0, 0, 1), ALONG_X, 1, BACK_X),
        (DISC, (1, 1, 5), BACK_Z, 4, ALONG_Z),
        (DISC, (1, 1, -5), ALONG_Z, 6, BACK_Z),
        (DISC, (2, 0, 5), BACK_Z, 4, ALONG_Z),  # the rim
        (DISC, (2.000001, 0, 5), BACK_Z, MISS, None),
        (DISC, (0, 0, 1), ALONG_Z, MISS, None),  # the eye lies in the disc
        (CARD, (1, 1, 5), BACK_Z, 4, ALONG_Z),
        (CARD, (0, 0, 5), BACK_Z, 4, ALONG_Z),  # the corner
        (CARD, (2, 3, 5), BACK_Z, 4, ALONG_Z),
        (CARD, (-1e-9, 1, 5), BACK_Z, MISS, None),
        (PLANE, (100, -50, 5), BACK_Z, 4, ALONG_Z),
        (PLANE, (100, -50, 5), ALONG_X, MISS, None),  # parallel
        (PLANE, (100, -50, 1), ALONG_X, MISS, None),  # within the plane
        (TRIANGLE, (1, 1, 5), BACK_Z, 4, ALONG_Z),
        (TRIANGLE, (1, 1, -5), ALONG_Z, 6, BACK_Z),
        (TRIANGLE, (1.5, 1.5, 5), BACK_Z, 4, ALONG_Z),  # the long edge
        (TRIANGLE, (0, 0, 5), BACK_Z, 4, ALONG_Z),  # a vertex
        (TRIANGLE, (2, 2, 5), BACK_Z, MISS, None),
        (TRIANGLE, (1, 1, 1), ALONG_Z, MISS, None),  # the eye lies in the triangle
    ],
)
def test_a_ray_meets_the_shape_where_geometry_says(make_case, shape, eye, way, depth, normal):
    target = [e + w for e, w in zip(eye, way, strict=True)]
    up = ALONG_Y if way[1] == 0 else ALONG_X
    camera = {"projection": "orthographic", "eye": list(eye), "target": target, "up": list(up), "height_m": 1}
    case = make_case(shape, camera=camera, film={"width": 1, "height": 1}, meshes=_mesh_of(shape))
    seen = Tracer(case).render(["depth", "normal", "object_id", "position"])
    if depth is MISS:
        assert seen["object_id"][0, 0] == -1, f"expected a miss, got depth {seen['depth'][0, 0]}"
        assert seen["depth"][0, 0] == math.inf
        return
    assert seen["object_id"][0, 0] == 0, f"expected depth {depth}, got a miss"
    assert seen["depth"][0, 0] == depth, f"depth: expected {depth}, got {seen['depth'][0, 0]!r}"
    np.testing.assert_array_equal(seen["normal"][0, 0], np.array(normal, float))
    np.testing.assert_array_equal(seen["position"][0, 0], np.array(eye, float) + depth * np.array(way, float))


def _mesh_of(shape):
    if shape["kind"] != "mesh":
        return None
    return {0: TriangleMesh(np.array(shape["vertices"], float), np.array(shape["faces"]))}


def test_an_oblique_sphere_is_met_at_the_root_of_the_quadratic(look):
    # |(0, 0, 5) + s (3, 0, -4)/5|² = 16  ⇔  s² − 8 s + 9 = 0
    seen = look({"kind": "sphere", "center": [0, 0, 0], "radius": 4}, eye=(0, 0, 5), target=(3, 0, 1))
    expected = 4 - math.sqrt(7)
    assert abs(seen["depth"] - expected) < 2e-16 * 4, f"expected {expected!r}, got {seen['depth']!r}"


def test_a_transformed_sphere_has_the_ellipsoids_normal(look):
    # x²/4 + y² = 1 seen from above at x = 1: y = √3/2, normal ∝ (x/4, y) = (1/4, √3/2)
    ellipsoid = {"kind": "sphere", "center": [0, 0, 0], "radius": 1, "transform": [{"scale": [2, 1, 1]}]}
    seen = look(ellipsoid, eye=(1, 5, 0), target=(1, 0, 0), up=(0, 0, 1))
    expected = np.array([0.25, math.sqrt(0.75), 0]) / math.sqrt(0.0625 + 0.75)
    np.testing.assert_allclose(seen["normal"], expected, rtol=0, atol=2.3e-16)  # two roundings of a component below 1
    np.testing.assert_allclose(seen["depth"], 5 - math.sqrt(0.75), rtol=2.3e-16)


def test_a_mirroring_transform_keeps_the_normal_on_the_viewers_side(look):
    mirrored = {"kind": "box", "min": [1, -1, -1], "max": [2, 1, 1], "transform": [{"scale": [-1, 1, 1]}]}
    seen = look(mirrored, eye=(-5, 0, 0), target=(0, 0, 0))
    assert seen["depth"] == 3
    np.testing.assert_array_equal(seen["normal"], [-1, 0, 0])


def test_the_nearest_of_several_wins(look):
    far, near = ({"kind": "sphere", "center": [0, 0, z], "radius": 1} for z in (-5, 0))
    assert look(far, near, eye=(0, 0, 5), target=(0, 0, 0))["object_id"] == 1
    assert look(near, far, eye=(0, 0, 5), target=(0, 0, 0))["object_id"] == 0


ROTATED = [{"rotate": {"axis": [1, 2, 3], "degrees": 37}}, {"translate": [0.1, 0.2, 0.3]}]
COINCIDENT = {
    "disc on its plane": (DISC, PLANE),
    "card on its plane": (CARD, PLANE),
    "box under a card": (CARD, {"kind": "box", "min": [-9, -9, -9], "max": [9, 9, 1]}),
    "cap of a cylinder in a plane": (PLANE, {"kind": "cylinder", "base": [0, 0, -1], "top": [0, 0, 1], "radius": 9}),
    "two equal spheres": (SPHERE, SPHERE),
}


@pytest.mark.parametrize("name", COINCIDENT)
@pytest.mark.parametrize("transform", [[], ROTATED], ids=["straight", "rotated"])
def test_coincident_surfaces_belong_to_the_first_in_file_order(make_case, name, transform):
    first, second = ({**shape, "transform": transform} for shape in COINCIDENT[name])
    camera = {"projection": "perspective", "eye": [0.7, 1.1, 9], "target": [0.8, 0.9, 1], "up": [0, 1, 0.1], "fov_y_deg": 9}
    for pair in ((first, second), (second, first)):
        film = {"width": 40, "height": 30}
        cases = [make_case(*objects, camera=camera, film=film) for objects in (pair[:1], pair)]
        alone, both = (Tracer(case).render(["object_id"])["object_id"] for case in cases)
        wrong = np.count_nonzero(both[alone == 0])
        assert wrong == 0, f"{name}: {wrong} of {np.count_nonzero(alone == 0)} pixels of the first went to the second"


def test_two_cards_that_share_an_edge_leave_no_crack(make_case):
    # their common edge x = 1/3 runs through pixel centres of an odd film looking straight at it
    left = {"kind": "rectangle", "corner": [-2, -2, 0], "edge_u": [2 + 1 / 3, 0, 0], "edge_v": [0, 4, 0]}
    right = {"kind": "rectangle", "corner": [1 / 3, -2, 0], "edge_u": [1, 0, 0], "edge_v": [0, 4, 0]}
    camera = {"projection": "perspective", "eye": [1 / 3, 0, 3], "target": [1 / 3, 0, 0], "fov_y_deg": 20}
    ids = Tracer(make_case(left, right, camera=camera, film={"width": 21, "height": 21})).render(["object_id"])["object_id"]
    assert (ids >= 0).all(), f"{np.count_nonzero(ids < 0)} pixels see through"


def test_no_ray_along_the_common_edge_of_two_turned_cards_sees_through(make_case):
    # the edge is common exactly, in the same frame; the rays miss it by their own rounding, on either side
    left = {"kind": "rectangle", "corner": [-2, -2, 0], "edge_u": [2.25, 0, 0], "edge_v": [0, 4, 0], "transform": ROTATED}
    right = {"kind": "rectangle", "corner": [0.25, -2, 0], "edge_u": [1.5, 0, 0.5], "edge_v": [0, 4, 0], "transform": ROTATED}
    camera = {"projection": "perspective", "eye": [0.3, 0.7, 6], "target": [0, 0, 0], "fov_y_deg": 40}
    case = make_case(left, right, camera=camera, film={"width": 100, "height": 100})
    along = np.stack([np.full(2000, 0.25), np.linspace(-1.9, 1.9, 2000), np.zeros(2000), np.ones(2000)], axis=1)
    points = (along @ matrix(case.scene.objects[0]).T)[:, :3]
    ids = Tracer(case).evaluate(film_positions_of(case, points), ["object_id"])["object_id"]
    assert set(ids) == {0, 1}, f"{np.count_nonzero(ids < 0)} of {ids.size} rays see through"


@pytest.mark.parametrize("scale", [1.0, 0.1, 1e6])
def test_an_eye_on_a_sphere_does_not_see_the_spot_it_is_on(make_case, scale):
    # (1, 2, 2) has length 3 exactly; outward nothing, inward the far side
    ball = {"kind": "sphere", "center": [0, 0, 0], "radius": 3, "transform": [{"scale": scale}]}
    eye = [scale * c for c in (1, 2, 2)]
    cameras = [{"projection": "perspective", "eye": eye, "target": [f * c for c in eye], "fov_y_deg": 60} for f in (2, 0)]
    film = {"width": 40, "height": 40}
    outward, inward = (Tracer(make_case(ball, camera=camera, film=film)).render(["depth"])["depth"] for camera in cameras)
    assert (outward == np.inf).all(), f"{np.isfinite(outward).sum()} rays meet the sphere at the eye"
    assert inward.min() > 4 * scale, f"nearest crossing at {inward.min()}"


def test_the_eye_may_be_inside_any_solid(make_case):
    camera = {"projection": "perspective", "eye": [0.1, 0.2, 0.3], "target": [1, 0.3, 0.5], "fov_y_deg": 150}
    for solid in (SPHERE, BOX, {**CAPPED, "base": [0, 0, -4]}):
        case = make_case(solid, camera=camera, film={"width": 33, "height": 17})
        seen = Tracer(case).render(["object_id", "normal", "position"])
        assert (seen["object_id"] == 0).all()
        toward_eye = np.array([0.1, 0.2, 0.3]) - seen["position"]
        assert (np.sum(seen["normal"] * toward_eye, axis=-1) > 0).all(), "a normal points away from the viewer inside"
