"""How far the geometry that VTK is given, and what it makes of it, departs from the scene's: bounds per object."""

from __future__ import annotations

from typing import Any

from equilux.adapter import Case
from equilux_adapters._triangles import bounds_round
from equilux_adapters._triangles.bounds import Bounds, largest_factor, view_of
from equilux_adapters._triangles.displaced import light_reach
from equilux_adapters._triangles.drawing import build
from equilux_adapters._triangles.extent import enclosure
from equilux_adapters._triangles.round import film_scale
from equilux_adapters._triangles.view import View
from equilux_adapters.vtk import bounds_flat
from equilux_adapters.vtk.knobs import VtkKnobs
from equilux_scenes.model import Cylinder, Disc, Sphere, SpotLight
from equilux_scenes.transforms import matrix


def geometry_of(case: Case, knobs: VtkKnobs) -> dict[str, Any]:
    """JSON: bounds on normal and position (metres) per object index (as text), and on the film position of edges (pixels)."""
    view, reach = view_of(case.scene.camera, case.scene.film), light_reach(case)
    bounds = {index: bounds_of(case, view, index, knobs, reach) for index in range(len(case.scene.objects))}
    cones = 0.0
    if any(isinstance(light, SpotLight) for light in case.scene.delta_lights.values()):
        # an error of position moves the border of a cone by at most as much as it moves the point
        cones = max((found.position_m * _pixels_per_metre(case, view, index) for index, found in bounds.items()), default=0.0)
    return {
        "normal": {str(index): found.normal for index, found in bounds.items() if found.normal > 0},
        "position_m": {str(index): found.position_m for index, found in bounds.items() if found.position_m > 0},
        "film_px": cones + max((found.film_px for found in bounds.values()), default=0.0),
    }


def bounds_of(case: Case, view: View, index: int, knobs: VtkKnobs, reach_m: float) -> Bounds:
    """Bounds of one object."""
    obj, segments = case.scene.objects[index], knobs.tessellation
    placed = matrix(obj) if obj.transform else None
    if isinstance(obj, Sphere):
        return bounds_round.of_sphere(view, obj, segments, placed)
    if isinstance(obj, Cylinder):
        return bounds_round.of_cylinder(view, obj, segments, placed)
    drawn = build(case, index, view, segments)
    if not drawn.flat:
        return bounds_flat.of_smooth_mesh(view, drawn)
    faces = bounds_flat.of_faces(view, drawn, reach_m)
    if isinstance(obj, Disc):
        return faces._replace(film_px=faces.film_px + bounds_round.of_disc(view, obj, segments, placed).film_px)
    return faces


def _pixels_per_metre(case: Case, view: View, index: int) -> float:
    """On the film, where the object is nearest to the eye."""
    points, around = enclosure(case, index, case.scene.objects[index])
    placed = matrix(case.scene.objects[index])
    world = points @ placed[:3, :3].T + placed[:3, 3]
    return film_scale(view, None, world, around * largest_factor(placed)).large if len(points) else 0.0
