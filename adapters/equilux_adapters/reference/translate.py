"""Scene → program: the typed scene as JSON, and each mesh as it is shaded, as NumPy arrays."""

from __future__ import annotations

import io

import numpy as np
import numpy.typing as npt

from equilux.adapter import Case, Program

ENTRY = "scene.json"
MESH_PARTS = ("vertices", "faces", "vertex_normals")


def mesh_file(index: int, part: str) -> str:
    """Where `part` of the mesh of object `index` is stored."""
    return f"mesh-{index}.{part}.npy"


def translate(case: Case) -> Program:
    """What determines the picture; title and expectations stay behind. Pure. Needs no tracer."""
    scene = case.scene.model_copy(update={"about": "", "expect": (), "sweep": {}})
    files = {ENTRY: scene.model_dump_json(indent=1, exclude_defaults=True).encode()}
    for index, mesh in case.meshes.items():
        for part in MESH_PARTS:
            array = getattr(mesh, part)
            if array is not None:
                files[mesh_file(index, part)] = _npy(array)
    return Program(files=files, entry=ENTRY, data={"meshes": sorted(case.meshes)})


def _npy(array: npt.NDArray[np.generic]) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, array, allow_pickle=False)
    return buffer.getvalue()
