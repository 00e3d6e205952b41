"""`equilux score`, as it is typed: an image from elsewhere against the truth."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from equilux.planes import write_planes
from equilux_oracle import radiance
from equilux_scenes.loader import load_scene_file
from support.engine import write_scene


@pytest.fixture
def truth(tiny: Path) -> np.ndarray:
    return radiance(load_scene_file(tiny).cases[0])


def write(path: Path, image: np.ndarray) -> Path:
    write_planes(path, {band: image[..., index] for index, band in enumerate("RGB")})
    return path


def test_the_truth_as_float_exr_agrees(tiny: Path, truth: np.ndarray, tmp_path: Path, equilux):
    said = equilux("score", tiny, write(tmp_path / "image.exr", truth))
    assert (said.code, said.err) == (0, "")
    assert said.out.startswith("tiny: the image agrees with the oracle\npixels: 48 agree, 0 diverge, 0 edge, 0 invalid, of 48\n")


def test_a_percent_too_much_diverges_and_agrees_when_it_is_stated(tiny: Path, truth: np.ndarray, tmp_path: Path, equilux):
    image = write(tmp_path / "image.exr", truth * 1.01)
    assert equilux("score", tiny, image).code == 1
    assert equilux("score", tiny, image, "--rel", "0.02").code == 0
    assert equilux("score", tiny, image, "--abs", "-1").code == 2


def test_a_blank_or_invalid_or_smaller_image_never_passes(tiny: Path, truth: np.ndarray, tmp_path: Path, equilux):
    for name, image in {"blank": truth * 0, "nan": truth * np.nan, "small": truth[:-1]}.items():
        assert equilux("score", tiny, write(tmp_path / f"{name}.exr", image)).code == 1, name


def test_json_is_the_pairs_statistics(tiny: Path, truth: np.ndarray, tmp_path: Path, equilux):
    np.save(tmp_path / "image.npy", truth)
    pair = json.loads(equilux("score", tiny, tmp_path / "image.npy", "--json").out)
    assert (pair["a"], pair["b"], pair["verdict"], pair["max_abs"]) == ("image", "oracle", "agree", 0.0)


def test_a_file_that_is_no_image_is_bad_usage(tiny: Path, tmp_path: Path, equilux):
    (tmp_path / "image.exr").write_text("not an image")
    for image in ("image.exr", "nowhere.exr"):
        said = equilux("score", tiny, tmp_path / image)
        assert (said.code, said.out, said.err.count("\n")) == (2, "", 1)


def test_of_a_sweep_one_case_must_be_chosen(tiny: Path, truth: np.ndarray, tmp_path: Path, equilux):
    write_scene(tiny, rest="sweep:\n  glow: {path: materials.clay.emission, values: [0, 0.5]}")
    image = write(tmp_path / "image.exr", truth)
    said = equilux("score", tiny, image)
    assert said.code == 2
    assert "an image is of one case, got 2: tiny[glow=0], tiny[glow=0.5]; choose one with --case-filter" in said.err
    assert equilux("score", tiny, image, "--case-filter", "*=0]").code == 0
    assert equilux("score", tiny, image, "--case-filter", "*=0.5]").code == 1


def test_an_image_that_diverges_is_told_its_cause(tiny: Path, truth: np.ndarray, tmp_path: Path, equilux):
    np.save(tmp_path / "image.npy", truth * np.pi)
    said = equilux("score", tiny, tmp_path / "image.npy")
    assert "cause: scaled [3.14159, which is π], 100 % of the diverging pixels" in said.out
    pair = json.loads(equilux("score", tiny, tmp_path / "image.npy", "--json").out)
    assert ([cause["id"] for cause in pair["causes"]], pair["explained"]) == (["scaled"], 1.0)
    assert "cause:" not in equilux("score", tiny, tmp_path / "image.npy", "--no-diagnose").out
