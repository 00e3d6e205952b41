"""The tracer against the closed forms on the corpus of the models beyond `phong`, within what both state of themselves.

`test_reference_against_oracle` holds the local model to one fixed promise; here secondary rays and integrals have bounds of their
own, per pixel: the tracer's rounding and quadrature, and the oracle's.
"""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

import equilux_oracle
from equilux_scenes.loader import corpus_folder, load_scenes
from equilux_scenes.model import LIGHTING_MODELS
from equilux_tracer import Tracer
from support.edges import on_edge

BEYOND_PHONG = [case for file in load_scenes([corpus_folder()]) for case in file.cases if case.scene.model != "phong"]
CASES = [case for case in BEYOND_PHONG if not equilux_oracle.supports(case)]


def test_every_model_has_closed_forms_in_the_corpus():
    counts = Counter(case.scene.model for case in CASES)
    assert all(counts[model] >= 10 for model in LIGHTING_MODELS if model != "phong"), dict(counts)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_the_reference_is_the_oracle_within_what_both_state(case):
    tracer = Tracer(case)
    found = tracer.render(["radiance", "rounding", "quadrature"])
    oracle, bound = equilux_oracle.radiance_with_bound(case)
    allowed = found["rounding"] + found["quadrature"] + bound
    apart = np.abs(found["radiance"] - oracle)
    wrong = np.argwhere((~(apart <= allowed)).any(axis=2))  # NaN is wrong
    if len(wrong):
        wrong = wrong[~on_edge(tracer, wrong[:, ::-1] + 0.5)]
    complaints = [
        f"reference {found['radiance'][y, x]}, oracle {oracle[y, x]} at ({x}, {y}), allowed {allowed[y, x]}" for y, x in wrong[:5]
    ]
    assert not complaints, f"{case.name}: {len(wrong)} pixels\n" + "\n".join(complaints)
    print(f"\n{case.name}: largest difference {apart.max():.2g}, largest bound {allowed.max():.2g}")


@pytest.mark.parametrize("case", CASES[::7], ids=lambda case: case.name)
def test_what_both_state_is_no_blank_cheque(case):
    """Hardly anywhere more than a hundred-thousandth of the picture's own scale."""
    found = Tracer(case).render(["radiance", "rounding", "quadrature"])
    _, bound = equilux_oracle.radiance_with_bound(case)
    allowed = (found["rounding"] + found["quadrature"] + bound).max(axis=2)
    scale = np.abs(found["radiance"]).max()
    share = float(np.mean(allowed > 1e-5 * scale))
    assert share <= 0.002, f"{case.name}: {share:.2%} of the pixels state more than 1e-5 of {scale:g}, one {allowed.max():g}"
