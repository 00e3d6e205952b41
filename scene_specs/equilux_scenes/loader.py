"""Spec files → typed scenes and their cases, or every error in them at once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

from equilux_scenes.case import Case
from equilux_scenes.checking import Context
from equilux_scenes.comments import comments_beside
from equilux_scenes.confined import CannotRead, read_bytes
from equilux_scenes.errors import SpecError, SpecErrors
from equilux_scenes.expanding import expand
from equilux_scenes.expectation import applies
from equilux_scenes.limits import Limits, exceeded
from equilux_scenes.meshes import MeshStore
from equilux_scenes.model import Scene
from equilux_scenes.reading import Reader
from equilux_scenes.yaml_tree import ListNode, MapNode, YamlText, YamlTree, parse

SUFFIX = ".scene.yaml"

__all__ = [
    "Limits", "SceneFile", "SpecError", "SpecErrors", "corpus_folder", "load_scene_file", "load_scene_text", "load_scenes",
    "repeated_names",
]  # fmt: skip


@dataclass(frozen=True, eq=False)
class SceneFile:
    """One spec that was read.

    scene: as written, its sweep included. path: the file, None for a text. cases: the last axis varies fastest; one for a scene
    without sweep. warnings: what is allowed and probably not meant. expect_comments: per expectation, the YAML comment beside it.
    name_place: line and column of the scene's name.
    """

    scene: Scene
    path: Path | None
    cases: tuple[Case, ...]
    warnings: tuple[SpecError, ...] = ()
    expect_comments: tuple[str | None, ...] = ()
    name_place: tuple[int, int] = (1, 1)


def corpus_folder() -> Path:
    """The folder of the scenes shipped with equilux."""
    return Path(str(files("equilux_scenes") / "corpus"))


def load_scene_text(
    text: str, name_for_errors: str = "<text>", folder: str | Path | None = None, limits: Limits | None = None
) -> SceneFile:
    """Read one spec from a string; `folder` is where its mesh files are. Raises SpecErrors with every error in it."""
    return _load(text, name_for_errors, None, Path(folder) if folder is not None else None, limits or Limits())


def load_scene_file(path: str | Path, limits: Limits | None = None) -> SceneFile:
    """Read one spec from a file (UTF-8, with or without a byte order mark). Raises SpecErrors with every error in it."""
    limits = limits or Limits()
    path = Path(path)
    return _load(_text_of(path, limits), str(path), path, path.parent, limits)


def load_scenes(paths: Iterable[str | Path], limits: Limits | None = None) -> list[SceneFile]:
    """Read files, and folders recursively (`*.scene.yaml`, in alphabetical order); a file named twice is read once.

    Raises SpecErrors with the errors of all files. Scene names must be unique among them.
    """
    loaded: list[SceneFile] = []
    errors: list[SpecError] = []
    seen: set[Path] = set()
    for path in _named(paths, errors):
        real = path.resolve()
        if real in seen:
            continue
        seen.add(real)
        try:
            loaded.append(load_scene_file(path, limits))
        except SpecErrors as failed:
            errors.extend(failed.errors)
    errors.extend(repeated_names(loaded))
    if errors:
        raise SpecErrors(errors)
    return loaded


def spec_paths(paths: Iterable[str | Path]) -> list[Path]:
    """The files that `load_scenes` would read, in its order; without paths, those of the shipped corpus."""
    return list(_named(list(paths) or [corpus_folder()], []))


def _named(paths: Iterable[str | Path], errors: list[SpecError]) -> Iterator[Path]:
    for path in map(Path, paths):
        if not path.is_dir():
            yield path
            continue
        found = sorted(path.rglob(f"*{SUFFIX}"))
        if not found:
            errors.append(SpecError(str(path), 1, 1, f"folder without scenes, allowed a folder with files named *{SUFFIX}"))
        yield from found


def repeated_names(loaded: Iterable[SceneFile]) -> Iterator[SpecError]:
    """Scenes that bear the name of one before them."""
    first: dict[str, SceneFile] = {}
    for file in loaded:
        other = first.setdefault(file.scene.name, file)
        if other is not file:
            where = f"{other.path}:{other.name_place[0]}:{other.name_place[1]}"
            message = f"name of the scene: got '{file.scene.name}', allowed a name of its own (also given at {where})"
            yield SpecError(str(file.path), *file.name_place, message)


def _text_of(path: Path, limits: Limits) -> str:
    try:
        content = read_bytes(path, limits.file_bytes)
    except CannotRead as failed:
        message = f"cannot be read: {failed.why}, allowed a spec file"
        if failed.size is not None:
            message = exceeded("file_bytes", failed.size, limits.file_bytes, "bytes of the file")
        raise SpecErrors([SpecError(str(path), 1, 1, message)]) from None
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError as failed:
        before = YamlText(str(path), content[: failed.start].decode("utf-8", errors="replace"))
        raise SpecErrors([before.error(len(before.text), f"byte 0x{content[failed.start]:02x}, allowed UTF-8 text")]) from None


def _load(text: str, file: str, path: Path | None, folder: Path | None, limits: Limits) -> SceneFile:
    if len(text) > limits.file_bytes:
        raise SpecErrors([SpecError(file, 1, 1, exceeded("file_bytes", len(text), limits.file_bytes, "bytes of the file"))])
    tree = parse(text, file, limits)
    reader = Reader(tree.source, Context(limits, MeshStore(folder, limits)))
    reader.errors.extend(tree.errors)
    scene = reader.scene(tree.root)
    cases = expand(tree, reader, scene, path, folder)
    if reader.errors or scene is None:
        raise SpecErrors(_in_order(reader.errors, limits))
    return SceneFile(scene, path, cases, _warnings(tree, reader, scene, cases), _expect_comments(tree), _name_place(tree))


def _in_order(errors: list[SpecError], limits: Limits) -> list[SpecError]:
    """By place, each once; beyond the limit only counted."""
    ordered = sorted(set(errors))
    if len(ordered) <= limits.errors:
        return ordered
    last = ordered[limits.errors]
    rest = len(ordered) - limits.errors
    words = f"{rest} more errors (limit 'errors': raise it with --limit errors={len(ordered)})"
    return [*ordered[: limits.errors], SpecError(last.file, last.line, last.column, words)]


def _entry(tree: YamlTree, key: str) -> object:
    return tree.root.entries.get(key) if isinstance(tree.root, MapNode) else None


def _warnings(tree: YamlTree, reader: Reader, scene: Scene, cases: tuple[Case, ...]) -> tuple[SpecError, ...]:
    expect = _entry(tree, "expect")
    for index, expectation in enumerate(scene.expect):
        if isinstance(expect, ListNode) and not any(applies(expectation, case.axes) for case in cases):
            place = expect.items[index].place
            reader.warn_at(place, f"when of expectation {index}: got '{expectation.when}', which holds for no case of the sweep")
    return tuple(sorted(set(reader.warnings)))


def _expect_comments(tree: YamlTree) -> tuple[str | None, ...]:
    expect = _entry(tree, "expect")
    return comments_beside(tree.source, expect) if isinstance(expect, ListNode) else ()


def _name_place(tree: YamlTree) -> tuple[int, int]:
    place = tree.root.entries["name"].place if isinstance(tree.root, MapNode) else tree.root.place
    return place.line, place.column
