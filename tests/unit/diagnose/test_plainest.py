"""Which of several explanations is reported: the plainest, the smallest, with values that are known."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest

from equilux.compare import RenderedImage, compare_pair
from equilux.diagnose.catalogue import all_rules
from equilux.diagnose.diagnosis import Diagnosis
from equilux.diagnose.hypotheses import Preference
from equilux.diagnose.search import diagnose
from equilux.uncertainty import Uncertainty
from equilux_tracer import Tracer
from equilux_tracer.causes import Applied, ChangedTracer
from support.faults import STATED, truth_of, two_balls

CASE = two_balls()
CATALOGUE = all_rules()


def diagnosed(*causes: Applied, dialect: Sequence[Applied] = ()) -> Diagnosis:
    shown = ChangedTracer(CASE, causes, CATALOGUE).render()["radiance"]
    side, truth = RenderedImage("lab", shown, Uncertainty(rel=STATED)), truth_of(CASE)
    scored = compare_pair(side, truth, Tracer(CASE))
    return diagnose(CASE, side, truth, scored, restate=None, rules=CATALOGUE, dialect=dialect)


@pytest.mark.parametrize("k", [4.0, 3.7])
def test_blinns_half_vector_with_a_converted_exponent_is_two_causes(k: float) -> None:
    """Neither looks likely by itself, and the first misleads the estimate of the second."""
    found = diagnosed(Applied("half-vector"), Applied("exponent-scaled", k))
    by_id = {cause.id: cause.parameter for cause in found.causes}
    assert by_id == {"half-vector": None, "exponent-scaled": pytest.approx(k, rel=1e-4)}, found


def test_a_cause_without_a_number_goes_before_a_fitted_one_that_does_the_same() -> None:
    found = diagnosed(Applied("clamped", 0.25), Applied("highlight-missing"))
    assert {cause.id for cause in found.causes} <= {"clamped", "highlight-missing"}, found


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (Applied("diffuse-missing"), Applied("mirrored-handedness")),
        (Applied("highlight-missing"), Applied("exponent-scaled", 8.8)),
        (Applied("light-missing", "key"), Applied("clamped", 0.017)),
        (Applied("scaled", math.pi), Applied("scaled", 3.1)),
        (Applied("scaled", math.pi), Applied("gamma-encoded", "4.002511196", "decoded")),
        (Applied("gamma-encoded", "srgb"), Applied("scaled", 1.7)),
        (Applied("half-vector"), Applied("highlight-tinted", None, "hue")),
    ],
    ids=str,
)
def test_the_plainer_cause_is_preferred(first: Applied, second: Applied) -> None:
    preference = Preference(CATALOGUE)
    assert preference.of(first) < preference.of(second)


def test_a_picture_without_light_is_not_a_matter_of_geometry() -> None:
    side, truth = RenderedImage("lab", np.zeros((48, 64, 3)), Uncertainty(rel=STATED)), truth_of(CASE)
    found = diagnose(CASE, side, truth, compare_pair(side, truth, Tracer(CASE)), restate=None, rules=CATALOGUE)
    groups = [CATALOGUE[cause.id].group for cause in found.causes if cause.id in CATALOGUE]
    assert "geometry" not in groups, found


def test_a_declared_cause_is_reported_with_what_the_scene_cannot_tell_from_it() -> None:
    declared = Applied("flipped-x")
    (cause,) = diagnosed(declared, dialect=[declared]).causes
    assert (cause.id, cause.declared) == ("flipped-x", True)
    assert {"mirrored-handedness"} <= {other.id for other in cause.alternatives}, cause
