"""The shipped corpus: every scene says what it is about, shows something, and covers what it promises to cover."""

from __future__ import annotations

import importlib
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from equilux_scenes.features import FEATURES, RESOLVED_FEATURES
from equilux_scenes.lecture import ROWS
from equilux_scenes.lecture_table import inserted
from equilux_scenes.loader import corpus_folder, load_scenes
from equilux_scenes.model import LIGHTING_MODELS
from equilux_tracer import Tracer

FILES = load_scenes([corpus_folder()])
ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.scene.name)
def test_a_scene_says_in_one_sentence_what_it_is_about(file):
    about = file.scene.about
    assert 20 <= len(about) <= 140, f"{file.path}: about has {len(about)} characters, expected 20 to 140: {about!r}"
    assert about.endswith("."), f"{file.path}: {about!r} is not a sentence"


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.scene.name)
def test_a_scene_is_named_like_its_file(file):
    assert file.path.name == f"{file.scene.name}.scene.yaml"


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.scene.name)
def test_every_expectation_has_its_reason_written_beside_it(file):
    reasons = file.expect_comments
    assert len(reasons) == len(file.scene.expect)
    for expectation, reason in zip(file.scene.expect, reasons, strict=True):
        assert len(reason or "") > 20, f"{file.path}: no reason beside {expectation.adapter}: {expectation.cause}, got {reason!r}"


INVISIBLE = "furnace[k_diff=0.3183098861837907]"
"""A furnace that reflects all it gets shows what surrounds it: that the ball cannot be seen is what the case is about."""


@pytest.mark.parametrize("case", [case for file in FILES for case in file.cases], ids=lambda case: case.name)
def test_the_truth_of_no_scene_is_a_constant_image(case):
    truth = Tracer(case).render()["radiance"]
    assert np.isfinite(truth).all()
    spread = np.ptp(truth.reshape(-1, 3), axis=0).max()
    if case.name == INVISIBLE:
        assert spread <= 1e-9 * np.abs(truth).max(), f"{case.name}: spread {spread:g}, and it should not be seen"
        return
    assert spread > 1e-3 * np.abs(truth).max() > 0, f"{case.name}: spread {spread:g}, largest {np.abs(truth).max():g}"


def test_the_corpus_is_large_enough_and_covers_every_feature():
    covered = {feature for file in FILES for case in file.cases for feature in case.requires}
    assert len(FILES) >= 90
    models = {file.scene.model for file in FILES}
    assert models == set(LIGHTING_MODELS), f"models of the corpus: {models}"
    every = set(FEATURES) | set(RESOLVED_FEATURES)
    assert covered == every, f"not covered: {sorted(every - covered)}"


@pytest.fixture(scope="module")
def make_teapot() -> Iterator[ModuleType]:
    """The script that tessellates the teapot; it lies beside the package, not in it."""
    sys.path.insert(0, str(ROOT / "scene_specs"))
    try:
        yield importlib.import_module("make_teapot")
    finally:
        sys.path.pop(0)


def test_the_teapot_is_what_the_script_makes_of_the_published_patches(make_teapot):
    vertices, normals, faces = make_teapot.tessellate()
    assert len(faces) >= 50_000
    made, shipped = make_teapot.ply(vertices, normals, faces), make_teapot.TEAPOT.read_bytes()
    assert len(made) == len(shipped)
    # Another libm or BLAS may round the last bit of a float32 differently; topology and header are the same to the byte.
    start = made.index(b"end_header\n") + len(b"end_header\n")
    middle = start + vertices.size * 2 * 4
    assert (made[:start], made[middle:]) == (shipped[:start], shipped[middle:])
    ours, theirs = (np.frombuffer(data[start:middle], "<f4") for data in (made, shipped))
    assert np.abs(ours - theirs).max() <= 1e-6, f"largest difference {np.abs(ours - theirs).max():g}"


def test_the_teapot_is_wound_outwards_and_its_normals_are_unit(make_teapot):
    vertices, normals, faces = make_teapot.tessellate()
    assert np.abs(np.linalg.norm(normals, axis=1) - 1).max() < 1e-12
    corner = vertices[faces]
    across = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    with_normals = np.einsum("ij,ij->i", across, normals[faces].sum(axis=1))
    assert (with_normals > 0).all()
    volume = np.einsum("ij,ij->i", corner[:, 0], np.cross(corner[:, 1], corner[:, 2])).sum() / 6
    assert volume > 20, f"signed volume {volume:g}, expected that of the pot, about 30: some patch is wound inwards"


def test_the_corpus_validates_from_the_command_line():
    command = [sys.executable, "-m", "equilux", "scenes", "validate", str(corpus_folder())]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_the_readmes_table_of_the_lecture_is_what_the_corpus_shows():
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert inserted(readme) == readme, "out of step: python -m equilux_scenes.lecture_table README.md"


@pytest.mark.parametrize("row_id", ROWS)
def test_what_a_row_of_the_lecture_names_as_its_place_exists(row_id):
    for place in ROWS[row_id].where:
        assert (ROOT / place).exists(), f"{row_id}: {place}"
