"""The search on a small picture, with rules of the tests' own."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from equilux.compare import compare_pair
from equilux.diagnose.diagnosis import Diagnosis
from equilux.diagnose.search import diagnose
from equilux_scenes.case import Case
from equilux_tracer import Tracer
from equilux_tracer.causes import Applied, Rule
from support.faults import RULES, Faulty, faulty, two_balls


def diagnosed(wrong: Faulty, **how: Any) -> Diagnosis:
    return diagnose(wrong.case, wrong.side, wrong.truth, wrong.scored, restate=None, rules=RULES, **how)


def names(found: Diagnosis) -> list[tuple[str, Any]]:
    return sorted((cause.id, cause.parameter) for cause in found.causes)


@pytest.mark.parametrize(
    "cause",
    [
        Applied("scaled", 1 / math.pi), Applied("scaled", 1.37), Applied("exponent-clamped", 37.0),
        Applied("light-missing", "key"), Applied("light-missing", "fill"), Applied("diffuse-missing"),
    ],
    ids=str,
)  # fmt: skip
def test_a_single_cause_is_named_with_its_parameter(cause: Applied) -> None:
    found = diagnosed(faulty(two_balls(), cause))
    assert [one.id for one in found.causes] == [cause.cause]
    assert (found.explained, found.broken) == (1.0, 0)
    if isinstance(cause.parameter, float):
        assert found.causes[0].parameter == pytest.approx(cause.parameter, rel=1e-9)
    else:
        assert found.causes[0].parameter == cause.parameter


def test_a_factor_of_one_over_pi_is_recognised_and_exact() -> None:
    (cause,) = diagnosed(faulty(two_balls(), Applied("scaled", 1 / math.pi))).causes
    assert (cause.recognised, cause.parameter) == ("1/π", 1 / math.pi)
    assert "1/π" in cause.words


def test_a_fit_is_right_within_a_wide_uncertainty_too() -> None:
    (cause,) = diagnosed(faulty(two_balls(), Applied("exponent-clamped", 37.25), rel=1e-3)).causes
    assert cause.parameter == pytest.approx(37.25, rel=1e-3)


@pytest.mark.parametrize(
    "causes",
    [
        (Applied("flipped-x"), Applied("scaled", 2.0)),
        (Applied("light-missing", "fill"), Applied("scaled", 0.75)),
        (Applied("exponent-clamped", 20.0), Applied("light-missing", "fill")),
        (Applied("flipped-x"), Applied("exponent-clamped", 20.0)),
    ],
    ids=lambda causes: " + ".join(map(str, causes)),
)
def test_pairs_of_causes_are_told_apart(causes: tuple[Applied, ...]) -> None:
    found = diagnosed(faulty(two_balls(), *causes))
    ids = {cause.id for cause in found.causes}
    assert ids == {cause.cause for cause in causes}, found
    assert found.explained == 1.0
    for cause in causes:
        named = next(one for one in found.causes if one.id == cause.cause)
        if cause.parameter is not None:
            assert named.parameter == (pytest.approx(cause.parameter) if isinstance(cause.parameter, float) else cause.parameter)


def test_three_causes_are_found_together() -> None:
    causes = (Applied("flipped-x"), Applied("light-missing", "fill"), Applied("scaled", 0.25))
    found = diagnosed(faulty(two_balls(), *causes))
    assert {cause.id for cause in found.causes} == {"flipped-x", "light-missing", "scaled"}, found
    assert found.explained == 1.0


def test_causes_that_a_scene_cannot_tell_apart_are_reported_together() -> None:
    (cause,) = diagnosed(faulty(two_balls(), Applied("flipped-x"))).causes
    assert (cause.id, [other.id for other in cause.alternatives]) == ("flipped-x", ["mirrored-handedness"])


def test_an_expected_cause_is_named_first_of_two_that_do_the_same() -> None:
    (cause,) = diagnosed(faulty(two_balls(), Applied("flipped-x")), expected=["mirrored-handedness"]).causes
    assert (cause.id, [other.id for other in cause.alternatives]) == ("mirrored-handedness", ["flipped-x"])


def test_a_declared_dialect_is_enough_and_what_it_does_not_need_is_left_out() -> None:
    dialect = (Applied("exponent-clamped", 20.0), Applied("light-missing"))
    found = diagnosed(faulty(two_balls(), Applied("exponent-clamped", 20.0), Applied("light-missing", "key")), dialect=dialect)
    assert (found.dialect, names(found)) == ("agree", [("exponent-clamped", 20.0), ("light-missing", "key")])
    assert all(cause.declared for cause in found.causes)


def test_a_render_that_does_not_follow_its_dialect_is_told() -> None:
    found = diagnosed(faulty(two_balls(), Applied("scaled", 2.0)), dialect=(Applied("exponent-clamped", 20.0),))
    assert (found.dialect, names(found)) == ("diverge", [("scaled", 2.0)])
    assert not found.causes[0].declared


def test_what_no_rule_does_is_unexplained_with_its_term_and_region() -> None:
    case = two_balls()
    channels = Tracer(case).render(("radiance", "specular"))
    picture = channels["radiance"] + 0.3 * np.sqrt(channels["specular"][:, :, 0])
    found = diagnosed(faulty(case, picture=picture))
    (cause,) = found.causes
    assert (cause.id, found.explained, cause.explained) == ("unexplained", 0.0, 1.0)
    assert next(iter(cause.terms)) == "specular key", cause.terms
    assert cause.region is not None
    assert "objects[0] (sphere, clay)" in cause.region.words


def test_noise_is_unexplained() -> None:
    """Not a curve and a factor of 1e5, under which the reference is so uncertain in the dark that it agrees with everything."""
    case = two_balls()
    truth = Tracer(case).render()["radiance"]
    noise = np.random.default_rng(1).standard_normal(truth.shape)
    found = diagnosed(faulty(case, picture=np.maximum(truth + 0.01 * truth.max() * noise, 0)))
    assert [cause.id for cause in found.causes] == ["unexplained"], found


def test_a_rule_that_cannot_be_tried_is_told_where_something_stays_unexplained() -> None:
    class Raising(Rule):
        """What a third party may write."""

        id = "acme:gloss"
        group = "highlight"
        formula = ("gloss", "no gloss")

        def hypotheses(self, case: Case) -> Sequence[Applied]:
            raise ValueError("no gloss here")

    case = two_balls()
    channels = Tracer(case).render(("radiance", "specular"))
    unknown = faulty(case, picture=channels["radiance"] + 0.3 * np.sqrt(channels["specular"][:, :, 0]))
    rules = {**RULES, "acme:gloss": Raising()}
    (left,) = diagnose(unknown.case, unknown.side, unknown.truth, unknown.scored, restate=None, rules=rules).causes
    assert left.id == "unexplained"
    assert "acme:gloss could not be tried (hypotheses: ValueError: no gloss here)" in left.words


def test_a_cause_that_explains_a_part_is_named_beside_the_unexplained_rest() -> None:
    """The floor is wrong in a way of its own."""
    case = two_balls()
    wrong = faulty(case, Applied("exponent-clamped", 20.0)).side.image.copy()
    on_floor = Tracer(case).render(("object_id",))["object_id"] == 1
    wrong[on_floor] += np.sin(np.arange(on_floor.sum()))[:, None] * 0.01 + 0.02
    found = diagnosed(faulty(case, picture=wrong))
    assert [cause.id for cause in found.causes] == ["exponent-clamped", "unexplained"], found
    assert found.causes[0].parameter == pytest.approx(20.0)
    assert sum(cause.explained or 0 for cause in found.causes) == pytest.approx(1.0)


def test_a_further_cause_of_a_few_pixels_is_found_in_what_the_first_leaves_over() -> None:
    """20 of 3072 pixels: the first cause alone accounts for 99 %."""
    found = diagnosed(faulty(two_balls(), Applied("scaled", 3.0), Applied("acme:dim-corner")))
    assert [cause.id for cause in found.causes] == ["scaled", "acme:dim-corner"], found
    assert found.explained == 1.0


def test_pixels_that_are_not_finite_are_no_evidence() -> None:
    case = two_balls()
    picture = faulty(case, Applied("scaled", 3.0)).side.image.copy()
    picture[::3, ::2] = np.nan
    picture[1::3, 1::2, 0] = np.inf
    found = diagnosed(faulty(case, picture=picture))
    assert names(found) == [("scaled", 3.0)]


def test_a_picture_of_another_size_has_no_diagnosis() -> None:
    case = two_balls()
    wrong = faulty(case, Applied("scaled", 3.0))
    small = type(wrong.side)("lab", wrong.side.image[:-1], wrong.side.uncertainty)
    found = diagnosed(Faulty(case, small, wrong.truth, compare_pair(small, wrong.truth, None)))
    assert (found.diverging, found.causes) == (0, ())


def test_the_same_pair_gets_the_same_diagnosis() -> None:
    wrong = faulty(two_balls(), Applied("flipped-x"), Applied("scaled", 2.0))
    first, second = (diagnosed(wrong).model_copy(update={"seconds": 0.0}) for _ in range(2))
    assert first == second


def test_a_diagnosis_survives_json() -> None:
    found = diagnosed(faulty(two_balls(), Applied("light-missing", "fill")))
    assert Diagnosis.model_validate(found.model_dump(mode="json")) == found
