"""Every term of POV-Ray's budget bounds its effect, and is approached to within a factor of ten by the very effect it bounds."""

from __future__ import annotations

import numpy as np
import pytest

from equilux_adapters.povray.exposures import merge
from equilux_adapters.povray.png import read_codes
from equilux_scenes.case import Case
from equilux_scenes.mesh import TriangleMesh
from equilux_tracer import Tracer
from support import plain_phong
from support.povray import Run, bound, case_of_text, pixel_centres, run, term

WITHIN = 0.1
"""What 'approached' means: a term a factor of ten above anything it bounds would prove nothing."""

WALL = """
equilux: 1
name: wall
model: phong
camera: {{projection: perspective, eye: [0, 0, 3], target: [0, 0, 0], fov_y_deg: 40}}
film: {{width: 96, height: 72}}
lights: {{key: {{{light}}}}}
materials: {{m: {{{material}}}}}
objects: [{{kind: plane, point: [0, 0, 0], normal: [0, 0, 1], material: m}}]
"""
LAMP = "kind: point, position: [0.3, 0.4, 2], intensity: 3"
DIFFUSE = "diffuse: [0.5, 0.3, 0.2]"


def wall(light: str = LAMP, material: str = DIFFUSE) -> Case:
    return case_of_text(WALL.format(light=light, material=material))


def truth_of(case: Case) -> np.ndarray:
    film = case.scene.film
    return plain_phong.radiance(case, pixel_centres(case))[0].reshape(film.height, film.width, 3)


def error_of(result: Run) -> tuple[np.ndarray, np.ndarray]:
    """|POV-Ray − truth| and the truth."""
    truth = truth_of(result.case)
    return np.abs(result.image - truth), truth


def before_storage(result: Run) -> np.ndarray:
    """The merged image in double precision."""
    film, scales = result.case.scene.film, result.raw.data["full_scales"]
    return merge({scales[name]: read_codes(path, film.width, film.height) for name, path in result.raw.files.items()})[0]


def assert_approached(name: str, share: np.ndarray | float) -> None:
    """share: the effect in units of the term, at every value."""
    largest = float(np.max(share))
    assert WITHIN <= largest <= 1.0, f"{name}: the effect reaches {largest:.3g} of what the budget states"


def test_quantisation(tmp_path):
    result = run(wall(), tmp_path)
    error, truth = error_of(result)
    rest = bound(result.budget, truth, leave_out=["quantisation"])
    assert_approached("quantisation", np.maximum(error - rest, 0) / term(result.budget, "quantisation").abs)


def test_float32_colours(tmp_path):
    # what exceeds half a step of the file can only come from the arithmetic before it; many pixels, so that some lie at the brink
    case = case_of_text(WALL.format(light=LAMP, material=DIFFUSE).replace("width: 96, height: 72", "width: 320, height: 240"))
    result = run(case, tmp_path, exposures=1)
    truth = truth_of(case)
    arithmetic = term(result.budget, "float32-colours")
    rest = bound(result.budget, truth, leave_out=["float32-colours", "storage"])
    beyond = np.abs(before_storage(result) - truth) - rest
    assert_approached("float32-colours", np.maximum(beyond, 0) / (arithmetic.abs + arithmetic.rel * truth))


def test_storage(tmp_path):
    result = run(wall(), tmp_path)
    exact = before_storage(result)
    assert_approached("storage", np.abs(result.image - exact) / (term(result.budget, "storage").rel * exact))


def test_light_cut(tmp_path):
    # 0.9e-10 W/m² is just below what POV-Ray drops; K = 1e9 makes it visible
    dim = wall("kind: directional, direction: [0, 0, -1], irradiance: 9.0e-11", "diffuse: 1.0e+9")
    result = run(dim, tmp_path, exposures=1)
    error, truth = error_of(result)
    assert not result.image.any(), "the light was not dropped"
    assert truth.min() == pytest.approx(0.09)
    assert_approached("light-cut", error / bound(result.budget, truth))


def test_a_light_just_above_the_cut_is_kept(tmp_path):
    result = run(wall("kind: directional, direction: [0, 0, -1], irradiance: 1.1e-10", "diffuse: 1.0e+9"), tmp_path, exposures=1)
    assert result.image.min() == pytest.approx(0.11, abs=1e-5)


def test_fade_distance(tmp_path):
    result = run(wall(), tmp_path, fade_ratio=0.1)
    error, truth = error_of(result)
    rest = bound(result.budget, truth, leave_out=["fade-distance"])
    assert_approached("fade-distance", np.maximum(error - rest, 0) / (term(result.budget, "fade-distance").rel * truth))


def test_fade_distance_of_a_linear_law(tmp_path):
    result = run(wall(LAMP + ", attenuation: {linear: 1}"), tmp_path, fade_ratio=0.1)
    error, truth = error_of(result)
    rest = bound(result.budget, truth, leave_out=["fade-distance"])
    assert_approached("fade-distance", np.maximum(error - rest, 0) / (term(result.budget, "fade-distance").rel * truth))


def test_cancellation(tmp_path):
    # (r + 0.99)(r + 1.01): two lights, a hundred times as bright as their difference
    result = run(wall(LAMP + ", attenuation: {constant: 0.9999, linear: 2, quadratic: 1}"), tmp_path)
    error, truth = error_of(result)
    rest = bound(result.budget, truth, leave_out=["cancellation"])
    assert_approached("cancellation", np.maximum(error - rest, 0) / term(result.budget, "cancellation").abs)


def test_film_by_float32_bounding_boxes(tmp_path):
    # the upper edge of a card that just fills its bounding box, seen through a window of a microradian
    text = """
equilux: 1
name: rim
model: phong
camera: {projection: perspective, eye: [0, 0, 1.48], target: [0, 0.888, 0], fov_y_deg: 1.0e-4}
film: {width: 1, height: 400}
materials: {m: {emission: 1}}
objects:
  - kind: mesh
    vertices: [[-1, -0.3, 0], [1, -0.3, 0], [1, 0.888, 0], [-1, 0.888, 0]]
    faces: [[0, 1, 2], [0, 2, 3]]
    material: m
"""
    result = run(case_of_text(text), tmp_path)
    error, _ = error_of(result)
    displaced = int((error > 0.5).any(axis=2).sum())
    assert_approached("film", displaced / result.budget.film_px)


def propagated(result: Run, tracer: Tracer) -> np.ndarray:
    """The mesh term carried into radiance by the reference: (h, w, 3)."""
    storage = term(result.budget, "mesh-storage")
    return np.asarray(tracer.sensitivity(storage.normal[0], storage.position_m[0]))


SHINY = """
equilux: 1
name: shiny-mesh
model: phong
camera: {projection: perspective, eye: [0.2, 0.1, 2], target: [0, 0, 0], fov_y_deg: 5}
film: {width: 64, height: 64}
lights: {key: {kind: directional, direction: [0.1, 0.05, -1], irradiance: 1}}
materials: {m: {specular: 1, exponent: 1000}}
objects: [{kind: mesh, normals: NORMALS, vertices: VERTICES, faces: [[0, 1, 2]], material: m}]
"""


def shiny(normals: str, vertices: str) -> Case:
    return case_of_text(SHINY.replace("NORMALS", normals).replace("VERTICES", vertices))


def assert_mesh_term_is_approached(case: Case, tmp_path) -> None:
    result = run(case, tmp_path)
    tracer = Tracer(case)
    truth = tracer.render(["radiance"])["radiance"]
    seen = tracer.render(["object_id"])["object_id"] == 0
    error, rest = np.abs(result.image - truth), bound(result.budget, truth)
    allowed = propagated(result, tracer)
    assert seen.any()
    excess = np.maximum(error - rest, 0)[seen] / np.maximum(allowed[seen], 1e-300)
    assert_approached("mesh-storage", excess)


def test_mesh_storage_of_a_sliver(tmp_path):
    # two corners 1e-4 apart, a metre from the centre: float32 turns the face
    vertices = "[[0.97, 0.0123456, 0.0212121], [0.9700337, 0.0124567, 0.0212323], [-1.0312, 0.0311, 0.0112]]"
    case = shiny("flat", vertices).scene.model_dump()
    case["camera"] |= {"target": (0.97, 0.0124, 0.0212), "eye": (0.99, 0.02, 2.0), "fov_y_deg": 0.001}
    case["materials"]["m"]["exponent"] = 30.0
    assert_mesh_term_is_approached(_revalidated(case), tmp_path)


def test_mesh_storage_of_equal_normals(tmp_path):
    given = "[[-1, -1, 0], [1, -1, 0], [0, 1, 0]], vertex_normals: [[0.05, 0, 1], [0.05, 0, 1], [0.05, 0, 1]]"
    assert_mesh_term_is_approached(shiny("smooth", given), tmp_path)


def _revalidated(content: dict) -> Case:
    from equilux_scenes.model import Scene

    scene = Scene.model_validate(content)
    mesh = scene.objects[0]
    return Case(scene.name, scene, scene.name, meshes={0: TriangleMesh(np.array(mesh.vertices), np.array(mesh.faces))})
