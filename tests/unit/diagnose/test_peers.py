"""Pairs of peers: what is accounted for is what both sides' causes account for."""

from __future__ import annotations

import numpy as np
import pytest

from equilux.compare import compare_pair
from equilux.diagnose.peers import Accounts, PeerExplanation
from equilux.diagnose.search import diagnose
from equilux_tracer import Tracer
from equilux_tracer.causes import Applied
from support.faults import RULES, Faulty, faulty, two_balls


def explained(a: Faulty, b: Faulty) -> PeerExplanation:
    accounts = Accounts(a.case, a.truth, RULES)
    sides = []
    for name, wrong in (("a", a), ("b", b)):
        side = type(wrong.side)(name, wrong.side.image, wrong.side.uncertainty)
        agrees = wrong.scored.json["verdict"] == "agree"
        found = None if agrees else diagnose(wrong.case, side, wrong.truth, wrong.scored, restate=None, rules=RULES)
        accounts.add(side, wrong.scored, found)
        sides.append(side)
    pair = compare_pair(sides[0], sides[1], Tracer(a.case))
    answer = accounts.explain("a", "b", pair.planes["class"])
    assert answer is not None
    return answer


def test_causes_of_both_sides_account_for_their_pair() -> None:
    case = two_balls()
    answer = explained(faulty(case, Applied("scaled", 2.0)), faulty(case, Applied("light-missing", "key")))
    assert answer.explained == 1.0
    assert {(cause.side, cause.id) for cause in answer.causes} == {("a", "scaled"), ("b", "light-missing")}


def test_a_side_that_agrees_with_the_truth_adds_no_cause() -> None:
    case = two_balls()
    answer = explained(faulty(case, Applied("flipped-x"), Applied("scaled", 2.0)), faulty(case))
    assert answer.explained == 1.0
    assert {(cause.side, cause.id) for cause in answer.causes} == {("a", "flipped-x"), ("a", "scaled")}


def test_what_is_unexplained_of_one_side_is_unexplained_of_the_pair() -> None:
    case = two_balls()
    picture = Tracer(case).render()["radiance"]
    on_floor = Tracer(case).render(("object_id",))["object_id"] == 1
    odd = np.where(on_floor[:, :, None], picture + 0.1 * np.sin(np.arange(64))[None, :, None] + 0.2, picture)
    answer = explained(faulty(case, Applied("scaled", 2.0)), faulty(case, picture=odd))
    assert answer.causes[-1].id == "unexplained"
    assert answer.explained == pytest.approx(1 - float(on_floor.mean()), abs=0.02)
