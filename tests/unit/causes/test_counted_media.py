"""Where it is worth trying that crossings are counted: only interpolated normals send rays to the wrong side of a face."""

from __future__ import annotations

import pytest

from equilux_scenes.loader import corpus_folder, load_scene_file
from equilux_tracer.causes import RULES


@pytest.mark.parametrize(
    ("scene", "readings"),
    [
        ("raytraced/glass-mesh-smooth", ["counted"]),
        ("showcase/glass-teapot", ["counted"]),
        ("raytraced/bubble-in-glass", [""]),
        ("raytraced/glass-sphere", []),
        ("raytraced/shadow-point", []),
    ],
)
def test_media_are_counted_where_glass_has_interpolated_normals_and_nest_where_there_are_two(scene, readings):
    case = load_scene_file(corpus_folder() / f"{scene}.scene.yaml").cases[0]
    assert [applied.reading for applied in RULES["nested-media"].hypotheses(case)] == readings
