"""Scene → POV-Ray scene file. Pure: needs no POV-Ray."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from equilux.adapter import Program
from equilux_adapters.povray import frame as frames
from equilux_adapters.povray.frame import Frame
from equilux_adapters.povray.knobs import PovrayKnobs
from equilux_adapters.povray.lights import Lamp, lamps
from equilux_adapters.povray.materials import Coefficients, coefficients, texture
from equilux_adapters.povray.meshes import mesh_accuracy
from equilux_adapters.povray.numbers import bands, matrix_modifier, number, vector
from equilux_adapters.povray.shapes import written
from equilux_scenes.case import Case
from equilux_scenes.transforms import matrix

SCENE_FILE = "scene.pov"
SETTINGS_FILE = "render.ini"
EXHAUSTIVE = 200  # below this many objects and lights all are tried, in file order: the first of coincident ones wins (Q17)


def program(case: Case, knobs: PovrayKnobs) -> Program:
    """The scene file, the settings file, and what `render` and `read` must know. Raises Unsupported."""
    frame = frames.choose(case)
    lights = lamps(case, frame, knobs.fade_ratio)
    materials = {name: coefficients(m, case.scene.ambient) for name, m in case.scene.materials.items()}
    files = {
        SCENE_FILE: _scene(case, frame, lights, materials).encode(),
        SETTINGS_FILE: _settings(case, knobs).encode(),
    }
    return Program(files, SCENE_FILE, _facts(case, frame, lights, materials))


def _scene(case: Case, frame: Frame, lights: list[Lamp], materials: Mapping[str, Coefficients]) -> str:
    scene = case.scene
    used = list(dict.fromkeys(obj.material for obj in scene.objects))
    names = {name: f"Material_{index}_{re.sub('[^A-Za-z0-9_]', '_', name)}" for index, name in enumerate(used)}
    textures = {name: texture(materials[name]) for name in used}
    ambient = any(any(materials[name].ambient) for name in used)
    blocks = [_header(case, frame), _globals(case, ambient, any(t.layered for t in textures.values())), _camera(case, frame)]
    if any(scene.background):
        blocks.append(f"background {{ rgb {bands(scene.background)} * Exposure }}")
    blocks += [lamp.text for lamp in lights]
    blocks += [f"#declare {names[name]} =\n{_indented(textures[name].text)};" for name in used]
    for index, obj in enumerate(scene.objects):
        shape = written(obj, case.meshes.get(index), frame)
        modifiers = [f"texture {{ {names[obj.material]} }}"]
        if shape.matrix is not None:
            modifiers.append(matrix_modifier(shape.matrix))
        # no occlusion in the model; a shadowless light would lose its highlight (Q3)
        modifiers.append("no_shadow }")
        blocks.append("\n  ".join([shape.text, *modifiers]))
    return "\n\n".join(blocks) + "\n"


def _header(case: Case, frame: Frame) -> str:
    lines = [f"// {case.name}"]
    if case.scene.about:
        lines.append(f"// {' '.join(case.scene.about.split())}")
    if not frame.is_world:
        lines.append(f"// lengths in units of {number(1.0 / frame.scale)} m, measured from {vector(frame.origin)} (m)")
    lines += [
        "#version 3.7;",
        "// radiance times Exposure is what the image shows, clipped at 1; render.ini and command.txt say how it is called",
        "#ifndef (Exposure) #declare Exposure = 1; #end",
    ]
    return "\n".join(lines)


def _globals(case: Case, ambient: bool, layered: bool) -> str:
    parts = ["assumed_gamma 1.0"]
    if ambient:
        parts.append(f"ambient_light rgb {bands(case.scene.ambient)} * Exposure")
    if layered:
        parts.append("adc_bailout 0")
    return f"global_settings {{ {' '.join(parts)} }}"


def _camera(case: Case, frame: Frame) -> str:
    """right = forward × up, explicitly: POV-Ray's own is left-handed (Q1). Lengths, not `angle`, set the field of view (Q2)."""
    camera = frames.view(case)
    size = 1.0 if camera.perspective else frame.scale
    kind = "" if camera.perspective else "orthographic\n  "
    return (
        f"camera {{\n  {kind}location {vector(frame.point(camera.eye))}\n"
        f"  direction {vector(camera.forward)}\n"
        f"  right {vector(camera.right)} * {number(camera.width * size)}\n"
        f"  up {vector(camera.up)} * {number(camera.height * size)}\n}}"
    )


def _indented(text: str) -> str:
    return "\n".join("  " + line for line in text.splitlines())


def _settings(case: Case, knobs: PovrayKnobs) -> str:
    """Every setting that the picture depends on. As $POVINI it replaces the user's and the system's povray.ini (Q23)."""
    film = case.scene.film
    return "\n".join([
        "; every setting the picture depends on; used as $POVINI, in place of any other povray.ini",
        f"Input_File_Name={SCENE_FILE}",
        f"Width={film.width}", f"Height={film.height}",
        "Output_File_Type=N", "Bits_Per_Color=16", "File_Gamma=1.0", "Output_Alpha=Off", "Grayscale_Output=Off", "Dither=Off",
        "Antialias=Off", "Quality=9", "Bounding=On", f"Bounding_Threshold={EXHAUSTIVE}", f"Work_Threads={knobs.threads}",
        "Display=Off", "Pause_When_Done=Off", "Verbose=Off", "Continue_Trace=Off",
        "Debug_Console=Off", "Render_Console=Off", "Statistic_Console=Off", "",
    ])


def _facts(case: Case, frame: Frame, lights: list[Lamp], materials: Mapping[str, Coefficients]) -> dict[str, Any]:
    """What the exposures and the budget are derived from; all bounds are over the whole picture."""
    scene = case.scene
    ceiling, strength, rounded_highlight = max(scene.background), 0.0, 0.0
    for index, obj in enumerate(scene.objects):
        m = materials[obj.material]
        glow = max(e + a * light for e, a, light in zip(m.emission, m.ambient, scene.ambient, strict=True))
        reflecting = max(d + s for d, s in zip(m.diffuse, m.specular, strict=True))
        arriving = sum(lamp.irradiance[index] for lamp in lights)
        ceiling, strength = max(ceiling, glow + arriving * reflecting), max(strength, reflecting)
        if float(np.float32(m.exponent)) != m.exponent:
            rounded_highlight = max(rounded_highlight, arriving * max(m.specular))
    used = [materials[name] for name in {obj.material for obj in scene.objects}]
    meshes = {str(index): vars(mesh_accuracy(mesh, matrix(scene.objects[index]))) for index, mesh in case.meshes.items()}
    return {
        "width": scene.film.width,
        "height": scene.film.height,
        "ceiling": float(ceiling),
        "strength": float(strength),
        "rounded_highlight": float(rounded_highlight),
        "layered": any(texture(m).layered for m in used),
        "glowing": any(any(m.ambient) or any(m.emission) for m in used),
        "sources": sum(lamp.sources for lamp in lights),
        "fading": max([lamp.relative for lamp in lights], default=0.0),
        "cancelled": float(np.sum([lamp.cancelled for lamp in lights]) * strength),
        "film_px": frame.film_px,
        "meshes": meshes,
    }
