"""What was made before from the same inputs is not made again, and nothing else is ever taken for it."""

from __future__ import annotations

import multiprocessing
import os
from pathlib import Path

import numpy as np
import pytest

from equilux.planes import read_planes
from equilux.reuse import Store, code_fingerprint, key
from equilux.tree import read_json
from support.engine import only_case, pair_of, renders_made, run, scene


def put(store: Store, name: str, content: bytes = b"content") -> None:
    def fill(folder: Path) -> None:
        (folder / "deep").mkdir()
        (folder / "deep" / "file").write_bytes(content)

    store.put("renders", name, fill)


def fetched(store: Store, name: str, into: Path) -> bytes | None:
    return (into / "deep" / "file").read_bytes() if store.fetch("renders", name, into) else None


def test_an_entry_comes_back_whole(tmp_path: Path):
    store = Store(tmp_path / "store")
    put(store, key(a=1))
    assert fetched(store, key(a=1), tmp_path) == b"content"
    assert fetched(store, key(a=2), tmp_path) is None


@pytest.mark.parametrize("damage", ["changed", "emptied", "removed", "index"])
def test_a_damaged_entry_is_ignored_and_replaced(tmp_path: Path, damage: str):
    store, name = Store(tmp_path / "store"), key(a=1)
    put(store, name)
    entry = tmp_path / "store" / "renders" / name[:2] / name
    path = entry / ("entry.json" if damage == "index" else "deep/file")
    if damage == "removed":
        path.unlink()
    else:
        path.write_bytes(b"" if damage == "emptied" else b"damaged")
    assert fetched(store, name, tmp_path) is None
    if damage == "removed":
        return  # absent files are a miss; the entry is replaced when it is pruned
    put(store, name, b"new")
    assert fetched(store, name, tmp_path) == b"new"


def test_a_store_that_cannot_be_written_remembers_nothing_and_fails_nothing(tmp_path: Path):
    (tmp_path / "store").write_text("a file")
    store = Store(tmp_path / "store")
    put(store, key(a=1))
    assert fetched(store, key(a=1), tmp_path) is None


def test_pruning_drops_what_was_used_longest_ago(tmp_path: Path):
    store = Store(tmp_path / "store", max_bytes=3000)
    for age, name in ((300, "old"), (200, "middle"), (100, "young")):
        put(store, key(name=name), bytes(1000))
        entry = tmp_path / "store" / "renders" / key(name=name)[:2] / key(name=name)
        os.utime(entry, (entry.stat().st_mtime - age,) * 2)
    assert fetched(store, key(name="old"), tmp_path) is not None  # used again: now the youngest
    store.prune()
    left = [name for name in ("old", "middle", "young") if fetched(store, key(name=name), tmp_path) is not None]
    assert left == ["old", "young"]


def _hammer(root: str, number: int) -> None:
    store = Store(Path(root))
    target = Path(root).parent / f"out-{number}"
    for turn in range(50):
        name = key(turn=turn % 5)
        put(store, name, b"same")
        target.mkdir(exist_ok=True)
        assert fetched(store, name, target) in (b"same", None)


def test_many_runs_may_share_a_store(tmp_path: Path):
    context = multiprocessing.get_context("fork")
    workers = [context.Process(target=_hammer, args=(str(tmp_path / "store"), number)) for number in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert [worker.exitcode for worker in workers] == [0] * 4
    assert fetched(Store(tmp_path / "store"), key(turn=0), tmp_path) == b"same"
    assert list((tmp_path / "store" / "incoming").iterdir()) == []


def test_a_changed_source_file_changes_the_fingerprint(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    package = tmp_path / "some_adapter_package"
    package.mkdir()
    (package / "__init__.py").write_text("x = 1\n")
    (package / "table.bin").write_bytes(b"1")
    monkeypatch.syspath_prepend(tmp_path)
    seen = [code_fingerprint.__wrapped__("some_adapter_package")]
    (package / "__init__.py").write_text("x = 2\n")
    seen.append(code_fingerprint.__wrapped__("some_adapter_package"))
    (package / "table.bin").write_bytes(b"2")
    seen.append(code_fingerprint.__wrapped__("some_adapter_package"))
    assert len(set(seen)) == 3


# --- reuse by runs ------------------------------------------------------------------------------------------------------


def test_a_second_run_elsewhere_takes_its_renders_from_the_store(tmp_path: Path, state: Path):
    first = run(tmp_path / "a", "good", store=tmp_path / "store")
    second = run(tmp_path / "b", "good", store=tmp_path / "store")
    assert renders_made(state, "good") == 1
    assert {name: render.reused for name, render in only_case(second).renders.items()} == {"good": True, "oracle": True}
    assert second.results.summary.reused == 2
    assert [pair.model_dump() for pair in only_case(second).pairs] == [pair.model_dump() for pair in only_case(first).pairs]
    one, other = (tmp_path / folder / "cases" / "tiny" for folder in ("a", "b"))
    for file in ("oracle/image.npy", "good/program/scene.txt", "pairs/good--oracle.exr", "pairs/good--oracle.json"):
        assert (one / file).read_bytes() == (other / file).read_bytes(), file
    written, again = (read_planes(folder / "good" / "image.exr") for folder in (one, other))
    assert all(np.array_equal(written[band], again[band]) for band in "RGB")


@pytest.mark.parametrize("change", ["scene", "knob", "version", "no reuse"])
def test_another_scene_knob_or_renderer_version_is_rendered_anew(
    tmp_path: Path, state: Path, monkeypatch: pytest.MonkeyPatch, change: str
):
    run(tmp_path / "a", "good", store=tmp_path / "store")
    if change == "version":
        monkeypatch.setenv("EQUILUX_FAKE_VERSION", "2.0")
    run(
        tmp_path / "b", "good", store=tmp_path / "store", reuse=change != "no reuse",
        scenes=[scene(specular=0.5 if change == "scene" else 0)], settings=["level=2"] if change == "knob" else [],
    )  # fmt: skip
    assert renders_made(state, "good") == 2


def test_a_scene_that_only_got_another_name_is_not_rendered_anew(tmp_path: Path, state: Path):
    run(tmp_path / "a", "good", store=tmp_path / "store")
    run(tmp_path / "b", "good", store=tmp_path / "store", scenes=[scene("renamed")])
    assert renders_made(state, "good") == 1


def test_only_renders_that_are_sound_are_remembered(tmp_path: Path):
    for folder in ("a", "b"):
        case = only_case(run(tmp_path / folder, "nan", "raising", store=tmp_path / "store"))
        assert not case.renders["nan"].reused
        assert not case.renders["raising"].reused
    assert case.renders["nan"].status == "invalid"


def test_judgement_is_made_afresh_over_reused_statistics(tmp_path: Path):
    first = run(tmp_path / "a", "bright", store=tmp_path / "store")
    pinned = [scene(rest="expect:\n  - {adapter: bright, cause: scaled}")]
    second = run(tmp_path / "b", "bright", store=tmp_path / "store", scenes=pinned)
    assert pair_of(only_case(first), "bright", "oracle").judged == "diverge_unexpected"
    assert pair_of(only_case(second), "bright", "oracle").judged == "diverge_expected"
    assert (first.exit_code, second.exit_code, second.results.summary.reused) == (1, 0, 2)


# --- continuing a tree --------------------------------------------------------------------------------------------------


def test_a_tree_is_continued_without_any_store(tmp_path: Path, state: Path):
    run(tmp_path / "run", "good")
    again = run(tmp_path / "run", "good")
    assert renders_made(state, "good") == 1
    assert again.results.summary.reused == 2
    assert pair_of(only_case(again), "good", "oracle").verdict == "agree"


@pytest.mark.parametrize("damage", ["image", "record", "absent"])
def test_a_damaged_render_in_a_continued_tree_is_made_anew(tmp_path: Path, state: Path, damage: str):
    run(tmp_path / "run", "good")
    folder = tmp_path / "run" / "cases" / "tiny" / "good"
    if damage == "image":
        (folder / "image.exr").write_bytes(b"not an image")
    elif damage == "record":
        (folder / "render.json").write_text("{half a rec")
    else:
        for path in (folder / "render.json", folder / "image.exr"):
            path.unlink()
    again = run(tmp_path / "run", "good")
    assert renders_made(state, "good") == 2
    assert only_case(again).renders["good"].status == "ok"
    assert pair_of(only_case(again), "good", "oracle").verdict == "agree"


def test_a_tampered_picture_in_a_continued_tree_is_made_anew(tmp_path: Path, state: Path):
    run(tmp_path / "run", "good")
    path = tmp_path / "run" / "cases" / "tiny" / "oracle" / "image.npy"
    np.save(path, np.load(path) * 2)
    again = run(tmp_path / "run", "good")
    assert renders_made(state, "oracle") == 2
    assert again.exit_code == 0


def test_a_pair_in_a_continued_tree_is_left_where_it_lies_and_made_anew_where_it_is_not_whole(tmp_path: Path):
    first = run(tmp_path / "run", "good")
    folder = tmp_path / "run" / "cases" / "tiny" / "pairs"
    kept = (folder / "good--oracle.exr").stat()
    again = run(tmp_path / "run", "good")
    assert (folder / "good--oracle.exr").stat().st_ino == kept.st_ino, "the pair was written again"
    assert only_case(again).pairs == only_case(first).pairs
    (folder / "good--oracle.exr").unlink()
    run(tmp_path / "run", "good")
    assert (folder / "good--oracle.exr").is_file()


def test_what_failed_is_tried_again_in_a_continued_tree(tmp_path: Path, state: Path):
    run(tmp_path / "run", "good", "raising")
    again = run(tmp_path / "run", "good", "raising")
    assert renders_made(state, "good") == 1
    assert not only_case(again).renders["raising"].reused


def test_other_adapters_replace_the_tree(tmp_path: Path):
    run(tmp_path / "run", "good", "slow")
    run(tmp_path / "run", "good")
    assert not (tmp_path / "run" / "cases" / "tiny" / "slow").exists()
    assert (read_json(tmp_path / "run" / "results.json") or {})["summary"]["renders"]["ok"] == 2
