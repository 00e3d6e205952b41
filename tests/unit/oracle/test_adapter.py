"""The oracle as an adapter: what it is given, what it delivers, and its budget."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest
from mpmath import mpf

import equilux_oracle
from equilux.adapter import Adapter, Limits, Unsupported
from equilux.budget import Bound
from equilux_adapters.oracle import ADAPTER
from equilux_adapters.oracle.read import REASONS
from equilux_oracle.precise import evaluate_at
from equilux_scenes.features import FEATURES
from equilux_scenes.loader import load_scene_text
from support.random_raytraced import random_raytraced
from support.random_scenes import case_of, random_spec

TRIANGLE = """
equilux: 1
name: triangle
model: phong
camera: {projection: orthographic, eye: [0, 0, 5], target: [0, 0, 0], height_m: 2}
film: {width: 4, height: 4}
materials: {m: {emission: 1}}
objects:
  - {kind: mesh, vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], faces: [[0, 1, 2]], material: m}
"""


def deliver(case, folder):
    """What the engine does with an adapter."""
    knobs = ADAPTER.Knobs()
    program = ADAPTER.translate(case, knobs)
    (folder / "program").mkdir(parents=True)
    (folder / "work").mkdir()
    for name, content in program.files.items():
        (folder / "program" / name).write_bytes(content)
    raw = ADAPTER.render(program, folder / "program", folder / "work", Limits(), knobs)
    return ADAPTER.read(raw, program, knobs)


def test_it_is_an_adapter():
    assert isinstance(ADAPTER, Adapter)
    assert ADAPTER.probe().found
    assert ADAPTER.version().startswith("equilux ")


def test_every_feature_is_exact_but_meshes():
    levels = {feature: capability.level for feature, capability in ADAPTER.capabilities().items()}
    assert set(levels) == set(FEATURES)
    assert {feature for feature, level in levels.items() if level != "exact"} == {"shape.mesh", "normals.flat", "normals.smooth"}


def test_a_mesh_is_refused_by_name():
    case = load_scene_text(TRIANGLE).cases[0]
    assert equilux_oracle.supports(case) == ["normals.flat", "shape.mesh"]
    with pytest.raises(Unsupported) as refusal:
        ADAPTER.translate(case, ADAPTER.Knobs())
    assert refusal.value.missing_features == ["normals.flat", "shape.mesh"]
    with pytest.raises(ValueError) as error:
        equilux_oracle.radiance(case)
    assert str(error.value) == "triangle: no closed form for normals.flat, shape.mesh (a mesh is data, not a formula)"


@pytest.mark.parametrize("seed", range(3))
def test_it_delivers_the_closed_form_in_float64(seed, tmp_path):
    case = case_of(random_spec(seed))
    reading = deliver(case, tmp_path)
    assert reading.image.dtype == np.float64
    assert np.array_equal(reading.image, equilux_oracle.radiance(case)), "the program does not say all of the scene"
    (term,) = reading.budget.terms
    assert isinstance(term, Bound)
    assert np.shape(term.abs) == reading.image.shape
    assert reading.budget.film_px == 0.0


def test_the_saved_program_reproduces_the_picture_by_its_command_line(tmp_path):
    case = case_of(random_spec(4))
    program = ADAPTER.translate(case, ADAPTER.Knobs())
    for name, content in program.files.items():
        (tmp_path / name).write_bytes(content)
    command = program.files["command.txt"].decode().split()
    assert command[0] == "python"
    subprocess.run([sys.executable, *command[1:]], cwd=tmp_path, check=True)
    assert np.array_equal(np.load(tmp_path / "radiance.npy"), equilux_oracle.radiance(case))
    assert "expect" not in json.loads(program.files[program.entry])


def test_the_command_line_explains_itself_when_misused():
    done = subprocess.run([sys.executable, "-m", "equilux_oracle"], capture_output=True, text=True)
    assert done.returncode == 2
    assert "SCENE.json" in done.stderr


def test_the_budget_holds_and_is_somewhere_approached_within_a_factor_of_ten(tmp_path):
    worst = 0.0
    for seed in range(12):
        case = case_of(random_spec(seed, film=(12, 9)))
        reading = deliver(case, tmp_path / str(seed))
        bound = np.asarray(reading.budget.terms[0].abs)
        for row, column in np.random.default_rng(seed).integers((9, 12), size=(6, 2)):
            true = evaluate_at(case, column + 0.5, row + 0.5).radiance
            for band in range(3):
                error, allowed = float(abs(mpf(reading.image[row, column, band]) - true[band])), bound[row, column, band]
                assert error <= allowed, f"{case.name} at ({column}, {row}): off by {error}, stated {allowed}"
                worst = max(worst, error / allowed if allowed else 0.0)
    assert worst >= 0.1, f"the budget is never approached: worst error is {worst} of it"


@pytest.mark.parametrize("model", ["opengl", "raytraced"])
def test_the_other_models_are_delivered_whole_with_a_reason_of_their_own(model, tmp_path):
    spec = random_raytraced(2, film=(12, 9)) if model == "raytraced" else {**random_spec(2, exponents=(1, 50)), "model": model}
    case = case_of({**spec, "viewer": "infinite"} if model == "opengl" else {**spec, "transparent_shadows": "ignore"})
    reading = deliver(case, tmp_path)
    picture, bound = equilux_oracle.radiance_with_bound(case)
    assert np.array_equal(reading.image, picture), "the program does not say all of the scene"
    (term,) = reading.budget.terms
    assert np.array_equal(np.asarray(term.abs), bound)
    assert term.reason == REASONS[model]


def test_too_deep_a_recursion_is_refused_with_the_reason():
    hall = {"kind": "sphere", "center": [0, 0, 0], "radius": 9, "material": "glass"}
    spec = random_raytraced(1, plane=False, film=(64, 48))
    glass = {"reflection": 0.9, "transmission": 0.9, "transparency": 0.5}
    case = case_of(
        {
            **spec,
            "materials": dict.fromkeys([*spec["materials"], "glass"], glass),
            "objects": [*spec["objects"], hall],
            "recursion_limit": 50,
        }
    )
    with pytest.raises(Unsupported) as refusal:
        ADAPTER.translate(case, ADAPTER.Knobs())
    assert refusal.value.missing_features == ["reflection", "transparency"]
    assert "recursion_limit 50 asks for more than" in str(refusal.value)
