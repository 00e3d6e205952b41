"""The reference adapter: what it hands over is the tracer's picture, to the last bit, with a budget that means something."""

from __future__ import annotations

import numpy as np
import pytest

from equilux.adapter import Adapter, Limits, RendererFailed
from equilux_adapters.reference import ADAPTER
from equilux_scenes.case import Case
from equilux_scenes.features import FEATURES
from equilux_scenes.mesh import TriangleMesh
from equilux_tracer import Tracer
from support.random_scenes import case_of, random_spec

BALL = {"kind": "sphere", "center": [0, 0, 0], "radius": 2.5}


def through_the_adapter(case, folder, **knobs):
    knobs = ADAPTER.Knobs(**knobs)
    program = ADAPTER.translate(case, knobs)
    program_dir, workdir = folder / "program", folder / "work"
    workdir.mkdir()
    for name, content in program.files.items():
        (program_dir / name).parent.mkdir(parents=True, exist_ok=True)
        (program_dir / name).write_bytes(content)
    raw = ADAPTER.render(program, program_dir, workdir, Limits(), knobs)
    return ADAPTER.read(raw, program, knobs)


def test_it_is_an_adapter_and_was_built():
    assert isinstance(ADAPTER, Adapter)
    assert ADAPTER.probe().found


def test_it_has_every_feature_there_is():
    assert set(ADAPTER.capabilities()) == set(FEATURES)
    assert {capability.level for capability in ADAPTER.capabilities().values()} == {"exact"}


@pytest.mark.parametrize("seed", range(6))
def test_its_image_is_the_tracers_to_the_last_bit(seed, tmp_path):
    case = case_of(random_spec(seed))
    reading = through_the_adapter(case, tmp_path, threads=1 + seed % 2)
    assert reading.image.dtype == np.float64
    np.testing.assert_array_equal(reading.image, Tracer(case).render()["radiance"])


@pytest.mark.parametrize("smooth", [False, True])
def test_meshes_travel_with_the_program(smooth, tmp_path, make_case):
    points = np.array([[-3, -3, 0], [3, -3, 0.1], [0, 3, 1 / 3]])
    normals = np.tile([0.6, 0, 0.8], (3, 1)) if smooth else None
    obj = {"kind": "mesh", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": [[0, 1, 2]]}
    light = {"kind": "point", "position": [1, 2, 3], "intensity": 3.0}
    made = make_case(
        BALL, {**obj, "normals": "smooth" if smooth else "flat"}, lights=[light], material={"diffuse": 0.7},
        meshes={1: TriangleMesh(points, np.array([[0, 1, 2]]), normals)},
    )  # fmt: skip
    case = Case(made.name, made.scene, made.scene_name, meshes=made.meshes)
    np.testing.assert_array_equal(through_the_adapter(case, tmp_path).image, Tracer(case).render()["radiance"])


def test_equal_pictures_have_equal_programs():
    spec = random_spec(1)
    cases = [case_of(spec), case_of({**spec, "about": "said differently"})]
    programs = [dict(ADAPTER.translate(case, ADAPTER.Knobs()).files) for case in cases]
    assert programs[0] == programs[1]


def test_what_the_tracer_refuses_is_a_failed_render(tmp_path, make_case):
    with pytest.raises(RendererFailed, match=r"objects\[0\]: its size is beyond 1e60 m"):
        through_the_adapter(make_case({**BALL, "radius": 1e70}), tmp_path)


def test_the_budget_is_far_below_what_is_promised(tmp_path, make_case):
    """1e-12 × (K_emit + K_amb L_amb + E (K_diff + K_spec)), at exponent 1000; here E ≥ 1 everywhere on the ball, K = 1 in all."""
    light = {"kind": "directional", "direction": [-1, -1, -3], "irradiance": 1.0}
    case = make_case(BALL, lights=[light], material={"diffuse": 0.5, "specular": 0.5, "exponent": 1000})
    (term,) = through_the_adapter(case, tmp_path).budget.terms
    assert 0 < term.abs.max() < 1e-12 / 10
