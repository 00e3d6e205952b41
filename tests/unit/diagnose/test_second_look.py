"""A number that the sample cannot tell from the right one is found all the same."""

from __future__ import annotations

import pytest

from equilux.diagnose.search import diagnose
from equilux_scenes.loader import corpus_folder, load_scene_file
from equilux_tracer import Tracer
from equilux_tracer.causes import RULES
from equilux_tracer.shading_rules import ShadingRules
from support.faults import faulty

TRIED = ("shadow-bias", "occlusion-ignored", "scaled", "diffuse-missing")


@pytest.mark.parametrize("length", [0.01, 0.05])
def test_the_length_of_a_shadow_bias_is_found_where_few_pixels_show_it(length: float) -> None:
    """Some dozen pixels at the foot of a tube: among the few hundred of the sample, 0.02 explains as much as 0.01."""
    (case,) = load_scene_file(corpus_folder() / "raytraced" / "own-shadow.scene.yaml").cases
    picture = Tracer(case, rules=ShadingRules(shadow_bias_m=length)).render()["radiance"]
    wrong = faulty(case, picture=picture)
    rules = {id_: RULES[id_] for id_ in TRIED}
    found = diagnose(wrong.case, wrong.side, wrong.truth, wrong.scored, restate=None, rules=rules)
    assert [(one.id, one.parameter) for one in found.causes] == [("shadow-bias", length)]
    assert (found.explained, found.broken) == (1.0, 0)
