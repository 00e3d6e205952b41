"""What goes with the difference that no cause accounts for: a hint where to look, never a cause."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from equilux.compare import RenderedImage
from equilux.diagnose.evidence import centres
from equilux.diagnose.proof import Proof
from equilux.diagnose.trials import Workshop

MOST_PIXELS = 2000
LEAST = 0.1
"""Correlations below are not worth a line."""

TERMS = ("emission", "ambient", "light_ambient", "diffuse", "specular", "reflected", "transmitted")


def correlations(workshop: Workshop, side: RenderedImage, proof: Proof | None, left: npt.NDArray[np.bool_]) -> dict[str, float]:
    """Term → Pearson's correlation with the remaining difference over the pixels that are left and as many that are not (so
    that a constant difference shows with the term it comes from), strongest first. Terms of a light are named 'diffuse key'.
    """
    width = left.shape[1]
    wrong, right = np.flatnonzero(left), np.flatnonzero(~left)
    pixels = np.union1d(wrong[:: len(wrong) // MOST_PIXELS + 1], right[:: len(right) // MOST_PIXELS + 1])
    terms = workshop.model.evaluate(centres(pixels, width), ("radiance", *TERMS))
    expected = terms["radiance"] if proof is None else proof.picture.reshape(-1, 3)[pixels]
    rest = np.asarray(side.image.reshape(-1, 3)[pixels], np.float64) - expected
    usable = np.isfinite(rest).all(axis=1)
    out = {}
    scene = workshop.case.scene
    names = [*scene.delta_lights, *scene.area_emitters, *(["environment"] if scene.environment is not None else [])]
    for term in TERMS:
        value = np.asarray(terms[term], np.float64)
        for index in range(value.shape[1] if value.ndim == 3 else 1):
            one = value[:, index] if value.ndim == 3 else value
            name = f"{term} {names[index]}" if value.ndim == 3 and index < len(names) else term
            found = _pearson(one[usable].ravel(), rest[usable].ravel())
            if abs(found) >= LEAST:
                out[name] = round(found, 4)
    return dict(sorted(out.items(), key=lambda item: -abs(item[1])))


def _pearson(x: npt.NDArray[np.float64], y: npt.NDArray[np.float64]) -> float:
    x, y = x - x.mean() if len(x) else x, y - y.mean() if len(y) else y
    scale = float(np.sqrt((x * x).sum()) * np.sqrt((y * y).sum()))
    return float((x * y).sum() / scale) if scale > 0 and np.isfinite(scale) else 0.0
