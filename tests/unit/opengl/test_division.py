"""Dividing triangles, and what interpolation over them leaves open."""

from __future__ import annotations

import math

import numpy as np
import pytest

from equilux_adapters._triangles import shapes
from equilux_adapters._triangles.clip import in_frame
from equilux_adapters._triangles.facing import is_watertight, towards_eye
from equilux_adapters._triangles.view import Mesh, View, look_at
from equilux_adapters.opengl.formula import Lighting, lit
from equilux_adapters.opengl.interpolation import left_open, on_surface, shown
from equilux_adapters.opengl.kit.refine import divided, drawn, on_film
from equilux_adapters.opengl.kit.stage import Light, Surface

VIEW = View(**look_at((0.3, 0.4, 3), (0, 0, 0), (0.1, 1, 0)), half_height=math.tan(math.radians(20)), width=96, height=72)
PARALLEL = View(**look_at((0.3, 0.4, 3), (0, 0, 0), (0, 1, 0)), half_height=1.5, width=96, height=72, parallel=True)
VIEWS = pytest.mark.parametrize("view", [VIEW, PARALLEL], ids=["perspective", "parallel"])


def sides(mesh: Mesh) -> np.ndarray:
    return np.concatenate([mesh.triangles[:, [k, (k + 1) % 3]] for k in range(3)])


def area(mesh: Mesh) -> float:
    a, b, c = (mesh.points[mesh.triangles[:, k]] for k in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


@VIEWS
def test_no_side_is_longer_on_the_film_than_asked_for(view):
    mesh = drawn(view, shapes.box(view, (-0.5, -0.4, -0.3), (0.4, 0.5, 0.2)), 1.5)
    film = on_film(view, mesh.points)
    longest = np.linalg.norm(np.subtract(*film[sides(mesh).T]), axis=1).max()
    assert longest <= 1.5, f"{longest} px"


@VIEWS
def test_dividing_opens_no_cracks_and_covers_what_was_there(view):
    """Of a closed surface every side still belongs to two triangles, although neighbours may be divided differently."""
    whole = shapes.box(view, (-0.5, -0.4, -0.3), (0.4, 0.5, 0.2))
    mesh = divided(view, whole, 4.0, 0.0)
    assert len(mesh.triangles) > 10 * len(whole.triangles)
    assert is_watertight(mesh.points, mesh.triangles)
    assert area(mesh) == pytest.approx(area(whole), rel=1e-12)


def test_the_two_triangles_of_a_side_halve_it_in_the_same_point():
    """Bit for bit: the order in which its ends come is not the same in both."""
    mesh = divided(VIEW, shapes.box(VIEW, (-0.5, -0.4, -0.3), (0.4, 0.5, 0.2)), 3.0, 0.0)
    unique = np.unique(mesh.points, axis=0)
    rounded = np.unique(np.round(mesh.points, 11), axis=0)
    assert len(unique) == len(rounded), f"{len(unique)} points, {len(rounded)} of them apart"


def test_normals_that_turn_are_divided_too():
    corners = np.array([[0.0, 0, 0], [0.3, 0, 0], [0, 0.3, 0]]) - VIEW.eye
    mesh = Mesh(corners, np.array([[0.0, 0, 1], [0.8, 0, 0.6], [0, 0.8, 0.6]]), np.array([[0, 1, 2]]))
    mesh = divided(VIEW, mesh, 5.0, 0.1)
    normals = mesh.normals / np.linalg.norm(mesh.normals, axis=1, keepdims=True)
    turned = np.linalg.norm(np.subtract(*normals[sides(mesh).T]), axis=1).max()
    assert turned <= 0.1, f"turned by {turned}"


@VIEWS
def test_every_pixel_of_a_surface_has_a_triangle_that_surely_shows_and_its_weights_give_the_point(view):
    mesh = drawn(view, shapes.plane(view, (0, 0, -2), (0.1, 0.2, 1)), 2.5)
    pairs = shown(view, mesh)
    assert len(np.unique(pairs.pixel)) == view.width * view.height
    points = np.einsum("nk,nkd->nd", pairs.weights, mesh.points[mesh.triangles[pairs.triangle]])
    film = on_film(view, points) * (1, -1) + (view.width / 2, view.height / 2)
    wanted = np.stack([pairs.pixel % view.width, pairs.pixel // view.width], axis=1) + 0.5
    assert np.abs(film - wanted).max() < 1e-9


@VIEWS
@pytest.mark.parametrize("axis", [None, (0.6, 0.0, 0.8)], ids=["sphere", "cylinder"])
def test_points_of_facets_are_moved_along_their_ray_onto_the_round_surface(view, axis):
    matrix = np.diag([1.2, 0.8, 1.0, 1.0])
    matrix[:3, 3] = 0.1, -0.05, 0.02
    true = {"center": [0.05, 0.02, 0.1], "radius": 0.5, "matrix": matrix.tolist()}
    rng = np.random.default_rng(5)
    outward = rng.normal(size=(200, 3))
    if axis is not None:
        true["axis"] = list(axis)
        outward -= (outward @ np.asarray(axis))[:, None] * axis
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    linear = matrix[:3, :3]
    normals = outward @ np.linalg.inv(linear)
    on_it = (np.asarray(true["center"]) + 0.5 * outward) @ linear.T + matrix[:3, 3] - view.eye
    ray = np.tile(view.forward, (200, 1)) if view.parallel else on_it / np.linalg.norm(on_it, axis=1, keepdims=True)
    front = np.sum(normals * ray, axis=1) < -0.2
    beneath = on_it[front] + 1e-3 * ray[front]
    varied = normals[front][:, None, :] + np.array([0.0, 0.01, 0.02])[:, None]
    points, found = on_surface(view, true, beneath, normals[front], varied)
    found /= np.linalg.norm(found, axis=1, keepdims=True)
    expected = normals[front] / np.linalg.norm(normals[front], axis=1, keepdims=True)
    assert np.abs(points - on_it[front]).max() < 1e-12
    assert np.abs(found - expected).max() < 1e-11


def test_the_formula_is_the_specification_s_at_a_point_worked_out_by_hand():
    """N = (0, 0, 1), L = (0.6, 0, 0.8) at distance 5, V = (0, 0, 1): N·H = 0.8/|H'| … with att = 1/(1 + 0.2·5 + 0.1·25)."""
    light = Light(
        ambient=(0.1, 0, 0), diffuse=(1, 2, 0), specular=(0, 0, 4), position=(3, 0, 2), attenuation=(1, 0.2, 0.1),
        direction=(-0.6, 0, -0.8), cutoff_deg=30, exponent=2,
    )  # fmt: skip
    surface = Surface(ambient=(0.5,) * 3, diffuse=(0.25,) * 3, specular=(0.5,) * 3, emission=(0.01, 0, 0), shininess=3)
    value = lit(np.array([[0.0, 0, -2]]), np.array([[0.0, 0, 7]]), surface, Lighting([light], np.array([0.2, 0, 0]), None))
    half = math.sqrt((1 + 0.8) / 2)
    expected = np.array([0.01 + 0.1 + (0.05 + 0.2) / 4.5, 0.4 / 4.5, 2 * half**3 / 4.5])
    assert value.radiance[0] == pytest.approx(expected, rel=1e-14)


def test_a_gate_within_rounding_of_a_corner_is_in_doubt_and_no_other():
    light, surface = Light(specular=(2, 2, 2), direction=(-1, 0, 0)), Surface(specular=(0.5,) * 3)
    points, lighting = np.tile([0.0, 0, -2], (3, 1)), Lighting([light], np.zeros(3), None)
    doubt = lit(points, np.array([[1e-9, 0, 1], [1e-3, 0, 1], [-1e-3, 0, 1]]), surface, lighting).doubt
    assert doubt[:, 0].tolist() == [1.0, 0.0, 0.0]


def test_the_bound_falls_with_the_square_of_the_triangles():
    light = Light(diffuse=(1, 1, 1), position=(0.3, 0.2, -2.0), attenuation=(0, 0, 1))
    surface, lighting = Surface(diffuse=(0.5,) * 3), Lighting([light], np.zeros(3), None)
    whole = towards_eye(VIEW, shapes.rectangle(VIEW, (-1, -1, 0), (2, 0, 0), (0, 2, 0)))
    largest = []
    for triangle_px in (8, 4, 2):
        mesh = divided(VIEW, in_frame(VIEW, whole), triangle_px, 0.0)
        largest.append(left_open(VIEW, [(mesh, surface, None)], lighting).interpolation.max())
    assert largest[0] > 2.5 * largest[1] > 2.5**2 * largest[2], f"bounds {largest}"


def test_where_a_corner_is_in_the_place_of_a_light_nothing_is_stated():
    light, surface = Light(diffuse=(1, 1, 1), position=(0, 0, -2), attenuation=(0, 0, 1)), Surface(diffuse=(0.5,) * 3)
    view = View(**look_at((0, 0, 2), (0, 0, 0), (0, 1, 0)), half_height=0.5, width=33, height=33)
    corners = np.array([[0.0, 0, -2], [1, 0, -2], [0, 1, -2], [-1, -1, -2]])
    mesh = Mesh(corners, np.tile([0.0, 0, 1], (4, 1)), np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1]]))
    bound = np.stack(left_open(view, [(mesh, surface, None)], Lighting([light], np.zeros(3), None)))
    assert np.isfinite(bound).all(), f"{(~np.isfinite(bound)).sum()} not finite"
