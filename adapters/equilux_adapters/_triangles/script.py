"""Pieces of the text of a stand-alone script: numbers, comments, the view, the objects, and the functions it needs."""

from __future__ import annotations

import io
import re
import textwrap
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from equilux.adapter import Case, Unsupported
from equilux_adapters._triangles.drawing import arguments
from equilux_adapters._triangles.source import kit_source, names_in
from equilux_scenes.mesh import TriangleMesh
from equilux_scenes.model import Object, Scene

ENTRY = "scene.py"


def refuse_what_is_missing(case: Case, expressed: Collection[str], lack_causes: Mapping[str, str], renderer: str) -> None:
    """Raise Unsupported naming every feature that is neither expressed nor has a cause that stands for its lack."""
    missing = [feature for feature in case.demands if feature not in expressed and feature not in lack_causes]
    if missing:
        raise Unsupported(missing, f"{renderer} cannot express {', '.join(missing)}")


def head(case: Case, needs: str) -> str:
    """What the script draws, what it needs, and what it leaves: comments."""
    about = textwrap.wrap(comment(case.scene.about), 100)
    film = f"({case.scene.film.height}, {case.scene.film.width}, 3)"
    lines = [
        comment(case.name),
        *about,
        "",
        f"Run it with Python, NumPy and {needs}: it writes image.npy, linear radiance in W/(m² sr), float32,",
        f"{film}, row 0 on top. Lengths are metres. Written by equilux.",
    ]
    return "\n".join(f"# {line}".rstrip() for line in lines)


def assembled(top: str, body: str, main: str, modules: tuple[str, ...]) -> str:
    """A script: the scene first, then the functions it needs and no others."""
    imports, functions = kit_source(names_in(body) | names_in(main) | {"np", "Array"}, modules)
    future = "from __future__ import annotations\n"
    return "\n".join([top, future, imports, "\n", body, "\n", functions, "\n", main, ""])


def function(signature: str, lines: Iterable[str]) -> str:
    """A function of these lines."""
    return "\n".join([f"def {signature}:", *(f"    {line}".rstrip() for line in lines)])


def view(scene: Scene) -> list[str]:
    """The statement that makes `view`."""
    camera, film = scene.camera, scene.film
    axes = f"**look_at(eye={numbers(camera.eye)}, target={numbers(camera.target)}, up={numbers(camera.up)})"
    if camera.projection == "perspective":
        lens = f"half_height=np.tan(np.radians({number(camera.fov_y_deg)}) / 2)"
    else:
        lens = f"half_height={number(camera.height_m)} / 2, parallel=True"
    return ["view = View(", f"    {axes},", f"    {lens},", f"    width={film.width}, height={film.height},", ")"]


def surface_names(objects: Iterable[Object]) -> dict[str, str]:
    """Material key → a Python name of its own; materials that no object uses are left out."""
    names: dict[str, str] = {}
    for obj in objects:
        if obj.material not in names:
            name = re.sub(r"\W", "_", f"surface_{obj.material}", flags=re.ASCII)
            while name in names.values():
                name += "_"
            names[obj.material] = name
    return names


def shape(index: int, obj: Object, segments: int, grazing: bool = True) -> str:
    """The call that makes an object's triangles; grazing: see `round.divide`."""
    given = [f"{name}={value(of)}" for name, of in arguments(obj, segments).items()]
    if obj.kind in ("sphere", "cylinder") and not grazing:
        given.append("grazing=False")
    if obj.kind == "mesh":
        given.insert(0, f'**read_mesh("mesh-{index}.npz")')
    return f"{obj.kind}({', '.join(['view', *given])})"


def set_back_line(steps: Sequence[int]) -> list[str]:
    """The statements that draw coincident objects apart, where there are any."""
    if not any(steps):
        return []
    return [
        f"apart = set_back(view, [mesh for mesh, _ in objects], steps={tuple(steps)})",
        "objects = [(mesh, surface) for mesh, (_, surface) in zip(apart, objects)]",
    ]


def listing(name: str, items: Sequence[tuple[str, str]]) -> list[str]:
    """A list of (expression, comment)."""
    if not items:
        return [f"{name}: list[Any] = []"]
    return [f"{name} = [", *(f"    {item},  # {comment(note)}" for item, note in items), "]"]


def mesh_files(case: Case) -> dict[str, bytes]:
    """The arrays beside the script."""
    return {f"mesh-{index}.npz": _mesh_file(mesh) for index, mesh in case.meshes.items()}


def _mesh_file(mesh: TriangleMesh) -> bytes:
    arrays = {"vertices": mesh.vertices, "faces": mesh.faces}
    if mesh.vertex_normals is not None:
        arrays["vertex_normals"] = mesh.vertex_normals
    with io.BytesIO() as file:
        np.savez(file, **arrays)  # type: ignore[arg-type]
        return file.getvalue()


def value(of: Any) -> str:
    """A number, a truth value, or a tuple of such."""
    if isinstance(of, bool):
        return str(of)
    return f"({', '.join(value(part) for part in of)})" if isinstance(of, tuple) else number(of)


def numbers(values: Iterable[float]) -> str:
    """A tuple."""
    return f"({', '.join(number(of) for of in values)})"


def number(of: float) -> str:
    """Shortest text that reads back as the same number."""
    return repr(float(of)).removesuffix(".0")


def comment(text: str) -> str:
    """One line, whatever the spec's author wrote."""
    return "".join(c if c.isprintable() else " " for c in text)
