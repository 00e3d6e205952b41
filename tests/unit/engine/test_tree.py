"""A results tree is continued, replaced or refused, and its files appear whole."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from equilux.complaint import BadUsage
from equilux.tree import RUN_SCHEMA, Tree
from equilux.wholefile import write_json

ONE = {"cases": {"tiny": "abc"}, "adapters": {"good": {"version": "1"}}}
OTHER = {"cases": {"tiny": "abc"}, "adapters": {"good": {"version": "2"}}}


def make_tree(root: Path, identity: object = ONE) -> None:
    root.mkdir()
    write_json(root / "run.json", {"schema": RUN_SCHEMA, "identity": identity})
    (root / "cases" / "tiny" / "good").mkdir(parents=True)
    (root / "cases" / "tiny" / "good" / "render.json").write_text("{}")
    (root / "results.json").write_text("{}")


@pytest.mark.parametrize("exists", [False, True])
def test_an_absent_or_empty_folder_is_taken(tmp_path: Path, exists: bool):
    root = tmp_path / "deep" / "run"
    if exists:
        root.mkdir(parents=True)
    with Tree.open(root, ONE) as tree:
        assert not tree.continued
        assert tree.scratch.is_dir()
    assert list(root.iterdir()) == []


def test_a_tree_of_the_same_identity_is_continued(tmp_path: Path):
    make_tree(tmp_path / "run")
    with Tree.open(tmp_path / "run", ONE) as tree:
        assert tree.continued
    assert (tmp_path / "run" / "cases" / "tiny" / "good" / "render.json").exists()


def test_a_tree_of_another_identity_is_replaced(tmp_path: Path):
    make_tree(tmp_path / "run", OTHER)
    with Tree.open(tmp_path / "run", ONE) as tree:
        assert not tree.continued
    assert list((tmp_path / "run").iterdir()) == []


def test_a_tree_of_the_same_identity_is_replaced_when_nothing_is_to_be_reused(tmp_path: Path):
    make_tree(tmp_path / "run")
    with Tree.open(tmp_path / "run", ONE, keep=False) as tree:
        assert not tree.continued
    assert not (tmp_path / "run" / "cases").exists()


def test_replacing_a_tree_leaves_what_is_not_ours(tmp_path: Path):
    make_tree(tmp_path / "run", OTHER)
    (tmp_path / "run" / "notes.txt").write_text("mine")
    Tree.open(tmp_path / "run", ONE).close()
    assert (tmp_path / "run" / "notes.txt").read_text() == "mine"


@pytest.mark.parametrize("content", ["photos/me.jpg", "run.json", "results.json", "cases/x/render.json"])
def test_a_folder_that_holds_anything_else_is_refused_untouched(tmp_path: Path, content: str):
    path = tmp_path / "home" / content
    path.parent.mkdir(parents=True)
    path.write_text('{"schema": "of somebody else"}')
    with pytest.raises(BadUsage, match="is no results tree; give an empty folder"):
        Tree.open(tmp_path / "home", ONE)
    assert path.read_text() == '{"schema": "of somebody else"}'
    assert sorted(each.name for each in (tmp_path / "home").iterdir()) == [content.split("/")[0]]


def test_a_file_is_refused(tmp_path: Path):
    (tmp_path / "file").write_text("x")
    with pytest.raises(BadUsage, match="is a file, expected a folder"):
        Tree.open(tmp_path / "file", ONE)


def test_a_folder_below_a_file_is_refused(tmp_path: Path):
    (tmp_path / "file").write_text("x")
    with pytest.raises(BadUsage, match="cannot be written: Not a directory"):
        Tree.open(tmp_path / "file" / "run", ONE)


def test_two_runs_cannot_write_one_tree_at_once(tmp_path: Path):
    with Tree.open(tmp_path / "run", ONE), pytest.raises(BadUsage, match="another run is writing"):
        Tree.open(tmp_path / "run", ONE)
    Tree.open(tmp_path / "run", ONE).close()


def test_what_a_killed_run_left_half_done_is_removed(tmp_path: Path):
    make_tree(tmp_path / "run")
    (tmp_path / "run" / ".scratch-dead" / "job-1").mkdir(parents=True)
    Tree.open(tmp_path / "run", ONE).close()
    assert not (tmp_path / "run" / ".scratch-dead").exists()


def test_json_appears_whole_or_not_at_all(tmp_path: Path):
    folder = tmp_path / "folder"
    folder.mkdir()
    write_json(folder / "a.json", {"x": 1})
    with pytest.raises(ValueError, match="Out of range float"):
        write_json(folder / "a.json", {"x": float("nan")})
    assert json.loads((folder / "a.json").read_text()) == {"x": 1}
    assert [path.name for path in folder.iterdir()] == ["a.json"]
