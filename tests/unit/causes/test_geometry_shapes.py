"""Rules that replace shapes or vertex normals, against scenes that are written so."""

from __future__ import annotations

import math

import numpy as np
import pytest

from equilux_tracer import Tracer
from equilux_tracer.causes import RULES, Applied
from equilux_tracer.causes.mesh_normals import box_mesh, smooth
from equilux_tracer.causes.tessellation import Style, tessellated_shape
from support.cause_scenes import ROOF, lopsided
from support.faulty import assert_same, evidence_of, picture, tried, with_cause

SMOOTH_ROOF = lopsided(objects=[{**ROOF, "normals": "smooth"}])
FLAT_ROOF = lopsided(objects=[ROOF])
BALLS = lopsided(film={"width": 48, "height": 36})


def as_mesh(vertices, faces, normals=None):
    """A mesh as a spec has it."""
    mesh = {"kind": "mesh", "material": "clay", "vertices": np.asarray(vertices).tolist(), "faces": np.asarray(faces).tolist()}
    return mesh if normals is None else {**mesh, "normals": "smooth", "vertex_normals": np.asarray(normals).tolist()}


def test_a_smooth_mesh_without_its_normals_is_the_flat_one():
    assert_same(with_cause(SMOOTH_ROOF, "faceted-normals"), picture(FLAT_ROOF))


def test_a_face_may_take_the_normal_of_one_vertex():
    mesh = SMOOTH_ROOF.meshes[0]
    vertices = mesh.vertices[mesh.faces].reshape(-1, 3)
    for reading, corner in [("first vertex", 0), ("last vertex", 2)]:
        normals = np.repeat(mesh.vertex_normals[mesh.faces[:, corner]], 3, axis=0)
        expected = lopsided(objects=[as_mesh(vertices, np.arange(12).reshape(4, 3), normals)])
        assert_same(with_cause(SMOOTH_ROOF, "faceted-normals", None, reading), picture(expected))


def test_a_flat_mesh_with_smooth_normals_is_the_smooth_one():
    assert_same(with_cause(FLAT_ROOF, "smoothed-normals"), picture(SMOOTH_ROOF))


@pytest.mark.parametrize("weight", ["area", "angle", "unweighted"])
def test_vertex_normals_are_sums_weighted_as_said(weight):
    vertices, faces = np.array(ROOF["vertices"], float), np.array(ROOF["faces"])
    expected = np.zeros_like(vertices)
    for face in faces:
        for k in range(3):
            a, b, c = vertices[np.roll(face, -k)]
            cross = np.cross(b - a, c - a)
            cosine = (b - a) @ (c - a) / np.linalg.norm(b - a) / np.linalg.norm(c - a)
            factor = {"area": np.linalg.norm(cross), "angle": math.acos(cosine), "unweighted": 1.0}[weight]
            expected[face[k]] += factor * cross / np.linalg.norm(cross)
    expected /= np.linalg.norm(expected, axis=1, keepdims=True)
    got = smooth(FLAT_ROOF.meshes[0], weight, merged=False).vertex_normals
    np.testing.assert_allclose(got, expected, rtol=0, atol=1e-12)
    shown = with_cause(FLAT_ROOF, "smoothed-normals", None, weight)
    assert_same(shown, picture(lopsided(objects=[as_mesh(vertices, faces, expected)])), relative=1e-9)


def test_copies_of_a_vertex_are_smoothed_only_where_they_are_merged():
    vertices = np.array(ROOF["vertices"], float)[np.array(ROOF["faces"])].reshape(-1, 3)
    apart = lopsided(objects=[as_mesh(vertices, np.arange(12).reshape(4, 3))])
    assert_same(with_cause(apart, "smoothed-normals"), picture(FLAT_ROOF))
    assert_same(with_cause(apart, "smoothed-normals", None, "merged"), picture(SMOOTH_ROOF))
    assert "merged" in [reading for _, reading in tried(apart, "smoothed-normals")]
    assert "merged" not in [reading for _, reading in tried(FLAT_ROOF, "smoothed-normals")]


def test_a_smoothed_cube_is_shaded_like_a_sphere():
    turned = [{"rotate": {"axis": [1, 2, 0.5], "degrees": 40}}]
    cube = {"kind": "box", "min": [-0.5, -0.5, -0.5], "max": [0.5, 0.5, 0.5], "material": "clay", "transform": turned}
    case = lopsided(objects=[cube])
    mesh = box_mesh((-0.5,) * 3, (0.5,) * 3, shared=True)
    radial = {**as_mesh(mesh.vertices, mesh.faces, mesh.vertices / np.sqrt(0.75)), "transform": turned}
    expected = picture(lopsided(objects=[radial]))
    assert_same(with_cause(case, "smoothed-normals", None, "angle"), expected, relative=1e-9)
    assert_same(with_cause(case, "smoothed-normals", None, "from the centre"), expected, relative=1e-9)


@pytest.mark.parametrize("weight", ["", "area", "angle", "unweighted"])
def test_boxes_may_stay_as_they_are_where_meshes_are_smoothed(weight):
    box = {"kind": "box", "min": [0.2, 0.1, 0.3], "max": [0.6, 0.5, 0.9], "material": "clay"}
    both = lopsided(objects=[ROOF, box])
    normals = smooth(FLAT_ROOF.meshes[0], weight or "area and angle", merged=False).vertex_normals
    expected = lopsided(objects=[as_mesh(ROOF["vertices"], ROOF["faces"], normals), box])
    reading = f"meshes only, {weight}" if weight else "meshes only"
    assert_same(with_cause(both, "smoothed-normals", None, reading), picture(expected), relative=1e-9)
    assert reading in [name for _, name in tried(both, "smoothed-normals")]


def test_a_box_of_triangles_is_the_box():
    box = {"kind": "box", "min": [-0.5, -0.4, -0.3], "max": [0.6, 0.3, 0.5], "material": "clay"}
    for shared in (False, True):
        mesh = box_mesh(tuple(box["min"]), tuple(box["max"]), shared=shared)
        assert_same(
            picture(lopsided(objects=[as_mesh(mesh.vertices, mesh.faces)])), picture(lopsided(objects=[box])), relative=1e-9
        )


def test_what_has_no_vertex_normals_and_is_not_curved_cannot_be_faceted():
    assert tried(FLAT_ROOF, "faceted-normals") == []
    assert tried(FLAT_ROOF, "tessellated") == []
    assert tried(BALLS, "smoothed-normals") == []


STYLES = [
    Style(), Style(rows="n", axis="z"), Style(rows="n-1", axis="x", other_diagonals=True), Style(rows="n/2-1"),
    Style(rows="icosphere"), Style(normals="averaged"), Style(turn="half a step", normals="flat"),
    Style(start="z", turn="quarter"), Style(start="across"),
]  # fmt: skip


@pytest.mark.parametrize("style", STYLES, ids=lambda style: style.name or "plain")
@pytest.mark.parametrize("kind", ["sphere", "cylinder", "disc"])
def test_tessellations_are_inscribed_face_outwards_and_come_near_the_area(style, kind):
    disc = {"kind": "disc", "center": [1, 2, 3], "normal": [1, -2, 0.5], "radius": 2, "material": "clay"}
    cylinder = {"kind": "cylinder", "base": [1, 2, 3], "top": [2, 1, 4], "radius": 2, "material": "clay"}
    sphere = {"kind": "sphere", "center": [1, 2, 3], "radius": 2, "material": "clay"}
    shape = lopsided(objects=[{"sphere": sphere, "cylinder": cylinder, "disc": disc}[kind]]).scene.objects[0]
    mesh = tessellated_shape(shape, 3 if style.rows == "icosphere" else 24, style)
    if kind != "sphere" and style.rows == "icosphere":
        return
    corners = mesh.vertices[mesh.faces]
    crosses = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    height = math.sqrt(3)
    full = {"sphere": 16 * math.pi, "cylinder": 4 * math.pi * height + 8 * math.pi, "disc": 4 * math.pi}[kind]
    area = float(np.linalg.norm(crosses, axis=1).sum() / 2)
    # a polygon of 24 sides has 1.1 % less area than its circle; bands from pole to pole take as much again
    assert 0.96 * full < area < full, f"area {area}, of the shape {full}"
    if kind == "disc":
        assert (crosses @ shape.normal > 0).all()
        return
    middle = np.array(shape.center) if kind == "sphere" else (np.array(shape.base) + np.array(shape.top)) / 2
    outwards = np.einsum("ij,ij->i", crosses, corners.mean(axis=1) - middle)
    assert (outwards > 0).all(), f"{(outwards <= 0).sum()} of {len(outwards)} triangles face inwards"
    if kind == "sphere":
        np.testing.assert_allclose(np.linalg.norm(mesh.vertices - middle, axis=1), 2, rtol=1e-12)


@pytest.mark.parametrize("style", STYLES, ids=lambda style: style.name or "plain")
def test_a_style_is_found_again_by_its_name(style):
    assert Style.named(style.name) == style


def test_fine_tessellations_come_near_the_sphere_with_the_square_of_their_number():
    true = picture(BALLS)
    errors = [float(np.median(np.abs(with_cause(BALLS, "tessellated", n) - true)[true[..., 0] > 0.1])) for n in (32, 64)]
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.15), f"medians {errors}"


@pytest.mark.parametrize(
    ("cause", "count", "reading"),
    [
        ("tessellated", 24, ""),
        ("tessellated", 16, "about z"),
        ("tessellated", 12, "n bands, about z"),
        ("tessellated", 2, "icosphere"),
        ("tessellated", 16, "about z, flat"),
        ("faceted-normals", 24, "tessellated, flat"),
    ],
)
def test_number_and_style_of_triangles_are_found(cause, count, reading):
    evidence = evidence_of(BALLS, with_cause(BALLS, cause, count, reading))
    start = "flat" if cause == "tessellated" and "flat" in reading else reading if cause == "faceted-normals" else ""
    found = RULES[cause].estimates(Applied(cause, None, start), evidence)[0]
    assert (found.parameter, found.reading) == (count, reading)


TUBE = {"kind": "cylinder", "base": [-0.9, -0.8, 0.4], "top": [-0.3, -0.2, 0.8], "radius": 0.25, "material": "clay"}
PLATE = {"kind": "disc", "center": [0.8, -0.6, 0.6], "normal": [0.2, 0.6, 1], "radius": 0.35, "material": "clay"}


@pytest.mark.parametrize("reading", ["", "spheres only"])  # a disc's triangles show at its rim alone
def test_shapes_that_stay_round_are_told_from_those_that_become_triangles(reading):
    ball = {"kind": "sphere", "center": [0.3, 0.3, 0], "radius": 0.6, "material": "clay"}
    case = lopsided(objects=[ball, TUBE, PLATE])
    seen = Tracer(case).render(["object_id"])["object_id"]
    assert {0, 1, 2} <= set(np.unique(seen)), "all are seen"
    evidence = evidence_of(case, with_cause(case, "tessellated", 32, reading))
    found = RULES["tessellated"].estimates(Applied("tessellated"), evidence)[0]
    assert (found.parameter, found.reading) == (32, reading)


def test_another_fault_is_not_taken_for_a_tessellation():
    evidence = evidence_of(BALLS, 1.3 * picture(BALLS))
    for reading in ("", "flat"):
        assert RULES["tessellated"].estimates(Applied("tessellated", None, reading), evidence) == []
