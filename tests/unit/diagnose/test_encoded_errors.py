"""A renderer's own error is another one once its picture is encoded."""

from __future__ import annotations

import numpy as np
import pytest

from equilux.diagnose.search import diagnose
from equilux_tracer import Tracer
from equilux_tracer.causes import RULES
from support.faults import faulty, two_balls

ERROR = 2e-4
"""Relative: a twentieth of a step of 8 bits, so that some values are rounded the other way."""


@pytest.mark.parametrize("cause", ["quantised", "gamma-encoded"])
def test_nothing_is_left_of_a_picture_that_is_off_by_a_little_before_it_is_encoded(cause: str) -> None:
    case = two_balls(film={"width": 96, "height": 72})
    true = Tracer(case).render()["radiance"]
    sign = np.where(np.indices(true.shape).sum(axis=0) % 2, 1.0, -1.0)
    linear = true * (1 + 0.9 * ERROR * sign)
    encoded = np.round(np.minimum(linear, 1) * 255) / 255 if cause == "quantised" else linear ** (1 / 2.2)
    wrong = faulty(case, picture=encoded, rel=ERROR)
    rules = {id_: RULES[id_] for id_ in ("quantised", "gamma-encoded", "scaled", "diffuse-missing")}
    found = diagnose(wrong.case, wrong.side, wrong.truth, wrong.scored, restate=None, rules=rules)
    assert [one.id for one in found.causes] == [cause]
    assert found.explained == 1.0
