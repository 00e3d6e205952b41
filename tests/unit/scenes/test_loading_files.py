"""Files and folders: what cannot be read, several files at once, and mesh files kept to the scene's folder."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from equilux_scenes.loader import SceneFile, SpecErrors, load_scene_file, load_scenes

TRIANGLE_OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


def _errors(run: Callable[[], object]) -> list[str]:
    with pytest.raises(SpecErrors) as caught:
        run()
    return [str(error) for error in caught.value.errors]


def _with_mesh(valid: str, name: str) -> str:
    """The valid spec with a mesh from a file."""
    start = valid.index("    vertices: [[0, 0, 0]")
    end = valid.index("    material: clay\n    transform")
    return valid[:start] + f"    file: {name}\n" + valid[end:]


def test_a_file_loads_like_its_text(tmp_path: Path, valid: str) -> None:
    path = tmp_path / "a.scene.yaml"
    path.write_text(valid, encoding="utf-8")
    file = load_scene_file(str(path))
    assert file.path == path
    assert file.cases[0].source == path
    assert file.cases[0].folder == tmp_path


def test_what_cannot_be_read_is_one_located_error(tmp_path: Path) -> None:
    empty, folder, pipe = tmp_path / "empty", tmp_path / "folder", tmp_path / "pipe"
    empty.touch()
    folder.mkdir()
    os.mkfifo(pipe)
    found = {path.name: _errors(lambda path=path: load_scene_file(path)) for path in (empty, folder, pipe, tmp_path / "absent")}
    assert found == {
        "empty": [f"{empty}:1:1: empty file, allowed a scene spec (it begins with 'equilux: 1')"],
        "folder": [f"{folder}:1:1: cannot be read: a folder, allowed a spec file"],
        "pipe": [f"{pipe}:1:1: cannot be read: not a regular file, allowed a spec file"],
        "absent": [f"{tmp_path / 'absent'}:1:1: cannot be read: no such file, allowed a spec file"],
    }


def test_bytes_that_are_not_utf_8_are_reported_at_their_place(tmp_path: Path) -> None:
    path = tmp_path / "latin.scene.yaml"
    path.write_bytes(b"equilux: 1\nabout: gr" + b"\xfc" + b"n\n")
    assert _errors(lambda: load_scene_file(path)) == [f"{path}:2:10: byte 0xfc, allowed UTF-8 text"]


def test_a_file_name_with_a_line_end_does_not_break_the_line(tmp_path: Path) -> None:
    assert len(_errors(lambda: load_scene_file(tmp_path / "a\nb"))[0].splitlines()) == 1


def test_folders_are_read_recursively_in_order_and_each_file_once(tmp_path: Path, valid: str) -> None:
    (tmp_path / "sub").mkdir()
    for name in ("b", "a", "sub/c"):
        (tmp_path / f"{name}.scene.yaml").write_text(valid.replace("every-part", name.replace("/", "-")), encoding="utf-8")
    (tmp_path / "notes.yaml").write_text("not a scene", encoding="utf-8")
    files = load_scenes([tmp_path, tmp_path / "a.scene.yaml", tmp_path / "sub" / ".." / "b.scene.yaml"])
    assert [file.scene.name for file in files] == ["a", "b", "sub-c"]


def test_the_errors_of_all_files_are_reported_at_once(tmp_path: Path, valid: str) -> None:
    (tmp_path / "a.scene.yaml").write_text(valid.replace("radius: 0.5", "radius: 0"), encoding="utf-8")
    (tmp_path / "b.scene.yaml").write_text(valid.replace("width: 64", "width: 0"), encoding="utf-8")
    errors = _errors(lambda: load_scenes([tmp_path, tmp_path / "absent.scene.yaml"]))
    assert [error.partition(": ")[2] for error in errors] == [
        "radius of object 0 (sphere): got 0, allowed a number > 0",
        "width of film: got 0, allowed an integer ≥ 1",
        "cannot be read: no such file, allowed a spec file",
    ]


def test_a_name_given_twice_is_reported_at_the_second(tmp_path: Path, valid: str) -> None:
    for name in ("a", "b"):
        (tmp_path / f"{name}.scene.yaml").write_text(valid, encoding="utf-8")
    a, b = tmp_path / "a.scene.yaml", tmp_path / "b.scene.yaml"
    words = f"name of the scene: got 'every-part', allowed a name of its own (also given at {a}:2:7)"
    assert _errors(lambda: load_scenes([tmp_path])) == [f"{b}:2:7: {words}"]


def test_a_folder_without_scenes_is_an_error(tmp_path: Path) -> None:
    assert _errors(lambda: load_scenes([tmp_path])) == [
        f"{tmp_path}:1:1: folder without scenes, allowed a folder with files named *.scene.yaml"
    ]


def test_every_scene_of_the_corpus_loads_without_a_warning(corpus: list[SceneFile]) -> None:
    assert len(corpus) >= 36, len(corpus)
    assert [warning for file in corpus for warning in file.warnings] == []


# --- mesh files -------------------------------------------------------------------------------------------------------


def test_a_mesh_file_is_found_in_the_scenes_folder_and_below(tmp_path: Path, valid: str, load: Callable[..., object]) -> None:
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "tri.OBJ").write_text(TRIANGLE_OBJ, encoding="utf-8")
    (tmp_path / "link.obj").symlink_to("sub/tri.OBJ")
    for name in ("sub/tri.OBJ", "./sub/tri.OBJ", "link.obj"):
        load(_with_mesh(valid, name), folder=tmp_path)


OUTSIDE = {
    "../secret.obj": "outside the scene's folder",
    "sub/../../secret.obj": "outside the scene's folder",
    "/etc/passwd.obj": "outside the scene's folder",
    "link.obj": "a symbolic link that leads outside the scene's folder",
    "sub/secret.obj": "a symbolic link that leads outside the scene's folder",
    "absent.obj": "no such file",
    "'a\\b.obj'": "not a file name (folders are separated by '/')",
    "folder.obj": "a folder",
    "pipe.obj": "not a regular file",
}


@pytest.mark.parametrize("name", OUTSIDE)
def test_a_mesh_file_elsewhere_or_unreadable_is_refused(
    tmp_path: Path, valid: str, only_error: Callable[..., str], name: str
) -> None:
    folder = tmp_path / "scenes"
    (folder / "folder.obj").mkdir(parents=True)
    (tmp_path / "secret.obj").write_text(TRIANGLE_OBJ, encoding="utf-8")
    (folder / "link.obj").symlink_to(tmp_path / "secret.obj")
    (folder / "sub").symlink_to(tmp_path)
    os.mkfifo(folder / "pipe.obj")
    message = only_error(_with_mesh(valid, "«" + name), folder=folder)
    got = name.strip("'")
    assert (
        message == f"file of object 6 (mesh): got '{got}', allowed a .obj or .ply file in the scene's folder or below it "
        f"({OUTSIDE[name]})"
    )


def test_a_mesh_file_of_another_kind_is_refused(tmp_path: Path, valid: str, only_error: Callable[..., str]) -> None:
    message = only_error(_with_mesh(valid, "«a.stl"), folder=tmp_path)
    assert message == "file of object 6 (mesh): got 'a.stl', allowed a file name that ends in .obj or .ply"


def test_a_text_has_no_folder_for_mesh_files(valid: str, only_error: Callable[..., str]) -> None:
    assert "allowed inline vertices and faces" in only_error(_with_mesh(valid, "«a.obj"))


def test_a_mesh_file_that_is_too_large_names_the_limit(tmp_path: Path, valid: str, only_error: Callable[..., str]) -> None:
    (tmp_path / "a.obj").write_text(TRIANGLE_OBJ, encoding="utf-8")
    message = only_error(_with_mesh(valid, "«a.obj"), folder=tmp_path, mesh_bytes=10)
    size = len(TRIANGLE_OBJ)
    assert (
        f"bytes of the file, got {size}, allowed at most 10 (limit 'mesh_bytes': raise it with --limit mesh_bytes={size})"
        in message
    )


def test_errors_in_a_mesh_file_are_located_in_it(tmp_path: Path, valid: str) -> None:
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 zero\n", encoding="utf-8")
    scene = tmp_path / "a.scene.yaml"
    scene.write_text(_with_mesh(valid, "a.obj").replace("radius: 0.5", "radius: 0"), encoding="utf-8")
    assert _errors(lambda: load_scene_file(scene)) == [
        f"{tmp_path / 'a.obj'}:2:1: v: got 'zero', allowed a finite number",
        f"{scene}:20:47: radius of object 0 (sphere): got 0, allowed a number > 0",
    ]


def test_objects_of_one_file_share_it(tmp_path: Path, valid: str, load: Callable[..., object]) -> None:
    (tmp_path / "a.obj").write_text(TRIANGLE_OBJ, encoding="utf-8")
    mesh = "  - {kind: mesh, file: a.obj, material: clay}\n"
    file = load(valid.replace("sweep:\n", mesh + mesh + "sweep:\n"), folder=tmp_path)
    meshes = file.cases[0].meshes  # type: ignore[attr-defined]
    assert meshes[7].vertices is meshes[8].vertices
