"""Samples in packets: the same bits as one by one, wherever a picture is made of them, in precisions "exact" and "refined".

Only radiance is computed in packets; whoever asks for another channel too has every sample computed by itself.
"""

from __future__ import annotations

import numpy as np
import pytest

from bench.scenes import rippled_ring, spheres, triangles
from equilux_scenes.case import Case
from equilux_tracer import Tracer, TracerError, _tracer
from support.random_scenes import ANALYTIC, case_of, random_spec


def told(packets, singles) -> str:
    unequal = (packets != singles).any(axis=-1)
    worst = np.abs(packets - singles).max()
    return f"{np.count_nonzero(unequal)} of {unequal.size} samples, by up to {worst:.3g}" if unequal.any() else ""


def differing(case: Case) -> str:
    tracer = Tracer(case)
    packets = tracer.render(["radiance"], threads=1)["radiance"]
    singles = tracer.render(["radiance", "object_id"], threads=1)["radiance"]
    return told(packets, singles)


def differing_refined(case: Case, limit_packets, lanes: int = 0) -> str:
    """In packets of that many lanes, 0 the widest, and one by one: without packets, and beside another channel."""
    tracer = Tracer(case)

    def radiance(*more: str):
        return tracer.render(["radiance", *more], threads=1, precision="refined", packet_width=lanes)["radiance"]

    packets, beside = radiance(), radiance("rounding")
    limit_packets(0)
    singles = radiance()
    limit_packets(16)
    return told(packets, singles) or told(packets, beside)


@pytest.fixture
def limit_packets():
    yield _tracer.limit_packets
    _tracer.limit_packets(16)


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


def placed_ring(make_case, flat: bool) -> Case:
    mesh = rippled_ring(12, 24)
    placed = {"kind": "mesh", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": [[0, 1, 2]]}
    shape = type(mesh)(mesh.vertices, mesh.faces, None if flat else mesh.vertex_normals)
    turned = {**placed, "transform": [{"scale": [1, 0.5, 2]}, {"rotate": {"axis": [1, 2, 3], "degrees": 40}}]}
    return make_case(turned, film={"width": 61, "height": 47}, meshes={0: shape})


def test_flat_and_smooth_meshes_of_every_placement_have_the_same_bits_in_packets_and_one_by_one(make_case):
    for flat in (False, True):
        assert differing(placed_ring(make_case, flat)) == "", "flat" if flat else "smooth"


@pytest.mark.parametrize("model", ["phong", "raytraced"])
@pytest.mark.parametrize("fov_deg", [(20.0, 120.0), None], ids=["perspective", "orthographic"])
@pytest.mark.parametrize("shapes", [("box", "cylinder", "plane"), ANALYTIC], ids=["found in float", "all"])
def test_random_refined_scenes_have_the_same_bits_in_packets_and_one_by_one(limit_packets, model, fov_deg, shapes):
    for seed in range(4):
        spec = random_spec(seed, shapes=shapes, fov_deg=fov_deg, light_kinds=("point", "directional"), film=(67, 45))
        assert differing_refined(case_of({**spec, "model": model}), limit_packets) == "", f"seed {seed}"


@pytest.mark.parametrize("lanes", [0, 4, 8, 16])
@pytest.mark.parametrize("changes", [{}, {"model": "phong"}, {"lights": {}}])
def test_refined_meshes_have_the_same_bits_in_packets_of_every_width_and_one_by_one(limit_packets, lanes, changes):
    try:
        found = differing_refined(triangles((131, 77), around=24, along=64, **changes), limit_packets, lanes)
    except TracerError as error:
        pytest.skip(str(error))
    assert found == ""


def test_a_finder_of_more_lanes_than_packets_may_have_does_without_packets(limit_packets):
    tracer = Tracer(triangles((67, 45), around=24, along=64))
    widest = tracer.render(precision="refined")["radiance"]
    limit_packets(4)
    assert told(tracer.render(precision="refined")["radiance"], widest) == ""


def test_refined_flat_and_smooth_meshes_of_every_placement_have_the_same_bits_in_packets_and_one_by_one(make_case, limit_packets):
    for flat in (False, True):
        case = placed_ring(make_case, flat)
        assert differing_refined(case, limit_packets) == "", "flat" if flat else "smooth"


@pytest.mark.parametrize("distance", [1e-9, 1.0, 1e9])
def test_refined_planes_and_meshes_together_have_the_same_bits_in_packets_and_one_by_one(make_case, limit_packets, distance):
    d = distance
    mesh = rippled_ring(12, 24)
    shape = type(mesh)(mesh.vertices * d, mesh.faces, mesh.vertex_normals)
    ring = {"kind": "mesh", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": [[0, 1, 2]]}
    floor = {"kind": "plane", "point": [0, 0, -0.3 * d], "normal": [0.1, 0.2, 1]}
    camera = {"projection": "perspective", "eye": [0, -3 * d, 2 * d], "target": [0, 0, 0], "fov_y_deg": 40}
    lamp = {"kind": "point", "position": [2 * d, -1 * d, 2 * d], "intensity": 20 * d * d}
    case = make_case(ring, floor, meshes={0: shape}, camera=camera, lights=[lamp], film={"width": 131, "height": 77})
    assert differing_refined(case, limit_packets) == ""


def test_refined_is_exact_where_both_see_the_same_primitive():
    for case, few in ((triangles((320, 180)), 1e-3), (spheres((320, 180)), 0.0)):
        tracer = Tracer(case)
        refined, exact = (tracer.render(precision=precision)["radiance"] for precision in ("refined", "exact"))
        apart = np.count_nonzero((refined != exact).any(axis=-1))
        assert apart <= few * 320 * 180, f"{case.name}: {told(refined, exact)}"
