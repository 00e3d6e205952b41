"""Closed-form crossings of a ray with each analytic primitive, one file per primitive, all in double-double.

Every primitive is a `Primitive`: an anchor point in object space from which the rays' origins are measured (so that nothing is
lost when it lies far from the origin), and a function from rays to the nearest crossing with t > 0 and the outward normal there.
"""

from equilux_oracle.shapes.crossing import Crossing, Primitive
from equilux_oracle.shapes.primitive import primitive_of

__all__ = ["Crossing", "Primitive", "primitive_of"]
