"""Precisions "float" and "refined": what they share with the exact mode, and what they refuse."""

from __future__ import annotations

import numpy as np
import pytest

from equilux_tracer import Tracer, TracerError

BALL = {"kind": "sphere", "center": [0, 0, 0], "radius": 2.5}
FLOOR = {"kind": "plane", "point": [0, 0, -2], "normal": [0.1, 0.2, 1]}
LAMP = {"kind": "point", "position": [1, 2, 6], "intensity": 30.0}
SHINY = {"diffuse": 0.3, "specular": 0.2, "exponent": 20}


def scene_of(make_case, **changes):
    return make_case(BALL, FLOOR, lights=[LAMP], material=SHINY, **{"film": {"width": 37, "height": 23}, **changes})


@pytest.mark.parametrize("precision", ["float", "refined"])
@pytest.mark.parametrize(("model", "named"), [("opengl", "opengl"), ("reflection-equation", "reflection-equation")])
def test_a_model_that_packets_do_not_cover_is_refused_by_name(make_case, precision, model, named):
    case = make_case(BALL, model=model)
    with pytest.raises(TracerError, match=f"float packets do not cover model {named}"):
        Tracer(case).render(precision=precision)


def test_a_channel_that_packets_do_not_have_is_refused(make_case):
    with pytest.raises(TracerError, match="channels: got depth, allowed with precision 'float' radiance, rounding"):
        Tracer(scene_of(make_case)).render(["radiance", "depth"], precision="float")


def test_an_array_of_another_shape_is_refused(make_case):
    with pytest.raises(TracerError, match=r"out: got float64 \(2, 2\), allowed contiguous float32 \(23, 37, 3\)"):
        Tracer(scene_of(make_case)).render(precision="float", out=np.empty((2, 2)))


def test_it_writes_where_it_is_told(make_case):
    out = np.empty((23, 37, 3), np.float32)
    assert Tracer(scene_of(make_case)).render(precision="float", out=out)["radiance"] is out


@pytest.mark.parametrize("model", ["phong", "raytraced"])
def test_the_picture_does_not_depend_on_the_threads(make_case, model):
    tracer = Tracer(scene_of(make_case, model=model, film={"width": 301, "height": 203}))
    one, three = (tracer.render(precision="float", threads=threads)["radiance"] for threads in (1, 3))
    np.testing.assert_array_equal(one, three)


def test_the_bare_traversal_counts_its_rays(make_case):
    tracer = Tracer(scene_of(make_case, model="raytraced"))
    traversal = tracer.raw_traversal(threads=1)
    exact = tracer.render(["object_id", "normal", "position"])
    to_light = np.array(LAMP["position"]) - exact["position"]
    lit = (exact["object_id"] >= 0) & (np.sum(to_light * exact["normal"], axis=2) > 0)
    assert traversal.eye_rays == 37 * 23
    assert traversal.shadow_rays == np.count_nonzero(lit)
    assert traversal.seconds > 0
