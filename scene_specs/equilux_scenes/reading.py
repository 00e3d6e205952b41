"""Located nodes → typed parts, going on after every error so that all of them are found at once.

The types of `model` say which keys a part has and pydantic validates each value; this module walks them side by side with the
nodes, so that every message has the place of the offending key or value. A part is checked further (`checks`) as soon as the
fields that a check needs are valid, whatever else is wrong with it.

Parts are remembered by node: the cases of a sweep share every part that the sweep does not touch.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, Final, get_args

from pydantic import ValidationError
from pydantic.fields import FieldInfo

from equilux_scenes import checks, checks_of_lights, checks_of_models
from equilux_scenes.checking import Context, Problem, checks_of
from equilux_scenes.errors import SpecError, SpecErrors, hint, number_text, shortened
from equilux_scenes.kinds import Kind, Leaf, Many, PartOf, fields_of
from equilux_scenes.limits import exceeded
from equilux_scenes.mesh import MeshError, TriangleMesh, triangle_areas
from equilux_scenes.model import LIGHTING_MODELS, ZERO, BandIntervals, Mesh, Part, Scene, Strength
from equilux_scenes.shown import label, owner, scene_of, shown
from equilux_scenes.units import CannotResolve, Units, in_bands
from equilux_scenes.values import OnlyIn, OrFrom
from equilux_scenes.yaml_tree import ListNode, MapNode, Node, Place, ScalarNode, YamlText, plain, walk

Path = tuple[str | int, ...]

CHECKS = (checks, checks_of_lights, checks_of_models)
"""Where the checks are; importing them declares them."""


class Invalid:
    """Stands for a value whose errors have been reported."""


INVALID: Final = Invalid()


class Reader:
    """Reads nodes of one text into typed parts, collecting errors. One reader serves the spec and all its cases."""

    def __init__(self, source: YamlText, context: Context) -> None:
        self.source = source
        self.context = context
        self.errors: list[SpecError] = []
        self.warnings: list[SpecError] = []
        self.part_at: dict[Path, type[Part]] = {}
        self._meshes: dict[int, TriangleMesh] = {}
        self._remembered: dict[tuple[object, ...], tuple[Node, Any]] = {}

    def scene(self, root: Node) -> Scene | None:
        """The typed scene, or None with its errors collected."""
        model = root.entries.get("model") if isinstance(root, MapNode) else None
        self.context.model = model.value if isinstance(model, ScalarNode) and isinstance(model.value, str) else None
        self.context.units = self._units(root)
        scene = self._part(PartOf((Scene,)), root, ())
        return scene if isinstance(scene, Scene) else None

    def _units(self, root: Node) -> Units:
        """What lights in photometric units depend on; the default in place of what is wrong, which is reported all the same."""
        if not isinstance(root, MapNode):
            return Units()
        self.part_at[()] = Scene
        kinds = {name: kind for name, kind, _ in fields_of(Scene) if name in ("k_m", "bands") and name in root.entries}
        found = {name: self._value(kind, root.entries[name], (name,)) for name, kind in kinds.items()}
        k_m, bands = found.get("k_m"), found.get("bands")
        return Units(k_m if isinstance(k_m, float) else Units.k_m, bands if isinstance(bands, BandIntervals) else None)

    def meshes(self, scene: Scene) -> dict[int, TriangleMesh]:
        """Object index → mesh of a scene read by this reader."""
        return {index: self._meshes[id(obj)] for index, obj in enumerate(scene.objects) if isinstance(obj, Mesh)}

    def error(self, place: Place, message: str) -> SpecError:
        """An error of this text."""
        return SpecError(self.source.file, place.line, place.column, message)

    def error_at(self, place: Place, message: str) -> None:
        """Collect an error."""
        self.errors.append(self.error(place, message))

    def warn_at(self, place: Place, message: str) -> None:
        """Collect a warning."""
        self.warnings.append(self.error(place, message))

    # --- values ---------------------------------------------------------------------------------------------------

    def _value(self, kind: Kind, node: Node, path: Path) -> Any:
        # what a part means depends on the scene's model and units too, which may be swept
        key = (id(node), id(kind), self.context.model, self.context.units)
        if key not in self._remembered:
            # the node is kept, so that its id stays its own
            self._remembered[key] = (node, self._read(kind, node, path))
        return self._remembered[key][1]

    def _read(self, kind: Kind, node: Node, path: Path) -> Any:
        if isinstance(kind, Leaf):
            return self._leaf(kind, node, path)
        if isinstance(kind, PartOf):
            return self._part(kind, node, path)
        return self._list(kind, node, path) if kind.container == "list" else self._mapping(kind, node, path)

    def _leaf(self, leaf: Leaf, node: Node, path: Path) -> Any:
        try:
            return leaf.adapter.validate_python(plain(node))
        except ValidationError as failed:
            places: set[int] = set()
            for error in failed.errors(include_url=False, include_context=False, include_input=False):
                found, inside = walk(node, error["loc"])
                if found.place.start not in places:
                    places.add(found.place.start)
                    allowed = leaf.allowed.at_depth(len(inside))
                    self._not_allowed(found, (*path, *inside), allowed, _word_note(leaf.words, found))
            return INVALID

    def _not_allowed(self, node: Node, path: Path, allowed: str, note: str = "") -> None:
        self.error_at(node.place, f"{self._what(path)}: got {shown(node)}, allowed {allowed}{note}")

    def _what(self, path: Path) -> str:
        """A part, or a value of a part, in words."""
        if path in self.part_at:
            return self._owner(path)
        part_path, rest = self._split(path)
        return f"{label(rest)} of {self._owner(part_path)}"

    def _split(self, path: Path) -> tuple[Path, Path]:
        """A path as the path of the innermost part on it, and what follows inside that part."""
        for length in range(len(path) - 1, -1, -1):
            if path[:length] in self.part_at:
                return path[:length], path[length:]
        return (), path

    def _owner(self, path: Path) -> str:
        cls = self.part_at.get(path)
        kind = cls.model_fields.get("kind") if cls is not None else None
        return owner(path, get_args(kind.annotation)[0] if kind is not None and path[0] == "objects" else None)

    # --- lists and mappings of parts ----------------------------------------------------------------------------

    def _list(self, many: Many, node: Node, path: Path) -> Any:
        if not isinstance(node, ListNode):
            self._not_allowed(node, path, "a list")
            return INVALID
        if not self._within_limit(len(node.items), node, path):
            return INVALID
        items = [self._value(many.of, item, (*path, index)) for index, item in enumerate(node.items)]
        return INVALID if any(item is INVALID for item in items) else tuple(items)

    def _mapping(self, many: Many, node: Node, path: Path) -> Any:
        if not isinstance(node, MapNode):
            self._not_allowed(node, path, "a mapping from names")
            return INVALID
        if not self._within_limit(len(node.entries), node, path):
            return INVALID
        items = {name: self._value(many.of, item, (*path, name)) for name, item in node.entries.items()}
        return INVALID if any(item is INVALID for item in items.values()) else items

    def _within_limit(self, count: int, node: Node, path: Path) -> bool:
        limit = getattr(self.context.limits, str(path[-1]), None)
        if limit is None or count <= limit:
            return True
        self.error_at(node.place, exceeded(str(path[-1]), count, limit, f"{path[-1]} of the scene"))
        return False

    # --- parts ----------------------------------------------------------------------------------------------------

    def _part(self, part: PartOf, node: Node, path: Path) -> Any:
        if not isinstance(node, MapNode):
            what = owner(path, None)
            self.error_at(node.place, f"{what}: got {shown(node)}, allowed a mapping")
            return INVALID
        cls = self._class(part, node, path)
        if cls is None:
            return INVALID
        self.part_at[path] = cls
        return self._fields(cls, node, path)

    def _class(self, part: PartOf, node: MapNode, path: Path) -> type[Part] | None:
        if part.discriminator is None:
            return part.classes[0]
        tags = {tag: cls for tag, cls in part.tags().items() if self._kind_exists(cls)}
        given = node.entries.get(part.discriminator)
        if given is None:
            self._no_discriminator(part, node, path)
            return None
        if isinstance(given, ScalarNode) and isinstance(given.value, str) and given.value in tags:
            return tags[given.value]
        note = self._other_model_note(part, given) or _word_note(tuple(tags), given)
        self.error_at(
            given.place, f"{part.discriminator} of {owner(path, None)}: got {shown(given)}, allowed {', '.join(tags)}{note}"
        )
        return None

    def _no_discriminator(self, part: PartOf, node: MapNode, path: Path) -> None:
        """Without it no other key can be judged, but it may be there misspelt."""
        assert part.discriminator is not None
        known = {name for cls in part.classes for name in cls.model_fields}
        what = owner(path, None)
        for key, place in node.keys.items():
            if key not in known and (meant := hint(key, [part.discriminator])):
                self.error_at(place, f"unknown key '{shortened(key)}' in {what}{meant}")
                return
        kinds = ", ".join(tag for tag, cls in part.tags().items() if self._kind_exists(cls))
        self.error_at(node.place, f"missing key '{part.discriminator}' in {what}, allowed {kinds}")

    def _kind_exists(self, cls: type[Part]) -> bool:
        only = cls.kinds_only_in
        return only is None or self.context.model in only.models or self.context.model not in LIGHTING_MODELS

    def _other_model_note(self, part: PartOf, given: Node) -> str:
        """Of a kind that another model has."""
        cls = part.tags().get(str(given.value)) if isinstance(given, ScalarNode) else None
        if cls is None or cls.kinds_only_in is None:
            return ""
        return f" in {scene_of(self.context.model)} (the model {cls.kinds_only_in} has this kind)"

    def _fields(self, cls: type[Part], node: MapNode, path: Path) -> Any:
        self._unknown_keys(cls, node, path)
        errors = len(self.errors)
        values: dict[str, Any] = {}
        complete = True
        for name, kind, field in fields_of(cls):
            value = self._field(name, kind, field, node, path)
            if value is INVALID:
                complete = False
            else:
                values[name] = value
        self._check(cls, values, node, path)
        mesh = self._mesh(values, node, path) if issubclass(cls, Mesh) else None
        if not complete or len(self.errors) > errors:
            return INVALID
        part = cls.model_construct(_fields_set=set(node.entries), **values)
        if mesh is not None:
            self._meshes[id(part)] = mesh
        return self._in_bands(part, node, path) if isinstance(part, Strength) else part

    def _in_bands(self, light: Strength, node: MapNode, path: Path) -> Strength | Invalid:
        try:
            return in_bands(light, self.context.units)
        except CannotResolve as failed:
            self._problem(Problem(failed.path, failed.allowed, failed.note), node, path)
            return INVALID

    def _field(self, name: str, kind: Kind, field: FieldInfo, node: MapNode, path: Path) -> Any:
        child = node.entries.get(name)
        if child is None:
            if not field.is_required():
                return field.get_default(call_default_factory=True)
            other = next((item.keys for item in field.metadata if isinstance(item, OrFrom)), ())
            if any(key in node.entries for key in other):
                return ZERO  # until it is worked out
            note = f" (or one of {', '.join(other)})" if other else ""
            self.error_at(node.place, f"missing key '{name}' in {self._owner(path)}, allowed {_allowed_words(kind)}{note}")
            return INVALID
        value = self._value(kind, child, (*path, name))
        return value if value is INVALID or self._term_exists(value, field, child, (*path, name)) else INVALID

    def _term_exists(self, value: Any, field: FieldInfo, node: Node, path: Path) -> bool:
        """Whether the scene's model has the term, or it keeps its default."""
        only = next((item for item in field.metadata if isinstance(item, OnlyIn)), None)
        default = field.get_default(call_default_factory=True)
        if only is None or value == default or self.context.model in only.models or self.context.model not in LIGHTING_MODELS:
            return True
        words = f"only its default, {_default_words(default)}, in {scene_of(self.context.model)}"
        self._not_allowed(node, path, words, f" (the model {only} has this term)")
        return False

    def _unknown_keys(self, cls: type[Part], node: MapNode, path: Path) -> None:
        for key, place in node.keys.items():
            if key in cls.model_fields:
                continue
            note = hint(key, cls.model_fields, otherwise=f", allowed {', '.join(cls.model_fields)}")
            self.error_at(place, f"unknown key '{shortened(key)}' in {self._owner(path)}{note}")

    def _check(self, cls: type[Part], values: dict[str, Any], node: MapNode, path: Path) -> None:
        for check in checks_of(cls):
            if all(name in values for name in check.needs):
                for problem in check.run(SimpleNamespace(**values), node, self.context):
                    self._problem(problem, node, path)

    def _problem(self, problem: Problem, node: MapNode, path: Path) -> None:
        found, inside = walk(node, problem.path)
        if problem.message is not None:
            report = self.warn_at if problem.warning else self.error_at
            report(problem.place or found.place, problem.message)
        elif len(inside) == 0 and problem.path:  # the value is a default
            words = f"not given, allowed {problem.allowed}{problem.note}"
            self.error_at(found.place, f"{label(problem.path)} of {self._owner(path)}: {words}")
        else:
            self._not_allowed(found, (*path, *inside), problem.allowed, problem.note)

    def _mesh(self, values: dict[str, Any], node: MapNode, path: Path) -> TriangleMesh | None:
        if not {"file", "vertices", "faces", "vertex_normals"} <= values.keys():
            return None
        values = {"normals": "flat", **values}  # where it is wrong, the triangles are looked at all the same
        try:
            mesh = self.context.meshes.triangles(SimpleNamespace(**values), node)
            self.context.mesh_at[id(node)] = (node, mesh)
            if not triangle_areas(mesh).any():
                self.warn_at(node.place, f"{self._owner(path)}: none of its triangles has an area, so nothing is seen of it")
            return mesh
        except MeshError as failed:
            self._problem(Problem(failed.path, failed.allowed, failed.note), node, path)
        except SpecErrors as failed:  # located in the mesh file
            self.errors.extend(failed.errors)
        return None


def _default_words(default: Any) -> str:
    """As one would write it: equal bands as one number."""
    number = default[0] if isinstance(default, tuple) and len(set(default)) == 1 else default
    return number_text(number) if isinstance(number, int | float) else str(number)


def _allowed_words(kind: Kind) -> str:
    if isinstance(kind, Leaf):
        return kind.allowed.text
    return "a mapping" if isinstance(kind, PartOf) or kind.container == "mapping" else "a list"


def _word_note(words: tuple[str, ...], node: Node) -> str:
    """The nearest of the words that are allowed."""
    return hint(node.value, words) if isinstance(node, ScalarNode) and isinstance(node.value, str) else ""
