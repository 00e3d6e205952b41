"""The facts about Mitsuba that the adapter is built on (its QUIRKS.md), asked of Mitsuba and of the script's parts directly."""

from __future__ import annotations

import math
import os
import runpy
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from equilux_adapters.mitsuba.library import ENVIRONMENT, find_llvm
from equilux_adapters.mitsuba.render import _start
from support.mitsuba import case_of_text, run

_start()

import drjit as dr  # noqa: E402  (LLVM is named first)
import mitsuba as mi  # noqa: E402

from equilux_adapters.mitsuba.kit import film, lamp, materials, phong, shapes  # noqa: E402

U = 2.0**-24
NOISE = 6
"""Standard deviations: two chances in 10⁹."""


def radiance(scene: dict[str, Any], origin: Any, direction: Any, samples: int = 256, repeats: int = 32) -> tuple[float, float]:
    """Mean and standard deviation of the mean, first band, of what one ray sees."""
    loaded = mi.load_dict({"type": "scene", "integrator": {"type": "direct"}, **scene}, optimize=False)
    unit = np.asarray(direction, dtype=float) / np.linalg.norm(direction)
    rays = mi.RayDifferential3f(o=mi.Point3f(*[[float(x)] * 2 for x in origin]), d=mi.Vector3f(*[[float(x)] * 2 for x in unit]))
    means = np.stack([film.one_repeat(loaded, rays, samples, seed) for seed in range(repeats)])[:, 0, 0]
    return float(means.mean()), float(means.std(ddof=1) / math.sqrt(repeats))


def floor(bsdf: dict[str, Any]) -> dict[str, Any]:
    """A disc of radius 5 across z, at the origin."""
    return {"type": "disk", "to_world": mi.ScalarTransform4f().scale(5), "bsdf": bsdf}


def sky(value: float = 1.0) -> dict[str, Any]:
    return {"type": "constant", "radiance": materials.bands(value, value, value)}


def panel(z: float, half: float, value: float, down: bool = True) -> dict[str, Any]:
    """A square above the origin that shines down, or up."""
    y = -half if down else half
    return {
        "type": "rectangle",
        "to_world": shapes.placed((half, 0, 0), (0, y, 0), (0, 0, -1 if down else 1), (0, 0, z)),
        "emitter": {"type": "area", "radiance": materials.bands(value, value, value)},
        "bsdf": materials.black(),
    }


def grey(k: float) -> tuple[float, float, float]:
    return (k, k, k)


SLANTED = ((3.0, 0.0, 3.0), (-1.0, 0.0, -1.0))
"""A ray to the origin, at 45°."""


# --- numbers ----------------------------------------------------------------------------------------------------------


def test_q1_no_variant_that_is_shipped_computes_in_double():
    assert not [name for name in mi.variants() if "double" in name]


def test_q2_environment_and_lambert_by_both_samplings_have_next_to_no_noise_unoccluded():
    mean, sigma = radiance({"sky": sky(), "floor": floor(materials.lambert(grey(0.2)))}, *SLANTED)
    assert mean == pytest.approx(0.2 * math.pi, abs=NOISE * sigma + 1e-6)
    assert sigma < 2e-3, f"σ {sigma}"


@pytest.mark.parametrize("lights", [1, 2, 3, 5])
def test_q3_a_number_of_samples_that_the_lights_divide_leaves_no_noise_of_choice(lights):
    scene = {f"l{k}": lamp.lamp((k, 0, 2), grey(k + 1.0)) for k in range(lights)}
    scene |= {"floor": floor(materials.lambert(grey(0.5)))}
    mean, sigma = radiance(scene, *SLANTED, samples=lights * lights)
    distance2 = [k * k + 4 for k in range(lights)]
    expected = sum(0.5 * (k + 1) / d2 * 2 / math.sqrt(d2) for k, d2 in enumerate(distance2))
    assert mean == pytest.approx(expected, rel=32 * U)
    assert sigma < 4 * U * mean, f"σ {sigma}, mean {mean}"


def test_q4_a_small_sphere_brings_light_that_is_off_by_the_rounding_of_its_cosine():
    errors = []
    for radius in (0.01, 0.012, 0.014, 0.017, 0.02):
        ball = {"type": "sphere", "center": [0, 0, 2], "radius": radius, "bsdf": materials.black()}
        ball["emitter"] = {"type": "area", "radiance": materials.bands(*grey(1 / (math.pi * radius**2)))}
        mean, _ = radiance({"ball": ball, "floor": floor(materials.lambert(grey(1.0)))}, *SLANTED)
        allowed = 2 * U / (radius**2 / 8)  # 2 u of 1 − cos α, α = radius/2
        errors.append(abs(mean / 0.25 - 1) / allowed)
    assert max(errors) <= 1 + 1e-2, f"errors in units of what is allowed: {errors}"
    assert max(errors) >= 0.1, f"errors in units of what is allowed: {errors}"


def test_q4_the_light_of_the_smallest_emitters_is_lost():
    for given, is_seen in (({"type": "sphere", "radius": 2.0**-10}, True), ({"type": "sphere", "radius": 2.0**-13}, False)):
        ball = given | {"center": [0, 0, 2], "bsdf": materials.black()}
        ball["emitter"] = {"type": "area", "radiance": materials.bands(*grey(1e9))}
        mean, _ = radiance({"ball": ball, "floor": floor(materials.lambert(grey(1.0)))}, *SLANTED, samples=16)
        assert (mean > 0) == is_seen, f"{given}: {mean}"
    for half, is_seen in ((2.0**-30, True), (2.0**-33, False)):
        mean, _ = radiance({"panel": panel(2, half, 1e19), "floor": floor(materials.lambert(grey(1.0)))}, *SLANTED, samples=16)
        assert (mean > 0) == is_seen, f"half an edge {half}: {mean}"


def test_reflectances_above_one_are_an_error_unless_unbounded():
    with pytest.raises(RuntimeError, match=r"must be in the range \[0, 1\]"):
        mi.load_dict({"type": "diffuse", "reflectance": {"type": "rgb", "value": [1.5, 0, 0]}})
    mean, sigma = radiance({"sky": sky(), "floor": floor(materials.lambert(grey(0.5)))}, *SLANTED)
    assert mean == pytest.approx(0.5 * math.pi, abs=NOISE * sigma + 1e-6)


# --- what Mitsuba has otherwise ---------------------------------------------------------------------------------------


GLOWING = """
equilux: 1
name: glowing
model: reflection-equation
camera: {projection: perspective, eye: [0, 1, 3], target: [0, 0, 0], fov_y_deg: 60}
film: {width: 16, height: 12}
background: [0, 4, 0]
materials: {lamp: {diffuse: 0.2, emission: [9, 0, 0]}, floor: {diffuse: 0.3}}
objects:
  - {kind: disc, center: [0, -0.5, 0], normal: [0, 1, 0], radius: 1, material: floor}
  - {kind: sphere, center: [0.1, 0, 0], radius: 0.3, material: lamp}
"""


def test_q5_what_glows_and_the_background_are_seen_and_light_nothing(tmp_path: Path):
    shown = run(case_of_text(GLOWING), tmp_path).image
    assert {tuple(pixel) for pixel in shown.reshape(-1, 3).tolist()} == {(9, 0, 0), (0, 4, 0), (0, 0, 0)}


def test_q6_diffuse_is_reflectance_over_pi_on_one_side_and_twosided_gives_it_a_back():
    light = {"l": {"type": "directional", "direction": [0, 0, -1], "irradiance": materials.bands(*grey(3.0))}}
    below = {"l": {"type": "directional", "direction": [0, 0, 1], "irradiance": materials.bands(*grey(3.0))}}
    bare = {"type": "diffuse", "reflectance": materials.bands(*grey(0.5))}
    assert radiance(light | {"floor": floor(bare)}, *SLANTED)[0] == pytest.approx(3 * 0.5 / math.pi, rel=16 * U)
    from_below = ((3.0, 0.0, -3.0), (-1.0, 0.0, 1.0))
    assert radiance(below | {"floor": floor(bare)}, *from_below)[0] == 0
    assert radiance(below | {"floor": floor(materials.lambert(grey(0.5)))}, *from_below)[0] == pytest.approx(1.5, rel=16 * U)
    assert radiance(light | {"floor": floor(materials.lambert(grey(0.5)))}, *from_below)[0] == 0


def test_q7_a_spot_without_falloff_is_a_hard_cone_of_constant_intensity():
    spot = {"type": "spot", "intensity": materials.bands(*grey(4.0)), "cutoff_angle": 30, "beam_width": 30}
    spot["to_world"] = shapes.placed((1, 0, 0), (0, -1, 0), (0, 0, -1), (0, 0, 2))
    scene = {"l": spot, "floor": floor(materials.lambert(grey(1.0)))}
    for degrees, is_lit in ((0, True), (20, True), (29.9, True), (30.1, False), (40, False)):
        cosine = math.cos(math.radians(degrees))
        x = 2 * math.tan(math.radians(degrees))
        expected = 4 / (2 / cosine) ** 2 * cosine if is_lit else 0.0
        assert radiance(scene, (x, 0, 3), (0, 0, -1))[0] == pytest.approx(expected, rel=32 * U), f"{degrees}°"


def test_q8_the_registered_lamp_has_every_attenuation_and_exponent():
    given = lamp.lamp((0, 0, 2), grey(4.0), (0.5, 0.25, 2.0), direction=(0, 0, -3), half_angle_deg=40, exponent=7)
    scene = {"l": given, "floor": floor(materials.lambert(grey(1.0)))}
    for degrees, is_lit in ((0, True), (25, True), (39.9, True), (40.1, False)):
        cosine = math.cos(math.radians(degrees))
        r = 2 / cosine
        expected = 4 * cosine**7 / (0.5 + 0.25 * r + 2 * r * r) * cosine if is_lit else 0.0
        assert radiance(scene, (r * math.sin(math.radians(degrees)), 0, 3), (0, 0, -1))[0] == pytest.approx(expected, rel=64 * U)


def test_emitters_are_seen_with_their_radiance_and_are_black_behind():
    for kind, value in (("rectangle", 5.0), ("disk", 6.0)):
        emitter = {**panel(0, 1, value, down=False), "type": kind}
        assert radiance({"e": emitter}, (0.1, 0.2, 3), (0, 0, -1))[0] == value
        assert radiance({"e": emitter, "sky": sky()}, (0.1, 0.2, -3), (0, 0, 1))[0] == 0
    ball = {"type": "sphere", "radius": 1, "bsdf": materials.black()}
    ball["emitter"] = {"type": "area", "radiance": materials.bands(*grey(7.0))}
    assert radiance({"e": ball}, (0.1, 0.2, 3), (0, 0, -1))[0] == 7
    assert radiance({"e": ball}, (0.1, 0.2, 0), (0, 0, -1))[0] == 0, "inside"


def test_an_emitter_lights_on_its_normals_side_only():
    lit, sigma = radiance({"e": panel(2, 0.5, 4), "floor": floor(materials.lambert(grey(1.0)))}, *SLANTED)
    a = 0.5 / math.hypot(0.5, 2)  # form factor of a square above a point in its middle: four corners
    expected = 4 * 4 * a / math.sqrt(1) * math.atan(0.5 / math.hypot(0.5, 2))
    assert lit == pytest.approx(expected, abs=NOISE * sigma + 1e-6), f"σ {sigma}"
    behind, _ = radiance({"e": panel(2, 0.5, 4, down=False), "floor": floor(materials.lambert(grey(1.0)))}, *SLANTED)
    assert behind == 0


def test_an_emitter_reflects_nothing():
    light = {"type": "directional", "direction": [0, 0, -1], "irradiance": materials.bands(*grey(1.0))}
    assert radiance({"e": panel(0, 1, 1, down=False), "l": light}, (0.1, 0.2, 3), (0, 0, -1))[0] == 1


# --- the registered lobes ---------------------------------------------------------------------------------------------


def directions(count: int, seed: int) -> np.ndarray:
    """(count, 3) above the surface."""
    found = np.random.default_rng(seed).normal(size=(count, 3))
    found[:, 2] = np.abs(found[:, 2]) + 1e-3
    return found / np.linalg.norm(found, axis=1, keepdims=True)


def vectors(of: np.ndarray) -> Any:
    return mi.Vector3f(film.as_float32(of))


def seen_from(viewer: np.ndarray) -> Any:
    hit = dr.zeros(mi.SurfaceInteraction3f, len(viewer))
    hit.wi = vectors(viewer)
    return hit


def lobe(law: str, k_diff: float, k_spec: float, exponent: float) -> Any:
    given = phong.phong(law, grey(k_diff), grey(k_spec), exponent)["bsdf"]
    return mi.load_dict(given)


@pytest.mark.parametrize("law", ["phong-classic", "phong-cosine"])
@pytest.mark.parametrize("exponent", [0.0, 1.0, 20.0, 300.0])
def test_q6_the_lobes_are_those_of_the_model(law, exponent):
    bsdf, viewer, light = lobe(law, 0.3, 0.7, exponent), directions(500, 1), directions(500, 2)
    light[250:] = viewer[250:] * [-1, -1, 1] + 0.05 * light[250:]  # within the lobe
    light /= np.linalg.norm(light, axis=1, keepdims=True)
    got = bsdf.eval(mi.BSDFContext(), seen_from(viewer), vectors(light), True).x.numpy()
    cosine = light[:, 2]
    mirrored = np.sum((2 * cosine[:, None] * [0, 0, 1] - light) * viewer, axis=1)
    power = np.where(mirrored > 0, np.maximum(mirrored, 0) ** exponent, 0)
    expected = 0.3 * cosine + 0.7 * power * (cosine if law == "phong-cosine" else 1)
    np.testing.assert_allclose(got, expected, rtol=32 * U, atol=0.7 * 16 * U * max(exponent, 1))


@pytest.mark.parametrize(("law", "is_reciprocal"), [("phong-cosine", True), ("phong-classic", False)])
def test_reciprocity_holds_of_the_one_lobe_and_fails_of_the_other(law, is_reciprocal):
    bsdf, a, b = lobe(law, 0.3, 0.7, 3.0), directions(500, 3), directions(500, 4)
    there = bsdf.eval(mi.BSDFContext(), seen_from(a), vectors(b), True).x.numpy() / b[:, 2]
    back = bsdf.eval(mi.BSDFContext(), seen_from(b), vectors(a), True).x.numpy() / a[:, 2]
    away = np.abs(there - back).max()
    assert (away < 1e-5) == is_reciprocal, f"f(a, b) − f(b, a) up to {away}"


@pytest.mark.parametrize("exponent", [0.0, 2.0, 50.0])
def test_the_density_of_the_lobes_directions_is_what_is_drawn(exponent):
    """E[1/pdf over a part of the hemisphere] is its solid angle, and E[f cosθ/pdf] the reflectance at normal incidence."""
    bsdf, count = lobe("phong-cosine", 0.1, 0.2, exponent), 1 << 18
    hit = seen_from(np.tile([[0.0, 0.0, 1.0]], (count, 1)))
    rng = np.random.default_rng(5)
    choice, point = mi.Float(rng.random(count, dtype=np.float32)), mi.Point2f(rng.random((2, count), dtype=np.float32))
    drawn, weight = bsdf.sample(mi.BSDFContext(), hit, choice, point, True)
    weights = weight.x.numpy().astype(float)
    expected = 0.1 * math.pi + 0.2 * 2 * math.pi / (exponent + 2)
    sigma = weights.std() / math.sqrt(count)
    assert weights.mean() == pytest.approx(expected, abs=NOISE * sigma + 1e-5), f"σ {sigma}"
    pdf, up = drawn.pdf.numpy().astype(float), drawn.wo.z.numpy()
    for low, high in ((0.5, 0.8), (0.8, 0.95), (0.95, 1.0)):
        shares = np.where((up >= low) & (up < high), 1 / np.maximum(pdf, 1e-12), 0.0)
        sigma = shares.std() / math.sqrt(count)
        assert shares.mean() == pytest.approx(2 * math.pi * (high - low), abs=NOISE * sigma), f"cosines {low} to {high}"
    np.testing.assert_allclose(bsdf.pdf(mi.BSDFContext(), hit, drawn.wo, True).numpy(), pdf, rtol=1e-5)


# --- geometry ---------------------------------------------------------------------------------------------------------


def test_q9_shadow_rays_start_1500_u_off_the_surface():
    assert mi.math.RayEpsilon == 1500 * U
    # a sheet across z, at a height above the floor: seen by shadow rays only if they start below it
    for height, is_lit in ((0.5 * 1500 * U, True), (2 * 1500 * U, False)):
        sheet = {"type": "disk", "to_world": mi.ScalarTransform4f().translate([0, 0, height]).scale(0.1)}
        scene = {"sheet": sheet, "floor": floor(materials.lambert(grey(1.0)))}
        scene["l"] = {"type": "directional", "direction": [0, 0, -1], "irradiance": materials.bands(*grey(1.0))}
        # the camera's ray starts between sheet and floor
        shown = radiance(scene, (0.02, 0, height / 2), (-0.02, 0, -height / 2))[0]
        assert (shown > 0) == is_lit, f"height {height}: {shown}"


def test_q9_shadow_rays_end_before_the_light():
    for short_of_light, is_lit in ((0.5, True), (2.0, False)):
        height = 2 * (1 - short_of_light * 15000 * U)
        sheet = {"type": "disk", "to_world": mi.ScalarTransform4f().translate([0, 0, height]).scale(0.1)}
        scene = {"l": lamp.lamp((0, 0, 2), grey(1.0)), "sheet": sheet, "floor": floor(materials.lambert(grey(1.0)))}
        shown = radiance(scene, *SLANTED)[0]
        assert (shown > 0) == is_lit, f"height {height}: {shown}"


def test_q10_a_stretched_sphere_is_drawn_exactly_as_an_instance_and_not_otherwise():
    stretched = mi.ScalarTransform4f().scale([1, 1, 0.5])
    group = {"type": "shapegroup", "s": {"type": "sphere", "bsdf": materials.lambert(grey(1.0))}}
    scene = {"g": group, "o": {"type": "instance", "to_world": stretched, "shapes": {"type": "ref", "id": "g"}}}
    scene["l"] = {"type": "directional", "direction": [0, 0, -1], "irradiance": materials.bands(*grey(1.0))}
    for x in (0.0, 0.3, 0.8):
        height = 0.5 * math.sqrt(1 - x * x)
        normal = np.array([x, 0, height / 0.25])
        expected = normal[2] / np.linalg.norm(normal)
        assert radiance(scene, (x, 0, 3), (0, 0, -1))[0] == pytest.approx(expected, rel=64 * U), f"at {x}"
    nested = {"type": "instance", "to_world": stretched, "shapes": {"type": "shapegroup", "s": {"type": "sphere"}}}
    with pytest.raises(RuntimeError, match="find key"):
        mi.load_dict({"type": "scene", "o": nested})


def test_q11_the_disc_in_place_of_the_plane_keeps_its_digits_and_a_rectangle_would_not():
    tilted = np.array([1.0, 2.0, 2.0]) / 3
    x = np.cross([1.0, 0, 0], tilted) / np.linalg.norm(np.cross([1.0, 0, 0], tilted))
    frame = [tuple(map(float, axis)) for axis in (x, np.cross(tilted, x), tilted)]
    off = {}
    for kind in ("disk", "rectangle"):
        shape = {"type": kind, "to_world": shapes.turned(*frame, (0.1, 0.2, 0.3), 3e6), "bsdf": materials.black()}
        scene = mi.load_dict({"type": "scene", "o": shape}, optimize=False)
        origin = np.float32(np.array([0.1, 0.2, 0.3]) + 2 * tilted)
        rays = np.random.default_rng(6).normal(scale=0.3, size=(100, 3)) - tilted
        hit = scene.ray_intersect(mi.Ray3f(mi.Point3f(*map(float, origin)), dr.normalize(vectors(rays))))
        off[kind] = np.abs((np.array(hit.p).T - [0.1, 0.2, 0.3]) @ tilted).max()
    assert off["disk"] < 16 * U * 3, f"metres off the plane: {off}"
    assert off["rectangle"] > 1e-3, f"metres off the plane: {off}"


def test_q12_the_side_of_a_smooth_mesh_is_that_of_its_shading_normal(tmp_path: Path):
    (tmp_path / "leaning.ply").write_text(LEANING)
    mesh = {"type": "ply", "filename": str(tmp_path / "leaning.ply"), "bsdf": materials.lambert(grey(1.0))}
    scene = {"m": mesh, "l": {"type": "directional", "direction": [1, 0, -1], "irradiance": materials.bands(*grey(1.0))}}
    # seen from above, against the shading normal (-1, 0, 0.1), which the light would meet from its front
    from_the_right = ((3.0, 0.0, 0.2), (-1.0, 0.0, -0.2 / 3))
    normal = np.array([-1, 0, 0.1]) / math.hypot(1, 0.1)
    to_light = np.array([-1, 0, 1]) / math.sqrt(2)
    assert radiance(scene, (0, 0, 3), (0, 0, -1))[0] == pytest.approx(normal @ to_light, rel=1e-5)
    assert radiance(scene, *from_the_right)[0] == 0


LEANING = """ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
property float nx
property float ny
property float nz
element face 1
property list uchar int vertex_indices
end_header
-2 -2 0 -1 0 0.1
2 -2 0 -1 0 0.1
0 2 0 -1 0 0.1
3 0 1 2
"""


def test_q13_meshes_of_one_material_are_merged_unless_told_otherwise():
    scene = {"type": "scene", "m": {"type": "diffuse", "id": "m"}}
    scene |= {name: {"type": "cube", "bsdf": {"type": "ref", "id": "m"}} for name in ("a", "b")}
    assert len(mi.load_dict(scene, optimize=False).shapes()) == 2
    assert len(mi.load_dict(scene).shapes()) == 1


# --- running ----------------------------------------------------------------------------------------------------------

LIT = """
equilux: 1
name: standalone
model: reflection-equation
camera: {projection: perspective, eye: [0, 0, 3], target: [0, 0, 0], fov_y_deg: 30}
film: {width: 6, height: 4}
lights: {sky: {kind: environment, radiance: 1}}
materials: {clay: {diffuse: 0.3, specular: 0.1, exponent: 5}}
objects: [{kind: sphere, center: [0.1, 0, 0], radius: 0.5, material: clay}]
"""


def test_q14_the_llvm_that_was_found_is_the_one_that_compiles():
    assert os.environ[ENVIRONMENT] == find_llvm()
    assert dr.detail.llvm_version()[0] >= 17


def kernels(folder: Path, text: str) -> list[tuple[str, int]]:
    """(hash, how many lanes) of the compiled kernels that a picture takes."""
    script = run(case_of_text(text), folder, samples=9).folder / "scene.py"
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        dr.kernel_history_clear()
        runpy.run_path(str(script))["picture"]()
        history = dr.kernel_history()
    return [(kernel["hash"], kernel["size"]) for kernel in history if kernel["type"] == dr.KernelType.JIT]


def test_q15_numbers_of_a_scene_are_not_part_of_its_kernels_and_each_path_is_traced_once(tmp_path: Path):
    first = kernels(tmp_path / "a", LIT)
    changed = LIT.replace("radiance: 1", "radiance: 2.5").replace("0.3", "0.25").replace("[0.1, 0, 0]", "[0.2, 0.1, 0]")
    second = kernels(tmp_path / "b", changed.replace("exponent: 5", "exponent: 7"))
    assert set(second) == set(first)
    paths = [size for _, size in second if size == 6 * 4 * 9]
    assert len(paths) == 32, f"{len(paths)} kernels over all paths, expected one per repeat: {second[:6]}"


def test_a_script_runs_by_itself_and_gives_the_same_picture(tmp_path: Path):
    result = run(case_of_text(LIT), tmp_path)
    alone = tmp_path / "alone"
    alone.mkdir()
    subprocess.run([sys.executable, str(result.folder / "scene.py")], cwd=alone, check=True, timeout=120)
    with np.load(alone / "picture.npz") as picture:
        assert np.array_equal(picture["image"], result.image)


def test_the_same_knobs_give_the_same_picture_and_repeats_differ(tmp_path: Path):
    first, second = (run(case_of_text(LIT), tmp_path / str(k)) for k in range(2))
    assert np.array_equal(first.image, second.image)
    with np.load(first.raw.files["picture.npz"]) as picture:
        seen = picture["object"] >= 0
        assert seen.any()
        assert (picture["sigma"][seen] > 0).all()
