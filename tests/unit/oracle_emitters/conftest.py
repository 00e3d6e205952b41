"""One lit point at the origin, and what it receives by the closed form."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from mpmath import mp, mpf

from equilux_oracle.doubledouble import DD
from equilux_oracle.emitters.covers import cover_of
from equilux_oracle.emitters.frame import Frame
from equilux_oracle.emitters.precise import Receiver
from equilux_oracle.emitters.received import Reflecting, from_everywhere, from_region
from equilux_scenes.model import AreaEmitter

NAMES = ("∫ N·ω", "∫ (R·V)^p", "∫ (R·V)^p N·ω")


def receiver_of(normal, to_viewer, exponent) -> Receiver:
    """At the origin; V turned to N's side."""
    with mp.workdps(40):
        n, v = (tuple(mpf(c) / mp.sqrt(sum(mpf(d) ** 2 for d in vector)) for c in vector) for vector in (normal, to_viewer))
        if sum(a * b for a, b in zip(n, v, strict=True)) < 0:
            v = tuple(-c for c in v)
        return Receiver((mpf(0), mpf(0), mpf(0)), n, v, mpf(exponent))


def double_double(vector) -> DD:
    high = [float(c) for c in vector]
    return DD(np.reshape(high, (3, 1)), np.reshape([float(c - h) for c, h in zip(vector, high, strict=True)], (3, 1)))


@pytest.fixture
def received() -> Callable[[AreaEmitter | None, Receiver], list[tuple[float, float]]]:
    """The three integrals of NAMES over an emitter (None: the hemisphere), each with its bound."""

    def of(emitter, at):
        with mp.workdps(40):
            frame = Frame.of(double_double(at.normal), double_double(at.to_viewer))
        found = []
        for diffuse, specular, cosine in ((1.0, 0.0, False), (0.0, 1.0, False), (0.0, 1.0, True)):
            p = np.array([float(at.exponent)])
            here = Reflecting(np.full((3, 1), diffuse), np.full((3, 1), specular), p, np.array([cosine]))
            if emitter is None:
                value, bound = from_everywhere(frame, here)
                found.append((float(value[0, 0]), float(bound[0, 0])))
                continue
            total, error = 0.0, 0.0
            for piece in cover_of(emitter, (0.0, 0.0, 0.0))(DD(np.zeros((3, 1))), frame):
                if piece.region is not None and piece.front.size and piece.front[0]:
                    value, bound = from_region(piece.region, frame, here)
                    total, error = total + float(value[0, 0]), error + float(bound[0, 0])
            found.append((total, error))
        return found

    return of
