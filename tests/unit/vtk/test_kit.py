"""The geometry that scripts make, before VTK sees it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from equilux_adapters._triangles import shapes
from equilux_adapters._triangles.bounds import Bounds, view_of
from equilux_adapters._triangles.clip import cut, in_frame
from equilux_adapters._triangles.depth import clipping_range, set_back
from equilux_adapters._triangles.facing import faces_eye, is_watertight, starts_inside, towards_eye
from equilux_adapters._triangles.view import Mesh, View, look_at, seen_from
from equilux_adapters.vtk.geometry import bounds_of
from equilux_adapters.vtk.knobs import VtkKnobs
from support.random_scenes import case_of, random_spec

VIEW = View(**look_at((0.3, 0.4, 3), (0, 0, 0), (0.1, 1, 0)), half_height=math.tan(math.radians(20)), width=96, height=72)
PARALLEL = View(**look_at((0.3, 0.4, 3), (0, 0, 0), (0, 1, 0)), half_height=1.5, width=96, height=72, parallel=True)


def area(mesh: Mesh) -> float:
    a, b, c = (mesh.points[mesh.triangles[:, k]] for k in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def edges(mesh: Mesh) -> np.ndarray:
    """(…, 6): end points of every edge, as numbers, so that equal points in two places are one."""
    points = mesh.points[mesh.triangles]
    return np.concatenate([np.concatenate([points[:, k], points[:, (k + 1) % 3]], axis=1) for k in range(3)])


def test_the_axes_of_a_view_are_right_handed_and_unit():
    axes = np.stack([VIEW.right, VIEW.up, -VIEW.forward])
    assert np.allclose(axes @ axes.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(axes) == pytest.approx(1, abs=1e-14)


@pytest.mark.parametrize("view", [VIEW, PARALLEL], ids=["perspective", "parallel"])
def test_corners_of_a_sphere_lie_on_it_with_outward_normals(view):
    center = np.array([0.2, -0.1, 0.4])
    mesh = shapes.sphere(view, center, 0.5, segments=64)
    out = mesh.points + view.eye - center
    assert np.allclose(np.linalg.norm(out, axis=1), 0.5, atol=1e-13)
    assert np.allclose(mesh.normals, out / 0.5, atol=1e-12)


def test_the_facets_of_a_sphere_that_is_seen_from_inside_enclose_it():
    mesh = shapes.sphere(VIEW, (0.3, 0.4, 2.5), 2.0, segments=48)
    assert is_watertight(np.round(mesh.points, 12), mesh.triangles)
    assert starts_inside(VIEW, mesh)
    assert area(mesh) == pytest.approx(4 * math.pi * 4, rel=0.01)


def test_neighbouring_facets_of_a_sphere_share_their_edges():
    mesh = shapes.sphere(VIEW, (0, 0, 0), 0.5, segments=64)
    sides = np.sort(np.concatenate([mesh.triangles[:, [0, 1]], mesh.triangles[:, [1, 2]], mesh.triangles[:, [2, 0]]]), axis=1)
    pairs, count = np.unique(sides, axis=0, return_counts=True)
    assert set(count) == {1, 2}
    # where the sphere ends for this eye the open edges run round in a ring
    _, ends = np.unique(pairs[count == 1], return_counts=True)
    assert set(ends) == {2}


@pytest.mark.parametrize("seed", range(6))
def test_facets_depart_from_the_sphere_by_no_more_than_is_stated(seed):
    """A ray meets facet and sphere: how far apart are the points and the normals, away from the rim?"""
    spec = random_spec(seed, shapes=("sphere",), objects=(1, 1), lights=(1, 1), transforms=False, film=(64, 48))
    case = case_of(spec)
    view, knobs = view_of(case.scene.camera, case.scene.film), VtkKnobs(tessellation=32)
    bounds, sphere = bounds_of(case, view, 0, knobs, 10.0), case.scene.objects[0]
    mesh = in_frame(view, shapes.sphere(view, sphere.center, sphere.radius, 32))
    rng = np.random.default_rng(seed)
    weights = rng.dirichlet((1, 1, 1), len(mesh.triangles))
    facet = np.einsum("ij,ijk->ik", weights, mesh.points[mesh.triangles])
    normal = np.einsum("ij,ijk->ik", weights, mesh.normals[mesh.triangles])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    ray = facet / np.linalg.norm(facet, axis=1, keepdims=True)
    to_center = np.asarray(sphere.center) - view.eye
    along = ray @ to_center
    root = along**2 - to_center @ to_center + sphere.radius**2
    hit = root > 0
    nearer = np.where(along > np.sqrt(np.maximum(root, 0)), -1.0, 1.0)
    point = ray * (along + nearer * np.sqrt(np.maximum(root, 0)))[:, None]
    true_normal = (point - to_center) / sphere.radius
    rim = np.abs(np.sum(true_normal * ray, axis=1)) * sphere.radius  # half the chord inside: 0 at the rim
    film = rim**2 / (2 * sphere.radius) * view.pixels_per_unit / np.linalg.norm(facet, axis=1)
    inner = hit & (film > 2 * bounds.film_px)
    off_normal = np.linalg.norm(normal - true_normal, axis=1)[inner]
    off_point = np.linalg.norm(point - facet, axis=1)[inner]
    assert inner.sum() > 100
    assert off_normal.max() <= bounds.normal, f"normal off by {off_normal.max()}, stated {bounds.normal}"
    assert off_normal.max() >= bounds.normal / 10, f"normal off by {off_normal.max()}, stated {bounds.normal}"
    assert off_point.max() <= bounds.position_m, f"position off by {off_point.max()}, stated {bounds.position_m}"


def test_finer_tessellation_states_less():
    case = case_of(random_spec(3, shapes=("sphere", "cylinder"), objects=(2, 2), film=(640, 480)))
    view = view_of(case.scene.camera, case.scene.film)
    stated = [bounds_of(case, view, 0, VtkKnobs(tessellation=n), 10.0) for n in (16, 64, 256)]
    assert stated[0].normal > 4 * stated[1].normal > 8 * stated[2].normal > 0, stated


def test_boxes_rectangles_and_planes_state_no_facets():
    case = case_of(random_spec(1, shapes=("rectangle",), objects=(1, 1), lights=(1, 1), light_kinds=("directional",)))
    view = view_of(case.scene.camera, case.scene.film)
    assert bounds_of(case, view, 0, VtkKnobs(tessellation=8), 0.0) == Bounds()


def test_cutting_keeps_the_area_and_makes_no_cracks():
    mesh = shapes.sphere(VIEW, (0.3, 0.4, 2.5), 2.0, segments=32)  # closed: seen from inside
    level = mesh.points @ np.array([0.3, 0.5, 0.1]) - 0.2
    (above, inner), (below, outer) = (cut(mesh.points, mesh.triangles, sign * level) for sign in (1, -1))
    whole = area(Mesh(above, above, inner)) + area(Mesh(below, below, outer))
    assert whole == pytest.approx(area(mesh), rel=1e-12)
    sides = {tuple(side) for side in edges(Mesh(above, above, inner))}
    alone = np.array([side for side in sides if (*side[3:], *side[:3]) not in sides])
    off_cut = np.abs(alone.reshape(-1, 3) @ np.array([0.3, 0.5, 0.1]) - 0.2)
    assert len(alone) > 10
    assert off_cut.max() < 1e-12, f"an open edge {off_cut.max()} away from the cut"


@pytest.mark.parametrize("view", [VIEW, PARALLEL], ids=["perspective", "parallel"])
def test_what_is_left_in_the_frame_is_inside_it_and_in_front_of_the_eye(view):
    mesh = in_frame(view, shapes.rectangle(view, (-50, -0.5, 50), (100, 0, 0), (0, 0, -100)))
    x, y, depth = seen_from(view, mesh.points).T
    reach = np.ones_like(depth) if view.parallel else depth
    assert len(mesh.triangles) > 0
    assert (depth >= 0).all()
    assert (np.abs(x) <= 1.1 * view.half_width * reach * (1 + 1e-9)).all()
    assert (np.abs(y) <= 1.1 * view.half_height * reach * (1 + 1e-9)).all()


def covered(view: View, mesh: Mesh) -> np.ndarray:
    """(height, width) bool: which pixel centres a mesh covers."""
    x, y, depth = seen_from(view, mesh.points).T
    over = np.ones_like(depth) if view.parallel else depth
    film = np.stack([x / over, y / over], axis=1)[mesh.triangles]
    columns = ((2 * np.arange(view.width) + 1) / view.width - 1) * view.half_width
    rows = (1 - (2 * np.arange(view.height) + 1) / view.height) * view.half_height
    found = np.zeros((view.height, view.width), dtype=bool)
    for a, b, c in film:
        side = [
            (q[0] - p[0]) * (rows[:, None] - p[1]) - (q[1] - p[1]) * (columns[None, :] - p[0])
            for p, q in ((a, b), (b, c), (c, a))
        ]
        found |= np.all(np.array(side) >= -1e-12, axis=0) | np.all(np.array(side) <= 1e-12, axis=0)
    return found


@pytest.mark.parametrize("normal", [(0, 1, 0), (0.2, 1, 0), (0, -1, 0), (0.3, 0.2, 1), (0, 1, 0.02)])
@pytest.mark.parametrize("view", [VIEW, PARALLEL], ids=["perspective", "parallel"])
def test_a_plane_covers_every_pixel_centre_that_sees_it_and_no_other(view, normal):
    point, n = np.array([0, -0.5, 0]), np.asarray(normal, dtype=float)
    mesh = shapes.plane(view, point, n)
    columns = ((2 * np.arange(view.width) + 1) / view.width - 1) * view.half_width
    rows = (1 - (2 * np.arange(view.height) + 1) / view.height) * view.half_height
    aside = columns[None, :, None] * view.right + rows[:, None, None] * view.up
    origin, ray = (view.eye + aside, view.forward) if view.parallel else (view.eye, view.forward + aside)
    with np.errstate(divide="ignore"):
        distance = ((point - origin) @ n) / (ray @ n)
    expected = np.broadcast_to((distance > 0) & np.isfinite(distance), (view.height, view.width))
    assert np.array_equal(covered(view, mesh), expected)
    assert np.max(np.abs((mesh.points + view.eye - point) @ n), initial=0) <= 1e-12 * np.max(np.abs(mesh.points), initial=1)


def test_a_plane_through_the_eye_is_not_seen():
    assert len(shapes.plane(VIEW, VIEW.eye, (0, 1, 0)).triangles) == 0


def test_triangles_are_wound_counter_clockwise_seen_from_their_normals():
    mirror = np.diag([-1.0, 2.0, 1.0, 1.0])
    for matrix in (None, mirror):
        for made in (
            shapes.sphere(VIEW, (0, 0, 0), 0.5, 32, matrix),
            shapes.box(VIEW, (-0.5, -0.4, -0.3), (0.2, 0.3, 0.4), matrix),
            shapes.cylinder(VIEW, (0, -0.5, 0), (0.2, 0.5, 0.1), 0.3, True, 32, matrix),
            shapes.disc(VIEW, (0, 0, 0), (0.1, 1, 0.3), 0.5, 32, matrix),
        ):
            a, b, c = (made.points[made.triangles[:, k]] for k in range(3))
            agree = np.einsum("ij,ij->i", np.cross(b - a, c - a), made.normals[made.triangles].sum(axis=1))
            assert (agree > 0).all()


def test_after_turning_every_triangle_shows_its_front():
    for made in (shapes.cylinder(VIEW, (0, -0.5, 0), (0, 0.5, 0), 0.3, False, 32), shapes.box(VIEW, (-4, -4, -4), (4, 4, 4))):
        turned = towards_eye(VIEW, made)
        assert faces_eye(VIEW, turned).all()
        assert len(turned.triangles) == len(made.triangles)


def test_a_box_hides_its_back_from_outside_and_shows_it_from_inside():
    outside = towards_eye(VIEW, shapes.box(VIEW, (-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)))
    inside = towards_eye(VIEW, shapes.box(VIEW, (-4, -4, -4), (4, 4, 4)))
    assert len(outside.triangles) <= 6
    assert len(inside.triangles) == 12


def test_a_mesh_with_a_hole_is_not_watertight():
    made = shapes.box(VIEW, (0, 0, 0), (1, 1, 1))
    assert is_watertight(made.points, made.triangles)
    assert not is_watertight(made.points, made.triangles[1:])


@pytest.mark.parametrize("view", [VIEW, PARALLEL], ids=["perspective", "parallel"])
def test_setting_back_keeps_the_place_on_the_film(view):
    card = shapes.rectangle(view, (-0.5, -0.5, 0), (1, 0, 0), (0, 1, 0.3))
    near, far = set_back(view, [card, card], (0, 3))
    x, y, depth = seen_from(view, near.points).T
    moved_x, moved_y, moved_depth = seen_from(view, far.points).T
    over, moved_over = (1.0, 1.0) if view.parallel else (depth, moved_depth)
    assert (moved_depth > depth).all()
    assert np.allclose([moved_x / moved_over, moved_y / moved_over], [x / over, y / over], rtol=0, atol=1e-15)


def test_the_clipping_range_holds_everything_and_little_else():
    mesh = shapes.box(VIEW, (-0.5, -0.5, -0.5), (0.5, 0.5, 0.5))
    near, far = clipping_range(VIEW, [mesh])
    depth = mesh.points @ VIEW.forward
    assert 0.99 * depth.min() < near < depth.min() < depth.max() < far < 1.01 * depth.max()
