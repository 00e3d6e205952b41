"""`equilux run` where nothing has changed since the run that left the tree, and where something has."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from equilux import unchanged
from support.engine import write_scene

PINNED = "expect:\n  - {adapter: good, cause: 'fakes:ramp'}"
BARE = ("--no-html", "--no-diagnose")
UNCHANGED = "nothing has changed since the run of "
MESH = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
MESH += "property list uchar int vertex_indices\nend_header\n-1 -1 0\n1 -1 0\n0 {top} 0\n3 0 1 2\n"

Run = Callable[..., Any]


@pytest.fixture
def run(tiny: Path, equilux: Run) -> Run:
    """`equilux run` on the tiny scene, with options."""
    write_scene(tiny, rest=PINNED)
    return lambda *options, adapters="good": equilux("run", tiny, "--adapters", adapters, *BARE, *options)


def renders() -> dict[str, dict]:
    (case,) = json.loads(Path("equilux-out/results.json").read_text())["cases"]
    return case["renders"]


def test_nothing_is_done_again_and_all_is_told_again(run: Run):
    first = run()
    files = [path for path in Path("equilux-out").rglob("*.*") if path.name not in ("results.json", "inputs.json")]
    times = {path: path.stat().st_mtime_ns for path in files}
    second = run()
    assert UNCHANGED not in first.out
    assert UNCHANGED in second.out
    assert second.code == first.code == 0
    assert second.out.split("\n")[0] == first.out.split("\n")[0]
    assert "(3 ok, 3 reused)" in second.out
    assert all(render["reused"] for render in renders().values())
    assert {path: path.stat().st_mtime_ns for path in times} == times
    assert UNCHANGED in run().out


def test_the_machine_form_is_results_json_here_too(run: Run):
    run()
    said = run("--json")
    assert UNCHANGED in said.err
    assert json.loads(said.out) == json.loads(Path("equilux-out/results.json").read_text())


def test_the_exit_code_of_what_stands_stands(tiny: Path, run: Run):
    write_scene(tiny)
    assert [run().code, run().code] == [1, 1]


@pytest.mark.parametrize(
    "change",
    [
        lambda tiny: write_scene(tiny, specular=0.25, rest=PINNED),
        lambda _: Path("equilux-out/cases/tiny/good/render.json").unlink(),
        lambda _: Path("equilux-out/cases/tiny/pairs/good--oracle.exr").write_bytes(b"damaged"),
        lambda _: Path("equilux-out/cases/tiny/good/added.txt").write_text("?"),
        lambda _: Path("equilux-out/inputs.json").write_text("{"),
        lambda _: os.utime("equilux-out/cases/tiny/good/image.exr"),
    ],
    ids=["scene", "file lost", "file damaged", "file added", "record damaged", "file touched"],
)
def test_what_has_changed_is_looked_at_again(tiny: Path, run: Run, change: Callable[[Path], object]):
    run()
    change(tiny)
    said = run()
    assert UNCHANGED not in said.out
    assert said.code == 0
    assert UNCHANGED in run().out


@pytest.mark.parametrize("options", [("--no-reuse",), ("--set", "level=2"), ("--timeout", "7"), ("--fail-fast",)])
def test_what_is_asked_otherwise_is_done(run: Run, options: tuple[str, ...]):
    run()
    assert UNCHANGED not in run(*options).out


def test_other_adapters_are_another_run(run: Run):
    run()
    assert UNCHANGED not in run(adapters="good,nan").out


def test_a_new_scene_in_the_folder_is_seen(elsewhere: Path, equilux: Run):
    folder = elsewhere / "scenes"
    folder.mkdir()
    write_scene(folder / "one.scene.yaml", rest=PINNED)
    said = [equilux("run", folder, "--adapters", "good", *BARE) for _ in range(2)]
    assert [UNCHANGED in each.out for each in said] == [False, True]
    text = (folder / "one.scene.yaml").read_text()
    (folder / "two.scene.yaml").write_text(text.replace("name: tiny", "name: other"))
    assert "2 cases" in equilux("run", folder, "--adapters", "good", *BARE).out


def test_a_changed_mesh_is_seen(elsewhere: Path, equilux: Run):
    (elsewhere / "one.ply").write_text(MESH.format(top=1))
    (elsewhere / "mesh.scene.yaml").write_text(
        "equilux: 1\nname: mesh\nmodel: phong\nfilm: {width: 8, height: 6}\n"
        "camera: {projection: perspective, eye: [0, 0, 4], target: [0, 0, 0], fov_y_deg: 40}\n"
        "lights: {key: {kind: point, position: [2, 3, 4], intensity: 9}}\nmaterials: {clay: {diffuse: 0.2}}\n"
        "objects: [{kind: mesh, file: one.ply, normals: flat, material: clay}]\n"
    )
    said = [equilux("run", "mesh.scene.yaml", "--adapters", "reference", *BARE) for _ in range(2)]
    assert [UNCHANGED in each.out for each in said] == [False, True]
    (elsewhere / "one.ply").write_text(MESH.format(top=0.5))
    assert UNCHANGED not in equilux("run", "mesh.scene.yaml", "--adapters", "reference", *BARE).out


def test_a_render_that_failed_is_tried_again(run: Run):
    assert [run(adapters="good,raising").code for _ in range(2)] == [3, 3]
    assert not Path("equilux-out/inputs.json").exists()


@pytest.mark.parametrize(("version", "left"), [("3.7", True), ("unknown: it does not say", False)])
def test_a_renderer_whose_version_is_unknown_is_asked_every_time(elsewhere: Path, version: str, left: bool):
    unchanged.remember(elsewhere, {"adapters": {"povray": {"version": version}}}, [], SimpleNamespace(cases=[]), 20.0)
    assert (elsewhere / "inputs.json").exists() == left


def test_a_full_disk_costs_no_more_than_the_next_run(elsewhere: Path, monkeypatch: pytest.MonkeyPatch):
    def full(path: Path, content: object) -> None:
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr(unchanged, "write_json", full)
    unchanged.remember(elsewhere, {"adapters": {}}, [], SimpleNamespace(cases=[]), 20.0)
    assert list(elsewhere.iterdir()) == []


def test_github_is_told_every_time(run: Run, monkeypatch: pytest.MonkeyPatch):
    run()
    monkeypatch.setenv("GITHUB_ACTIONS", "true")
    assert UNCHANGED not in run().out


def test_a_tree_whose_store_is_lost_is_rendered_anew(run: Run):
    """The store holds the budgets, and without its budget a render would be diagnosed otherwise than at first."""
    run()
    Path("equilux-out/inputs.json").unlink()
    shutil.rmtree(".cache/renders")
    assert "(3 ok)" in run().out
