"""Samples in packets: the same bits as one by one, wherever a picture is made of them.

Only radiance is computed in packets; whoever asks for another channel too has every sample computed by itself.
"""

from __future__ import annotations

import numpy as np
import pytest

from bench.scenes import rippled_ring, spheres, triangles
from equilux_scenes.case import Case
from equilux_tracer import Tracer, _tracer
from support.random_scenes import ANALYTIC, case_of, random_spec


def differing(case: Case) -> str:
    tracer = Tracer(case)
    packets = tracer.render(["radiance"], threads=1)["radiance"]
    singles = tracer.render(["radiance", "object_id"], threads=1)["radiance"]
    unequal = (packets != singles).any(axis=-1)
    worst = np.abs(packets - singles).max()
    return f"{np.count_nonzero(unequal)} of {unequal.size} samples, by up to {worst:.3g}" if unequal.any() else ""


@pytest.mark.parametrize("model", ["phong", "raytraced"])
@pytest.mark.parametrize("fov_deg", [(20.0, 120.0), None], ids=["perspective", "orthographic"])
@pytest.mark.parametrize("shapes", [("sphere", "plane", "disc", "rectangle"), ANALYTIC], ids=["plain", "all"])
def test_random_scenes_have_the_same_bits_in_packets_and_one_by_one(model, fov_deg, shapes):
    for seed in range(6):
        spec = random_spec(seed, shapes=shapes, fov_deg=fov_deg, light_kinds=("point", "directional"), film=(37, 23))
        assert differing(case_of({**spec, "model": model})) == "", f"seed {seed}"


@pytest.mark.parametrize("changes", [{}, {"model": "phong"}, {"lights": {}}])
def test_the_measured_scenes_have_the_same_bits_in_packets_and_one_by_one(changes):
    for case in (triangles((131, 77), around=24, along=64, **changes), spheres((131, 77), **changes)):
        assert differing(case) == "", case.name


@pytest.fixture
def limit_packets():
    yield _tracer.limit_packets
    _tracer.limit_packets(16)


@pytest.mark.parametrize("lanes", [4, 8])
def test_machines_with_narrower_registers_make_the_same_bits(limit_packets, lanes):
    limit_packets(lanes)
    for case in (triangles((67, 45), around=24, along=64), spheres((67, 45), count=5)):
        assert differing(case) == "", case.name


def test_positions_off_the_pixel_centres_have_the_same_bits_in_packets_and_one_by_one():
    tracer = Tracer(triangles((131, 77), around=24, along=64))
    positions = np.random.default_rng(1).uniform((-20, -20), (150, 100), (1003, 2))
    packets = tracer.evaluate(positions)["radiance"]
    singles = tracer.evaluate(positions, ["radiance", "depth"])["radiance"]
    assert (packets == singles).all()


def test_flat_and_smooth_meshes_of_every_placement_have_the_same_bits_in_packets_and_one_by_one(make_case):
    mesh = rippled_ring(12, 24)
    placed = {"kind": "mesh", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": [[0, 1, 2]]}
    for flat in (False, True):
        shape = type(mesh)(mesh.vertices, mesh.faces, None if flat else mesh.vertex_normals)
        turned = {**placed, "transform": [{"scale": [1, 0.5, 2]}, {"rotate": {"axis": [1, 2, 3], "degrees": 40}}]}
        case = make_case(turned, film={"width": 61, "height": 47}, meshes={0: shape})
        assert differing(case) == "", "flat" if flat else "smooth"
