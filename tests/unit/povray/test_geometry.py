"""Distances to surfaces and the bounds of what float32 meshes lose: against brute force."""

from __future__ import annotations

import numpy as np
import pytest

from equilux_adapters._bounds import distances
from equilux_adapters.povray.meshes import LEAST_SMOOTH, mesh_accuracy, smooth_normals, stuck_faces
from equilux_scenes.mesh import TriangleMesh
from support.povray import case_of_text
from support.random_scenes import case_of, changed, random_spec

SURFACES = {
    "sphere": "kind: sphere, center: [0, 0, 0], radius: 2",
    "plane": "kind: plane, point: [0, -1, 0], normal: [0, 2, 0]",
    "box": "kind: box, min: [-1, -1, -1], max: [1, 1, 1]",
    "disc": "kind: disc, center: [0, 0, 0], normal: [0, 0, 3], radius: 1",
    "rectangle": "kind: rectangle, corner: [0, 0, 0], edge_u: [2, 0, 0], edge_v: [0, 1, 0]",
    "capped cylinder": "kind: cylinder, base: [0, 0, 0], top: [0, 2, 0], radius: 1",
    "open cylinder": "kind: cylinder, base: [0, 0, 0], top: [0, 2, 0], radius: 1, capped: false",
    "mesh": "kind: mesh, vertices: [[0, 0, 0], [4, 0, 0], [0, 4, 0]], faces: [[0, 1, 2]]",
}
POINTS = {  # name: [(point, distance by hand)]
    "sphere": [((0, 0, 5), 3), ((0, 0.5, 0), 1.5)],
    "plane": [((7, 3, 2), 4), ((0, -1, 0), 0)],
    "box": [((0, 0, 0.25), 0.75), ((2, 2, 0), np.sqrt(2))],
    "disc": [((0, 0, 2), 2), ((4, 0, 4), 5)],
    "rectangle": [((1, 0.5, 3), 3), ((5, 0.5, 4), 5)],
    "capped cylinder": [((0, 1.9, 0), 0.1), ((4, 6, 0), 5)],
    "open cylinder": [((0, 1.9, 0), 1), ((0, 5, 0), np.sqrt(10))],
    "mesh": [((1, 1, 3), 3), ((-3, -4, 0), 5), ((4, 4, 0), np.sqrt(8))],
}


def case_with(shape: str):
    camera = "camera: {projection: perspective, eye: [0, 0, 30], target: [0, 0, 0], fov_y_deg: 30}, film: {width: 4, height: 4}"
    objects = "materials: {m: {diffuse: 1}}, objects: [{" + shape + ", material: m}]"
    return case_of_text("{equilux: 1, name: one, model: phong, " + camera + ", " + objects + "}")


@pytest.mark.parametrize("name", SURFACES)
def test_the_distance_to_a_surface_is_the_one_by_hand(name):
    for point, expected in POINTS[name]:
        got = distances.nearest(case_with(SURFACES[name]), 0, np.array(point, dtype=float))
        assert got == pytest.approx(expected, abs=1e-12), f"{name} from {point}: {got}, by hand {expected}"


def test_a_transform_keeps_the_distance_a_lower_bound():
    case = case_with(SURFACES["sphere"] + ", transform: [{scale: [1, 2, 3]}, {translate: [0, 0, 1]}]")
    # the ellipsoid reaches z = 1 + 6
    got = distances.nearest(case, 0, np.array([0.0, 0.0, 10.0]))
    assert 0 < got <= 3.0, f"bound {got}, distance 3"


def test_every_visible_point_lies_within_the_hull():
    for seed in range(10):
        spec = random_spec(seed, shapes=("sphere", "box", "disc", "rectangle", "cylinder"), objects=(1, 1))
        hull = distances.extremes(case_of(changed(spec)), 0)
        assert hull is not None
        assert np.isfinite(hull).all()


def sphere_mesh(rings: int, centre=(0.0, 0.0, 0.0), smooth: bool = True) -> TriangleMesh:
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, 2 * rings), np.linspace(0.1, np.pi - 0.1, rings))
    points = np.stack([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)], axis=-1).reshape(-1, 3)
    index = np.arange(len(points)).reshape(rings, 2 * rings)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]
    faces = np.concatenate([np.stack(t, axis=-1).reshape(-1, 3) for t in ((a, c, b), (b, c, d))])
    return TriangleMesh(points + np.array(centre), faces, points if smooth else None)


def test_a_mesh_far_from_its_origin_is_stored_as_well_as_one_at_it():
    near, far = (mesh_accuracy(sphere_mesh(20, (shift, 0, 0)), np.eye(4)) for shift in (0.0, 1e6))
    assert far.position_m == pytest.approx(near.position_m, rel=0.2)


@pytest.mark.parametrize("smooth", [True, False])
def test_float32_storage_costs_a_smooth_sphere_its_last_digits_only(smooth):
    accuracy = mesh_accuracy(sphere_mesh(40, smooth=smooth), np.eye(4))
    assert 2**-24 < accuracy.normal < 1e-5
    assert 2**-26 < accuracy.position_m < 1e-6


def flat_triangle_with(normal) -> TriangleMesh:
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    return TriangleMesh(vertices, np.array([[0, 1, 2]]), np.array([normal] * 3) / np.linalg.norm(normal))


def test_equal_normals_that_are_not_the_face_normal_are_kept_from_being_taken_for_flat():
    mesh = flat_triangle_with((1.0, 0.0, 1.0))
    assert stuck_faces(mesh).all()
    normals, indices = smooth_normals(mesh)
    at_corners = normals[indices[0]].astype(float)
    apart = np.linalg.norm(at_corners[0] - at_corners[1])
    assert 1.0e-5 < apart < 1.6e-5, f"corner normals are {apart} apart"
    assert LEAST_SMOOTH <= mesh_accuracy(mesh, np.eye(4)).normal < 2 * LEAST_SMOOTH


def test_equal_normals_that_are_the_face_normal_stay_as_they_are():
    mesh = flat_triangle_with((0.0, 0.0, 1.0))
    assert not stuck_faces(mesh).any()
    assert smooth_normals(mesh)[1] is mesh.faces
