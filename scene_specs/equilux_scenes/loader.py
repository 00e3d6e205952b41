"""Spec files → typed scenes and their cases, or every error in them at once."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from equilux_scenes.case import Case
from equilux_scenes.errors import SpecError, SpecErrors, number_text
from equilux_scenes.limits import Limits
from equilux_scenes.mesh import MeshData, TriangleMesh, resolve
from equilux_scenes.model import Mesh, Scene
from equilux_scenes.yaml_tree import ListNode, MapNode, YamlTree, parse, plain


@dataclass(frozen=True, eq=False)
class SceneFile:
    """One spec that was read: the scene as written, and its cases (one without a sweep)."""

    scene: Scene
    path: Path | None
    cases: tuple[Case, ...]
    warnings: tuple[SpecError, ...] = ()
    expect_comments: tuple[str | None, ...] = ()


def corpus_folder() -> Path:
    """The folder of the scenes shipped with equilux."""
    return Path(str(files("equilux_scenes") / "corpus"))


def load_scene_text(text: str, name_for_errors: str = "<text>", folder: Path | None = None, limits: Limits | None = None) -> SceneFile:
    """Read one spec from a string. Raises SpecErrors."""
    return _load(text, name_for_errors, None, folder, limits or Limits())


def load_scene_file(path: str | Path, limits: Limits | None = None) -> SceneFile:
    """Read one spec from a file. Raises SpecErrors."""
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8", errors="strict")
    except (OSError, UnicodeDecodeError) as error:
        raise SpecErrors([SpecError(str(path), 1, 1, f"cannot be read: {error}")]) from None
    return _load(text, str(path), path, path.parent, limits or Limits())


def load_scenes(paths: Iterable[str | Path], limits: Limits | None = None) -> list[SceneFile]:
    """Read files and folders (recursively `*.scene.yaml`). Raises SpecErrors with the errors of all of them."""
    loaded: list[SceneFile] = []
    errors: list[SpecError] = []
    for path in _spec_paths(paths):
        try:
            loaded.append(load_scene_file(path, limits))
        except SpecErrors as failed:
            errors.extend(failed.errors)
    if errors:
        raise SpecErrors(errors)
    return loaded


def _spec_paths(paths: Iterable[str | Path]) -> Iterator[Path]:
    for path in map(Path, paths):
        if path.is_dir():
            yield from sorted(path.rglob("*.scene.yaml"))
        else:
            yield path


def _load(text: str, file: str, path: Path | None, folder: Path | None, limits: Limits) -> SceneFile:
    tree = parse(text, file, limits)
    if tree.errors:
        raise SpecErrors(tree.errors)
    content = plain(tree.root)
    scene = _scene(content, tree)
    cases = tuple(_cases(content, scene, tree, path, folder))
    return SceneFile(scene, path, cases)


def _scene(content: Any, tree: YamlTree) -> Scene:
    try:
        return Scene.model_validate(content)
    except ValidationError as failed:
        raise SpecErrors(
            SpecError(tree.source.file, *_where(tree, error["loc"]), f"{'.'.join(map(str, error['loc']))}: {error['msg']}, got {error['input']}")
            for error in failed.errors()
        ) from None


def _where(tree: YamlTree, loc: tuple[Any, ...]) -> tuple[int, int]:
    node = tree.root
    for part in loc:
        if isinstance(node, MapNode) and part in node.entries:
            node = node.entries[part]
        elif isinstance(node, ListNode) and isinstance(part, int) and part < len(node.items):
            node = node.items[part]
    return node.place.line, node.place.column


def _cases(content: Any, scene: Scene, tree: YamlTree, path: Path | None, folder: Path | None) -> Iterator[Case]:
    axes = list(scene.sweep)
    for picks in itertools.product(*(list(enumerate(scene.sweep[axis].values)) for axis in axes)):
        swept = content
        for axis, (_, value) in zip(axes, picks, strict=True):
            swept = _replaced(swept, scene.sweep[axis].path.split("."), value)
        case_scene = _scene({**swept, "sweep": {}}, tree)
        labels = [f"{axis}={_label(index, value)}" for axis, (index, value) in zip(axes, picks, strict=True)]
        name = scene.name + (f"[{','.join(labels)}]" if labels else "")
        values = {axis: value for axis, (_, value) in zip(axes, picks, strict=True)}
        yield Case(name, case_scene, scene.name, values, path, folder, _meshes(case_scene, folder))


def _label(index: int, value: Any) -> str:
    return number_text(value) if isinstance(value, int | float) and not isinstance(value, bool) else f"#{index}"


def _replaced(content: Any, keys: list[str], value: Any) -> Any:
    if not keys:
        return value
    key, *rest = keys
    if isinstance(content, tuple):
        return tuple(_replaced(item, rest, value) if str(index) == key else item for index, item in enumerate(content))
    return {**content, key: _replaced(content.get(key, {}), rest, value)}


def _meshes(scene: Scene, folder: Path | None) -> Mapping[int, TriangleMesh]:
    found = {}
    for index, obj in enumerate(scene.objects):
        if isinstance(obj, Mesh) and obj.vertices is not None and obj.faces is not None:
            normals = None if obj.vertex_normals is None else np.array(obj.vertex_normals, dtype=np.float64)
            data = MeshData(np.array(obj.vertices, dtype=np.float64), np.array(obj.faces, dtype=np.int64), normals)
            found[index] = resolve(data, obj.normals)
    return found
