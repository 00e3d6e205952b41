"""A program `povray` that hangs, dies, complains or writes garbage is reported as what it did."""

from __future__ import annotations

import os
import time
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

from equilux.adapter import Limits, RawRender, RendererCrashed, RendererFailed, RendererTimedOut
from equilux_adapters.povray import ADAPTER
from equilux_adapters.povray.render import spoken
from support.povray import case_of_text

SCENE = """
equilux: 1
name: one-ball
model: phong
camera: {projection: perspective, eye: [0, 0, 3], target: [0, 0, 0], fov_y_deg: 30}
film: {width: 6, height: 4}
materials: {glow: {emission: 0.5}}
objects: [{kind: sphere, center: [0, 0, 0], radius: 0.5, material: glow}]
"""
KNOBS = ADAPTER.Knobs()


def put_on_path(folder: Path, monkeypatch: pytest.MonkeyPatch, script: str) -> None:
    """Makes `script` (sh) the program that POV-Ray is taken for; $OUT is the file it is asked for."""
    folder.mkdir(exist_ok=True)
    program = folder / "povray"
    program.write_text(f"#!/bin/sh\nOUT=${{1#Output_File_Name=}}\n{script}\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder}{os.pathsep}{os.environ['PATH']}")


def rendered(folder: Path, timeout_s: float = 20.0) -> RawRender:
    program = ADAPTER.translate(case_of_text(SCENE), KNOBS)
    (folder / "program").mkdir()
    (folder / "work").mkdir()
    for name, content in program.files.items():
        (folder / "program" / name).write_bytes(content)
    return ADAPTER.render(program, folder / "program", folder / "work", Limits(timeout_s=timeout_s), KNOBS)


def test_a_hang_is_a_timeout_and_leaves_no_process(tmp_path, monkeypatch):
    put_on_path(tmp_path / "bin", monkeypatch, f"echo $$ >> {tmp_path}/pids; echo thinking; exec sleep 60")
    started = time.monotonic()
    with pytest.raises(RendererTimedOut, match="thinking"):
        rendered(tmp_path, timeout_s=0.5)
    assert time.monotonic() - started < 10
    for pid in (tmp_path / "pids").read_text().split():
        with pytest.raises(ProcessLookupError):
            os.kill(int(pid), 0)


def test_a_death_by_signal_is_a_crash_with_that_signal(tmp_path, monkeypatch):
    put_on_path(tmp_path / "bin", monkeypatch, "kill -SEGV $$")
    with pytest.raises(RendererCrashed) as caught:
        rendered(tmp_path)
    assert caught.value.signal == 11


def test_a_complaint_is_reported_without_the_banner(tmp_path, monkeypatch):
    banner = "echo 'Persistence of Vision(tm)'; echo '==== [Parsing...] ===='"
    complaint = "echo \"File 'scene.pov' line 8: Parse Error: No matching }\""
    put_on_path(tmp_path / "bin", monkeypatch, f"{banner}; {complaint}; exit 1")
    with pytest.raises(RendererFailed, match=r"status 1: File 'scene\.pov' line 8: Parse Error") as caught:
        rendered(tmp_path)
    assert "Persistence" not in str(caught.value)


def test_one_failure_ends_its_companions(tmp_path, monkeypatch):
    put_on_path(tmp_path / "bin", monkeypatch, 'case "$OUT" in exposure-0*) exit 3;; esac; exec sleep 60')
    started = time.monotonic()
    with pytest.raises(RendererFailed, match="status 3"):
        rendered(tmp_path)
    assert time.monotonic() - started < 10


GARBAGE = {
    "nothing": ("true", "wrote no exposure-0.png"),
    "text": ('echo garbage > "$OUT"', "is no image"),
    "half a file": ('head -c 60 {good} > "$OUT"', "exposure-0.png"),
    "another size": ('cp {large} "$OUT"', r"is 7×4, 3 × uint16, expected 6×4"),
    "eight bits": ('cp {eight} "$OUT"', r"is 6×4, 3 × uint8"),
    "four bands": ('cp {four} "$OUT"', r"is 6×4, 4 × uint16"),
}


def picture(path: Path, width: int, bands: int, dtype: str) -> Path:
    out = oiio.ImageOutput.create(str(path))
    out.open(str(path), oiio.ImageSpec(width, 4, bands, dtype))
    out.write_image(np.zeros((4, width, bands), dtype=dtype))
    out.close()
    return path


@pytest.mark.parametrize("kind", GARBAGE)
def test_garbage_is_a_failure_that_says_what_was_got(kind, tmp_path, monkeypatch):
    files = {
        "good": picture(tmp_path / "good.png", 6, 3, "uint16"), "large": picture(tmp_path / "large.png", 7, 3, "uint16"),
        "eight": picture(tmp_path / "eight.png", 6, 3, "uint8"), "four": picture(tmp_path / "four.png", 6, 4, "uint16"),
    }
    script, message = GARBAGE[kind]
    put_on_path(tmp_path / "bin", monkeypatch, script.format(**files))
    with pytest.raises(RendererFailed, match=message):
        rendered(tmp_path)


def test_an_absent_renderer_is_not_found_and_has_no_version(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    assert not ADAPTER.probe().found
    assert "package povray" in ADAPTER.probe().detail
    assert ADAPTER.version() == "absent"
    with pytest.raises(RendererFailed, match="no program 'povray'"):
        rendered(tmp_path)


def test_a_program_that_cannot_be_run_is_a_failure(tmp_path, monkeypatch):
    put_on_path(tmp_path / "bin", monkeypatch, "")
    (tmp_path / "bin" / "povray").write_text("#!/nonexistent/interpreter\n")
    with pytest.raises(RendererFailed, match="cannot be run"):
        rendered(tmp_path)


def test_the_version_is_what_the_program_says(tmp_path, monkeypatch):
    put_on_path(tmp_path / "bin", monkeypatch, "echo 'POV-Ray 3.9.1-fake.7' >&2")
    assert ADAPTER.version() == "3.9.1-fake.7"
    assert ADAPTER.probe().found


def test_what_is_said_before_the_first_phase_counts_when_there_is_no_phase():
    said = spoken("Problem with option setting\n\nFailed to parse INI file\n")
    assert said == ["Problem with option setting", "Failed to parse INI file"]


def test_a_message_that_got_lost_is_asked_for_again(tmp_path, monkeypatch):
    lost = "echo '==== [Parsing...] ===='; echo 'Fatal error in parser: Cannot parse input.'; echo 'Render failed'; exit 1"
    told = lost.replace("; echo 'Fatal", "; echo 'File line 3: Parse Error: No matching }'; echo 'Fatal")
    put_on_path(tmp_path / "bin", monkeypatch, f"if mkdir {tmp_path}/asked-$OUT 2>/dev/null; then {lost}; else {told}; fi")
    with pytest.raises(RendererFailed, match=r"status 1: .*Parse Error: No matching \}") as caught:
        rendered(tmp_path)
    assert "line 3" in str(caught.value)


def test_a_message_that_never_comes_is_asked_for_only_once(tmp_path, monkeypatch):
    put_on_path(tmp_path / "bin", monkeypatch, f"echo $OUT >> {tmp_path}/asked; echo 'Fatal error in parser: no.'; exit 1")
    with pytest.raises(RendererFailed, match="Fatal error in parser"):
        rendered(tmp_path)
    asked = (tmp_path / "asked").read_text().split()
    assert max(asked.count(name) for name in asked) == 2, asked
