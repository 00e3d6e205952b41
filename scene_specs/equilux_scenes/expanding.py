"""A spec and its sweep → its cases, with every error of every case at the value that causes it."""

from __future__ import annotations

from pathlib import Path

from equilux_scenes.case import Case
from equilux_scenes.errors import SpecError, shortened
from equilux_scenes.limits import exceeded
from equilux_scenes.model import Scene
from equilux_scenes.reading import Reader
from equilux_scenes.sweep import CASE_NAME_LENGTH, Pick, axes_of, case_name, combinations, count, swept
from equilux_scenes.yaml_tree import MapNode, Node, YamlTree, plain


def expand(tree: YamlTree, reader: Reader, scene: Scene | None, path: Path | None, folder: Path | None) -> tuple[Case, ...]:
    """The cases of a spec, the last axis varying fastest; errors are collected by the reader.

    scene: the spec as written, None if that has errors already; its sweep is looked at all the same.
    """
    if not isinstance(tree.root, MapNode):
        return ()
    axes, errors = axes_of(tree.root, reader.part_at)
    for error in errors:
        reader.error_at(error.place, error.message)
    limit = reader.context.limits.cases
    if count(axes) > limit:
        place = tree.root.keys["sweep"]
        reader.error_at(place, exceeded("cases", count(axes), limit, "cases of the sweep"))
        return ()
    return _Expansion(tree.root, reader, scene, path, folder).cases(list(combinations(axes)))


class _Expansion:
    def __init__(self, root: MapNode, reader: Reader, scene: Scene | None, path: Path | None, folder: Path | None) -> None:
        self.root = root
        self.reader = reader
        self.scene = scene
        self.path = path
        self.folder = folder
        self.errors_as_written = list(reader.errors)
        self.known = set(reader.errors)  # and, later, those of the cases, as first said
        self.found: list[SpecError] = []

    def cases(self, all_picks: list[tuple[Pick, ...]]) -> tuple[Case, ...]:
        cases = []
        for picks in all_picks:
            case = self._case(picks)
            if case is not None:
                cases.append(case)
            if len(self.found) > self.reader.context.limits.errors:
                break
        self.reader.errors[:] = [*self.errors_as_written, *self.found]
        return tuple(cases)

    def _case(self, picks: tuple[Pick, ...]) -> Case | None:
        name = case_name(self.scene.name if self.scene is not None else "scene", picks)
        if len(name.encode()) > CASE_NAME_LENGTH:
            what = f"name of a case: got {len(name.encode())} bytes ('{shortened(name)}'), allowed {CASE_NAME_LENGTH}"
            self._report(self.reader.error(self.root.keys["sweep"], f"{what} (shorten the names of scene and axes)"))
            return None
        scene, errors = self._read(picks)
        for error in errors:
            if error not in self.known:
                self.known.add(error)
                self._report(self._at_its_value(error, picks, name))
        if scene is None or errors:
            return None
        axes = {pick.axis.name: plain(pick.value) for pick in picks}
        fixed = scene.model_copy(update={"sweep": {}})
        return Case(name, fixed, scene.name, axes, self.path, self.folder, self.reader.meshes(scene))

    def _report(self, error: SpecError) -> None:
        if error not in self.found:
            self.found.append(error)

    def _read(self, picks: tuple[Pick, ...]) -> tuple[Scene | None, list[SpecError]]:
        self.reader.errors[:] = []
        scene = self.reader.scene(swept(self.root, picks))
        return scene, list(self.reader.errors)

    def _at_its_value(self, error: SpecError, picks: tuple[Pick, ...], name: str) -> SpecError:
        """An error stands at the swept value that it is about, or else at the one that brings it about.

        It names the case, unless the value is wrong by itself.
        """
        if not picks or error.file != self.reader.source.file:
            return error
        alone = [pick for pick in picks if error in self._errors_of(pick)]
        about = [pick for pick in picks if self._inside(error, pick.value)]
        if about and alone:
            return error
        place = (alone or list(picks))[0].value.place
        line, column = (error.line, error.column) if about else (place.line, place.column)
        return SpecError(error.file, line, column, f"{error.message} (in case '{name}')")

    def _errors_of(self, pick: Pick) -> list[SpecError]:
        """The errors with that one value in place; found by a reader of its own, as this one reports no part twice."""
        reader = Reader(self.reader.source, self.reader.context)
        reader.scene(swept(self.root, (pick,)))
        return reader.errors

    def _inside(self, error: SpecError, node: Node) -> bool:
        end = self.reader.source.place(node.place.end)
        return (node.place.line, node.place.column) <= (error.line, error.column) < (end.line, end.column)
