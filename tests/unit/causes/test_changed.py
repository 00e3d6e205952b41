"""The changed tracer: causes one upon another, and how errors of the geometry come through the picture's own rules."""

from __future__ import annotations

import numpy as np
import pytest

from equilux_tracer import Tracer
from equilux_tracer.causes import RULES, Applied, ChangedTracer
from support.cause_scenes import lopsided
from support.faulty import assert_same, picture

CASE = lopsided()
TRUE = picture(CASE)


def shown(*causes):
    return ChangedTracer(CASE, causes, RULES).render()["radiance"]


def test_without_causes_it_is_the_tracer():
    assert_same(shown(), TRUE, relative=0)


def test_causes_of_values_follow_one_another_in_their_order():
    clamped, encoded = Applied("clamped", 0.5), Applied("gamma-encoded", "2.2")
    assert_same(shown(clamped, encoded), np.minimum(TRUE, 0.5) ** (1 / 2.2))
    assert_same(shown(encoded, clamped), np.minimum(TRUE ** (1 / 2.2), 0.5))


def test_causes_of_places_follow_one_another_in_their_order():
    flipped, moved = Applied("flipped-x"), Applied("shifted", (3.0, 0.0), "wrapped")
    assert_same(shown(flipped, moved), np.roll(TRUE[:, ::-1], 3, axis=1))
    assert_same(shown(moved, flipped), np.roll(TRUE, 3, axis=1)[:, ::-1])


def test_a_border_filled_with_black_is_moved_by_what_comes_after():
    moved = np.zeros_like(TRUE)
    moved[:, 4:] = TRUE[:, :-4]
    assert_same(shown(Applied("shifted", (4.0, 0.0), "black"), Applied("flipped-x")), moved[:, ::-1])


def test_the_scene_is_changed_before_the_picture_whatever_the_order():
    mirrored, halved = Applied("mirrored-handedness", None, "z"), Applied("scaled", 0.5)
    assert_same(shown(mirrored, halved), shown(halved, mirrored))
    assert_same(shown(mirrored, halved), 0.5 * shown(mirrored))


def test_channels_follow_the_place_and_not_the_value():
    changed = ChangedTracer(CASE, [Applied("flipped-y"), Applied("scaled", 2.0)], RULES)
    out = changed.render(["radiance", "object_id", "diffuse"])
    true = Tracer(CASE).render(["object_id", "diffuse"])
    assert (out["object_id"] == true["object_id"][::-1]).all()
    assert_same(out["diffuse"], true["diffuse"][::-1])


def test_one_position_is_evaluated_like_a_whole_film():
    changed = ChangedTracer(CASE, [Applied("shifted", (0.5, -0.25)), Applied("clamped", 0.6)], RULES)
    whole = changed.render()["radiance"]
    assert_same(changed.evaluate([[7.5, 4.5]])["radiance"][0], whole[4, 7], relative=0)


def test_a_factor_multiplies_the_sensitivity_and_a_flip_moves_it():
    plain = Tracer(CASE).sensitivity(1e-3, 1e-3)
    # the rule makes a step of the sum itself: as much is lost as L + step rounds
    assert_same(ChangedTracer(CASE, [Applied("scaled", 3.0)], RULES).sensitivity(1e-3, 1e-3), 3 * plain, relative=1e-9)
    assert_same(ChangedTracer(CASE, [Applied("flipped-x")], RULES).sensitivity(1e-3, 1e-3), plain[:, ::-1], relative=1e-9)


def test_what_is_cut_off_does_not_follow_the_geometry():
    sensitivity = ChangedTracer(CASE, [Applied("clamped", 0.3)], RULES).sensitivity(1e-6, 0.0)
    far_above = TRUE > 0.31
    assert far_above.any()
    assert not sensitivity[far_above].any()
    assert sensitivity[(TRUE < 0.29) & (TRUE > 0.12)].any()


def test_swapped_bands_swap_their_sensitivities():
    plain = Tracer(CASE).sensitivity(1e-3, 0.0)
    assert_same(ChangedTracer(CASE, [Applied("bands-swapped", "brg")], RULES).sensitivity(1e-3, 0.0), plain[..., [2, 0, 1]], 1e-9)


def test_a_cause_without_a_rule_is_a_key_error():
    with pytest.raises(KeyError, match="no-such-cause"):
        ChangedTracer(CASE, [Applied("no-such-cause")], RULES)
