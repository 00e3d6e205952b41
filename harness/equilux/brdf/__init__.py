"""BRDFs of the spec's materials: values, directional-hemispherical reflectance, reciprocity and energy checks, polar curves.

What the lecture plots and what its plot does not show: whether a surface gives back more than it gets.
"""

from equilux.brdf.lobes import KINDS, Brdf, brdf_of
from equilux.brdf.study import Study, study

__all__ = ["KINDS", "Brdf", "Study", "brdf_of", "study"]
