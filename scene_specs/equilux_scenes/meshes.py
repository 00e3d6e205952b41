"""From the keys of a `mesh` object to its triangles; files are read once, however many objects and cases use them."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np

from equilux_scenes.confined import CannotRead, inside, read_bytes
from equilux_scenes.errors import SpecErrors
from equilux_scenes.limits import Limits, exceeded
from equilux_scenes.mesh import MeshError, TriangleMesh, shaded
from equilux_scenes.mesh_obj import read_obj
from equilux_scenes.mesh_ply import read_ply
from equilux_scenes.yaml_tree import MapNode

READERS = {".obj": read_obj, ".ply": read_ply}
"""File name extension → reader of (content, name for errors, limits)."""


class MeshStore:
    """The meshes of one spec. `folder`: where its files are, None for a spec that has no place of its own."""

    def __init__(self, folder: Path | None, limits: Limits) -> None:
        self._folder = folder
        self._limits = limits
        self._files: dict[Path, TriangleMesh | SpecErrors] = {}

    def triangles(self, mesh: SimpleNamespace, node: MapNode) -> TriangleMesh:
        """The shaded mesh of an object with the fields of `model.Mesh`.

        Raises MeshError, or SpecErrors located in the mesh file.
        """
        inline = {"vertices", "faces", "vertex_normals"} & node.entries.keys()
        if "file" in node.entries and inline:
            raise MeshError((), "either file or vertices and faces, not both")
        if mesh.file is not None:
            return self._of_file(mesh)
        missing = {"vertices", "faces"} - node.entries.keys()
        if missing:
            note = f" ({' and '.join(sorted(missing))} missing)" if inline else ""
            raise MeshError((), "either file, or vertices and faces", note)
        return shaded(self._inline(mesh), mesh.normals)

    def _inline(self, mesh: SimpleNamespace) -> TriangleMesh:
        vertices = np.array(mesh.vertices, dtype=np.float64).reshape(-1, 3)
        faces = np.array(mesh.faces, dtype=np.int64).reshape(-1, 3)
        outside = np.argwhere(faces >= len(vertices))
        if len(outside):
            face, corner = (int(index) for index in outside[0])
            raise MeshError(("faces", face, corner), f"0 to {len(vertices) - 1}" if len(vertices) else "no face without vertices")
        normals = None
        if mesh.vertex_normals is not None:
            normals = np.array(mesh.vertex_normals, dtype=np.float64).reshape(-1, 3)
            if len(normals) != len(vertices):
                raise MeshError(("vertex_normals",), f"one per vertex, {len(vertices)}", f" ({len(normals)} given)")
        return TriangleMesh(vertices, faces, normals)

    def _of_file(self, mesh: SimpleNamespace) -> TriangleMesh:
        try:
            return shaded(self._read(mesh.file), mesh.normals)
        except MeshError as failed:
            if failed.path[0] == "vertex_normals":
                raise MeshError(("file",), f"vertex normals that are not 0 (that of vertex {failed.path[1]} is)") from None
            raise

    def _read(self, name: str) -> TriangleMesh:
        if self._folder is None:
            raise MeshError(("file",), "inline vertices and faces", " (a spec that is no file has no folder to look in)")
        reader = READERS.get(Path(name).suffix.lower())
        if reader is None:
            raise MeshError(("file",), "a file name that ends in .obj or .ply")
        try:
            path = inside(self._folder, name)
            if path not in self._files:
                content = read_bytes(path, self._limits.mesh_bytes)
                try:
                    self._files[path] = reader(content, str(self._folder / name), self._limits)
                except SpecErrors as failed:
                    self._files[path] = failed
        except CannotRead as failed:
            raise self._unreadable(failed) from None
        found = self._files[path]
        if isinstance(found, SpecErrors):
            raise found
        return found

    def _unreadable(self, failed: CannotRead) -> MeshError:
        if failed.size is not None:
            limit = exceeded("mesh_bytes", failed.size, self._limits.mesh_bytes, "bytes of the file")
            return MeshError(("file",), "a smaller file", f" ({limit})")
        return MeshError(("file",), "a .obj or .ply file in the scene's folder or below it", f" ({failed.why})")
