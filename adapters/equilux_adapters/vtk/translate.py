"""Scene → stand-alone VTK script."""

from __future__ import annotations

import io
import re
import textwrap
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from equilux.adapter import Case, Program, Unsupported
from equilux_adapters.vtk.budget import facts_of
from equilux_adapters.vtk.capabilities import CAPABILITIES
from equilux_adapters.vtk.coincident import set_backs
from equilux_adapters.vtk.drawing import arguments
from equilux_adapters.vtk.knobs import VtkKnobs
from equilux_adapters.vtk.source import kit_source, names_in
from equilux_scenes.mesh import TriangleMesh
from equilux_scenes.model import DeltaLight, DirectionalLight, Material, Object, PointLight, Scene

ENTRY = "scene.py"


def translate(case: Case, knobs: VtkKnobs) -> Program:
    """The script that draws the case, and its meshes. Raises Unsupported naming every feature that VTK lacks."""
    missing = [feature for feature in case.requires if feature not in CAPABILITIES or CAPABILITIES[feature].level == "none"]
    if missing:
        raise Unsupported(missing, f"VTK cannot express {', '.join(missing)}")
    files = {ENTRY: script(case, knobs).encode()}
    files |= {f"mesh-{index}.npz": _mesh_file(mesh) for index, mesh in case.meshes.items()}
    return Program(files, ENTRY, facts_of(case, knobs))


def script(case: Case, knobs: VtkKnobs) -> str:
    """The scene in VTK's words first, then the functions it needs and no others."""
    body = "\n".join(["def picture() -> tuple[Array, str]:", *(f"    {line}".rstrip() for line in _body(case, knobs))])
    main = 'if __name__ == "__main__":\n    np.save("image.npy", picture()[0])'
    imports, functions = kit_source(names_in(body) | {"np", "Array"})
    future = "from __future__ import annotations\n"
    return "\n".join([_head(case), future, imports, "\n", body, "\n", functions, "\n", main, ""])


def _head(case: Case) -> str:
    about = textwrap.wrap(_comment(case.scene.about), 100)
    film = f"({case.scene.film.height}, {case.scene.film.width}, 3)"
    lines = [
        _comment(case.name),
        *about,
        "",
        "Run it with Python, NumPy and VTK: it writes image.npy, linear radiance in W/(m² sr), float32,",
        f"{film}, row 0 on top. Lengths are metres. Written by equilux.",
    ]
    return "\n".join(f"# {line}".rstrip() for line in lines)


def _body(case: Case, knobs: VtkKnobs) -> list[str]:
    scene = case.scene
    surfaces = _surface_names(scene.objects)
    lines = [*_view(scene), ""]
    for key, name in surfaces.items():
        lines += [*_surface(name, scene.materials[key], scene), ""]
    lines += _list("lights", [(_light(light), key) for key, light in scene.delta_lights.items()])
    drawn = [f"({_shape(index, obj, knobs)}, {surfaces[obj.material]})" for index, obj in enumerate(scene.objects)]
    lines += _list("objects", [(text, f"objects[{index}]") for index, text in enumerate(drawn)])
    if any(steps := set_backs(case)):  # Q12
        lines.append(f"apart = set_back(view, [mesh for mesh, _ in objects], steps={tuple(steps)})")
        lines.append("objects = [(mesh, surface) for mesh, (_, surface) in zip(apart, objects)]")
    return [*lines, f"return render(view, {_tuple(scene.background)}, lights, objects)"]


def _view(scene: Scene) -> list[str]:
    camera, film = scene.camera, scene.film
    axes = f"**look_at(eye={_tuple(camera.eye)}, target={_tuple(camera.target)}, up={_tuple(camera.up)})"
    if camera.projection == "perspective":
        lens = f"half_height=np.tan(np.radians({_number(camera.fov_y_deg)}) / 2)"
    else:
        lens = f"half_height={_number(camera.height_m)} / 2, parallel=True"
    return ["view = View(", f"    {axes},", f"    {lens},", f"    width={film.width}, height={film.height},", ")"]


def _surface_names(objects: Iterable[Object]) -> dict[str, str]:
    """Material key → a Python name of its own; materials that no object uses are left out."""
    names: dict[str, str] = {}
    for obj in objects:
        if obj.material not in names:
            name = re.sub(r"\W", "_", f"surface_{obj.material}", flags=re.ASCII)
            while name in names.values():
                name += "_"
            names[obj.material] = name
    return names


def _surface(name: str, material: Material, scene: Scene) -> list[str]:
    """The statements of one vtkProperty. The K go into the colours: coefficients are clamped to 1, colours are not (Q4)."""
    lines = [f"{name} = vtkProperty()", f"{name}.SetInterpolationToPhong()"]
    glow = [own + k * around for own, k, around in zip(material.emission, material.ambient, scene.ambient, strict=True)]  # Q3
    if any(glow):
        lines += [f"{name}.SetAmbient(1)", f"{name}.SetAmbientColor{_tuple(glow)}"]
    # without lights VTK would show the diffuse colour as it is (Q10)
    if any(material.diffuse) and scene.lights:
        lines.append(f"{name}.SetDiffuseColor{_tuple(material.diffuse)}")
    else:
        lines.append(f"{name}.SetDiffuse(0)")
    if any(material.specular) and scene.lights:
        lines += [f"{name}.SetSpecular(1)", f"{name}.SetSpecularColor{_tuple(material.specular)}"]
        lines.append(f"{name}.SetSpecularPower({_number(material.exponent)})")
    return lines


def _light(light: DeltaLight) -> str:
    if isinstance(light, DirectionalLight):
        return f"directional_light(direction={_tuple(light.direction)}, irradiance={_tuple(light.irradiance)})"
    terms = _tuple([light.attenuation.constant, light.attenuation.linear, light.attenuation.quadratic])
    place = f"view, position={_tuple(light.position)}, intensity={_tuple(light.intensity)}, attenuation={terms}"
    if isinstance(light, PointLight):
        return f"point_light({place})"
    cone = f"cone_half_angle_deg={_number(light.cone_half_angle_deg)}, exponent={_number(light.exponent)}"
    return f"spot_light({place}, direction={_tuple(light.direction)}, {cone})"


def _shape(index: int, obj: Object, knobs: VtkKnobs) -> str:
    given = [f"{name}={_value(value)}" for name, value in arguments(obj, knobs).items()]
    if obj.kind == "mesh":
        given.insert(0, f'**read_mesh("mesh-{index}.npz")')
    return f"{obj.kind}({', '.join(['view', *given])})"


def _list(name: str, items: Sequence[tuple[str, str]]) -> list[str]:
    if not items:
        return [f"{name}: list[Any] = []"]
    return [f"{name} = [", *(f"    {item},  # {_comment(note)}" for item, note in items), "]"]


def _mesh_file(mesh: TriangleMesh) -> bytes:
    arrays = {"vertices": mesh.vertices, "faces": mesh.faces}
    if mesh.vertex_normals is not None:
        arrays["vertex_normals"] = mesh.vertex_normals
    with io.BytesIO() as file:
        np.savez(file, **arrays)  # type: ignore[arg-type]
        return file.getvalue()


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return str(value)
    return f"({', '.join(_value(part) for part in value)})" if isinstance(value, tuple) else _number(value)


def _tuple(values: Iterable[float]) -> str:
    return f"({', '.join(_number(value) for value in values)})"


def _number(value: float) -> str:
    """Shortest text that reads back as the same number."""
    return repr(float(value)).removesuffix(".0")


def _comment(text: str) -> str:
    """One line, whatever the spec's author wrote."""
    return "".join(c if c.isprintable() else " " for c in text)
