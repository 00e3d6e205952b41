"""What each lighting model asks of a scene, beyond the terms that it has at all."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import SimpleNamespace

from equilux_scenes.checking import Context, Problem, check
from equilux_scenes.errors import number_text, shortened
from equilux_scenes.kinds import kinds_of
from equilux_scenes.mesh import open_edge, signed_volume
from equilux_scenes.model import Emitter, Material, Scene, SpotLight
from equilux_scenes.overlaps import overlapping
from equilux_scenes.shown import scene_of, shown
from equilux_scenes.yaml_tree import ListNode, MapNode, Node, ScalarNode

LARGEST_GL_EXPONENT = 128
"""glMaterial and glLight take exponents in [0, 128] and reject others."""

CLOSED = "a sphere, box, capped cylinder, watertight mesh or plane"


# --- opengl -----------------------------------------------------------------------------------------------------------


@check(Material, SpotLight, needs=("exponent",))
def _exponent_within_gl(part: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    if context.model == "opengl" and part.exponent > LARGEST_GL_EXPONENT:
        yield Problem(("exponent",), f"a number in [0, {LARGEST_GL_EXPONENT}] in {scene_of(context.model)}")


# --- raytraced --------------------------------------------------------------------------------------------------------


@check(Material, needs=("transparency", "transmission"))
def _transparent_lets_light_through(material: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    if context.model == "raytraced" and material.transparency > 0 and not any(material.transmission):
        what = f"transparency {number_text(material.transparency)} with transmission 0"
        yield Problem(("transparency",), message=f"{what}: it lets no light through, so it casts a full shadow", warning=True)


@check(Scene)
def _what_refracts_is_closed(scene: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    objects, materials = node.entries.get("objects"), node.entries.get("materials")
    if context.model != "raytraced" or not isinstance(objects, ListNode) or not isinstance(materials, MapNode):
        return
    bending = {name: ior for name, material in materials.entries.items() if (ior := _bending_ior(material)) is not None}
    for index, obj in enumerate(objects.items):
        if not isinstance(obj, MapNode) or (named := _word(obj, "material")) not in bending:
            continue
        why = _not_closed(obj, context)
        if why is not None:
            what = f"object {index} ({_word(obj, 'kind')}): got ior {bending[named]} of material '{shortened(named)}'"
            yield Problem((), message=f"{what}, allowed ior 1 ({why}; another needs {CLOSED})", place=obj.place)
        elif id(obj) in context.mesh_at and signed_volume(context.mesh_at[id(obj)][1]) < 0:
            words = (
                f"object {index} (mesh): its triangles face inwards, so its index {bending[named]} is that of what is around it"
            )
            yield Problem((), message=words, place=obj.place, warning=True)


def _bending_ior(material: Node) -> str | None:
    """How a material's index is written, if it is not 1: whatever the transparency, it is an index of what lies behind."""
    ior = material.entries.get("ior") if isinstance(material, MapNode) else None
    return shown(ior) if ior is not None and _number(ior, 1.0) != 1 else None


def _not_closed(obj: MapNode, context: Context) -> str | None:
    kind = _word(obj, "kind")
    if kind in ("disc", "rectangle"):
        return f"a {kind} encloses nothing"
    capped = obj.entries.get("capped")
    if kind == "cylinder" and isinstance(capped, ScalarNode) and capped.value is False:
        return "without its caps the cylinder encloses nothing"
    if kind == "mesh" and id(obj) in context.mesh_at:
        found = open_edge(context.mesh_at[id(obj)][1])
        if found is not None:
            a, b, along, against = found
            return f"this mesh is not watertight: {along + against} triangles have the edge of vertices {a} and {b}" + (
                ", not 2" if along + against != 2 else ", wound the same way"
            )
    return None


@check(Scene, needs=("objects", "materials"))
def _media_do_not_overlap(scene: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    if context.model != "raytraced" or any(obj.material not in scene.materials for obj in scene.objects):
        return
    for a, b in overlapping(scene.objects, scene.materials):
        what = f"objects {a} ({scene.objects[a].kind}) and {b} ({scene.objects[b].kind}) overlap and let light through"
        yield Problem(
            ("objects", b), message=f"{what}: a surface takes what lies outside it for index 1, and here it is not", warning=True
        )


# --- reflection-equation ----------------------------------------------------------------------------------------------


@check(Material, needs=("brdf", "specular"))
def _lambert_has_no_highlight(material: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    if material.brdf == "lambert" and any(material.specular):
        yield Problem(("specular",), "0 with brdf lambert (phong-classic and phong-cosine have a highlight)")


@check(Scene)
def _one_environment(scene: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    lights = node.entries.get("lights")
    entries: Mapping[str, Node] = lights.entries if isinstance(lights, MapNode) else {}
    found = [name for name, light in entries.items() if isinstance(light, MapNode) and _word(light, "kind") == "environment"]
    if context.model != "reflection-equation" or not found:
        return
    first = shortened(found[0])
    for name in found[1:]:
        yield Problem(("lights", name, "kind"), f"one environment in a scene, and light '{first}' is one")
    background = node.entries.get("background")
    if background is not None and any(_number(item, 0.0) for item in _items(background)):
        yield Problem(("background",), f"0 beside an environment (light '{first}' is what rays that miss see)")


@check(Scene)
def _something_to_be_seen(scene: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    if "objects" in node.entries:
        return
    lights = node.entries.get("lights")
    kinds = {_word(light, "kind") for light in lights.entries.values()} if isinstance(lights, MapNode) else set()
    if context.model != "reflection-equation" or not kinds & kinds_of(Emitter).keys():
        note = " (an emitter would do too)" if context.model == "reflection-equation" else ""
        yield Problem((), message=f"missing key 'objects' in the scene, allowed a list{note}")


def _items(node: Node) -> tuple[Node, ...]:
    return node.items if isinstance(node, ListNode) else (node,)


def _word(node: Node, key: str) -> str:
    """A text among the entries, empty where there is none."""
    value = node.entries.get(key) if isinstance(node, MapNode) else None
    return value.value if isinstance(value, ScalarNode) and isinstance(value.value, str) else ""


def _number(node: Node | None, default: float) -> float:
    """A number as written; the default for anything else, which is an error already."""
    if not isinstance(node, ScalarNode) or isinstance(node.value, bool) or not isinstance(node.value, int | float):
        return default
    return node.value
