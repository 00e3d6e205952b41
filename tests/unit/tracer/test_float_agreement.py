"""Precisions "float" and "refined" against the exact mode: within what they state, but for edges, which are few."""

from __future__ import annotations

import numpy as np
import pytest

from equilux_scenes.case import Case
from equilux_scenes.loader import corpus_folder, load_scenes
from equilux_tracer import Tracer
from support.random_scenes import case_of, random_spec

SCENES = (
    "attenuation-all-terms", "orthographic", "lamp", "sun", "highlight-exponent", "mesh-smooth", "mesh-transformed",
    "cylinder-open", "disc", "inside-a-sphere", "matrix", "shadow-point", "own-shadow",
    "mirror-sphere", "glass-sphere", "transparent-shadows",
    "lit-from-behind",
)  # fmt: skip
"""One for each thing that packets can do. Coincident surfaces are not among them: reference QUIRKS, R18."""

CORPUS = {
    case.name: case
    for name in SCENES
    for path in corpus_folder().rglob(f"{name}.scene.yaml")
    for file in load_scenes([path])
    for case in file.cases[-1:]
}

FEW_EDGES = 0.02
TURNS = np.arange(8) * np.pi / 4
SCALES = [1e-15, 1e-6, 1e6, 1e15]


def beyond(tracer: Tracer, precision, **options):
    """What the precision shows, what the exact mode shows, where they differ by more than is stated, and the share of edges.

    Edges are not among the places: the path changes within the stated displacement.
    """
    found = tracer.render(("radiance", "rounding"), precision=precision, **options)
    exact = tracer.render(("radiance", "rounding", "signature"))
    bound = found["rounding"].astype(float) + exact["rounding"]
    apart = ~(np.abs(found["radiance"] - exact["radiance"]) <= bound).all(axis=2)
    rows, columns = np.nonzero(apart)
    edge = np.zeros(len(rows), bool)
    for turn in TURNS:
        step = tracer.displacement_px() * np.array([np.cos(turn), np.sin(turn)])
        around = tracer.evaluate(np.stack([columns, rows], axis=1) + 0.5 + step, ("signature",))["signature"]
        edge |= around != exact["signature"][rows, columns]
    inner = np.stack([rows, columns], axis=1)[~edge]
    return found, exact, inner, float(edge.sum()) / apart.size


def told(found, exact, inner):
    return [
        (tuple(at), found["radiance"][tuple(at)], exact["radiance"][tuple(at)], found["rounding"][tuple(at)]) for at in inner[:3]
    ]


@pytest.mark.parametrize("precision", ["float", "refined"])
@pytest.mark.parametrize("case", CORPUS.values(), ids=lambda case: case.name)
def test_the_corpus_is_within_the_stated_budget(case: Case, precision):
    found, exact, inner, edges = beyond(Tracer(case), precision, threads=1)
    assert len(inner) == 0, told(found, exact, inner)
    assert edges <= FEW_EDGES


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("model", ["phong", "raytraced"])
@pytest.mark.parametrize("precision", ["float", "refined"])
def test_random_scenes_are_within_the_stated_budget(seed, model, precision):
    case = case_of({**random_spec(seed), "model": model})
    found, exact, inner, edges = beyond(Tracer(case), precision, threads=1)
    assert len(inner) == 0, told(found, exact, inner)
    assert edges <= FEW_EDGES


@pytest.mark.parametrize("width", [4, 8, 16])
def test_every_width_of_packets_is_within_the_stated_budget(width):
    try:
        found, exact, inner, _ = beyond(Tracer(CORPUS["shadow-point"]), "float", packet_width=width)
    except ValueError as error:
        pytest.skip(str(error))
    assert len(inner) == 0, told(found, exact, inner)


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("precision", ["float", "refined"])
def test_the_scale_of_a_scene_does_not_matter(make_case, scale, precision):
    case = make_case(
        {"kind": "sphere", "center": [0, 0, -5 * scale], "radius": scale},
        {
            "kind": "rectangle",
            "corner": [-3 * scale, -2 * scale, -8 * scale],
            "edge_u": [6 * scale, 0, 0],
            "edge_v": [0, 3 * scale, 4 * scale],
        },
        lights=[{"kind": "point", "position": [2 * scale, 3 * scale, -2 * scale], "intensity": 10 * scale * scale}],
        material={"diffuse": 0.3, "specular": 0.2, "exponent": 30},
        model="raytraced",
        camera={"projection": "perspective", "eye": [0, 0, 0], "target": [0, 0, -scale], "up": [0, 1, 0], "fov_y_deg": 40},
        film={"width": 64, "height": 48},
    )  # fmt: skip
    found, exact, inner, edges = beyond(Tracer(case), precision)
    assert exact["radiance"].max() > 0.01
    assert len(inner) == 0, told(found, exact, inner)
    assert edges <= FEW_EDGES


def test_the_stated_bound_is_approached():
    """Within a factor of ten, somewhere: a bound that is far from all errors says little."""
    share = 0.0
    for name in ("shadow-point", "mirror-sphere", "mesh-smooth"):
        tracer = Tracer(CORPUS[name])
        found = tracer.render(("radiance", "rounding"), precision="float")
        error = np.abs(found["radiance"] - tracer.render()["radiance"])
        within = (error <= found["rounding"]) & (found["rounding"] > 0)
        share = max(share, float((error[within] / found["rounding"][within]).max()))
    assert share > 0.1, f"the largest error is {share:.3g} of its bound"
