"""Meshes in POV-Ray: right where the model and the renderer mean the same, and wrong exactly where Q19 says."""

from __future__ import annotations

import json

import numpy as np
import pytest

from equilux_scenes.case import Case
from equilux_tracer import Tracer
from support import plain_phong, plain_raytraced
from support.edges import LEAST_DELTA_PX, on_edge
from support.povray import Run, bound, case_of_text, pixel_centres, run, term
from support.wrong_sides import wrong_sides

SCENE = """
equilux: 1
name: mesh
model: phong
camera: {{projection: perspective, eye: [1.5, 2, 2.5], target: [0, 0, 0], fov_y_deg: 35}}
film: {{width: 64, height: 48}}
lights:
  key: {{kind: point, position: [2, 3, -1], intensity: 12}}
  fill: {{kind: directional, direction: [-1, -1, -0.3], irradiance: [0.3, 0.2, 0.4]}}
materials: {{m: {{diffuse: [0.5, 0.3, 0.2], specular: 0.3, exponent: 40}}}}
objects: [{{kind: mesh, normals: {normals}, {geometry}, material: m{transform}}}]
"""
TURNED = ", transform: [{scale: [1, 0.7, 1.3]}, {rotate: {axis: [1, 2, 0.5], degrees: 20}}, {translate: [0.05, 0, -0.1]}]"


def hills(cells: int = 10) -> str:
    """A wavy sheet, seen from above: no interpolated normal faces away from the viewer."""
    x, z = (axis.ravel() for axis in np.meshgrid(np.linspace(-1, 1, cells + 1), np.linspace(-1, 1, cells + 1)))
    y = 0.1 * np.sin(3 * x) * np.cos(2 * z)
    return _geometry(np.stack([x, y, z], axis=1), _grid(cells, cells))


def ball(rings: int = 9) -> str:
    """A coarse sphere without its poles: at its rim interpolated normals do face away from the viewer."""
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, 2 * rings + 1), np.linspace(0.2, np.pi - 0.2, rings + 1))
    points = 0.7 * np.stack([np.sin(v) * np.sin(u), np.cos(v), np.sin(v) * np.cos(u)], axis=-1).reshape(-1, 3)
    return _geometry(points, _grid(rings, 2 * rings), points / 0.7)


def _grid(rows: int, columns: int) -> np.ndarray:
    index = np.arange((rows + 1) * (columns + 1)).reshape(rows + 1, columns + 1)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]
    return np.concatenate([np.stack(corners, axis=-1).reshape(-1, 3) for corners in ((a, c, b), (b, c, d))])


def _geometry(vertices: np.ndarray, faces: np.ndarray, normals: np.ndarray | None = None) -> str:
    given = "" if normals is None else f", vertex_normals: {json.dumps(normals.tolist())}"
    return f"vertices: {json.dumps(vertices.tolist())}, faces: {json.dumps(faces.tolist())}{given}"


def mesh_case(normals: str, geometry: str, transform: str = "") -> Case:
    return case_of_text(SCENE.format(normals=normals, geometry=geometry, transform=transform))


def disagreeing(result: Run) -> tuple[np.ndarray, np.ndarray]:
    """Pixels (n, 2: y, x) off edges that are farther from the truth than the budget allows, and the truth (h, w, 3)."""
    film, tracer = result.case.scene.film, Tracer(result.case)
    truth = plain_phong.radiance(result.case, pixel_centres(result.case))[0].reshape(film.height, film.width, 3)
    storage = term(result.budget, "mesh-storage")
    allowed = bound(result.budget, truth) + np.asarray(tracer.sensitivity(storage.normal[0], storage.position_m[0]))
    wrong = np.argwhere((np.abs(result.image - truth) > allowed).any(axis=2))
    if not len(wrong):
        return wrong, truth
    return wrong[~on_edge(tracer, wrong[:, ::-1] + 0.5, max(LEAST_DELTA_PX, result.budget.film_px))], truth


@pytest.mark.parametrize("transform", ["", TURNED])
@pytest.mark.parametrize(("normals", "geometry"), [("smooth", hills()), ("flat", hills()), ("flat", ball())])
def test_a_mesh_agrees_within_its_budget(normals, geometry, transform, tmp_path):
    result = run(mesh_case(normals, geometry, transform), tmp_path)
    wrong, truth = disagreeing(result)
    assert not len(wrong), "\n".join(f"({x}, {y}): povray {result.image[y, x]}, truth {truth[y, x]}" for y, x in wrong[:5])


def test_only_interpolated_normals_that_face_away_are_shaded_otherwise_and_then_turned_over(tmp_path):
    # Q19: the model keeps N on the side of the face's normal, POV-Ray turns N to the viewer
    case = mesh_case("smooth", ball())
    result = run(case, tmp_path)
    wrong, truth = disagreeing(result)
    assert len(wrong) > 0, "no silhouette pixel shows the rule"
    channels = Tracer(case).render(["normal", "position"])
    for y, x in wrong:
        normal, point = channels["normal"][y, x][None], channels["position"][y, x][None]
        to_viewer = np.array(case.scene.camera.eye) - point
        to_viewer /= np.linalg.norm(to_viewer)
        assert (normal * to_viewer).sum() < 0, f"({x}, {y}): povray {result.image[y, x]}, truth {truth[y, x]}, N faces the viewer"
        turned = plain_phong.shade(case, case.scene.materials["m"], point, -normal, to_viewer)[0]
        assert result.image[y, x] == pytest.approx(turned, rel=2e-4, abs=2e-6), f"({x}, {y}): N turned over gives {turned}"


def test_three_equal_normals_are_interpolated_not_taken_for_flat(tmp_path):
    bent = "vertex_normals: [[0.3, 1, 0], [0.3, 1, 0], [0.3, 1, 0]]"
    result = run(mesh_case("smooth", f"vertices: [[-1, 0, 1], [1, 0, 1], [0, 0, -1]], faces: [[0, 1, 2]], {bent}"), tmp_path)
    wrong, truth = disagreeing(result)
    assert not len(wrong), "\n".join(f"({x}, {y}): povray {result.image[y, x]}, truth {truth[y, x]}" for y, x in wrong[:5])


GLASS = """
equilux: 1
name: mesh
model: raytraced
camera: {{projection: perspective, eye: [1.5, 2, 2.5], target: [0, 0, 0], fov_y_deg: 30}}
film: {{width: 28, height: 21}}
background: [0.1, 0.2, 0.4]
recursion_limit: 3
lights: {{key: {{kind: point, position: [2, 3, -1], intensity: 12}}}}
materials:
  glass: {{transparency: 0.9, transmission: [0.9, 1, 0.8], ior: 1.52, reflection: 0.8, emission: 0.01}}
  floor: {{diffuse: [0.5, 0.3, 0.2], emission: 0.02}}
objects:
  - {{kind: mesh, normals: {normals}, {geometry}, material: glass}}
  - {{kind: rectangle, corner: [-1, -0.8, -1.5], edge_u: [0, 0, 3], edge_v: [2, 0, 0], material: floor}}
"""


def closed_ball() -> str:
    """An octahedron whose faces are divided twice: 128 triangles on a sphere, closed."""
    points = [(1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)]
    faces = [(a, b, c) for a in (0, 1) for b in (2, 3) for c in (4, 5)]
    for _ in range(2):
        halves: dict[frozenset[int], int] = {}

        def half(i: int, j: int, halves: dict[frozenset[int], int] = halves) -> int:
            if frozenset((i, j)) not in halves:
                middle = np.add(points[i], points[j])
                halves[frozenset((i, j))] = len(points)
                points.append(tuple(middle / np.linalg.norm(middle)))
            return halves[frozenset((i, j))]

        faces = [
            part for a, b, c in faces
            for part in ((a, half(a, b), half(c, a)), (b, half(b, c), half(a, b)), (c, half(c, a), half(b, c)),
                         (half(a, b), half(b, c), half(c, a)))
        ]
    corners = np.array(points)
    a, b, c = np.moveaxis(corners[np.array(faces)], 1, 0)
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a) < 0
    return _geometry(0.7 * corners, np.where(inward[:, None], np.array(faces)[:, ::-1], np.array(faces)))


@pytest.mark.parametrize("normals", ["flat", "smooth"])
def test_a_glass_mesh_agrees_wherever_no_normal_sends_a_ray_to_the_wrong_side_of_a_face(normals, tmp_path):
    # Q19, Q43: the model decides by the face which medium a ray is in, POV-Ray by counting
    result = run(case_of_text(GLASS.format(normals=normals, geometry=closed_ball())), tmp_path)
    film = result.case.scene.film
    truth = plain_raytraced.radiance(result.case, pixel_centres(result.case))[0].reshape(film.height, film.width, 3)
    tracer, storage, refraction = Tracer(result.case), term(result.budget, "mesh-storage"), term(result.budget, "refraction")
    tilts = [storage.normal[0] + refraction.normal[0], 0.0]
    allowed = bound(result.budget, truth) + np.asarray(tracer.sensitivity(tilts, [storage.position_m[0], 0.0])) + 1e-9
    wrong = np.argwhere((np.abs(result.image - truth) > allowed).any(axis=2))
    wrong = wrong[~on_edge(tracer, wrong[:, ::-1] + 0.5, max(LEAST_DELTA_PX, result.budget.film_px))]
    astray = wrong_sides(result.case, pixel_centres(result.case)).reshape(film.height, film.width)
    unexplained = [f"({x}, {y}): povray {result.image[y, x]}, truth {truth[y, x]}" for y, x in wrong if not astray[y, x]]
    assert not unexplained, "\n".join(unexplained[:5])
    assert (len(wrong) > 0) == (normals == "smooth"), f"{len(wrong)} pixels differ"
    assert astray.sum() < 0.5 * (truth != result.case.scene.background).any(axis=2).sum(), f"{astray.sum()} pixels are excused"
