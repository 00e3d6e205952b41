"""The border integrals against brute integration over the emitters' surfaces at 25 digits.

The bound that the closed form states must hold, and be of use: below 1e-12 of the largest value that the integral can have.
"""

from __future__ import annotations

import math
import random

import pytest
from mpmath import mp, mpf

from equilux_oracle.emitters.precise import Receiver, converged, from_emitter, from_hemisphere
from support.random_emitters import at_the_horizon, between_the_horizons, random_direction, random_emitter

from .conftest import NAMES, receiver_of

KINDS = ("sphere", "disc", "rectangle")


def check(found, true, at: Receiver, what: str, useful: float = 1e-12) -> None:
    exact_ones = (true.irradiance, true.lobe, true.lobe_with_cosine)
    for name, (value, bound), exact in zip(NAMES, found, exact_ones, strict=True):
        most = math.pi if name == NAMES[0] else 2 * math.pi / (float(at.exponent) + 1)
        error = float(abs(mpf(value) - exact))
        text = f"{what}: {name} closed form {value!r}, integrated {mp.nstr(exact, 20)}, apart {error:.2g}, bound {bound:.2g}"
        print(text)
        assert error <= bound, text
        assert bound <= useful * most, f"{text}, of at most {most:.3g}"


def integrated(emitter, at: Receiver, pieces: int = 1):
    return converged(lambda nodes: from_emitter(emitter, at, nodes=nodes, pieces=pieces), float(at.exponent))


def floats(vector):
    return tuple(float(c) for c in vector)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("exponent", [0.0, 1.0, 6.4, 20.0])
def test_an_emitter_anywhere(received, kind, exponent):
    rng = random.Random(f"{kind} {exponent}")
    at = receiver_of(random_direction(rng), random_direction(rng), exponent)
    toward = [a + b for a, b in zip(floats(at.normal), random_direction(rng), strict=True)]
    direction = tuple(c / math.hypot(*toward) for c in toward)
    emitter = random_emitter(rng, kind, direction, rng.uniform(0.3, 3), rng.uniform(0.1, 0.5))
    check(received(emitter, at), integrated(emitter, at), at, f"{kind}, p = {exponent}")


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("exponent", [0.3, 3.0])
@pytest.mark.parametrize("horizon", ["N", "M", "both"])
def test_an_emitter_at_a_horizon(received, kind, exponent, horizon):
    rng = random.Random(f"{kind} {exponent} {horizon}")
    at = receiver_of(random_direction(rng), random_direction(rng), exponent)
    normal, mirror = floats(at.normal), floats(at.mirror)
    if horizon == "both":
        direction = between_the_horizons(normal, mirror)
    else:
        direction = at_the_horizon(rng, normal if horizon == "N" else mirror, 0.2)
    emitter = random_emitter(rng, kind, direction, rng.uniform(0.5, 2), rng.uniform(0.2, 0.4))
    check(received(emitter, at), integrated(emitter, at), at, f"{kind} at the horizon of {horizon}, p = {exponent}")


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("off", [0.0, 0.2])
def test_a_sharp_highlight_in_an_emitter_and_beside_it(received, kind, off):
    rng = random.Random(kind)
    at = receiver_of((0.1, 1, -0.2), (0.5, 0.6, 0.3), 1000.0)
    toward = [m + off * c for m, c in zip(floats(at.mirror), random_direction(rng), strict=True)]
    emitter = random_emitter(rng, kind, tuple(c / math.hypot(*toward) for c in toward), 1.5, 0.15)
    check(received(emitter, at), integrated(emitter, at, pieces=2), at, f"{kind}, p = 1000, {off} off", useful=2e-11)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("slope", [1e-5])
def test_a_view_along_the_surface(received, kind, slope):
    rng = random.Random(f"{kind} {slope}")
    at = receiver_of((0, 0, 1), (1, 0.2, slope), 30.0)
    emitter = random_emitter(rng, kind, (-0.9701425001453319, 0.0, 0.24253562503633297), 1.0, 0.4)
    check(received(emitter, at), integrated(emitter, at), at, f"{kind}, N·V about {slope}")


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("exponent", [6.5, 4.0])
def test_a_view_along_the_normal(received, kind, exponent):
    rng = random.Random(kind)
    at = receiver_of((0, 0, 1), (0, 0, 1), exponent)
    emitter = random_emitter(rng, kind, (0.9128709291752769, -0.18257418583505536, 0.3651483716701107), 1.2, 0.5)
    check(received(emitter, at), integrated(emitter, at), at, f"{kind}, V = N, p = {exponent}")


@pytest.mark.parametrize(("exponent", "cosine"), [(0.0, 0.5), (6.5, 0.9), (1.0, 0.3), (5.0, 0.5)])
def test_the_whole_hemisphere(received, exponent, cosine):
    at = receiver_of((0, 0, 1), (math.sqrt(1 - cosine**2), 0, cosine), exponent)
    true = converged(lambda nodes: from_hemisphere(at, nodes=nodes), exponent)
    check(received(None, at), true, at, f"hemisphere, N·V = {cosine}, p = {exponent}")


@pytest.mark.parametrize("kind", KINDS)
def test_nothing_is_received_from_behind(received, kind):
    rng = random.Random(kind)
    at = receiver_of((0, 0, 1), (0.3, 0.2, 1), 3.0)
    emitter = random_emitter(rng, kind, (0.3, 0.1, -0.9), 1.0, 0.2)
    assert received(emitter, at) == [(0.0, 0.0)] * 3, f"closed form {received(emitter, at)}, below the horizon 0"
