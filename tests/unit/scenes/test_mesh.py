"""Triangle meshes: vertex normals by area and angle, given normals, and what cannot be shaded."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from equilux_scenes.mesh import MeshError, TriangleMesh, shaded

CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
CUBE_FACES = np.array(
    [
        [0, 1, 3],
        [0, 3, 2],
        [4, 6, 7],
        [4, 7, 5],
        [0, 4, 5],
        [0, 5, 1],
        [2, 3, 7],
        [2, 7, 6],
        [0, 2, 6],
        [0, 6, 4],
        [1, 5, 7],
        [1, 7, 3],
    ]
)


def test_normals_of_a_cube_point_along_its_diagonals_however_its_faces_are_cut() -> None:
    mesh = shaded(TriangleMesh(CUBE, CUBE_FACES), "smooth")
    assert mesh.vertex_normals is not None
    expected = (2 * CUBE - 1) / np.sqrt(3)
    assert np.abs(mesh.vertex_normals - expected).max() < 1e-15, mesh.vertex_normals


def test_normals_are_weighted_by_area_and_angle() -> None:
    # at vertex 0: one triangle in z = 0 of area 1/2 and angle 90°, one in x = 0 of area 2 and angle 45°
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 2, 2], [0, 2, 0]])
    mesh = shaded(TriangleMesh(vertices, np.array([[0, 1, 2], [0, 4, 3]])), "smooth")
    weighted = np.array([2 * np.pi / 4, 0, 0.5 * np.pi / 2])
    assert mesh.vertex_normals is not None
    assert np.abs(mesh.vertex_normals[0] - weighted / np.linalg.norm(weighted)).max() < 1e-15, mesh.vertex_normals[0]


@pytest.mark.parametrize("scale", [5e-324, 1e-200, 1e-9, 1.0, 1e9, 1e150, 1.7e308])
def test_normals_do_not_depend_on_the_size_of_the_mesh(scale: float) -> None:
    mesh = shaded(TriangleMesh(CUBE * scale, CUBE_FACES), "smooth")
    reference = shaded(TriangleMesh(CUBE, CUBE_FACES), "smooth")
    assert mesh.vertex_normals is not None
    assert reference.vertex_normals is not None
    assert np.abs(mesh.vertex_normals - reference.vertex_normals).max() < 1e-15


def test_given_normals_are_made_unit_and_kept() -> None:
    given = np.array([[0, 0, 1e-200], [0, 3.0, 4], [1e200, 0, 0]])
    mesh = shaded(TriangleMesh(CUBE[:3], np.array([[0, 1, 2]]), given), "smooth")
    assert mesh.vertex_normals is not None
    assert np.abs(mesh.vertex_normals - [[0, 0, 1], [0, 0.6, 0.8], [1, 0, 0]]).max() < 1e-15, mesh.vertex_normals


def test_flat_shading_has_no_vertex_normals_even_where_they_are_given() -> None:
    assert shaded(TriangleMesh(CUBE[:3], np.array([[0, 1, 2]]), np.ones((3, 3))), "flat").vertex_normals is None


def test_normals_that_cancel_out_are_an_error_that_names_the_vertex() -> None:
    both_sides = np.array([[0, 1, 2], [0, 2, 1]])
    with pytest.raises(MeshError, match="the normals of the triangles at vertex 0 cancel out"):
        shaded(TriangleMesh(CUBE[:3], both_sides), "smooth")


def test_a_vertex_that_is_never_seen_needs_no_normal() -> None:
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 5, 5], [2, 0, 0]])
    faces = np.array([[0, 1, 2], [0, 1, 4]])  # vertex 3 is unused, triangle 1 has no area
    mesh = shaded(TriangleMesh(vertices, faces), "smooth")
    assert mesh.vertex_normals is not None
    assert mesh.vertex_normals.tolist() == [[0, 0, 1]] * 5
    given = np.array([[0.0, 0, 1], [0, 0, 1], [0, 0, 1], [0, 0, 0], [0, 0, 0]])
    assert shaded(TriangleMesh(vertices, faces, given), "smooth").vertex_normals is not None


def test_a_mesh_without_any_area_is_warned_about(load: Callable[..., Any], valid: str) -> None:
    flat = valid.replace("vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]]", "vertices: [[0, 0, 0], [1, 0, 0], [2, 0, 0]]")
    assert [warning.message for warning in load(flat).warnings] == [
        "object 6 (mesh): none of its triangles has an area, so nothing is seen of it"
    ]


def test_cancelling_normals_are_reported_in_the_spec(only_error: Callable[..., str], edited: Callable[..., str]) -> None:
    text = edited(
        "normals: smooth", "normals: «smooth", "faces: [[0, 1, 2]]", "faces: [[0, 1, 2], [0, 2, 1]]",
        "    vertex_normals: [[0, 0, 1], [0, 0, 2], [0, 0, 3]]\n", "",
    )  # fmt: skip
    message = only_error(text)
    assert message == (
        "normals of object 6 (mesh): got 'smooth', allowed flat (smooth: the normals of the triangles at vertex 0 cancel out)"
    )


def test_the_content_hash_tells_meshes_apart_and_takes_minus_zero_for_zero() -> None:
    faces = np.array([[0, 1, 2]])
    mesh = TriangleMesh(CUBE[:3], faces)
    assert mesh.content_hash() == TriangleMesh(CUBE[:3] * [1, -1, 1] * [1, -1, 1] + [-0.0, 0, 0], faces.copy()).content_hash()
    assert mesh.content_hash() == TriangleMesh(np.where(CUBE[:3] == 0, -0.0, CUBE[:3]), faces).content_hash()
    others = [
        TriangleMesh(CUBE[:3] + 1e-15, faces),
        TriangleMesh(CUBE[:3], faces[:, ::-1]),
        TriangleMesh(CUBE[:3], faces, np.ones((3, 3))),
        TriangleMesh(CUBE[:4], faces),
    ]
    assert len({mesh.content_hash(), *(other.content_hash() for other in others)}) == 5
