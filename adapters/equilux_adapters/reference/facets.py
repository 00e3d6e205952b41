"""Facets in place of spheres, cylinders and discs, for models of which camera rays are all: those that shade locally.

They are divided for the camera's view as VTK's adapter divides them, and what a shape hides of itself is left out; so secondary
rays would miss it, and scenes that need them are refused.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from equilux.adapter import Case, Unsupported
from equilux_adapters._triangles import bounds_round
from equilux_adapters._triangles.bounds import Bounds, Floats, view_of
from equilux_adapters._triangles.drawing import build
from equilux_adapters._triangles.view import View
from equilux_scenes.mesh import TriangleMesh
from equilux_scenes.model import Cylinder, Disc, Mesh, Object, Sphere
from equilux_scenes.transforms import matrix

LOCAL = ("phong", "opengl")
"""Models without secondary rays."""


def faceted(case: Case, segments: int) -> tuple[Case, dict[str, Any]]:
    """The case with meshes in place of what is round; and as JSON what that may displace: bounds on normal and position (metres)
    per object index (as text), and on the place of edges (pixels). Raises Unsupported for models with secondary rays."""
    if case.scene.model not in LOCAL:
        reason = f"reference.tessellation {segments}: facets are divided for camera rays, and the model follows others"
        raise Unsupported([f"model.{case.scene.model}"], reason)
    view = view_of(case.scene.camera, case.scene.film)
    objects, meshes = list(case.scene.objects), dict(case.meshes)
    found: dict[int, Bounds] = {}
    for index, obj in enumerate(objects):
        bounds = _bounds(view, obj, segments)
        if bounds is not None:
            found[index] = bounds
            meshes[index] = _mesh(case, index, view, segments)
            file = f"facets-{index}"
            objects[index] = Mesh(kind="mesh", file=file, normals="smooth", material=obj.material, transform=obj.transform)
    scene = case.scene.model_copy(update={"objects": tuple(objects)})
    return Case(name=case.name, scene=scene, scene_name=case.scene_name, meshes=meshes), {
        "normal": {str(index): bounds.normal for index, bounds in found.items() if bounds.normal},
        "position_m": {str(index): bounds.position_m for index, bounds in found.items() if bounds.position_m},
        "film_px": max((bounds.film_px for bounds in found.values()), default=0.0),
    }


def _bounds(view: View, obj: Object, segments: int) -> Bounds | None:
    placed = matrix(obj) if obj.transform else None
    if isinstance(obj, Sphere):
        return bounds_round.of_sphere(view, obj, segments, placed)
    if isinstance(obj, Cylinder):
        return bounds_round.of_cylinder(view, obj, segments, placed)
    return bounds_round.of_disc(view, obj, segments, placed) if isinstance(obj, Disc) else None


def _mesh(case: Case, index: int, view: View, segments: int) -> TriangleMesh:
    """From the eye's coordinates back into the object's own, where its normals were unit."""
    drawn, obj = build(case, index, view, segments), case.scene.objects[index]
    to_world = matrix(obj) if obj.transform else np.eye(4)
    linear, shift = to_world[:3, :3], to_world[:3, 3]
    vertices: Floats = np.linalg.solve(linear, (drawn.points + view.eye - shift).T).T
    normals = drawn.normals @ linear
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    faces = drawn.triangles[:, ::-1] if np.linalg.det(linear) < 0 else drawn.triangles
    return TriangleMesh(np.ascontiguousarray(vertices), np.ascontiguousarray(faces, dtype=np.int64), normals)
