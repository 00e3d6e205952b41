"""Scene → stand-alone OpenGL script."""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from equilux.adapter import Case, Program
from equilux_adapters._triangles import script as text
from equilux_adapters._triangles.coincident import set_backs
from equilux_adapters._triangles.script import ENTRY, number, numbers, value
from equilux_adapters._triangles.source import GEOMETRY
from equilux_adapters.opengl.budget import facts_of
from equilux_adapters.opengl.capabilities import CAPABILITIES, LACK_CAUSES
from equilux_adapters.opengl.division import segments_of
from equilux_adapters.opengl.kit.stage import Light, Surface
from equilux_adapters.opengl.knobs import OpenGLKnobs
from equilux_adapters.opengl.lighting import light_of, local_viewer, surface_of
from equilux_scenes.model import Mesh

KIT = (*GEOMETRY, *(f"equilux_adapters.opengl.kit.{name}" for name in ("refine", "context", "stage")))


def translate(case: Case, knobs: OpenGLKnobs) -> Program:
    """The script that draws the case, and its meshes. Raises Unsupported naming every feature that OpenGL lacks and that no cause
    stands for."""
    expressed = {feature for feature, capability in CAPABILITIES.items() if capability.level != "none"}
    text.refuse_what_is_missing(case, expressed, LACK_CAUSES, "OpenGL")
    return Program({ENTRY: script(case, knobs).encode(), **text.mesh_files(case)}, ENTRY, facts_of(case, knobs))


def script(case: Case, knobs: OpenGLKnobs) -> str:
    """The scene in OpenGL's words first, then the functions it needs and no others."""
    body = text.function("scene() -> Scene", _body(case, knobs))
    main = 'if __name__ == "__main__":\n    np.save("image.npy", render(scene()))'
    return text.assembled(text.head(case, "PyOpenGL"), body, main, KIT)


def _body(case: Case, knobs: OpenGLKnobs) -> list[str]:
    scene = case.scene
    surfaces = text.surface_names(scene.objects)
    shines = any(any(scene.materials[key].specular) for key in surfaces)
    lines = [*text.view(scene), ""]
    lines += [f"{name} = {_call('Surface', surface_of(scene.materials[key]))}" for key, name in surfaces.items()]
    lights = {key: light_of(light) for key, light in scene.delta_lights.items()}
    unused = set() if shines else {"specular"}
    lines += ["", *text.listing("lights", [(_call("Light", light, unused), key) for key, light in lights.items()])]
    drawn = []
    for index, (obj, segments) in enumerate(zip(scene.objects, segments_of(case, knobs), strict=True)):
        smooth = isinstance(obj, Mesh) and case.meshes[index].vertex_normals is not None
        turn = f", turn={number(2 * np.pi / knobs.tessellation)}" if smooth else ""
        fine = f"drawn(view, {text.shape(index, obj, segments, grazing=False)}, triangle_px={number(knobs.triangle_px)}{turn})"
        drawn.append((f"({fine}, {surfaces[obj.material]})", f"objects[{index}]"))
    lines += [*text.listing("objects", drawn), *text.set_back_line(set_backs(case))]
    rest = [f"ambient={numbers(scene.ambient)}"] if any(scene.ambient) else []
    rest += [f"background={numbers(scene.background)}"] if any(scene.background) else []
    rest += [] if local_viewer(scene) else ["local_viewer=False"]
    return [*lines, f"return Scene({', '.join(['view', 'lights', 'objects', *rest])})"]


def _call(name: str, of: Light | Surface, without: set[str] | None = None) -> str:
    """A call with every field that is not what it is by default."""
    given = {field.name: (getattr(of, field.name), field.default) for field in fields(of) if field.name not in (without or ())}
    return f"{name}({', '.join(f'{key}={value(now)}' for key, (now, default) in given.items() if now != default)})"


