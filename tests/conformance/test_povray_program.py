"""The saved program and its surroundings: it reproduces the image by hand, and nothing of the user's changes it."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from equilux.adapter import Limits, RendererFailed
from equilux_adapters.povray import ADAPTER
from equilux_adapters.povray.png import read_codes
from support.povray import case_of_text, run

SCENE = """
equilux: 1
name: two-lights
model: phong
camera: {projection: perspective, eye: [0, 0, 3], target: [0, 0, 0], fov_y_deg: 30}
film: {width: 24, height: 18}
lights:
  key: {kind: point, position: [2, 2, 3], intensity: 7}
  fill: {kind: directional, direction: [1, -0.2, -1], irradiance: [0.1, 0.2, 0.3]}
materials: {clay: {diffuse: [0.5, 0.2, 0], specular: [0, 0.3, 0.1], exponent: 30}}
objects: [{kind: sphere, center: [0, 0, 0], radius: 0.7, material: clay}]
"""


@pytest.fixture
def elsewhere() -> Iterator[Path]:
    """A folder neither below /tmp nor below the home folder, where POV-Ray's default configuration permits nothing."""
    folder = Path(tempfile.mkdtemp(dir="/var/tmp"))
    yield folder
    shutil.rmtree(folder)


def test_the_command_lines_repeated_by_hand_give_the_same_files(tmp_path):
    result = run(case_of_text(SCENE), tmp_path / "run")
    by_hand = tmp_path / "by-hand"
    shutil.copytree(tmp_path / "run" / "program", by_hand)
    commands = result.raw.program_files["command.txt"].decode()
    subprocess.run(["sh", "-e"], input=commands, text=True, cwd=by_hand, check=True, capture_output=True)
    assert len(result.raw.files) >= 2
    for name, path in result.raw.files.items():
        # not the bytes: a PNG carries the time it was written
        assert np.array_equal(read_codes(by_hand / name, 24, 18), read_codes(path, 24, 18)), f"{name} differs"


def test_the_run_may_lie_anywhere(elsewhere, tmp_path):
    case = case_of_text(SCENE)
    assert np.array_equal(run(case, elsewhere / "run").image, run(case, tmp_path / "run").image)


def test_nothing_of_the_user_changes_the_image(tmp_path, monkeypatch):
    case = case_of_text(SCENE)
    expected = run(case, tmp_path / "plain").image
    home = tmp_path / "home"
    settings = "Quality=1\nAntialias=On\nFile_Gamma=2.2\nWidth=5\nStart_Row=3\nDeclare=Exposure=9\nOutput_Alpha=On\n"
    (home / ".povray" / "3.7").mkdir(parents=True)
    (home / ".povray" / "3.7" / "povray.ini").write_text(settings)
    (home / ".povray" / "3.7" / "povray.conf").write_text("[File I/O Security]\nrestricted\n[Permitted Paths]\nread = /nowhere\n")
    (tmp_path / "mine.ini").write_text(settings)
    monkeypatch.setenv("HOME", str(home))
    monkeypatch.setenv("POVINI", str(tmp_path / "mine.ini"))
    monkeypatch.setenv("LC_ALL", "de_DE.UTF-8")
    assert np.array_equal(run(case, tmp_path / "hostile").image, expected)


def test_the_number_of_threads_changes_nothing(tmp_path):
    case = case_of_text(SCENE)
    assert np.array_equal(run(case, tmp_path / "one", threads=1).image, run(case, tmp_path / "three", threads=3).image)


def test_the_program_names_no_place_on_this_machine(tmp_path):
    result = run(case_of_text(SCENE), tmp_path)
    for name, content in {**result.program.files, **result.raw.program_files}.items():
        text = content.decode()
        assert str(tmp_path) not in text, name
        assert os.path.expanduser("~") + "/" not in text, name


def test_a_scene_that_povray_does_not_understand_is_a_short_failure(tmp_path):
    knobs = ADAPTER.Knobs()
    program = ADAPTER.translate(case_of_text(SCENE), knobs)
    for folder in ("program", "work"):
        (tmp_path / folder).mkdir()
    for name, content in program.files.items():
        (tmp_path / "program" / name).write_bytes(content.replace(b"camera {", b"camera { sideways"))
    with pytest.raises(RendererFailed, match=r"Parse Error: No matching \}") as caught:
        ADAPTER.render(program, tmp_path / "program", tmp_path / "work", Limits(timeout_s=60.0), knobs)
    assert len(str(caught.value).splitlines()) < 15


def test_the_installed_povray_is_found_and_tells_its_version():
    assert ADAPTER.probe().found
    assert ADAPTER.version().startswith("3.7"), ADAPTER.version()
