"""Scene → POV-Ray scene file. Pure: needs no POV-Ray."""

from __future__ import annotations

import re
from collections.abc import Mapping

from equilux.adapter import Program
from equilux_adapters.povray import frame as frames
from equilux_adapters.povray.facts import facts, levels
from equilux_adapters.povray.frame import Frame
from equilux_adapters.povray.gl_lights import check_viewer
from equilux_adapters.povray.knobs import PovrayKnobs
from equilux_adapters.povray.lights import Lamp, lamps
from equilux_adapters.povray.materials import Coefficients, coefficients
from equilux_adapters.povray.media import NEARLY, Media, media
from equilux_adapters.povray.numbers import bands, matrix_modifier, number, vector
from equilux_adapters.povray.shapes import written
from equilux_adapters.povray.textures import texture
from equilux_scenes.case import Case

SCENE_FILE = "scene.pov"
SETTINGS_FILE = "render.ini"
LOCAL = ("phong", "opengl")  # models without occlusion
FILE_TYPES = {"png16": "N", "exr": "E", "hdr": "H"}
EXHAUSTIVE = 200  # below this many objects and lights all are tried, in file order: the first of coincident ones wins (Q17)


def program(case: Case, knobs: PovrayKnobs) -> Program:
    """The scene file, the settings file, and what `render` and `read` must know. Raises Unsupported."""
    check_viewer(case)
    frame = frames.choose(case)
    lights = lamps(case, frame, knobs.fade_ratio)
    insides = media(case)
    materials = {name: coefficients(m, case.scene) for name, m in case.scene.materials.items()}
    files = {
        SCENE_FILE: _scene(case, frame, lights, materials, insides, knobs).encode(),
        SETTINGS_FILE: _settings(case, knobs).encode(),
    }
    return Program(files, SCENE_FILE, facts(case, frame, lights, materials, insides, knobs))


def _scene(
    case: Case, frame: Frame, lights: list[Lamp], materials: Mapping[str, Coefficients], insides: Media, knobs: PovrayKnobs
) -> str:
    scene = case.scene
    used = list(dict.fromkeys(obj.material for obj in scene.objects))
    names = {name: f"Material_{index}_{re.sub('[^A-Za-z0-9_]', '_', name)}" for index, name in enumerate(used)}
    textures = {name: texture(materials[name]) for name in used}
    ambient = any(any(materials[name].ambient) for name in used)
    layered = any(t.layered for t in textures.values())
    blocks = [_header(case, frame), _globals(case, ambient, layered, knobs), _camera(case, frame)]
    if any(scene.background):
        blocks.append(f"background {{ rgb {bands(scene.background)} * Exposure }}")
    blocks += [lamp.text for lamp in lights]
    blocks += [f"#declare {names[name]} =\n{_indented(textures[name].text)};" for name in used]
    blocks += [_object(case, frame, i, names, insides) for i in range(len(scene.objects)) if i not in insides.shared]
    if insides.shared:
        blocks.append(_sharing(case, frame, names, insides))
    return "\n\n".join(blocks) + "\n"


def _sharing(case: Case, frame: Frame, names: Mapping[str, str], insides: Media) -> str:
    """Objects with one inside: a ray enters and leaves it in turns, so that every crossing counts (Q34).

    They come last, so that it is the innermost of what the eye is inside of, and as one object, so that it counts once. Of
    coincident surfaces in a union the last one wins.
    """
    parts = [_object(case, frame, index, names, insides) for index in reversed(insides.shared)]
    if len(parts) == 1:
        return f"{parts[0][:-2]}\n  {NEARLY} }}"
    return "union {\n" + "\n".join(_indented(part) for part in parts) + f"\n  {NEARLY}\n  split_union off\n}}"


def _object(case: Case, frame: Frame, index: int, names: Mapping[str, str], insides: Media) -> str:
    obj = case.scene.objects[index]
    shape = written(obj, case.meshes.get(index), frame)
    modifiers = [*insides.modifiers.get(index, []), f"texture {{ {names[obj.material]} }}"]
    if shape.matrix is not None:
        modifiers.append(matrix_modifier(shape.matrix))
    if _shadowless(case, index):
        modifiers.append("no_shadow")
    modifiers[-1] += " }"
    return "\n  ".join([shape.text, *modifiers])


def _shadowless(case: Case, index: int) -> bool:
    """Whether light passes this object as if it were not there; a shadowless light would lose its highlight (Q3)."""
    if case.scene.model in LOCAL:
        return True
    see_through = case.scene.materials[case.scene.objects[index].material].transparency > 0
    return see_through and "shadow.ignored" in case.requires


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


def _globals(case: Case, ambient: bool, layered: bool, knobs: PovrayKnobs) -> str:
    parts = ["assumed_gamma 1.0"]
    if ambient:
        parts.append(f"ambient_light rgb {bands(case.scene.ambient)} * Exposure")
    secondary = {"reflection", "transparency"} & set(case.requires)
    if layered or secondary:
        parts.append(f"adc_bailout {number(knobs.adc_bailout)}")
    if secondary:
        parts.append(f"max_trace_level {levels(case, knobs)}")
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
        f"Output_File_Type={FILE_TYPES[knobs.channel]}", "Bits_Per_Color=16", "File_Gamma=1.0", "Output_Alpha=Off",
        "Grayscale_Output=Off", "Dither=Off",
        *_antialiasing(knobs), "Quality=9", "Bounding=On", f"Bounding_Threshold={EXHAUSTIVE}", f"Work_Threads={knobs.threads}",
        "Display=Off", "Pause_When_Done=Off", "Verbose=Off", "Continue_Trace=Off",
        "Debug_Console=Off", "Render_Console=Off", "Statistic_Console=Off", "",
    ])


def _antialiasing(knobs: PovrayKnobs) -> list[str]:
    """Method 1 adds antialias² points of a grid to the pixel's centre where neighbours differ, without jitter (Q46)."""
    if not knobs.antialias:
        return ["Antialias=Off"]
    return [
        "Antialias=On", "Sampling_Method=1", f"Antialias_Depth={knobs.antialias}",
        f"Antialias_Threshold={number(knobs.antialias_threshold)}", "Jitter=Off",
    ]  # fmt: skip
