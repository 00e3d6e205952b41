"""The proven bound of the panels: never exceeded, not by the roughest of them either, and not so wide that it says nothing."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from equilux_oracle.doubledouble import DD
from equilux_oracle.emitters import lobe, panels, regions
from equilux_oracle.emitters.frame import Frame

COUNT = 100


def random_curves(exponent: float, cosine: bool, seed: int) -> lobe.Curves:
    """Borders of random caps, discs and parallelograms before random views, all horizons among them."""
    rng = np.random.default_rng(seed)

    def directions():
        v = rng.normal(size=(3, COUNT))
        return v / np.linalg.norm(v, axis=0)

    normal, view = directions(), directions()
    view *= np.where(np.sum(normal * view, axis=0) < 0, -1, 1)
    frame = Frame.of(DD(normal), DD(view / np.linalg.norm(view, axis=0)))
    angle = rng.uniform(0.01, 1.5, COUNT)
    corner, u = directions(), directions()
    v = np.cross(u, directions(), axis=0)
    corners = np.stack([corner, corner + u, corner + u + v, corner + v])
    shapes = (
        regions.cap(directions(), np.cos(angle), np.sin(angle)),
        regions.disc(directions() * rng.uniform(0.3, 2, COUNT), directions(), 0.5),
        regions.parallelogram(corners, np.sum(corner * np.cross(u, v, axis=0), axis=0)),
    )
    contour = [arcs for shape in shapes for arcs in shape.contour(frame, highlight=True)]
    return lobe.curves(contour, frame, np.full(COUNT, exponent), np.full(COUNT, cosine))


def fine(of: lobe.Curves, part: panels._Panels) -> np.ndarray:
    """The same panels by 30 nodes on each of many parts, graded towards both ends."""
    x, w = np.polynomial.legendre.leggauss(30)
    graded = 8.0 ** -np.arange(8, 0, -1.0)
    total = np.zeros(len(part.curve))
    for low, high in pairwise([-1.0, *(graded - 1), 0.0, *(1 - graded[::-1]), 1.0]):
        t = (low + high) / 2 + (high - low) / 2 * x
        value, _ = lobe.integrand(of[part.curve], part.middle[:, np.newaxis] + part.half[:, np.newaxis] * t)
        total += (high - low) / 2 * part.half * (value @ w)
    return total


def coarse(of: lobe.Curves, part: panels._Panels) -> tuple[np.ndarray, np.ndarray]:
    value, density = lobe.integrand(of[part.curve], part.middle[:, np.newaxis] + part.half[:, np.newaxis] * panels._X)
    rounding = part.half * (density @ panels._W) + 0.5 * density.max(axis=1)
    return part.half * (value @ panels._W), panels.UNIT_ROUNDOFF * rounding


def with_few_nodes(monkeypatch, nodes: int, tolerance: float) -> None:
    x, w = np.polynomial.legendre.leggauss(nodes)
    for name, value in (("NODES", nodes), ("TOLERANCE", tolerance), ("_X", x), ("_W", w)):
        monkeypatch.setattr(panels, name, value)


@pytest.mark.parametrize("exponent", [0.0, 0.4, 2.0, 7.3, 60.0, 1000.0])
@pytest.mark.parametrize("cosine", [False, True])
@pytest.mark.parametrize(("nodes", "tolerance"), [(3, 1.0), (6, 1e-3), (20, panels.TOLERANCE)])
def test_no_panel_is_off_by_more_than_its_bound(monkeypatch, exponent, cosine, nodes, tolerance):
    # Few nodes and a loose tolerance leave errors far above rounding: those are the ones whose bound could be wrong.
    with_few_nodes(monkeypatch, nodes, tolerance)
    of = random_curves(exponent, cosine, seed=7)
    for part in panels._panels(of):
        if len(part.curve) == 0:
            continue
        part = part[:: max(1, len(part.curve) // 100)]
        (value, rounding), true = coarse(of, part), fine(of, part)
        excess = np.abs(value - true) - part.bound - 2 * rounding
        worst = int(np.argmax(excess))
        assert excess[worst] <= 0, (
            f"p = {exponent}: panel of half-length {part.half[worst]:.3g} gives {value[worst]!r}, "
            f"much finer {true[worst]!r}, bound {part.bound[worst]:.3g}"
        )


@pytest.mark.parametrize("exponent", [0.4, 60.0])
def test_a_rough_panel_comes_near_its_bound(monkeypatch, exponent):
    with_few_nodes(monkeypatch, 3, 1e-1)
    of = random_curves(exponent, False, seed=3)
    nearest = 0.0
    for part in panels._panels(of):
        if len(part.curve):
            part = part[:: max(1, len(part.curve) // 300)]
            (value, rounding), true = coarse(of, part), fine(of, part)
            clear = np.abs(value - true) > 4 * rounding
            nearest = max(nearest, float(np.max(np.where(clear, np.abs(value - true) / part.bound, 0.0))))
    print(f"p = {exponent}: largest error is {nearest:.2g} of its bound")
    assert nearest > 1e-4, f"largest error is {nearest} of its bound: a bound that nothing comes near says nothing"


@pytest.mark.parametrize("exponent", [0.0, 0.001, 1.5, 1000.0, 1e6])
def test_the_whole_bound_stays_of_use(exponent):
    for cosine in (False, True):
        of = random_curves(exponent, cosine, seed=11)
        _, bound = panels.integrate(of, COUNT)
        # What rounding makes of directions close to a rim or a long edge, and of the lobe's peak.
        worst = float(bound.max() * (exponent + 1) / (2 * np.pi))
        assert worst <= 1e-11 * max(1.0, exponent), f"p = {exponent}: bound {worst:.2g} of the whole lobe"


def test_an_arc_of_no_length_has_no_panels():
    of = random_curves(3.0, False, seed=1)
    none = of[np.zeros(0, dtype=np.intp)]
    total, bound = panels.integrate(none, 5)
    assert total.tolist() == bound.tolist() == [0.0] * 5
