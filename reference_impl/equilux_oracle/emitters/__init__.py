"""Closed forms of model `reflection-equation`: what extended emitters send to surfaces that see them whole.

`supports(case)` says what has none, `lacking(case)` why, `radiance_with_bound(case)` is the picture, `evaluate(case, film_xy)`
single film positions, `examine` the same with bound and scale. `closed_forms` are the textbook ones, for tests and readers;
`precise` evaluates single positions by brute integration at many digits, written apart from all of this.

How: a point's light is an integral over the directions in which it sees emitters. Stokes' theorem makes it an integral along
the borders of those regions (regions.py, arcs.py): for Lambert's cosine that has a closed form (lambert.py), for Phong's lobe
with any exponent it is one integral of an analytic function, evaluated by Gauss–Legendre with a proven bound (lobe.py,
panels.py).
"""

from equilux_oracle.emitters.picture import evaluate, examine, radiance_with_bound
from equilux_oracle.emitters.unblocked import lacking, supports

__all__ = ["evaluate", "examine", "lacking", "radiance_with_bound", "supports"]
