"""Which closed form a scene's object has."""

from __future__ import annotations

from equilux_oracle.shapes.box import box
from equilux_oracle.shapes.crossing import Primitive
from equilux_oracle.shapes.cylinder import cylinder
from equilux_oracle.shapes.flat import disc, plane, rectangle
from equilux_oracle.shapes.sphere import sphere
from equilux_scenes.model import Box, Cylinder, Disc, Object, Plane, Rectangle, Sphere


def primitive_of(shape: Object) -> Primitive:
    """The primitive of an object; raises TypeError for one without a closed form (a mesh)."""
    match shape:
        case Sphere():
            return sphere(shape)
        case Plane():
            return plane(shape)
        case Box():
            return box(shape)
        case Disc():
            return disc(shape)
        case Rectangle():
            return rectangle(shape)
        case Cylinder():
            return cylinder(shape)
        case _:
            raise TypeError(f"no closed form for {shape.kind}")
