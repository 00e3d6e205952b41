"""Renderers that hang, die, lie or return rubbish: each is recorded for what it is, and the run goes on."""

from __future__ import annotations

import time
from pathlib import Path

import psutil
import pytest

from equilux.results import CaseRecord
from equilux.tree import read_json
from support.engine import LABORATORIES, only_case, pair_of, run
from support.laboratories.fake_laboratories import ADAPTERS, STATE

TIMEOUT_S = 3.0
MEMORY = 300 << 20
WELL_BEHAVED = ("good", "talkative", "bright", "dying-once", "dying-idle")
SLOW_TO_END = ("hanging", "breeding", "closing")


@pytest.fixture(scope="module")
def everything(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, CaseRecord, Path]:
    """One run of one case with every fake there is. Returns the tree, the case and the fakes' marks."""
    folder = tmp_path_factory.mktemp("misbehaviour")
    state = folder / "marks"
    state.mkdir()
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(STATE, str(state))
        patch.syspath_prepend(LABORATORIES)
        finished = run(folder / "run", *ADAPTERS, timeout_s=TIMEOUT_S, memory_bytes=MEMORY)
    assert finished.errors == ()
    assert finished.exit_code == 3
    return folder / "run", only_case(finished), state


EXPECTED = {
    # adapter: status, what its reason says, how often it was tried
    "oracle": ("ok", None, 1),
    "reference": ("ok", None, 1),
    "good": ("ok", None, 1),
    "talkative": ("ok", None, 1),
    "bright": ("ok", None, 1),
    "dying-once": ("ok", None, 2),
    "dying-idle": ("ok", None, 1),
    "slow": ("ok", None, 1),
    "matte": ("ok", None, 1),
    "tunable": ("ok", None, 1),
    "absent": ("missing", "no such program: fake-renderer", 0),
    "untranslatable": ("unsupported", "point lights beyond 3 m", 1),
    "nan": ("invalid", "of 48 pixels: 1 NaN", 1),
    "infinite": ("invalid", "of 48 pixels: 1 +Inf", 1),
    "negative": ("invalid", "of 48 pixels: 1 negative beyond its own uncertainty", 1),
    "blank": ("ok", None, 1),
    "truncated": ("failed", "float32 and shape (5, 8, 3), expected float32 or float64 of shape (6, 8, 3)", 1),
    "transposed": ("failed", "float32 and shape (8, 6, 3), expected float32 or float64 of shape (6, 8, 3)", 1),
    "integers": ("failed", "uint8 and shape (6, 8, 3), expected float32 or float64", 1),
    "listed": ("failed", "an image of type list, expected float32 or float64 of shape (6, 8, 3)", 1),
    "bare": ("failed", "read() returned ndarray, expected equilux.adapter.Reading", 1),
    "boundless": ("failed", "budget term 'b': abs is inf, expected a finite number of at least 0", 1),
    "budgetless": ("failed", "the budget is NoneType, expected equilux.adapter.Budget", 1),
    "hanging": ("timeout", "no picture within 3 s; its process group was ended", 1),
    "breeding": ("timeout", "no picture within 3 s; its process group was ended", 1),
    "timing-out": ("timeout", "fake-renderer took more than 3 s", 1),
    "segfaulting": ("crashed", "the worker was ended by signal 11, SIGSEGV", 2),
    "crashing": ("crashed", "fake-renderer was ended by SIGABRT", 2),
    "hungry": ("crashed", "the memory limit: ", 2),
    "garbling": ("failed", "the worker wrote garbage instead of a reply: the reply starts with the bytes", 2),
    "shouting": ("failed", "the reply is 4294967295 bytes long", 2),
    "lying": ("failed", "expected 'done' of job", 2),
    "closing": ("failed", "the worker ended without a reply (it closed its reply pipe)", 2),
    "leaving": ("failed", "the worker ended without a reply (exit status 0)", 2),
    "raising": ("failed", "ZeroDivisionError: the renderer divided by zero", 1),
    "exiting": ("failed", "SystemExit: the adapter wants to leave", 1),
    "failing": ("failed", "parse error in line 3", 1),
    "escaping": ("failed", "'../../escaped.txt', expected a path inside the program's folder", 1),
    "programless": ("failed", "translate() returned NoneType, expected equilux.adapter.Program", 1),
    "timeless": ("failed", "'render' took nan s, expected a finite number of at least 0", 1),
    "speechless": ("failed", "capabilities() raised KeyError: 'which?'", 0),
}


def test_every_fake_is_expected_to_do_something():
    assert set(EXPECTED) == set(ADAPTERS)


@pytest.mark.parametrize("adapter", EXPECTED)
def test_each_misbehaviour_is_recorded_as_what_it_is(everything: tuple[Path, CaseRecord, Path], adapter: str):
    render = everything[1].renders[adapter]
    status, reason, attempts = EXPECTED[adapter]
    assert (render.status, render.attempts) == (status, attempts), render
    if reason is None:
        assert render.reason is None
    else:
        assert reason in (render.reason or ""), f"got {render.reason!r}, expected it to say {reason!r}"


def test_a_crash_names_its_signal(everything: tuple[Path, CaseRecord, Path]):
    renders = everything[1].renders
    assert {name: renders[name].signal for name in ("segfaulting", "crashing", "hungry", "good")} == {
        "segfaulting": 11, "crashing": 6, "hungry": 9, "good": None,
    }  # fmt: skip


def test_what_a_renderer_prints_is_kept_and_corrupts_nothing(everything: tuple[Path, CaseRecord, Path]):
    out = everything[0] / "cases" / "tiny"
    said = (read_json(out / "talkative" / "render.json") or {})["stderr_tail"]
    assert all(text in said for text in ("C says hello", "a child says hello", "raw bytes on stdout")), said
    assert "about to read address 0" in (read_json(out / "segfaulting" / "render.json") or {})["stderr_tail"]
    assert "ZeroDivisionError" in (read_json(out / "raising" / "render.json") or {})["stderr_tail"]


def test_a_timeout_ends_children_grandchildren_and_orphans_in_sessions_of_their_own(everything: tuple[Path, CaseRecord, Path]):
    pids = [int(pid) for pid in (everything[2] / "children").read_text().split()]
    deadline = time.monotonic() + 5
    while (alive := [pid for pid in pids if _runs(pid)]) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert len(pids) == 3
    assert alive == []


def _runs(pid: int) -> bool:
    try:
        return psutil.Process(pid).status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False


def test_invalid_pictures_are_compared_and_never_pass(everything: tuple[Path, CaseRecord, Path]):
    for adapter in ("nan", "infinite", "negative"):
        pair = pair_of(everything[1], adapter, "oracle")
        assert (pair.verdict, pair.judged, pair.invalid) == ("diverge", "diverge_unexpected", 1), adapter


def test_a_blank_picture_diverges(everything: tuple[Path, CaseRecord, Path]):
    assert pair_of(everything[1], "blank", "oracle").verdict == "diverge"


def test_nothing_is_compared_with_a_render_that_did_not_deliver(everything: tuple[Path, CaseRecord, Path]):
    delivered = {name for name, (status, _, _) in EXPECTED.items() if status in ("ok", "invalid")}
    compared = {name for pair in everything[1].pairs for name in (pair.a, pair.b)}
    assert compared == delivered
    assert len(everything[1].pairs) == len(delivered) * (len(delivered) - 1) // 2


def test_the_well_behaved_agree_beside_all_that(everything: tuple[Path, CaseRecord, Path]):
    verdicts = {name: pair_of(everything[1], name, "oracle").verdict for name in ("good", "talkative", "dying-once", "bright")}
    assert verdicts == {"good": "agree", "talkative": "agree", "dying-once": "agree", "bright": "diverge"}


def test_a_render_that_failed_leaves_no_picture_and_nothing_outside_its_folder(everything: tuple[Path, CaseRecord, Path]):
    case = everything[0] / "cases" / "tiny"
    for adapter, (status, _, _) in EXPECTED.items():
        held = {path.name for path in (case / adapter).iterdir()}
        assert ("image.exr" in held) == (status in ("ok", "invalid")), (adapter, held)
        assert held <= {"render.json", "image.exr", "image.npy", "uncertainty.exr", "program"}, (adapter, held)
    assert not list(everything[0].rglob("escaped.txt"))
    assert not list(everything[0].glob(".scratch*"))


def test_no_worker_outlives_the_run(everything: tuple[Path, CaseRecord, Path]):
    (nursery,) = [child for child in psutil.Process().children() if "equilux.nursery" in child.cmdline()]
    assert [child.cmdline() for child in nursery.children(recursive=True) if child.status() != psutil.STATUS_ZOMBIE] == []
