"""The BRDFs of the lecture: values, reflectance against high-precision integration, reciprocity, energy."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from equilux.brdf import Brdf, brdf_of, study
from equilux.brdf.lobes import direction
from equilux.brdf.reflectance import reflectance
from equilux_scenes.loader import load_scene_text

ANGLES_DEG = (0.0, 10.0, 45.0, 75.0, 86.0)
EXPONENTS = (0.0, 0.5, 1.0, 7.0, 20.0, 300.0)


def phong_lobe_precise(theta: float, exponent: float) -> float:
    """∫ (R·V)^p (N·V) dω over the lobe's hemisphere above the surface, by brute force in two dimensions about R."""
    with mp.workdps(15):

        def ring(a: mp.mpf) -> mp.mpf:
            # N·V = cosθ cosα + sinθ sinα cosφ ≥ 0
            level, swing = mp.cos(theta) * mp.cos(a), mp.sin(theta) * mp.sin(a)
            end = mp.pi if swing <= level else mp.acos(-level / swing)
            return 2 * mp.quad(lambda f: level + swing * mp.cos(f), [0, end])

        horizon = mp.pi / 2 - theta
        cuts = sorted({mp.mpf(0), horizon / 8, horizon / 2, horizon, mp.pi / 2})
        return float(mp.quad(lambda a: mp.cos(a) ** exponent * mp.sin(a) * ring(a), cuts))


@pytest.mark.parametrize("theta_deg", [10.0, 75.0])
@pytest.mark.parametrize("exponent", [0.5, 20.0])
def test_the_reflectance_of_the_phong_lobe_is_its_integral(theta_deg, exponent):
    theta = np.radians(theta_deg)
    rho, error = reflectance(Brdf("phong-cosine", 0.0, 1.0, exponent), theta)
    precise = phong_lobe_precise(theta, exponent)
    assert abs(rho - precise) <= 1e-9 * precise, f"quadrature {rho:.12g}, precise {precise:.12g}, stated error {error:.1e}"


@pytest.mark.parametrize("exponent", EXPONENTS)
def test_at_normal_incidence_the_lobe_reflects_two_pi_over_p_plus_two(exponent):
    rho, error = reflectance(Brdf("phong-cosine", 0.0, 1.0, exponent), 0.0)
    assert rho == pytest.approx(2 * np.pi / (exponent + 2), rel=1e-10), f"{rho} and {2 * np.pi / (exponent + 2)}, ± {error}"


@pytest.mark.parametrize("theta_deg", [0.0, 30.0, 80.0])
def test_with_exponent_0_the_half_vectors_lobe_is_one_over_cosine_everywhere(theta_deg):
    rho = float(reflectance(Brdf("half-vector", 0.0, 0.3, 0.0), np.radians(theta_deg))[0])
    assert rho == pytest.approx(0.3 * np.pi / np.cos(np.radians(theta_deg)), rel=1e-12), f"{rho}"


@pytest.mark.parametrize("theta_deg", ANGLES_DEG)
def test_the_classic_lobe_reflects_one_over_cosine_times_the_lectures(theta_deg):
    theta = np.radians(theta_deg)
    classic, cosine = (reflectance(Brdf(kind, 0.0, 0.7, 12.0), theta)[0] for kind in ("phong-classic", "phong-cosine"))
    assert classic * np.cos(theta) == pytest.approx(cosine, rel=1e-12), f"{classic * np.cos(theta)} and {cosine}"


@pytest.mark.parametrize("kind", ["lambert", "phong-classic", "phong-cosine", "half-vector"])
@pytest.mark.parametrize("theta_deg", [0.0, 30.0, 80.0])
def test_reflectance_is_the_hemispherical_integral_of_the_value(kind, theta_deg):
    """Against a plain sum over a million directions, whatever the parametrisation of the lobe."""
    brdf = Brdf(kind, 0.11, 0.3, 6.0)
    cos_out, azimuth = np.meshgrid((np.arange(1000) + 0.5) / 1000, (np.arange(1000) + 0.5) * 2 * np.pi / 1000, indexing="ij")
    to_viewer = direction(np.arccos(cos_out), azimuth)
    to_light = np.broadcast_to(direction(np.radians(theta_deg)), to_viewer.shape)
    summed = float(np.mean(brdf.value(to_light, to_viewer) * cos_out) * 2 * np.pi)
    rho, error = reflectance(brdf, np.radians(theta_deg))
    said = f"{kind} at {theta_deg}°: quadrature {rho}, sum {summed}, stated error {error}"
    assert rho == pytest.approx(summed, abs=float(error) + 1e-5 * summed), said


@given(
    st.sampled_from(("lambert", "phong-cosine")),
    st.floats(0.02, 1.55), st.floats(0.02, 1.55), st.floats(0, 6.28), st.floats(0, 500),
)  # fmt: skip
def test_lambert_and_the_lectures_brdf_are_reciprocal(kind, theta_i, theta_r, azimuth, exponent):
    brdf = Brdf(kind, 0.2, 0.4, exponent)
    one, other = direction(theta_i), direction(theta_r, azimuth)
    there, back = float(brdf.value(one, other)), float(brdf.value(other, one))
    assert there == pytest.approx(back, rel=1e-11, abs=1e-300), f"f(i, r) = {there}, f(r, i) = {back}"


def test_the_classic_phong_is_not_reciprocal_by_the_ratio_of_the_cosines():
    brdf = Brdf("phong-classic", 0.0, 1.0, 3.0)
    one, other = direction(0.3), direction(0.9, np.pi)
    ratio = float(brdf.value(one, other) / brdf.value(other, one))
    assert ratio == pytest.approx(np.cos(0.9) / np.cos(0.3), rel=1e-12), f"{ratio} and {np.cos(0.9) / np.cos(0.3)}"
    assert not study(brdf).reciprocity.reciprocal


def test_the_classic_phong_gives_back_more_than_it_gets_near_grazing():
    brdf = Brdf("phong-classic", 0.2, 0.2, 5.0)
    found = study(brdf).energy
    assert found.unbounded
    assert not found.conserved
    assert found.above_one_from_deg is not None
    rho = [float(reflectance(brdf, np.radians(found.above_one_from_deg + off))[0]) for off in (-0.01, 0.01)]
    assert rho[0] < 1 < rho[1], f"ρ just below {rho[0]}, just above {rho[1]}"


def test_a_lambertian_of_reflectance_one_conserves_energy_and_more_does_not():
    assert study(Brdf("lambert", 1 / np.pi, 0.0, 1.0)).energy.conserved
    assert study(Brdf("lambert", 1.001 / np.pi, 0.0, 1.0)).energy.above_one_from_deg == 0.0


def test_nothing_is_reflected_below_the_surface():
    brdf = Brdf("phong-cosine", 0.5, 0.5, 2.0)
    below = direction(np.radians(100.0))
    assert brdf.value(direction(0.2), below) == 0
    assert brdf.value(below, direction(0.2)) == 0


def test_the_highlight_is_where_the_mirror_direction_is():
    found = study(Brdf("phong-cosine", 0.1, 0.4, 50.0), 30.0)
    peak = found.curve_deg[int(np.argmax(found.curve))]
    assert peak == pytest.approx(30.0, abs=0.5), f"light from 30°, peak at {peak}°"


@pytest.mark.parametrize(
    ("model", "kind"), [("phong", "phong-classic"), ("raytraced", "phong-classic"), ("opengl", "half-vector")]
)
def test_a_scenes_model_says_which_brdf_its_materials_have(model, kind):
    text = (
        f"equilux: 1\nname: a\nmodel: {model}\n"
        "camera: {projection: perspective, eye: [0, 0, 3], target: [0, 0, 0], fov_y_deg: 30}\n"
        "film: {width: 2, height: 2}\nmaterials: {m: {diffuse: [0.1, 0.2, 0.3], specular: 0.4, exponent: 9}}\n"
        "objects: [{kind: sphere, center: [0, 0, 0], radius: 1, material: m}]\n"
    )
    scene = load_scene_text(text).scene
    assert brdf_of(scene.materials["m"], scene, 1) == Brdf(kind, 0.2, 0.4, 9.0)


def test_an_angle_that_does_not_arrive_is_refused():
    with pytest.raises(ValueError, match=r"allowed \[0, π/2\)"):
        reflectance(Brdf("lambert", 0.1, 0.0, 1.0), np.pi / 2)
    with pytest.raises(ValueError, match=r"allowed \[0, 90\)"):
        study(Brdf("lambert", 0.1, 0.0, 1.0), 90.0)
