"""Sensitivity of `raytraced` pictures to the geometry of what is seen, mirrored and refracted: against scenes that have moved."""

from __future__ import annotations

import numpy as np
import pytest

from equilux_scenes.case import Case
from equilux_scenes.mesh import TriangleMesh
from equilux_tracer import Tracer
from support.one_ray import box, lamp, plane, scene, sphere, sun
from support.random_raytraced import random_raytraced
from support.random_scenes import case_of

EYE = np.array([0.3, -2.0, 1.5])
TARGET = np.array([0.1, 0.2, 0.0])
QUAD = np.array([[-4, -4, 0], [4, -4, 0], [4, 4, 0], [-4, 4, 0]], dtype=float)
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])
MESH = {"kind": "mesh", "vertices": [[0, 0, 0]] * 3, "faces": [[0, 1, 2]], "normals": "smooth"}


def mesh_case(*others, mesh_material, materials, normal=(0, 0, 1), height=0.0, eye=EYE, target=TARGET, **more):
    """A floor that is a mesh, z = height, all of whose vertex normals are `normal`; it is object 0."""
    normal = np.asarray(normal, dtype=float)
    quad = TriangleMesh(QUAD + np.array([0, 0, height]), TRIANGLES, np.tile(normal / np.linalg.norm(normal), (4, 1)))
    materials = {"floor": mesh_material, **materials}
    spec = scene({**MESH, "material": "floor"}, *others, materials=materials, eye=list(eye), target=list(target), **more)
    case = case_of(spec)
    return Case(case.name, case.scene, case.scene_name, meshes={0: quad})


def seen(case):
    return Tracer(case).render(["radiance"])["radiance"][0, 0]


def largest_of_two(base, plus, minus):
    return np.maximum(np.abs(plus - base), np.abs(minus - base))


MIRROR = {"diffuse": [0.2, 0.1, 0.05], "specular": 0.4, "exponent": 20, "reflection": [0.9, 0.5, 0.1]}
WALL = plane([0, 5, 0], [0, -1, 0.2], "wall")
WALL_MATERIAL = {"diffuse": 0.5, "specular": 1.0, "exponent": 8}
LIGHTS = [lamp([1.0, 1.0, 4.0], 20.0), sun([0.1, 0.3, -1.0])]
MIRROR_SCENE = {"mesh_material": MIRROR, "materials": {"wall": WALL_MATERIAL}, "lights": LIGHTS}


def test_normals_of_a_mirror_that_is_a_mesh():
    # every vertex normal really turned: the local terms and what the mirror shows change together
    step = 3e-3
    base = seen(mesh_case(WALL, **MIRROR_SCENE))
    expected = np.zeros(3)
    for tangent in ([1, 0, 0], [0, 1, 0]):
        normals = [np.add([0, 0, 1], np.multiply(s * step, tangent)) for s in (1, -1)]
        expected += largest_of_two(base, *(seen(mesh_case(WALL, normal=n, **MIRROR_SCENE)) for n in normals))
    got = Tracer(mesh_case(WALL, **MIRROR_SCENE)).sensitivity([step, 0], 0)[0, 0]
    np.testing.assert_allclose(got, expected, rtol=1e-9, atol=1e-12)
    assert (got > 1e-4).all()


def test_positions_of_a_mirror_that_is_a_mesh():
    # P + δu is what a camera at the same eye sees that looks there, with the floor lifted so that it is there
    step = 3e-3
    base = seen(mesh_case(WALL, **MIRROR_SCENE))
    expected = np.zeros(3)
    for u in np.eye(3):
        moved = []
        for s in (step, -step):
            moved.append(seen(mesh_case(WALL, target=TARGET + s * u, height=(s * u)[2], **MIRROR_SCENE)))
        expected += largest_of_two(base, *moved)
    got = Tracer(mesh_case(WALL, **MIRROR_SCENE)).sensitivity(0, [step, 0])[0, 0]
    np.testing.assert_allclose(got, expected, rtol=1e-9, atol=1e-12)


GLASSY = {"reflection": 0.6}
IN_MIRROR = {"mesh_material": {"diffuse": [0.5, 0.2, 0.1], "specular": 0.5, "exponent": 15}, "materials": {"mirror": GLASSY}}
ABOVE = plane([0, 0, 4], [0.05, 0.1, -1], "mirror")
UPWARD = {"eye": [0, -1, 2], "target": [0.1, -0.4, 4]}
LOW_SUN = [lamp([1.0, 1.0, 3.0], 20.0)]


def test_normals_of_a_mesh_seen_in_a_mirror():
    step = 3e-3
    base = seen(mesh_case(ABOVE, lights=LOW_SUN, **IN_MIRROR, **UPWARD))
    expected = np.zeros(3)
    for tangent in ([1, 0, 0], [0, 1, 0]):
        normals = [np.add([0, 0, 1], np.multiply(s * step, tangent)) for s in (1, -1)]
        turned = [seen(mesh_case(ABOVE, normal=n, lights=LOW_SUN, **IN_MIRROR, **UPWARD)) for n in normals]
        expected += largest_of_two(base, *turned)
    got = Tracer(mesh_case(ABOVE, lights=LOW_SUN, **IN_MIRROR, **UPWARD)).sensitivity([step, 0], 0)[0, 0]
    np.testing.assert_allclose(got, expected, rtol=1e-9, atol=1e-12)
    assert (got > 1e-4).all()


def test_positions_of_a_mesh_seen_in_a_mirror():
    # The mirrored ray keeps its direction: P + δu as an eye sees it that moves along.
    step = 3e-3
    case = mesh_case(ABOVE, lights=LOW_SUN, **IN_MIRROR, **UPWARD)
    eye, target, n = np.array(UPWARD["eye"]), np.array(UPWARD["target"]), np.array([0.05, 0.1, -1])
    n /= np.linalg.norm(n)
    d = (target - eye) / np.linalg.norm(target - eye)
    at_mirror = eye + d * (n @ ([0, 0, 4] - eye)) / (n @ d)
    onward = d - 2 * (n @ d) * n
    hit = at_mirror + onward * (0 - at_mirror[2]) / onward[2]

    def from_near(point):
        below = {"height": point[2], "eye": point - 0.5 * onward, "target": point}
        return 0.6 * seen(mesh_case(ABOVE, lights=LOW_SUN, **IN_MIRROR, **below))

    expected = np.zeros(3)
    for u in np.eye(3):
        expected += largest_of_two(from_near(hit), from_near(hit + step * u), from_near(hit - step * u))
    got = Tracer(case).sensitivity(0, [step, 0])[0, 0]
    np.testing.assert_allclose(got, expected, rtol=1e-9, atol=1e-12)


def refracted(d, n, eta):
    c = -n @ d
    return eta * d + (eta * c - np.sqrt(1 - eta**2 * (1 - c**2))) * n


@pytest.mark.parametrize("as_mesh", [False, True])
def test_positions_of_a_glass_slab_shift_what_is_behind_it_at_both_surfaces(as_mesh):
    step, thick, ior = 2e-3, 0.5, 1.5
    glass = {"transparency": 1.0, "transmission": 0.9, "ior": ior}
    light = np.array([0.7, 0.3, -2.5])
    up = np.array([0.0, 0.0, 1.0])
    eye, target = np.array([0.1, -1.0, 2.0]), np.array([0.3, 0.2, 0.0])

    def down(p, d, z):
        return p + d * (z - p[2]) / d[2]

    def screen(p, d):
        toward = light - down(p, d, -3.0)
        return toward[2] / np.linalg.norm(toward) ** 3

    def from_top(p):
        d = refracted((p - eye) / np.linalg.norm(p - eye), up, 1 / ior)
        return from_bottom(down(p, d, -thick), d)

    def from_bottom(p, d):
        return 0.9**2 * screen(p, refracted(d, up, ior))

    first = target
    inside = refracted((first - eye) / np.linalg.norm(first - eye), up, 1 / ior)
    second = down(first, inside, -thick)
    base, expected = from_top(first), 0.0
    for u in np.eye(3) * step:
        expected += max(abs(from_top(first + u) - base), abs(from_top(first - u) - base))
        expected += max(abs(from_bottom(second + u, inside) - base), abs(from_bottom(second - u, inside) - base))
    solid, meshes = box([-9, -9, -thick], [9, 9, 0], "glass"), {}
    if as_mesh:
        corners = np.array([[x, y, z] for x in (-9, 9) for y in (-9, 9) for z in (-thick, 0)], dtype=float)
        sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        faces = np.array([t for a, b, c, e in sides for t in ((a, b, c), (a, c, e))])
        solid, meshes = {**MESH, "normals": "flat", "material": "glass"}, {0: TriangleMesh(corners, faces, None)}
    spec = scene(
        solid, plane([0, 0, -3], [0, 0, 1], "screen"), materials={"glass": glass, "screen": {"diffuse": 1.0}}, eye=eye.tolist(),
        target=target.tolist(), lights=[lamp(light.tolist())], transparent_shadows="ignore",
    )  # fmt: skip
    case = case_of(spec)
    got = Tracer(Case(case.name, case.scene, case.scene_name, meshes=meshes)).sensitivity(0, [step, 0])[0, 0, 0]
    assert abs(got - expected) <= 1e-9 * expected, f"got {got}, expected {expected}"


def test_a_step_across_a_silhouette_shows_only_the_continuous_change():
    # A mirror shows the rim of a lamp 1e-3 away: a whole step would leave the lamp, which glows alike all over.
    mirror, glow = {"reflection": 1.0}, {"emission": 100.0}
    panel = {"kind": "rectangle", "corner": [-5, 2.0, 0.5], "edge_u": [10, 0, 0], "edge_v": [0, 0, 9], "material": "glow"}
    eye, target = [0, -2.0, 2.0], [0, 0.0, 0.0]  # mirrored: up at 45°, at y = 2 the height is 2
    case = mesh_case({**panel, "edge_v": [0, 0, 1.501]}, mesh_material=mirror, materials={"glow": glow}, eye=eye, target=target)
    assert seen(case)[0] == 100
    got = Tracer(case).sensitivity([0.01, 0], [0.01, 0])[0, 0]
    assert (got == 0).all(), f"got {got}, expected 0"


@pytest.mark.parametrize("seed", range(4))
def test_objects_add_up_and_so_do_normals_and_positions(seed):
    case = case_of(random_raytraced(seed, film=(16, 12)))
    objects = len(case.scene.objects)
    tracer = Tracer(case)
    normal, position = np.linspace(1e-3, 2e-3, objects), np.linspace(2e-4, 1e-4, objects)
    whole = tracer.sensitivity(normal, position)
    parts = tracer.sensitivity(normal, 0) + tracer.sensitivity(0, position)
    np.testing.assert_allclose(parts, whole, rtol=1e-10, atol=1e-14)
    alone = sum(tracer.sensitivity(np.where(np.arange(objects) == k, normal, 0), 0) for k in range(objects))
    np.testing.assert_allclose(alone, tracer.sensitivity(normal, 0), rtol=1e-10, atol=1e-14)
    assert whole.max() > 1e-3
    assert (tracer.sensitivity(0, 0) == 0).all()


def test_with_a_recursion_limit_of_zero_only_the_local_terms_move():
    steps = {"normal": [3e-3, 0], "position_m": [1e-3, 0]}
    limited = Tracer(mesh_case(WALL, recursion_limit=0, **MIRROR_SCENE)).sensitivity(**steps)
    matt = {**MIRROR_SCENE, "mesh_material": {**MIRROR, "reflection": 0.0}}
    np.testing.assert_array_equal(limited, Tracer(mesh_case(WALL, **matt)).sensitivity(**steps))


def test_a_ball_moved_inward_does_not_meet_itself():
    # its own surface, a step away, is no crossing: the mirrored ray sees the far wall as before
    glow = {"emission": 3.0}
    spec = scene(
        sphere([0, 0, 0], 1, "mirror"), plane([0, 0, 9], [0, 0, -1], "glow"),
        materials={"mirror": {"reflection": 0.5}, "glow": glow}, eye=[0.2, 0.1, 5], target=[0.2, 0.1, 0],
    )  # fmt: skip
    got = Tracer(case_of(spec)).sensitivity(0, [1e-2, 0])
    assert (got == 0).all(), f"got {got}: the wall glows alike everywhere"
