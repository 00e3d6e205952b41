"""What lies inside transparent objects: `interior` statements, and which objects share one."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from equilux.adapter import Unsupported
from equilux_adapters._bounds import distances
from equilux_adapters.povray.numbers import number
from equilux_scenes.case import Case
from equilux_scenes.mesh import TriangleMesh
from equilux_scenes.model import Disc, Material, Mesh, Object, PerspectiveCamera, Plane, Rectangle

DEEPEST = 255  # POV-Ray's own limit is 256 levels, the camera ray's included
INDEX_STEP = 2.0**-24
NEARLY_ONE = 0.99999994  # stored as 1 − INDEX_STEP: no float32 but 1 is nearer to 1 (Q34)


@dataclass(frozen=True)
class Media:
    """What is written of the insides of objects.

    modifiers: object → its own modifiers. shared: objects whose index is 1 and whose crossings must count, and which share one
    `interior` therefore. index_error: object → relative error of its index of refraction as stored.
    """

    modifiers: dict[int, list[str]] = field(default_factory=dict)
    shared: tuple[int, ...] = ()
    index_error: dict[int, float] = field(default_factory=dict)


def media(case: Case) -> Media:
    """Raises Unsupported where paths may be longer than POV-Ray follows them."""
    if case.scene.recursion_limit > DEEPEST and {"reflection", "transparency"} & set(case.requires):
        features = sorted({"reflection", "transparency"} & set(case.requires))
        raise Unsupported(features, f"recursion_limit {case.scene.recursion_limit}: POV-Ray's max_trace_level ends at {DEEPEST}")
    transparent = {i: m for i, m in enumerate(_materials(case)) if m.transparency > 0}
    result = Media()
    for index, material in transparent.items():
        if material.ior != 1:
            ior, error = _index(material.ior, case.meshes.get(index))
            result.modifiers[index] = [*_seen_from_inside(case, index), f"interior {{ ior {number(ior)} }}"]
            result.index_error[index] = error
    straight = [index for index, material in transparent.items() if material.ior == 1]
    if not straight or not _counting_matters(case, straight):
        return result
    return Media(result.modifiers, tuple(straight), result.index_error)


NEARLY = f"interior {{ ior {number(NEARLY_ONE)} }}"
"""For objects of index 1: a ray goes straight on, and counts (Q34)."""


def crossings(obj: Object, mesh: TriangleMesh | None) -> int:
    """How often a straight line can cross `obj` at most."""
    if mesh is not None:
        return len(mesh.faces)
    return 1 if isinstance(obj, Plane | Disc | Rectangle) else 2


def _materials(case: Case) -> list[Material]:
    return [case.scene.materials[obj.material] for obj in case.scene.objects]


def _index(ior: float, mesh: TriangleMesh | None) -> tuple[float, float]:
    """The index as written and the relative error of its float32 (Q35).

    POV-Ray counts crossings and knows no outward side: of a mesh turned inside out it sees the inverse index (Q36).
    """
    wanted = 1.0 / ior if mesh is not None and _volume(mesh) < 0 else ior
    return wanted, abs(float(np.float32(wanted)) - wanted) / wanted


def _volume(mesh: TriangleMesh) -> float:
    corners = mesh.vertices[mesh.faces]
    return float(np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6.0)


def _seen_from_inside(case: Case, index: int) -> list[str]:
    """A mesh knows whether the eye is inside only by an `inside_vector`, which any direction serves as (Q36)."""
    if not isinstance(case.scene.objects[index], Mesh):
        return []
    hull = distances.extremes(case, index)
    assert hull is not None
    eye = np.array(case.scene.camera.eye)
    near = not isinstance(case.scene.camera, PerspectiveCamera) or bool(((hull.min(0) <= eye) & (eye <= hull.max(0))).all())
    return ["inside_vector <0.36, 0.48, 0.8>"] if near else []


def _counting_matters(case: Case, straight: list[int]) -> bool:
    """Whether a path could ever be cut by the recursion limit; without mirrors and lenses it goes straight."""
    if "reflection" in case.requires or "refraction" in case.requires:
        return True
    most = sum(crossings(case.scene.objects[index], case.meshes.get(index)) for index in straight)
    return most > case.scene.recursion_limit
