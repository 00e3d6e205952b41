"""Film positions, threads, cancelling, odd films and refusals."""

from __future__ import annotations

import inspect
import re
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from equilux_tracer import CHANNELS, Cancel, Cancelled, Tracer, TracerError, _tracer
from support.random_scenes import case_of, changed, random_spec

BALL = {"kind": "sphere", "center": [0, 0, 0], "radius": 2.5}


def test_evaluating_at_pixel_centres_gives_the_image():
    for fov in ((30.0, 30.0), None):
        case = case_of(random_spec(5, fov_deg=fov))
        tracer = Tracer(case)
        film = case.scene.film
        x, y = np.meshgrid(np.arange(film.width) + 0.5, np.arange(film.height) + 0.5)
        image = tracer.render(list(CHANNELS))
        points = tracer.evaluate(np.stack([x.ravel(), y.ravel()], axis=1), list(CHANNELS))
        for name in CHANNELS:
            np.testing.assert_array_equal(points[name].reshape(image[name].shape), image[name], err_msg=name)


def test_row_zero_is_on_top_and_x_runs_to_the_right(make_case):
    # one pixel per unit: a small ball at (2.5, 1.5) is pixel (6, 2)
    case = make_case({**BALL, "center": [2.5, 1.5, 0], "radius": 0.3})
    image = Tracer(case).render()["radiance"][..., 0]
    assert list(zip(*np.nonzero(image), strict=True)) == [(2, 6)]


def test_the_picture_does_not_depend_on_the_number_of_threads():
    tracer = Tracer(case_of(random_spec(11, film=(61, 47))))
    alone = tracer.render(list(CHANNELS), threads=1)
    for threads in (2, 3, 16):
        together = tracer.render(list(CHANNELS), threads=threads)
        for name in CHANNELS:
            np.testing.assert_array_equal(together[name], alone[name], err_msg=f"{name} with {threads} threads")


def test_several_threads_may_use_one_tracer():
    tracer = Tracer(case_of(random_spec(12)))
    expected = tracer.render()["radiance"]
    results: list[np.ndarray] = []
    crew = [threading.Thread(target=lambda: results.append(tracer.render()["radiance"])) for _ in range(8)]
    for member in crew:
        member.start()
    for member in crew:
        member.join()
    assert len(results) == 8
    assert all(np.array_equal(result, expected) for result in results)


def test_cancelling_stops_a_long_render_soon():
    tracer = Tracer(case_of(changed(random_spec(3), film={"width": 20000, "height": 4000})))
    cancel = Cancel()
    timer = threading.Timer(0.1, cancel.cancel)
    timer.start()
    started = time.perf_counter()
    with pytest.raises(Cancelled):
        tracer.render(["object_id"], cancel=cancel)
    assert time.perf_counter() - started < 5, "80 million samples take minutes: it did not stop"
    assert cancel.cancelled


def test_a_cancelled_render_leaves_the_tracer_usable():
    tracer = Tracer(case_of(random_spec(3)))
    cancel = Cancel()
    cancel.cancel()
    with pytest.raises(Cancelled):
        tracer.render(cancel=cancel)
    assert np.isfinite(tracer.render()["radiance"]).all()


def test_ctrl_c_interrupts_a_render():
    import _thread

    tracer = Tracer(case_of(changed(random_spec(3), film={"width": 20000, "height": 4000})))
    threading.Timer(0.1, _thread.interrupt_main).start()
    with pytest.raises(KeyboardInterrupt):
        tracer.render(["object_id"])


@pytest.mark.parametrize(("width", "height"), [(1, 1), (20000, 1), (1, 5000)])
def test_films_of_any_shape_render(make_case, width, height):
    camera = {"projection": "orthographic", "eye": [0, 0, 5], "target": [0, 0, 0], "height_m": height}  # a pixel per metre
    image = Tracer(make_case(BALL, camera=camera, film={"width": width, "height": height})).render()["radiance"]
    assert image.shape == (height, width, 3)
    assert image[height // 2, width // 2, 0] == 1, "the ball is in the middle"


def test_no_lights_is_a_scene_like_any_other(make_case):
    seen = Tracer(make_case(BALL)).render(["radiance", "diffuse", "specular"])
    assert seen["diffuse"].shape == (8, 8, 0, 3)
    assert seen["radiance"].max() == 1


def test_no_objects_shows_the_background(make_case):
    seen = Tracer(make_case(background=[1, 2, 3])).render(["radiance", "object_id"])
    assert (seen["radiance"] == [1, 2, 3]).all()
    assert (seen["object_id"] == -1).all()


def test_no_film_positions_give_empty_arrays(make_case):
    assert Tracer(make_case(BALL)).evaluate(np.empty((0, 2)))["radiance"].shape == (0, 3)


@pytest.mark.parametrize(
    ("channels", "positions", "says"),
    [
        (["radiance", "colour"], [[0, 0]], r"channels: got colour, allowed radiance, .*signature"),
        (["radiance"], [[0, 0, 0]], r"film_xy: got shape \(1, 3\), allowed \(n, 2\)"),
        (["radiance"], [[0, np.nan]], r"film_xy: a position is not finite"),
    ],
)
def test_a_refusal_says_what_is_allowed(make_case, channels, positions, says):
    with pytest.raises(TracerError, match=says):
        Tracer(make_case(BALL)).evaluate(positions, channels)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"transform": [{"matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [1, 1, 0, 0], [0, 0, 0, 1]]}]}, r"objects\[1\]: .*singular"),
        ({"radius": 1e61}, r"objects\[1\]: its size is beyond 1e60 m"),
        ({"radius": 1e-61}, r"objects\[1\]: its size is below 1e-60 m"),
        ({"center": [1e61, 0, 0]}, r"objects\[1\]: it is farther than 1e60 m"),
    ],
)
def test_a_scene_that_cannot_be_computed_with_is_refused(make_case, change, says):
    with pytest.raises(TracerError, match=says):
        Tracer(make_case(BALL, {**BALL, **change}))


def test_an_unknown_precision_is_refused(make_case):
    with pytest.raises(TracerError, match="precision: got 'sloppy', allowed 'exact'"):
        Tracer(make_case(BALL), precision="sloppy")


def test_the_typed_stub_names_what_the_extension_has():
    stub = Path(inspect.getfile(_tracer)).with_name("_tracer.pyi")
    if not stub.exists():  # an editable install keeps the extension apart from the sources
        stub = Path(inspect.getfile(Tracer)).with_name("_tracer.pyi")
    text = stub.read_text()
    declared = set(re.findall(r"^(?:class |def )?([A-Za-z]\w*)(?=[:(])", text, re.MULTILINE))
    present = {name for name in vars(_tracer) if not name.startswith("_")}
    assert declared == present
    for owner in (_tracer.World, _tracer.SceneDescription, _tracer.Cancel):
        members = {name for name in vars(owner) if not name.startswith("_")}
        body = re.search(rf"class {owner.__name__}:\n((?: .*\n|\n)*)", text)
        assert body
        assert set(re.findall(r"    def ([a-z]\w*)\(", body.group(1))) == members
