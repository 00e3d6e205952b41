"""Scene → program: the typed scene as JSON, and each mesh as it is shaded, as NumPy arrays."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import numpy.typing as npt

from equilux.adapter import Case, Program
from equilux_adapters.reference.cut import depth_of, missing
from equilux_adapters.reference.facets import faceted
from equilux_adapters.reference.knobs import ReferenceKnobs

ENTRY = "scene.json"
MESH_PARTS = ("vertices", "faces", "vertex_normals")


def mesh_file(index: int, part: str) -> str:
    """Where `part` of the mesh of object `index` is stored."""
    return f"mesh-{index}.{part}.npy"


def translate(case: Case, knobs: ReferenceKnobs) -> Program:
    """What determines the picture; title and expectations stay behind. Pure. Needs no tracer. Raises Unsupported for facets where
    rays are followed."""
    depth = depth_of(case, knobs)
    data: dict[str, Any] = {}
    if cut := missing(case, depth):
        data["depth"], data["missing"] = depth, cut
    if knobs.tessellation:
        case, data["facets"] = faceted(case, knobs.tessellation)
    scene = case.scene.model_copy(update={"about": "", "expect": (), "sweep": {}, "recursion_limit": depth})
    files = {ENTRY: scene.model_dump_json(indent=1, exclude_defaults=True).encode()}
    for index, mesh in case.meshes.items():
        for part in MESH_PARTS:
            array = getattr(mesh, part)
            if array is not None:
                files[mesh_file(index, part)] = _npy(array)
    return Program(files=files, entry=ENTRY, data={"meshes": sorted(case.meshes), **data})


def _npy(array: npt.NDArray[np.generic]) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, array, allow_pickle=False)
    return buffer.getvalue()
