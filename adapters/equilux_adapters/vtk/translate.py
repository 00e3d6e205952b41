"""Scene → stand-alone VTK script."""

from __future__ import annotations

from equilux.adapter import Case, Program
from equilux_adapters._triangles import script as text
from equilux_adapters._triangles.coincident import set_backs
from equilux_adapters._triangles.script import ENTRY, number, numbers
from equilux_adapters._triangles.source import GEOMETRY
from equilux_adapters.vtk.budget import facts_of
from equilux_adapters.vtk.capabilities import CAPABILITIES, LACK_CAUSES
from equilux_adapters.vtk.knobs import VtkKnobs
from equilux_scenes.model import DeltaLight, DirectionalLight, Material, PointLight, Scene

KIT = (*GEOMETRY, "equilux_adapters.vtk.kit.stage", "equilux_adapters.vtk.kit.limited")


def translate(case: Case, knobs: VtkKnobs) -> Program:
    """The script that draws the case, and its meshes. Raises Unsupported naming every feature that VTK lacks and that no cause
    stands for."""
    expressed = {feature for feature, capability in CAPABILITIES.items() if capability.level != "none"}
    text.refuse_what_is_missing(case, expressed, LACK_CAUSES, "VTK")
    return Program({ENTRY: script(case, knobs).encode(), **text.mesh_files(case)}, ENTRY, facts_of(case, knobs))


def script(case: Case, knobs: VtkKnobs) -> str:
    """The scene in VTK's words first, then the functions it needs and no others."""
    result = "Frame" if is_limited(knobs) else "tuple[Array, str]"
    body = text.function(f"picture() -> {result}", _body(case, knobs))
    saved = "picture().pixels" if is_limited(knobs) else "picture()[0]"
    main = f'if __name__ == "__main__":\n    np.save("image.npy", {saved})'
    return text.assembled(text.head(case, "VTK"), body, main, KIT)


def is_limited(knobs: VtkKnobs) -> bool:
    """Whether the frame holds less than radiance at the pixels' centres."""
    return knobs.target != "float32" or knobs.samples > 0


def _body(case: Case, knobs: VtkKnobs) -> list[str]:
    scene = case.scene
    surfaces = text.surface_names(scene.objects)
    lines = [*text.view(scene), ""]
    for key, name in surfaces.items():
        lines += [*_surface(name, scene.materials[key], scene, knobs), ""]
    lines += text.listing("lights", [(_light(light), key) for key, light in scene.delta_lights.items()])
    meshes = [text.shape(index, obj, knobs.tessellation) for index, obj in enumerate(scene.objects)]
    drawn = [f"({mesh}, {surfaces[obj.material]})" for mesh, obj in zip(meshes, scene.objects, strict=True)]
    lines += text.listing("objects", [(call, f"objects[{index}]") for index, call in enumerate(drawn)])
    lines += text.set_back_line(set_backs(case))  # Q12
    everything = f"view, {numbers(scene.background)}, lights, objects"
    if is_limited(knobs):
        return [*lines, f'return render_limited({everything}, target="{knobs.target}", samples={knobs.samples})']
    return [*lines, f"return render({everything})"]


def _surface(name: str, material: Material, scene: Scene, knobs: VtkKnobs) -> list[str]:
    """The statements of one vtkProperty. The K go into the colours: coefficients are clamped to 1, colours are not (Q4).

    What lets light through is drawn opaque, with the share 1 − t of light from the front that is its own (Q17).
    """
    lines = [f"{name} = vtkProperty()", f"{name}.SetInterpolationTo{knobs.interpolation.capitalize()}()"]  # Q19
    glow = [own + k * around for own, k, around in zip(material.emission, material.ambient, scene.ambient, strict=True)]  # Q3
    if any(glow):
        lines += [f"{name}.SetAmbient(1)", f"{name}.SetAmbientColor{numbers(glow)}"]
    kept = 1 - material.transparency
    # without lights VTK would show the diffuse colour as it is (Q10)
    if any(material.diffuse) and scene.lights and kept > 0:
        lines.append(f"{name}.SetDiffuseColor{numbers(kept * k for k in material.diffuse)}")
    else:
        lines.append(f"{name}.SetDiffuse(0)")
    if any(material.specular) and scene.lights and kept > 0:
        lines += [f"{name}.SetSpecular(1)", f"{name}.SetSpecularColor{numbers(kept * k for k in material.specular)}"]
        lines.append(f"{name}.SetSpecularPower({number(material.exponent)})")
    return lines


def _light(light: DeltaLight) -> str:
    if isinstance(light, DirectionalLight):
        return f"directional_light(direction={numbers(light.direction)}, irradiance={numbers(light.irradiance)}{_colours(light)})"
    terms = numbers([light.attenuation.constant, light.attenuation.linear, light.attenuation.quadratic])
    place = f"view, position={numbers(light.position)}, intensity={numbers(light.intensity)}, attenuation={terms}"
    if isinstance(light, PointLight):
        return f"point_light({place}{_colours(light)})"
    cone = f"cone_half_angle_deg={number(light.cone_half_angle_deg)}, exponent={number(light.exponent)}"
    return f"spot_light({place}, direction={numbers(light.direction)}, {cone}{_colours(light)})"


def _colours(light: DeltaLight) -> str:
    """The light's shares, where it has any of its own: VTK takes the diffuse one for the highlight too (Q18)."""
    shares = {"ambient": (0.0,) * 3, "diffuse": (1.0,) * 3, "specular": (1.0,) * 3}
    if all(getattr(light, term) == default for term, default in shares.items()):
        return ""
    return "".join(f", {term}={numbers(getattr(light, term))}" for term in shares)
