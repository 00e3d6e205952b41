"""Triangle meshes: no leaks, normals as the model says, ties between triangles."""

from __future__ import annotations

import math

import numpy as np
import pytest

from equilux_scenes.mesh import TriangleMesh
from equilux_tracer import Tracer, TracerError
from support.plain_phong import film_positions_of

MESH = {"kind": "mesh", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": [[0, 1, 2]]}  # its arrays are replaced
PYRAMID = TriangleMesh(
    np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0], [0, 0, 1]], float),
    np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]),
)


def closed_ball(around: int, along: int, wobble: float = 0.0) -> TriangleMesh:
    """A ball of triangles with a fan at each pole; `wobble` makes it bumpy. Every edge is shared by two triangles."""
    rng = np.random.default_rng(7)
    theta = np.pi * np.arange(1, along) / along
    phi = 2 * np.pi * np.arange(around) / around
    ring = np.stack(
        [np.outer(np.sin(theta), np.cos(phi)), np.outer(np.sin(theta), np.sin(phi)), np.outer(np.cos(theta), np.ones(around))], -1
    )
    points = np.concatenate([[[0, 0, 1]], ring.reshape(-1, 3), [[0, 0, -1]]])
    points *= 1 + wobble * rng.uniform(-1, 1, (len(points), 1))
    faces = [(0, 1 + k, 1 + (k + 1) % around) for k in range(around)]
    for j in range(along - 2):
        for k in range(around):
            a, b = 1 + j * around + k, 1 + j * around + (k + 1) % around
            faces += [(a, a + around, b + around), (a, b + around, b)]
    last = len(points) - 1
    faces += [(last, last - around + (k + 1) % around, last - around + k) for k in range(around)]
    return TriangleMesh(points, np.array(faces))


@pytest.mark.parametrize("eye", [[0, 0, 4], [0, 0, -4], [3, 0.7, 0], [0.123, -2.1, 1.3], [0, 0, 0], [0.1, 0.2, -0.3]])
def test_no_ray_through_an_edge_or_a_vertex_of_a_closed_mesh_leaks(make_case, eye):
    mesh = closed_ball(around=48, along=24, wobble=0.02)
    target = [0, 0, 0] if any(eye) else [0.2, 0.9, 0.4]
    camera = {"projection": "perspective", "eye": eye, "target": target, "up": [0.3, 1, 0.2], "fov_y_deg": 60}
    case = make_case(MESH, camera=camera, film={"width": 64, "height": 64}, meshes={0: mesh})
    # interior samples: vertices, and points on all edges at odd places; seen from inside, whatever lies ahead
    corners = mesh.vertices[mesh.faces]
    following = np.roll(corners, -1, axis=1)
    along = np.concatenate([mesh.vertices] + [((1 - f) * corners + f * following).reshape(-1, 3) for f in (0.5, 1 / 3, 0.99999)])
    forward = np.subtract(target, eye) / np.linalg.norm(np.subtract(target, eye))
    inside = not any(eye) or np.linalg.norm(eye) < 0.9
    depth = (along - eye) @ forward
    distance = np.linalg.norm(np.cross(along - eye, forward), axis=1)
    # from outside, keep clear of the silhouette: a ball of radius 0.95 is inside the wobbly one
    off_axis = np.linalg.norm(np.cross(_unit(along - eye), _unit(-np.array(eye, float) if not inside else forward)), axis=1)
    keep = depth > 0.1 if inside else (depth > 0) & (off_axis < 0.95 / np.linalg.norm(eye))
    assert np.count_nonzero(keep) > 500, distance.max()
    ids = Tracer(case).evaluate(film_positions_of(case, along[keep]), ["object_id"])["object_id"]
    assert (ids == 0).all(), f"{np.count_nonzero(ids < 0)} of {ids.size} rays slip through"


def _unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


@pytest.mark.parametrize("projection", ["perspective", "orthographic"])
def test_rays_exactly_through_vertices_and_edges_of_a_grid_hit(make_case, projection):
    # a grid whose vertices fall on pixel centres, in coordinates that are not dyadic
    n, step = 12, 0.1
    x, y = np.meshgrid(np.arange(-n, n + 1) * step, np.arange(-n, n + 1) * step)
    parallel = projection == "orthographic"
    points = np.stack([x.ravel(), y.ravel(), 0.3 * parallel * np.sin(5 * x.ravel())], axis=1)
    w = 2 * n + 1
    first = np.arange(w * (w - 1)).reshape(w - 1, w)[:, :-1].ravel()
    faces = np.concatenate([first[:, None] + corners for corners in ([0, 1, w + 1], [0, w + 1, w])])
    size = {"height_m": 21 * step} if parallel else {"fov_y_deg": 2 * math.degrees(math.atan(10.5 * step / 3))}
    camera = {"projection": projection, "eye": [0, 0, 3], "target": [0, 0, 0], **size}
    case = make_case(MESH, camera=camera, film={"width": 21, "height": 21}, meshes={0: TriangleMesh(points, faces)})
    ids = Tracer(case).render(["object_id"])["object_id"]
    assert (ids == 0).all(), f"{np.count_nonzero(ids < 0)} of {ids.size} rays slip through"


def test_a_flat_mesh_has_its_face_normals(make_case):
    # the film is 1 m high: (0.5, 0.4) is at x = −0.25, y = 0.3, on face 2; (0.4, 0.5) at x = −0.3, y = 0.25, on face 3
    case = make_case(MESH, film={"width": 2, "height": 2}, camera=_down(1.0), meshes={0: PYRAMID})
    seen = Tracer(case).evaluate([[0.5, 0.4], [0.4, 0.5]], ["normal", "depth"])
    np.testing.assert_allclose(seen["normal"], np.array([[0, 1, 1], [-1, 0, 1]]) / math.sqrt(2), atol=1.2e-16)
    np.testing.assert_allclose(seen["depth"], 5 - np.array([0.7, 0.7]), rtol=2.3e-16)


def _down(height):
    return {"projection": "orthographic", "eye": [0, 0, 5], "target": [0, 0, 0], "height_m": height}


def test_a_smooth_mesh_interpolates_its_vertex_normals(make_case):
    normals = _unit(np.array([[0, 0, 1], [1, 0, 1], [0, 1, 1]], float))
    mesh = TriangleMesh(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], float), np.array([[0, 1, 2]]), normals)
    case = make_case({**MESH, "normals": "smooth"}, camera=_down(8.0), meshes={0: mesh})
    seen = Tracer(case).evaluate([[4.25, 3.5], [4.5, 3.75]], ["normal"])["normal"]  # x, y = ¼, ½ and ½, ¼
    weights = np.array([[0.25, 0.25, 0.5], [0.25, 0.5, 0.25]])
    np.testing.assert_allclose(seen, _unit(weights @ normals), atol=2.3e-16)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("from_below", [False, True])
def test_the_shading_normal_is_on_the_geometric_normals_viewer_side(make_case, sign, from_below):
    normals = sign * _unit(np.array([[0.3, 0, 1], [1, 0, 1], [0, 1, 1]], float))
    mesh = TriangleMesh(np.array([[-9, -9, 0], [9, -9, 0], [0, 9, 0]], float), np.array([[0, 1, 2]]), normals)
    camera = {"projection": "orthographic", "eye": [0, 0, -5 if from_below else 5], "target": [0, 0, 0], "height_m": 1}
    seen = Tracer(make_case({**MESH, "normals": "smooth"}, camera=camera, meshes={0: mesh})).render(["normal"])["normal"]
    assert (np.sign(seen[..., 2]) == (-1 if from_below else 1)).all()


def test_normals_go_by_the_inverse_transpose(make_case):
    # a slope z = x squeezed by 4 along z is z = x/4, normal ∝ (−1, 0, 4); the smooth normal, equal at all vertices, goes along
    points = np.array([[-9, -9, -9], [9, -9, 9], [0, 9, 0]], float)
    normals = np.tile(_unit(np.array([-1, 0, 1.0])), (3, 1))
    transform = [{"scale": [1, 1, 0.25]}]
    for given in (None, normals):
        mesh = TriangleMesh(points, np.array([[0, 1, 2]]), given)
        obj = {**MESH, "normals": "flat" if given is None else "smooth", "transform": transform}
        seen = Tracer(make_case(obj, camera=_down(1.0), meshes={0: mesh})).render(["normal"])["normal"]
        expected = np.broadcast_to(np.array([-1, 0, 4]) / math.sqrt(17), seen.shape)
        np.testing.assert_allclose(seen, expected, atol=2.3e-16)


def test_coincident_triangles_belong_to_the_first(make_case):
    twice = TriangleMesh(PYRAMID.vertices, np.concatenate([PYRAMID.faces, PYRAMID.faces]))
    case = make_case(MESH, MESH, camera=_down(3.0), meshes={0: twice, 1: PYRAMID})
    once = make_case(MESH, camera=_down(3.0), meshes={0: PYRAMID})
    doubled, single = (Tracer(c).render(["signature", "object_id"]) for c in (case, once))
    np.testing.assert_array_equal(doubled["object_id"], single["object_id"])
    np.testing.assert_array_equal(doubled["signature"], single["signature"])


def test_degenerate_triangles_are_no_obstacle(make_case):
    points = np.concatenate([PYRAMID.vertices, [[0, 0, 3], [0, 0, 3], [1, 1, 3], [2, 2, 3]]])
    faces = np.concatenate([[[5, 6, 7], [5, 7, 8], [5, 5, 5]], PYRAMID.faces])
    with_slivers = make_case(MESH, camera=_down(3.0), meshes={0: TriangleMesh(points, faces)})
    without = make_case(MESH, camera=_down(3.0), meshes={0: PYRAMID})
    a, b = (Tracer(c).render(["depth"])["depth"] for c in (with_slivers, without))
    np.testing.assert_array_equal(a, b)


def test_an_empty_mesh_is_not_there(make_case):
    empty = TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), np.int64))
    assert (Tracer(make_case(MESH, meshes={0: empty})).render(["object_id"])["object_id"] == -1).all()


def test_a_face_without_its_vertex_is_refused(make_case):
    broken = TriangleMesh(PYRAMID.vertices, np.array([[0, 1, 5]]))
    with pytest.raises(TracerError, match="mesh face 0: vertex 5 does not exist"):
        Tracer(make_case(MESH, meshes={0: broken}))
