"""The Embree tracer against the closed forms: two implementations that share nothing but the spec."""

from __future__ import annotations

import random
from dataclasses import dataclass

import numpy as np
import pytest

import equilux_oracle
from equilux_oracle.precise import evaluate_at
from equilux_scenes.loader import corpus_folder, load_scenes
from equilux_tracer import Tracer
from support.edges import on_edge
from support.random_scenes import case_of, random_spec

RELATIVE = 1e-12
"""What exact mode promises, in units of K_emit + K_amb L_amb + Σ E_i (K_diff + K_spec), where |N·V| ≥ 0.1 and off edges."""
FACING = 0.1
"""Below it the promise widens as 1/|N·V|: an error of the ray moves a grazing hit point by that much more."""

PHONG = [case for file in load_scenes([corpus_folder()]) for case in file.cases if case.scene.model == "phong"]
CASES = [case for case in PHONG if not equilux_oracle.supports(case)]

GROUPS = {
    "plain": {},
    "a million metres from the origin": {"offset": (1e6, -1e6, 1e6)},
    "narrow": {"fov_deg": (1.0, 1.0)},
    "narrow and far": {"fov_deg": (1.0, 1.0), "offset": (-1e6, 1e6, 1e6)},
    "wide": {"fov_deg": (150.0, 150.0)},
    "orthographic": {"fov_deg": None},
    "sharp highlights": {"exponents": (300.0, 1000.0)},
    "soft highlights": {"exponents": (0.1, 0.9)},
    "many lights": {"lights": (20, 64)},
}
SEEDS_PER_GROUP = 8


@dataclass(frozen=True)
class Comparison:
    """Film positions (n, 2), both radiances (n, 3), the allowed difference (n, 3), and whether a position is on an edge."""

    film_xy: np.ndarray
    reference: np.ndarray
    oracle: np.ndarray
    allowed: np.ndarray
    edge: np.ndarray

    @property
    def wrong(self):
        return (~(np.abs(self.reference - self.oracle) <= self.allowed)).any(axis=1)  # NaN is wrong

    def worst(self):
        """The largest difference in units of what is allowed, off edges."""
        return float((np.abs(self.reference - self.oracle) / np.maximum(self.allowed, 1e-300))[~self.edge].max(initial=0.0))

    def complaints(self):
        """One line per position that differs off edges, both numbers and the pixel."""
        for k in np.flatnonzero(self.wrong & ~self.edge)[:5]:
            x, y = self.film_xy[k]
            reference, oracle = self.reference[k], self.oracle[k]
            apart = np.abs(reference - oracle).max()
            yield f"reference {reference}, oracle {oracle} at ({x}, {y}): apart {apart}, allowed {self.allowed[k]}"


def compared(case, allowed_of, film_xy=None, spoil=None):
    """The tracer's and the oracle's values; edges are looked for only where they differ, as comparison.md says."""
    film_xy = equilux_oracle.pixel_centers(case.scene.film) if film_xy is None else film_xy
    tracer, true = Tracer(case), equilux_oracle.examine(case, film_xy)
    reference = tracer.evaluate(film_xy, ["radiance"])["radiance"]
    if spoil is not None:
        reference = spoil(reference, true)
    edge = np.zeros(len(film_xy), dtype=bool)
    found = Comparison(film_xy, reference, true.radiance, allowed_of(true), edge)
    suspects = np.flatnonzero(found.wrong)
    if len(suspects):
        edge[suspects] = on_edge(tracer, film_xy[suspects])
    return found


def promised(true):
    return RELATIVE * true.scale * np.maximum(1.0, FACING / np.maximum(true.facing, 1e-300))[:, np.newaxis]


def assert_agrees(case, found):
    complaints = list(found.complaints())
    assert not complaints, f"{case.name}:\n" + "\n".join(complaints)


def test_the_corpus_has_closed_forms():
    assert len(CASES) >= 36, f"{len(CASES)} cases with a closed form"


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_the_reference_is_the_oracle_on_the_corpus(case):
    found = compared(case, promised)
    assert_agrees(case, found)
    print(f"\n{case.name}: worst difference {found.worst():.2g} of what is allowed, {found.edge.sum()} pixels on edges")


@pytest.mark.parametrize("group", GROUPS)
def test_the_reference_is_the_oracle_on_random_scenes(group):
    worst, edges, positions = 0.0, 0, 0
    for seed in range(1000, 1000 + SEEDS_PER_GROUP):
        case = case_of(random_spec(seed, **GROUPS[group], film=(48, 36)))
        found = compared(case, promised)
        assert_agrees(case, found)
        worst, edges, positions = max(worst, found.worst()), edges + found.edge.sum(), positions + len(found.film_xy)
    print(f"\n{group}: worst difference {worst:.2g} of what is allowed, {edges} of {positions} pixels on edges")
    # A millionth of a pixel on either side of every discontinuity is next to no area.
    assert edges <= positions * 1e-3, f"{edges} of {positions} pixels were excused as edges"


@pytest.mark.parametrize("seed", range(2000, 2024))
def test_random_scenes_agree_with_an_independent_evaluation_to_a_billionth(seed):
    """Spheres, boxes, discs, rectangles and a plane under one to three lights of any kind: every pixel, whatever |N·V|."""
    fov = random.Random(seed).choice([(20.0, 60.0), (100.0, 140.0), None])
    spec = random_spec(seed, shapes=("sphere", "box", "disc", "rectangle"), fov_deg=fov, film=(64, 48))
    spec["objects"].append(random_spec(seed, shapes=("plane",), objects=(1, 1))["objects"][0])
    case = case_of(spec)
    found = compared(case, lambda true: 1e-9 + 1e-9 * true.radiance)
    assert_agrees(case, found)
    picture = found.reference.reshape(48, 64, 3)
    for column, row in np.random.default_rng(seed).integers((64, 48), size=(4, 2)):
        true = [float(band) for band in evaluate_at(case, column + 0.5, row + 0.5).radiance]
        apart = np.abs(picture[row, column] - true)
        excused = found.edge[row * 64 + column]
        assert excused or (apart <= 1e-9 + 1e-9 * np.array(true)).all(), (
            f"reference {picture[row, column]}, fifty digits {true} at ({column}, {row})"
        )


def coincident(seed, order, transform, offset):
    """A box, a rectangle, a plane and a disc that share the plane z = 0.1 of their space, in some file order."""

    def at(*place):
        return [o + c for o, c in zip(offset, place, strict=True)]

    shapes = [
        {"kind": "box", "min": at(-0.7, -0.7, -0.7), "max": at(0.3, 0.4, 0.1), "material": "m0"},
        {"kind": "rectangle", "corner": at(-1, -1, 0.1), "edge_u": [2, 0, 0], "edge_v": [0, 2, 0], "material": "m1"},
        {"kind": "plane", "point": at(0.5, 0.25, 0.1), "normal": [0, 0, 1], "material": "m2"},
        {"kind": "disc", "center": at(0.1, 0.2, 0.1), "normal": [0, 0, 3], "radius": 0.5, "material": "m1"},
    ]
    spec = random_spec(seed, offset=offset, film=(32, 24))
    return case_of({**spec, "objects": [{**shapes[k], "transform": transform} for k in order]})


@pytest.mark.parametrize("offset", [(0, 0, 0), (1e6, 1e6, 1e6)], ids=["near the origin", "far from it"])
@pytest.mark.parametrize("transform", [[], [{"rotate": {"axis": [1, 2, 0.5], "degrees": 33}}]], ids=["upright", "turned"])
@pytest.mark.parametrize("order", [(0, 1, 2, 3), (3, 2, 1, 0), (1, 3, 0, 2)])
def test_of_coincident_surfaces_the_first_in_the_file_is_seen(order, transform, offset):
    there = [{"translate": list(offset)}] if transform else []
    case = coincident(3, order, transform + there, (0, 0, 0) if transform else offset)
    positions = equilux_oracle.pixel_centers(case.scene.film)
    reference = Tracer(case).evaluate(positions, ["object_id"])["object_id"]
    oracle = equilux_oracle.examine(case, positions).object_id
    differ = np.flatnonzero(reference != oracle)
    where = positions[differ][:5].tolist()
    assert len(differ) == 0, f"reference sees {reference[differ][:5]}, oracle {oracle[differ][:5]} at {where}"
    # Whatever lies in the shared plane within reach of an earlier object belongs to that one: no speckle of later ones.
    plane = order.index(2)
    assert not np.isin(oracle, [k for k in range(plane + 1, 4) if order[k] in (1, 3)]).any(), np.bincount(oracle + 1)


def test_two_trillionths_too_much_are_noticed():
    case = case_of(random_spec(1))
    found = compared(case, promised, spoil=lambda radiance, true: radiance + 2 * promised(true))
    hit = equilux_oracle.examine(case, found.film_xy).object_id >= 0
    assert hit.sum() > 50
    assert (found.wrong & ~found.edge)[hit].all(), f"{(found.wrong & ~found.edge)[hit].sum()} of {hit.sum()} were noticed"


def test_only_positions_on_a_discontinuity_are_excused():
    ball = {"kind": "sphere", "center": [0, 0, 0], "radius": 1, "material": "m0"}
    view = {"projection": "orthographic", "eye": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0], "height_m": 4}
    case = case_of({**random_spec(1, film=(8, 8)), "objects": [ball], "camera": view, "lights": {}})
    limb = 6.0  # two pixels per metre
    positions = [[limb - 5e-7, 4], [limb + 5e-7, 4], [limb - 2e-6, 4], [limb + 2e-6, 4], [4, 4]]
    assert on_edge(Tracer(case), positions).tolist() == [True, True, False, False, False]
