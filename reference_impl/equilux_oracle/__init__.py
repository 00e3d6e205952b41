"""Closed forms of the lighting model: the truth that every renderer, the in-house tracer too, is judged against.

`radiance(case)` is the whole picture, `evaluate(case, film_xy)` single film positions, `examine(case, film_xy)` the same with
the bound and the scale of errors, `supports(case)` what has no closed form. `equilux_oracle.precise` evaluates single positions
at fifty digits and more, written apart from all of this. Shares no code with the tracer.

How far the oracle may stand for the truth when one quantity is pushed to its end, within 1e-9 of every band's value and within
its own bound, compared with 150 digits by tests/conformance/test_reference_at_the_extremes.py:

    scene scale                      1e-15 … 1e15 (phong, opengl, raytraced)
    offset from the world's origin   to 1e8 scene sizes; from 1e14 bounds become infinite, because surfaces count as coincident
    light's distance                 1e-12 … 1e20
    radiance                         1e-30 … 1e30; below 1e-300 the bound grows by what denormal numbers lose
    exponent                         1e-16 … 1e8; spot cones 1e-6° … 90°
    grazing light and view           1 … 1e-12 rad
    field of view                    1e-4° … 179.99°; film 1 : 10000
    gap between surfaces             1 … 1e-14 of the eye's distance; below, infinite bounds
    number of lights, depth          1000 lights, 200 mirrors
    index of refraction              1e-8 … 1e8, 1 ± 1e-15, ± 1e-15 rad about the critical angle
    attenuation coefficients         1e-12 … 1e12

Meshes have no closed form: `precise` alone evaluates flat ones that are written in the spec.
"""

from equilux_oracle.examination import Examination, pixel_centers
from equilux_oracle.picture import evaluate, examine, lacking, radiance, radiance_with_bound, supports

VERSION = "3"
"""Changes whenever a picture may change in any bit."""

__all__ = [
    "VERSION",
    "Examination",
    "evaluate",
    "examine",
    "lacking",
    "pixel_centers",
    "radiance",
    "radiance_with_bound",
    "supports",
]
