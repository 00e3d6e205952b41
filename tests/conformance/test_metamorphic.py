"""Laws of light that hold whatever the scene, over random scenes, for the tracer and for the oracle.

Where telling a scene differently rounds no number (powers of two, whole metres on a binary grid, exchanged axes), the picture
must be the same to the evaluator's own promise, edges included, or even to the last bit; only where the telling itself rounds are
edges left out.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import equilux_oracle
from equilux_tracer import Tracer
from support.edges import on_edge
from support.random_scenes import case_of, changed, random_spec
from support.rearranged import (
    enlarged,
    exposed,
    moved,
    on_a_grid,
    rotation_about,
    shifted,
    turned_exactly,
    with_bands_exchanged,
    with_lights_scaled,
    without_own_light,
)

PROMISE = 1e-12
"""Each evaluation's own error, in units of the scale K_emit + K_amb L_amb + Σ E_i (K_diff + K_spec), where |N·V| ≥ 0.1."""

INPUTS = 1e-10
"""What rounding a scene's numbers once more may change, in units of the scale with spots' cos^e left out. Places and matrices are
rounded by 2^-52 of at most 10 m; hit points then move by 10 times that at |N·V| = 0.1, and normals by this over the least radius
of curvature, 0.2 × 0.6: 2e-13 in every direction. A highlight of exponent 1000 feels 19 times that twice over (R turns twice as
far as N), a spot of exponent 60 at 89° feels 60 times; with E's own the sum is below 3e-11."""

SUBJECTS = {
    "tracer": lambda case, film_xy: Tracer(case).evaluate(film_xy, ["radiance"])["radiance"],
    "oracle": equilux_oracle.evaluate,
}
EXAMPLES = {"tracer": 25, "oracle": 8}  # the oracle is slower, and is checked against fifty digits besides

PROPERTY = settings(deadline=None, derandomize=True, database=None)
specs = st.builds(
    random_spec,
    st.integers(0, 2**32),
    fov_deg=st.sampled_from([(20.0, 90.0), (1.0, 3.0), (120.0, 150.0), None]),
    film=st.just((14, 10)),
)
plain_specs = st.builds(  # nothing is rotated, so that the whole scene can be told elsewhere without rounding
    random_spec,
    st.integers(0, 2**32),
    fov_deg=st.sampled_from([(20.0, 90.0), (1.0, 3.0), (120.0, 150.0), None]),
    film=st.just((14, 10)),
    transforms=st.just(False),
    inverse_square=st.just(True),
)
gentle_specs = st.builds(  # for telling with rounding: no slope without bound (p < 1), no eye far off
    random_spec,
    st.integers(0, 2**32),
    fov_deg=st.sampled_from([(20.0, 90.0), None]),
    film=st.just((14, 10)),
    exponents=st.just((1.0, 1000.0)),
)


def law(strategies):
    """Run a property for both subjects: the function is given `see` (spec → radiance at the pixel centres) and what is drawn."""

    def decorate(claim):
        @pytest.mark.parametrize("subject", SUBJECTS)
        def test(subject):
            def see(spec):
                case = case_of(spec)
                return SUBJECTS[subject](case, equilux_oracle.pixel_centers(case.scene.film))

            @settings(PROPERTY, max_examples=EXAMPLES[subject])
            @given(**strategies)
            def holds(**drawn):
                claim(see, **drawn)

            holds()

        test.__name__, test.__doc__ = claim.__name__, claim.__doc__
        return test

    return decorate


def allowed(spec, share=PROMISE, evaluations=2):
    """Allowed difference (n, 3) between sums of so many evaluations of a scene; wider where grazing."""
    case = case_of(spec)
    true = equilux_oracle.examine(case, equilux_oracle.pixel_centers(case.scene.film))
    return evaluations * share * true.scale * np.maximum(1.0, 0.1 / np.maximum(true.facing, 1e-300))[:, np.newaxis]


def assert_same(got, true, within=0.0, but=None):
    """Each pixel of one within so much of the other, `but` left out; says both numbers."""
    wrong = ~(np.abs(got - true) <= within).all(axis=1)
    if but is not None:
        wrong &= ~but
    k = int(np.argmax(wrong))
    limit = np.broadcast_to(within, got.shape)[k].tolist()
    assert not wrong[k], f"pixel {k}: got {got[k].tolist()}, law {true[k].tolist()}, allowed {limit}; {wrong.sum()} pixels"


@law({"spec": specs})
def test_doubling_intensity_doubles_radiance(see, spec):
    spec = without_own_light(spec)
    assert_same(see(with_lights_scaled(spec, 2.0)), 2 * see(spec))


@law({"spec": specs, "factor": st.floats(1e-6, 1e6)})
def test_any_exposure_scales_radiance_alike(see, spec, factor):
    assert_same(see(exposed(spec, factor)), factor * see(spec), factor * allowed(spec))


@law({"spec": specs, "power": st.integers(-40, 40)})
def test_exposure_by_a_power_of_two_scales_radiance_to_the_last_bit(see, spec, power):
    assert_same(see(exposed(spec, 2.0**power)), 2.0**power * see(spec))


@law({"spec": specs})
def test_lights_add(see, spec):
    nothing = see(changed(spec, lights={}))
    alone = [see(changed(spec, lights={name: light})) - nothing for name, light in spec["lights"].items()]
    assert_same(see(spec), nothing + sum(alone), allowed(spec, evaluations=2 + 2 * len(alone)))


@law({"spec": specs, "emission": st.floats(0, 10)})
def test_emission_adds(see, spec, emission):
    dark = changed(spec, materials={name: {**m, "emission": [0, 0, 0]} for name, m in spec["materials"].items()})
    lit = changed(spec, materials={name: {**m, "emission": [emission] * 3} for name, m in spec["materials"].items()})
    case = case_of(spec)
    hit = equilux_oracle.examine(case, equilux_oracle.pixel_centers(case.scene.film)).object_id >= 0
    assert_same(see(lit), see(dark) + emission * hit[:, np.newaxis], allowed(lit))


@law({"spec": specs, "order": st.permutations(range(3))})
def test_exchanging_bands_exchanges_bands(see, spec, order):
    assert_same(see(with_bands_exchanged(spec, order)), see(spec)[:, list(order)])


@law({"spec": specs, "data": st.data()})
def test_permuting_objects_changes_nothing(see, spec, data):
    assert_same(see(changed(spec, objects=data.draw(st.permutations(spec["objects"])))), see(spec))


@law({"spec": specs, "data": st.data()})
def test_permuting_lights_changes_nothing(see, spec, data):
    lights = dict(data.draw(st.permutations(list(spec["lights"].items()))))
    assert_same(see(changed(spec, lights=lights)), see(spec), allowed(spec))


TURNS = [
    (axes, signs)
    for axes in itertools.permutations(range(3))
    for signs in itertools.product((1.0, -1.0), repeat=3)
    if np.linalg.det(np.eye(3)[list(axes)] * np.asarray(signs)[:, None]) > 0
]


@law({"spec": plain_specs, "turn": st.sampled_from(TURNS)})
def test_turning_everything_by_right_angles_changes_nothing(see, spec, turn):
    assert_same(see(turned_exactly(spec, *turn)), see(spec), allowed(spec))


@law({"spec": plain_specs, "by": st.tuples(*[st.integers(-(2**30), 2**30)] * 3)})
def test_shifting_everything_by_whole_metres_changes_nothing(see, spec, by):
    spec = on_a_grid(spec)
    assert_same(see(shifted(spec, by)), see(spec), allowed(spec))


vectors = st.tuples(*[st.floats(0.1, 3)] * 3)


@law({"spec": gentle_specs, "axis": vectors, "angle": st.floats(-3, 3), "by": vectors})
def test_a_rigid_motion_of_everything_changes_nothing(see, spec, axis, angle, by):
    other = moved(spec, rotation_about(axis, angle), by)
    case = case_of(spec)
    edge = on_edge(Tracer(case), equilux_oracle.pixel_centers(case.scene.film))
    lights = {name: {**light, "exponent": 0} if light["kind"] == "spot" else light for name, light in spec["lights"].items()}
    assert_same(see(other), see(spec), allowed(changed(spec, lights=lights), INPUTS), but=edge)


@law({"spec": plain_specs, "power": st.integers(-20, 20)})
def test_enlarging_by_a_power_of_two_with_intensity_squared_changes_not_a_bit(see, spec, power):
    assert_same(see(enlarged(spec, 2.0**power)), see(spec))


@law({"spec": gentle_specs, "factor": st.floats(1e-3, 1e3)})
def test_enlarging_with_intensity_squared_changes_nothing(see, spec, factor):
    lights = {name: {k: v for k, v in light.items() if k != "attenuation"} for name, light in spec["lights"].items()}
    shapes = [{k: v for k, v in shape.items() if k != "transform"} for shape in spec["objects"]]
    spec = changed(spec, lights=lights, objects=shapes)
    case = case_of(spec)
    edge = on_edge(Tracer(case), equilux_oracle.pixel_centers(case.scene.film))
    even = {name: {**light, "exponent": 0} if light["kind"] == "spot" else light for name, light in lights.items()}
    assert_same(see(enlarged(spec, factor)), see(spec), allowed(changed(spec, lights=even), INPUTS), but=edge)


@law({"spec": specs})
def test_a_finer_film_shows_the_same_at_the_same_places(see, spec):
    width, height = spec["film"]["width"], spec["film"]["height"]
    fine = see(changed(spec, film={"width": 3 * width, "height": 3 * height})).reshape(3 * height, 3 * width, 3)
    assert_same(fine[1::3, 1::3].reshape(-1, 3), see(spec), allowed(spec))


@law({"spec": specs})
def test_turning_normals_round_changes_nothing(see, spec):
    shapes = [{**s, "normal": [-c for c in s["normal"]]} if "normal" in s else s for s in spec["objects"]]
    shapes = [{**s, "edge_u": s["edge_v"], "edge_v": s["edge_u"]} if "edge_u" in s else s for s in shapes]
    assert_same(see(changed(spec, objects=shapes)), see(spec), allowed(spec))


@law({"fov": st.floats(1, 150), "distance": st.floats(2, 1e6), "emission": st.floats(1e-3, 1e3)})
def test_the_radiance_of_an_emitter_does_not_change_with_distance(see, fov, distance, emission):
    spec = random_spec(1, film=(1, 1))
    view = {"projection": "perspective", "eye": [0, 0, distance], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y_deg": fov}
    ball = {"kind": "sphere", "center": [0, 0, 0], "radius": 1, "material": "m0"}
    spec = changed(spec, camera=view, objects=[ball], lights={}, ambient=0, materials={"m0": {"emission": emission}})
    assert see(spec).tolist() == [[emission] * 3]


@law({"spec": specs})
def test_no_radiance_is_negative_and_none_exceeds_the_scale(see, spec):
    case = case_of(spec)
    true = equilux_oracle.examine(case, equilux_oracle.pixel_centers(case.scene.film))
    hit = true.object_id >= 0
    value = see(spec)
    assert (value >= 0).all(), f"least radiance {value.min()}"
    assert (value[hit] <= true.scale[hit] * (1 + PROMISE)).all(), f"largest share {np.nanmax(value[hit] / true.scale[hit])}"
    assert math.isfinite(value.sum())
