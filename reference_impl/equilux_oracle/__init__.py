"""Closed forms of the lighting model: the truth that every renderer, the in-house tracer too, is judged against.

`radiance(case)` is the whole picture, `evaluate(case, film_xy)` single film positions, `examine(case, film_xy)` the same with
the bound and the scale of errors, `supports(case)` what has no closed form. `equilux_oracle.precise` evaluates single positions
at fifty digits, written apart from all of this. Shares no code with the tracer.
"""

from equilux_oracle.examination import Examination, pixel_centers
from equilux_oracle.picture import evaluate, examine, lacking, radiance, radiance_with_bound, supports

VERSION = "2"
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
