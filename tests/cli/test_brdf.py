"""`equilux brdf`, as it is typed."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from support.engine import write_scene


def test_without_anything_it_draws_the_lectures_figure(tmp_path: Path, equilux):
    said = equilux("brdf")
    assert (said.code, said.err) == (0, "")
    assert said.out.splitlines()[0].split()[:2] == ["BRDF", "band"]
    plots = sorted(path.name for path in (tmp_path / "equilux-brdf").glob("*.svg"))
    assert len(plots) == 16, plots  # four triples of (K_diff, K_spec, p), two Phongs, two plots each
    assert all(path.read_text().startswith("<svg") for path in (tmp_path / "equilux-brdf").glob("*.svg"))


def test_the_numbers_are_those_of_the_lobe(tmp_path: Path, equilux):
    said = equilux("brdf", "--diffuse", "0.1", "--specular", "0.4", "--exponent", "20", "--kind", "phong-cosine", "--json")
    (subject,) = json.loads(said.out)
    study = subject["bands"]["all"]
    expected = 3.141592653589793 * (0.1 + 0.4 * 2 / 22)
    assert study["rho"][0] == pytest.approx(expected, rel=1e-8), f"ρ(0) {study['rho'][0]}, π K_diff + 2π K_spec/(p+2) {expected}"
    assert study["reciprocity"]["reciprocal"]
    assert study["energy"]["conserved"]
    assert json.loads((tmp_path / "equilux-brdf" / "brdf.json").read_text()) == json.loads(said.out)


def test_a_scenes_materials_are_examined_with_its_own_model(tmp_path: Path, equilux):
    scene = write_scene(tmp_path / "specs", "some")
    said = equilux("brdf", scene, "--out", "plots", "--json")
    assert said.code == 0, said.err
    assert {subject["bands"][band]["brdf"]["kind"] for subject in json.loads(said.out) for band in subject["bands"]} == {
        "phong-classic"
    }


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--diffuse", "-1"), "--diffuse: got -1, allowed a finite number ≥ 0"),
        (("--specular", "inf"), "--specular: got inf, allowed a finite number ≥ 0"),
        (("--kind", "phong-clasic"), "--kind: got 'phong-clasic', allowed lambert, phong-classic, phong-cosine, half-vector"),
        (("--theta-i-deg", "90"), "--theta-i-deg: got 90, allowed a number in [0, 90)"),
        (("--theta-i-deg", "nan"), "--theta-i-deg: got nan, allowed a number in [0, 90)"),
        (("nowhere.scene.yaml",), "no such file or folder: 'nowhere.scene.yaml'"),
    ],
)
def test_bad_usage_is_one_line_and_writes_nothing(arguments, message, tmp_path: Path, equilux):
    said = equilux("brdf", *arguments)
    assert said.code == 2
    assert message in said.err
    assert len(said.err.splitlines()) == 1, said.err
    assert not (tmp_path / "equilux-brdf").exists()


def test_coefficients_and_scenes_together_are_refused(tmp_path: Path, equilux):
    said = equilux("brdf", write_scene(tmp_path / "specs", "some"), "--diffuse", "0.2")
    assert said.code == 2
    assert "--diffuse: got it together with scenes" in said.err


def test_a_file_in_the_place_of_the_folder_is_refused(tmp_path: Path, equilux):
    (tmp_path / "taken").write_text("mine")
    said = equilux("brdf", "--out", "taken")
    assert (said.code, (tmp_path / "taken").read_text()) == (2, "mine")
