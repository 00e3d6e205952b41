"""VTK's radiance within its own budget of the truth; every term of the budget approached; every rule of VTK's own seen."""

from __future__ import annotations

import copy
import math
import subprocess
import sys
from itertools import pairwise

import numpy as np
import pytest

from equilux.uncertainty import stated
from equilux_oracle import radiance as oracle_radiance
from equilux_tracer import Tracer
from support.random_scenes import Spec, case_of, random_spec
from support.vtk import (
    Run,
    against,
    against_reference,
    allowed_by,
    case_of_text,
    corpus_case,
    run,
    term_of,
    verdict_line,
)

TEST_SCENE = """
equilux: 1
name: test-scene
model: phong
camera: {projection: perspective, eye: [0, 0, 3], target: [0, 0, 0], up: [0, 1, 0], fov_y_deg: 30}
film: {width: 256, height: 192}
lights:
  key: {kind: point, position: [0, 2, 3], intensity: 7.5}
materials:
  clay: {diffuse: 0.6, specular: 0.5, exponent: 20}
objects:
  - {kind: sphere, center: [0, 0, 0], radius: 0.5, material: clay}
"""


def within(spec: Spec) -> Spec:
    """A random scene without what VTK has rules of its own for: Q5, Q6, Q7, Q8, and for orthographic views Q9."""
    spec = copy.deepcopy(spec)
    for material in spec["materials"].values():
        material["exponent"] = min(max(material["exponent"], 2.0), 128.0)
        if spec["camera"]["projection"] == "orthographic":
            material["specular"] = 0
    for light in spec["lights"].values():
        if light["kind"] == "spot":
            light["exponent"] = min(light.get("exponent", 0.0), 128.0)
            light["cone_half_angle_deg"] = min(light["cone_half_angle_deg"], 89.0)
    return spec


VIEWS = {
    "plain": {},
    "orthographic": {"fov_deg": None},
    "wide": {"fov_deg": (150.0, 150.0)},
    "narrow": {"fov_deg": (1.0, 1.0)},
    "far from the origin": {"offset": (1e6, -2e5, 3e6)},
    "cylinders": {"shapes": ("cylinder",)},
    "many lights": {"lights": (4, 8)},
}


@pytest.mark.parametrize("view", VIEWS)
def test_random_scenes_agree_with_the_reference_within_the_budget(view, tmp_path):
    problems = []
    for seed in range(700, 708 if view == "plain" else 704):
        result = run(case_of(within(random_spec(seed, film=(96, 72), **VIEWS[view]))), tmp_path)
        pair = against_reference(result)
        if pair.json["verdict"] != "agree":
            problems.append(verdict_line(result, pair))
    assert not problems, "\n".join(problems)


@pytest.mark.parametrize(
    "scene",
    [
        "clay-ball", "perspective", "tilted-up", "far-from-the-origin", "one-row", "plane", "cylinder", "cylinder-open", "disc",
        "inside-a-sphere", "nearest-wins", "two-sided", "lamp", "sixty-four-lights", "attenuation-all-terms", "non-uniform-scale",
        "mirrored", "matrix", "mesh-flat", "mesh-smooth", "mesh-given-normals", "mesh-transformed", "mesh-from-obj",
        "emission-only", "background", "coefficients-above-one",
    ],
)  # fmt: skip
def test_corpus_scene_agrees_with_the_reference_within_the_budget(scene, tmp_path):
    result = run(corpus_case(scene), tmp_path)
    pair = against_reference(result)
    assert pair.json["verdict"] == "agree", verdict_line(result, pair)


def test_the_default_tessellation_keeps_the_geometric_uncertainty_of_the_test_scene_below_1e3(tmp_path):
    case = case_of_text(TEST_SCENE)
    result, tracer = run(case, tmp_path), Tracer(case)
    stated_geometry = allowed_by(term_of(result, "facets"), result, tracer)
    assert stated_geometry.max() <= 1e-3, f"stated {stated_geometry.max()}, allowed 1e-3"
    pair = against(oracle_radiance(case), result, tracer)
    assert pair.json["verdict"] == "agree", verdict_line(result, pair)
    assert pair.json["max_abs"] <= 1e-3, f"measured {pair.json['max_abs']}, allowed 1e-3"


def test_finer_tessellation_is_nearer_to_the_truth(tmp_path):
    case = case_of_text(TEST_SCENE)
    truth = oracle_radiance(case)
    inner = np.s_[60:130, 90:165]  # off the rim
    errors = [
        np.abs(run(case, tmp_path / str(n), tessellation=n).image[inner] - truth[inner]).max() for n in (32, 64, 128, 256)
    ]
    # the error goes with the square of the angle: a factor of 4 each, less what rounding adds
    assert all(a > 2.5 * b for a, b in pairwise(errors)), f"errors at 32, 64, 128, 256 facets: {errors}"


def test_a_picture_is_neither_mirrored_nor_turned(tmp_path):
    result = run(corpus_case("perspective"), tmp_path)
    truth = Tracer(result.case).render()["radiance"]
    right = np.abs(result.image - truth).mean()
    for name, wrong in {"flipped-x": truth[:, ::-1], "flipped-y": truth[::-1], "turned": truth[::-1, ::-1]}.items():
        assert np.abs(result.image - wrong).mean() > 20 * right, f"{name}: as near as the picture itself, {right}"


def test_two_equal_surfaces_show_the_first_of_the_file(tmp_path):
    """Coplanar rectangles of different extent, either order, perspective and orthographic: not one pixel of the second."""
    for projection in ("projection: perspective, fov_y_deg: 40", "projection: orthographic, height_m: 3"):
        for first, second in (("red", "green"), ("green", "red")):
            case = case_of_text(f"""
equilux: 1
name: cards-{first}-{projection.split()[1].rstrip(",")}
model: phong
camera: {{{projection}, eye: [1.3, 0.8, 3], target: [0, 0, 0], up: [0, 1, 0]}}
film: {{width: 96, height: 72}}
lights: {{sun: {{kind: directional, direction: [0.2, -0.3, -1], irradiance: 1}}}}
materials: {{red: {{diffuse: [0.5, 0, 0]}}, green: {{diffuse: [0, 0.5, 0]}}}}
objects:
  - {{kind: rectangle, corner: [-0.9, -0.7, 0.1], edge_u: [1.3, 0, 0], edge_v: [0, 1.1, 0], material: {first}}}
  - {{kind: rectangle, corner: [-0.5, -0.9, 0.1], edge_u: [1.7, 0, 0], edge_v: [0, 1.3, 0], material: {second}}}
""")
            result = run(case, tmp_path)
            pair = against_reference(result)
            assert pair.json["verdict"] == "agree", verdict_line(result, pair)


# --- the budget is not loose ------------------------------------------------------------------------------------------


def approached(result: Run, name: str, truth: np.ndarray, where: object = np.s_[:]) -> float:
    """The largest share of what a term alone allows that the picture's error uses up, where the term allows anything."""
    tracer = Tracer(result.case)
    allowed = allowed_by(term_of(result, name), result, tracer)[where]
    error = np.abs(result.image - truth)[where]
    return float(np.max(error / np.where(allowed > 0, allowed, np.inf)))


def test_the_term_facets_is_approached_within_a_factor_of_ten(tmp_path):
    case = case_of_text(TEST_SCENE)
    result = run(case, tmp_path, tessellation=64)
    share = approached(result, "facets", oracle_radiance(case), np.s_[40:150, 70:185])
    assert 0.1 <= share <= 1, f"used {share} of the term"


def test_the_term_single_precision_is_approached_within_a_factor_of_ten(tmp_path):
    result = run(corpus_case("rectangle"), tmp_path)
    share = approached(result, "single precision", oracle_radiance(result.case))
    assert share >= 0.1, f"used {share} of the term"


def test_the_term_shader_arithmetic_is_approached_within_a_factor_of_ten(tmp_path):
    result = run(corpus_case("lamp-exponent", "lamp-exponent[exponent=128]"), tmp_path)
    share = approached(result, "shader arithmetic", oracle_radiance(result.case))
    assert share >= 0.1, f"used {share} of the term"


def test_the_term_horizon_is_approached_within_a_factor_of_ten(tmp_path):
    result = run(corpus_case("plane"), tmp_path)
    share = approached(result, "horizon", oracle_radiance(result.case))
    assert share >= 0.1, f"used {share} of the term"


def test_the_term_set_back_is_approached_within_a_factor_of_ten(tmp_path):
    case = case_of_text("""
equilux: 1
name: cards-apart
model: phong
camera: {projection: perspective, eye: [0, 0, 3], target: [0, 0, 0], up: [0, 1, 0], fov_y_deg: 40}
film: {width: 96, height: 72}
lights: {near: {kind: point, position: [0.3, 0.2, 0.05], intensity: 0.01}}
materials: {card: {diffuse: 0.5}, blank: {diffuse: 0.1}}
objects:
  - {kind: rectangle, corner: [-0.9, -0.7, 0], edge_u: [0.5, 0, 0], edge_v: [0, 1, 0], material: blank}
  - {kind: rectangle, corner: [-0.6, -0.7, 0], edge_u: [1.5, 0, 0], edge_v: [0, 1.4, 0], material: card}
  - {kind: sphere, center: [0, 0, -30], radius: 1, material: blank}
""")
    result = run(case, tmp_path)
    share = approached(result, "set back", oracle_radiance(case), np.s_[10:60, 40:80])
    assert share >= 0.1, f"used {share} of the term"


def test_the_term_pixel_grid_is_approached_within_a_factor_of_ten(tmp_path):
    """Somewhere along a slanted edge a pixel is on the wrong side although the edge is more than a tenth of the term away."""
    result = run(case_of_text("""
equilux: 1
name: slanted
model: phong
camera: {projection: perspective, eye: [0, 0, 3], target: [0, 0, 0], up: [0.31, 1, 0], fov_y_deg: 40}
film: {width: 400, height: 400}
materials: {card: {emission: 1}}
objects:
  - {kind: rectangle, corner: [-0.9, -0.85, 0], edge_u: [1.71, 0.01, 0], edge_v: [-0.01, 1.71, 0], material: card}
  - {kind: rectangle, corner: [-0.8, -0.75, 0.1], edge_u: [1.4, 0.2, 0], edge_v: [-0.2, 1.4, 0], material: card}
"""), tmp_path)
    tracer = Tracer(result.case)
    wrong = np.argwhere(np.abs(result.image - tracer.render()["radiance"]).max(axis=2) > 0.5)
    centres = wrong[:, ::-1] + 0.5
    grid_px = term_of(result, "pixel grid").film_px
    away = 0.1 * grid_px
    alike = np.ones(len(centres), dtype=bool)
    here = tracer.evaluate(centres, ["object_id"])["object_id"] >= 0
    for angle in np.linspace(0, 2 * math.pi, 16, endpoint=False):
        there = tracer.evaluate(centres + away * np.array([math.cos(angle), math.sin(angle)]), ["object_id"])["object_id"] >= 0
        alike &= there == here
    assert alike.any(), f"{len(centres)} pixels on the wrong side, none farther from the edge than {away} pixel"


# --- what is VTK's own is seen ----------------------------------------------------------------------------------------


def test_an_exponent_above_128_is_drawn_as_128(tmp_path):
    case = case_of_text(TEST_SCENE.replace("exponent: 20", "exponent: 1000"))
    result = run(case, tmp_path)
    assert against_reference(result).json["verdict"] == "diverge"
    clamped = Tracer(case_of_text(TEST_SCENE.replace("exponent: 20", "exponent: 128")))
    pair = against(clamped.render()["radiance"], result, clamped)
    assert pair.json["verdict"] == "agree", verdict_line(result, pair)


LAMP = """
equilux: 1
name: lamp-test
model: phong
camera: {projection: perspective, eye: [0.5, 2, 3], target: [0, 0, 0], up: [0, 1, 0], fov_y_deg: 40}
film: {width: 96, height: 72}
lights:
  lamp: {kind: spot, position: [0, 1.5, 0], direction: [0.1, -1, 0], intensity: 2, cone_half_angle_deg: 30, exponent: 4}
materials: {floor: {diffuse: 0.5}}
objects: [{kind: rectangle, corner: [-2, 0, 2], edge_u: [4, 0, 0], edge_v: [0, 0, -4], material: floor}]
"""


def test_a_spot_exponent_above_128_is_drawn_as_128(tmp_path):
    result = run(case_of_text(LAMP.replace("exponent: 4", "exponent: 500")), tmp_path)
    assert against_reference(result).json["verdict"] == "diverge"
    clamped = Tracer(case_of_text(LAMP.replace("exponent: 4", "exponent: 128")))
    pair = against(clamped.render()["radiance"], result, clamped)
    assert pair.json["verdict"] == "agree", verdict_line(result, pair)


def test_a_cone_of_90_degrees_is_a_point_light_without_exponent(tmp_path):
    result = run(case_of_text(LAMP.replace("cone_half_angle_deg: 30", "cone_half_angle_deg: 90")), tmp_path)
    assert against_reference(result).json["verdict"] == "diverge"
    text = LAMP.replace("kind: spot", "kind: point").replace("direction: [0.1, -1, 0], ", "")
    point = Tracer(case_of_text(text.replace(", cone_half_angle_deg: 30, exponent: 4", "")))
    pair = against(point.render()["radiance"], result, point)
    assert pair.json["verdict"] == "agree", verdict_line(result, pair)


def test_a_low_exponent_shines_where_the_mirror_direction_is_hidden(tmp_path):
    """R·V is raised to 1e-5: with p = 0.1 what is left of it is (1e-5)^0.1 = 0.316 of the highlight's peak."""
    case = case_of_text(TEST_SCENE.replace("exponent: 20", "exponent: 0.1"))
    result, tracer = run(case, tmp_path), Tracer(case)
    seen = tracer.render(["radiance", "normal", "position", "object_id"])
    to_light = np.array([0.0, 2.0, 3.0]) - seen["position"]
    distance = np.linalg.norm(to_light, axis=2, keepdims=True)
    to_light, to_viewer = to_light / distance, np.array([0.0, 0.0, 3.0]) - seen["position"]
    to_viewer /= np.linalg.norm(to_viewer, axis=2, keepdims=True)
    cosine = np.sum(seen["normal"] * to_light, axis=2)
    mirrored = 2 * cosine[..., None] * seen["normal"] - to_light
    hidden = (seen["object_id"] == 0) & (cosine > 1e-3) & (np.sum(mirrored * to_viewer, axis=2) < -1e-2)
    expected = seen["radiance"][hidden] + 0.5 * 1e-5**0.1 * 7.5 / distance[hidden] ** 2
    allowed = stated(result.budget, result.image, tracer)
    bound = allowed.bound(result.image)[hidden] + 1e-4 * expected
    error = np.abs(result.image[hidden] - expected)
    assert hidden.sum() > 100, f"only {hidden.sum()} pixels to look at"
    assert (error <= bound).all(), f"vtk {result.image[hidden][error.argmax() // 3]}, expected {expected[error.argmax() // 3]}"


def test_an_orthographic_highlight_is_seen_from_the_eye_point(tmp_path):
    """V is taken to the eye, so an orthographic view has the highlights of the perspective one at the same points."""
    case = corpus_case("orthographic")
    result, tracer = run(case, tmp_path), Tracer(case)
    assert against_reference(result).json["verdict"] == "diverge"
    seen = tracer.render(["radiance", "normal", "position", "object_id", "specular"])
    ball = (seen["object_id"] == 0) & (np.sum(seen["specular"], axis=(2, 3)) > 1e-3)
    point, normal = seen["position"][ball], seen["normal"][ball]
    to_light, to_eye = np.array([-1.5, 2.5, 2.0]) - point, np.array([0.8, 1.0, 3.0]) - point
    arriving = 8 / np.sum(to_light**2, axis=1)
    to_light /= np.linalg.norm(to_light, axis=1, keepdims=True)
    to_eye /= np.linalg.norm(to_eye, axis=1, keepdims=True)
    mirrored = 2 * np.sum(normal * to_light, axis=1, keepdims=True) * normal - to_light
    highlight = 0.3 * arriving * np.maximum(0, np.sum(mirrored * to_eye, axis=1)) ** 25
    expected = seen["radiance"][ball] - np.sum(seen["specular"], axis=2)[ball] + highlight[:, None]
    error = np.abs(result.image[ball] - expected).max()
    # the budget's own reach: the same facets under the same light
    allowed = stated(result.budget, result.image, tracer).bound(result.image).max()
    assert error <= 2 * allowed, f"off by {error}, allowed {2 * allowed}"


# --- the program is what was drawn ------------------------------------------------------------------------------------

ALONE = """
import runpy, sys
for name in ("equilux", "equilux_adapters", "equilux_scenes", "equilux_tracer", "equilux_oracle"):
    sys.modules[name] = None  # importing it is an error now
runpy.run_path("scene.py", run_name="__main__")
"""


@pytest.mark.parametrize("scene", ["all-terms", "mesh-transformed"])
def test_the_saved_script_draws_the_same_bits_with_vtk_and_numpy_alone(scene, tmp_path):
    """In a process of its own, after this one has drawn other scenes: nothing of them is left in the picture."""
    run(case_of_text(LAMP), tmp_path)
    result = run(corpus_case(scene), tmp_path)
    run(case_of_text(TEST_SCENE), tmp_path)
    again = run(corpus_case(scene), tmp_path / "again")
    subprocess.run([sys.executable, "-c", ALONE], cwd=result.folder, check=True, timeout=120, capture_output=True)
    alone = np.load(result.folder / "image.npy")
    assert alone.dtype == np.float32
    assert np.array_equal(alone, result.image), f"differs by {np.abs(alone - result.image).max()}"
    assert np.array_equal(again.image, result.image), f"differs by {np.abs(again.image - result.image).max()}"


def test_a_background_above_one_is_not_clamped(tmp_path):
    result = run(case_of_text(TEST_SCENE.replace("lights:", "background: [3, 0.5, 1000]\nlights:")), tmp_path)
    assert np.array_equal(result.image[0, 0], np.float32([3, 0.5, 1000])), f"background {result.image[0, 0]}"


# --- what VTK has of the other models ---------------------------------------------------------------------------------

BALL = TEST_SCENE.replace("width: 256, height: 192", "width: 96, height: 72")


def test_a_ray_traced_scene_in_which_nothing_stands_in_the_way_is_drawn_exactly(tmp_path):
    text = BALL.replace("model: phong", "model: raytraced").replace("lights:", "ambient: 0.2\nlights:")
    case = case_of_text(text.replace("diffuse: 0.6", "diffuse: 0.6, ambient: 0.5, emission: 0.1"))
    assert "occlusion" not in case.requires
    result = run(case, tmp_path)
    pair = against(oracle_radiance(case), result, Tracer(case))
    assert pair.json["verdict"] == "agree", verdict_line(result, pair)


RAYTRACED = """
equilux: 1
name: as-is
model: raytraced
camera: {projection: perspective, eye: [0, 1, 3], target: [0, 0, 0], up: [0, 1, 0], fov_y_deg: 35}
film: {width: 96, height: 72}
lights: {key: {kind: point, position: [-1, 2, 2], intensity: 5}}
materials:
  glass: {diffuse: 0.4, specular: 0.8, exponent: 30, transmission: 0.8, transparency: 0.75, ior: 1.5}
  mirror: {diffuse: 0.3, reflection: 0.5}
objects:
  - {kind: sphere, center: [-0.3, 0, 0.3], radius: 0.3, material: glass}
  - {kind: rectangle, corner: [-1.5, -0.35, 1], edge_u: [3, 0, 0], edge_v: [0, 0, -3], material: mirror}
"""


def test_of_a_ray_traced_scene_vtk_draws_the_local_terms(tmp_path):
    """1 − t of the glass's own, all of the mirror's own, no shadow: the picture of a local scene with these coefficients."""
    result = run(case_of_text(RAYTRACED), tmp_path)
    local = RAYTRACED.replace("raytraced", "phong").replace(", reflection: 0.5", "")
    local = local.replace(", transmission: 0.8, transparency: 0.75, ior: 1.5", "")
    tracer = Tracer(case_of_text(local.replace("diffuse: 0.4, specular: 0.8", "diffuse: 0.1, specular: 0.2")))
    pair = against(tracer.render()["radiance"], result, tracer)
    assert pair.json["verdict"] == "agree", verdict_line(result, pair)


def test_of_an_opengl_scene_vtk_draws_phong_s_highlight_in_the_light_s_diffuse_colour(tmp_path):
    case = corpus_case("opengl-not-phong")
    result = run(case, tmp_path)
    assert against_reference(result).json["verdict"] == "diverge"
    light = case.scene.delta_lights["key"].model_dump(mode="json", exclude={"ambient", "specular"})
    share = light.pop("diffuse")
    light["intensity"] = [a * b for a, b in zip(light["intensity"], share, strict=True)]
    spec = case.scene.model_dump(mode="json", exclude_defaults=True, exclude={"expect"})
    tracer = Tracer(case_of(spec | {"model": "phong", "lights": {"key": light}}))
    pair = against(tracer.render()["radiance"], result, tracer)
    assert pair.json["verdict"] == "agree", verdict_line(result, pair)


def test_an_infinite_viewer_s_highlight_is_seen_from_the_eye_point(tmp_path):
    """The same picture as with a local viewer."""
    infinite = BALL.replace("model: phong", "model: opengl\nviewer: infinite")
    local = run(case_of_text(infinite.replace("viewer: infinite", "viewer: local")), tmp_path / "local")
    assert np.array_equal(run(case_of_text(infinite), tmp_path).image, local.image)
