"""Scene → stand-alone Mitsuba script."""

from __future__ import annotations

import math
import re
import textwrap

from equilux.adapter import Case, Program, Unsupported
from equilux_adapters.mitsuba.budget import facts_of, near_of, reach_of
from equilux_adapters.mitsuba.capabilities import CAPABILITIES
from equilux_adapters.mitsuba.knobs import MitsubaKnobs
from equilux_adapters.mitsuba.lights import emitter
from equilux_adapters.mitsuba.shapes import entries, mesh_file, mesh_in_world, ply
from equilux_adapters.mitsuba.source import kit_source
from equilux_adapters.mitsuba.text import comment, number, triple
from equilux_adapters.mitsuba.too_small import check_sizes
from equilux_adapters.mitsuba.unit import in_units, units_per_metre
from equilux_scenes.model import DeltaLight, Material, Scene

ENTRY = "scene.py"


def translate(case: Case, knobs: MitsubaKnobs) -> Program:
    """The script that draws the case, and its meshes. Raises Unsupported naming what Mitsuba lacks or cannot hold."""
    missing = [feature for feature in case.demands if feature not in CAPABILITIES or CAPABILITIES[feature].level == "none"]
    if missing:
        raise Unsupported(missing, f"Mitsuba cannot express {', '.join(missing)}")
    units = units_per_metre(case)
    case = in_units(case, units)
    check_sizes(case)
    files = {ENTRY: script(case, knobs, units).encode()}
    files |= {mesh_file(index): ply(mesh_in_world(case, index)) for index in case.meshes}
    return Program(files, ENTRY, facts_of(case))


def script(case: Case, knobs: MitsubaKnobs, units: float) -> str:
    """The scene in Mitsuba's words first, then the functions it needs and no others; the case is in the script's units."""
    body = "\n".join([*_scene(case), "", "", *_picture(case, knobs)])
    imports, constants, definitions = kit_source(body)
    head = [_head(case, units), "from __future__ import annotations", "", imports, "", 'mi.set_variant("llvm_ad_rgb")']
    main = 'if __name__ == "__main__":\n    np.savez("picture.npz", **picture())'
    return "\n".join([*head, "", constants, "", "", body, "", "", definitions, "", "", main, ""])


def _head(case: Case, units: float) -> str:
    lengths = "metres" if units == 1 else f"in units of 2^{round(-math.log2(units))} m (Q9)"
    film = f"({case.scene.film.height}, {case.scene.film.width}, 3)"
    lines = [
        comment(case.name),
        *textwrap.wrap(comment(case.scene.about), 100),
        "",
        "Run it with Python, NumPy, Mitsuba 3 and LLVM 17 or newer: it writes picture.npz, in it `image`, linear radiance in",
        f"W/(m² sr), {film}, row 0 on top, and `sigma`, its standard deviation. Lengths are {lengths}. Written by equilux.",
    ]
    return "\n".join(f"# {line}".rstrip() for line in lines)


def _scene(case: Case) -> list[str]:
    scene, reach = case.scene, reach_of(case)
    surfaces = surface_names(scene)
    lines = [f"{name} = {_surface(scene.materials[key])}" for key, name in surfaces.items()]
    lines += ["return {", '    "type": "scene",', f'    "integrator": {_integrator(scene)},']
    for index, (key, light) in enumerate(scene.lights.items()):
        lines.append(f'    "light_{index}": {emitter(light)},  # {comment(key)}')
    for index, obj in enumerate(scene.objects):
        lines += [f'    "{name}": {text},' for name, text in entries(case, index, surfaces[obj.material], reach)]
    return ["def scene() -> dict[str, Any]:", *(f"    {line}" for line in [*lines, "}"])]


def _integrator(scene: Scene) -> str:
    """Emitter and BSDF samples by multiple importance; the BSDF's find only what has an extent."""
    return f'{{"type": "direct", "emitter_samples": 1, "bsdf_samples": {int(is_sampled(scene))}}}'


def is_sampled(scene: Scene) -> bool:
    """Whether any light has an extent, so that there is something to integrate."""
    return not all(isinstance(light, DeltaLight) for light in scene.lights.values())


def sample_count(scene: Scene, wanted: int) -> int:
    """The least number of samples not below `wanted` that Mitsuba's sampler takes as it is and that gives each light alike.

    The sampler makes strata of y = ⌊√n⌋ rows and ⌈n/y⌉ columns; along its first coordinate, by which Mitsuba chooses the
    light, there are n of them, so that a multiple of the number of lights leaves no noise in the choice (Q3).
    """
    lights, count = max(len(scene.lights), 1), wanted
    while count % lights or count % math.isqrt(count):
        count += 1
    return count


def _picture(case: Case, knobs: MitsubaKnobs) -> list[str]:
    scene = case.scene
    camera, film = scene.camera, scene.film
    if camera.projection == "perspective":
        lens = f"half_height=np.tan(np.radians({number(camera.fov_y_deg)}) / 2)"
    else:
        lens = f"half_height={number(camera.height_m)} / 2, parallel=True"
    sampled = is_sampled(scene)
    glowing = {index: scene.materials[obj.material].emission for index, obj in enumerate(scene.objects)}
    shown = [f"{index}: {triple(bands)}" for index, bands in glowing.items() if any(bands)]
    settings = {
        "samples": str(sample_count(scene, knobs.samples if sampled else 1)),
        "repeats": str(knobs.repeats if sampled else 1),
        "emission": f"{{{', '.join(shown)}}}",
    }
    if any(scene.background):
        settings["background"] = triple(scene.background)
    if sampled and "occlusion" in case.requires:
        settings["soft_shadows"] = "True"
    given = ", ".join(f'"{name}": {value}' for name, value in settings.items())
    return [
        "def picture() -> dict[str, Any]:",
        "    view = View(",
        f"        eye={triple(camera.eye)}, target={triple(camera.target)}, up={triple(camera.up)},",
        f"        {lens}, width={film.width}, height={film.height}, near={number(near_of(case))},",
        "    )",
        f"    settings = {{{given}}}",
        "    return render(mi.load_dict(scene(), optimize=False), view, **settings)",
    ]


def surface_names(scene: Scene) -> dict[str, str]:
    """Material key → a Python name of its own; materials that no object uses are left out."""
    names: dict[str, str] = {}
    for obj in scene.objects:
        if obj.material not in names:
            name = re.sub(r"\W", "_", f"surface_{obj.material}", flags=re.ASCII)
            while name in names.values():
                name += "_"
            names[obj.material] = name
    return names


def _surface(material: Material) -> str:
    """Mitsuba's own `diffuse` where there is no lobe."""
    if material.brdf == "lambert" or not any(material.specular):
        return f"lambert({triple(material.diffuse)})"
    given = f"{triple(material.diffuse)}, {triple(material.specular)}, {number(material.exponent)}"
    return f'phong("{material.brdf}", {given})'
