"""The adapter as the engine sees it."""

from __future__ import annotations

import subprocess
import sys
from importlib import metadata

import numpy as np
import pytest
from pydantic import ValidationError

from equilux.adapter import Adapter, Limits, Program, RawRender, RendererFailed
from equilux.budget import Geometric
from equilux.uncertainty import MINIMUM_REPEATS, stated
from equilux_adapters.mitsuba import ADAPTER, library
from equilux_adapters.mitsuba.knobs import MitsubaKnobs
from equilux_scenes.features import FEATURES, RESOLVED_FEATURES
from support.mitsuba import case_of_text

SCENE = """
equilux: 1
name: one-light
model: reflection-equation
camera: {projection: perspective, eye: [0, 0, 3], target: [0, 0, 0], fov_y_deg: 30}
film: {width: 2, height: 1}
lights: {sky: {kind: environment, radiance: 1}}
materials: {clay: {diffuse: 0.3}}
objects: [{kind: sphere, center: [0, 0, 0], radius: 0.5, material: clay}]
"""


def program() -> Program:
    return ADAPTER.translate(case_of_text(SCENE), MitsubaKnobs())


def picture(**changes: np.ndarray) -> dict[str, np.ndarray]:
    """As a script leaves it, 1×2 pixels."""
    bands, numbers = np.ones((1, 2, 3)), np.zeros((1, 2), dtype=np.int32)
    whole = {"image": bands, "sigma": 0.01 * bands, "position": 0.5 * bands, "object": numbers, "facing": np.ones((1, 2))}
    return whole | changes


def test_it_is_an_adapter():
    assert isinstance(ADAPTER, Adapter)
    assert ADAPTER.name == "mitsuba"


def test_every_capability_is_of_a_feature_that_exists():
    assert set(ADAPTER.capabilities()) <= set(FEATURES)


def test_every_feature_that_the_reflection_equation_may_need_has_a_capability():
    foreign = ("model.", "viewer.", "shadow.", "light.ambient-", "light.diffuse-", "light.specular-", "material.ambient")
    foreign += ("reflection", "refraction", "transparency")
    needed = {name for name in FEATURES if not name.startswith(foreign)} - set(RESOLVED_FEATURES)
    assert set(ADAPTER.capabilities()) == needed | {"model.reflection-equation"}


def test_version_and_probe_do_not_import_mitsuba():
    code = (
        "import sys; from equilux_adapters.mitsuba import ADAPTER; print(ADAPTER.probe().found, ADAPTER.version(), "
        "any(name.startswith(('mitsuba', 'drjit')) for name in sys.modules), sep='|')"
    )
    out = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True, timeout=60).stdout.strip()
    assert out == f"True|{metadata.version('mitsuba')}, drjit {metadata.version('drjit')}|False"


def test_a_missing_package_is_found_missing(monkeypatch):
    def nowhere(name):
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(metadata, "version", nowhere)
    probe = ADAPTER.probe()
    assert not probe.found
    assert "equilux[mitsuba]" in probe.detail


def test_a_missing_llvm_is_found_missing(monkeypatch):
    monkeypatch.delenv(library.ENVIRONMENT, raising=False)
    monkeypatch.setattr(library, "FOLDERS", ("/nowhere",))
    probe = ADAPTER.probe()
    assert not probe.found
    assert "LLVM" in probe.detail
    assert "17" in probe.detail


@pytest.mark.parametrize(
    ("found", "expected"),
    [
        (["/lib/libLLVM-15.so.1", "/lib/libLLVM-14.so.1"], None),
        (["/lib/libLLVM-15.so.1", "/lib/libLLVM.so.19.1", "/lib/libLLVM-19.so"], "/lib/libLLVM-19.so"),
        (["/lib/libLLVM-17.so.1"], "/lib/libLLVM-17.so.1"),
        (["/lib/libLLVM-9.so.1", "/lib/libLLVM-18.so.1"], "/lib/libLLVM-18.so.1"),
        (["/lib/libLLVMSPIRVLib.so.15"], None),
        ([], None),
    ],
)
def test_the_newest_llvm_that_will_do_is_taken(found, expected):
    assert library.newest(found) == expected


def test_the_llvm_that_the_environment_names_is_taken(monkeypatch, tmp_path):
    named = tmp_path / "libLLVM.so"
    monkeypatch.setenv(library.ENVIRONMENT, str(named))
    assert library.find_llvm() is None
    named.touch()
    assert library.find_llvm() == str(named)


@pytest.mark.parametrize("knobs", [{"samples": 0}, {"samples": 1.5}, {"repeats": 1}, {"repeats": 1 << 13}, {"seeds": 3}])
def test_a_knob_out_of_range_is_refused(knobs):
    with pytest.raises(ValidationError):
        MitsubaKnobs(**knobs)


def test_by_default_there_are_enough_repeats_to_judge_by_and_fewer_are_said_to_be_too_few(tmp_path):
    assert MitsubaKnobs().repeats >= MINIMUM_REPEATS
    np.savez(tmp_path / "picture.npz", **picture())
    raw = RawRender({"picture.npz": tmp_path / "picture.npz"})
    for repeats, is_judged in ((MINIMUM_REPEATS, True), (MINIMUM_REPEATS - 1, False)):
        reading = ADAPTER.read(raw, program(), MitsubaKnobs(repeats=repeats))
        assert (stated(reading.budget, reading.image).obstacle is None) == is_judged, f"{repeats} repeats"


def test_a_script_that_raises_is_a_failed_render_with_its_message(tmp_path):
    (tmp_path / "scene.py").write_text("def picture():\n    raise ValueError('no such light')\n")
    with pytest.raises(RendererFailed, match=r"scene\.py: ValueError: no such light"):
        ADAPTER.render(Program({}, "scene.py"), tmp_path, tmp_path, Limits(), MitsubaKnobs())


@pytest.mark.parametrize("content", [None, b"", b"not an archive"])
def test_a_picture_that_cannot_be_read_is_a_failed_render(content, tmp_path):
    path = tmp_path / "picture.npz"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(RendererFailed, match=r"picture\.npz"):
        ADAPTER.read(RawRender({"picture.npz": path}), program(), MitsubaKnobs())


def test_pixels_that_are_not_finite_are_handed_on_and_leave_the_budget_finite(tmp_path):
    image = np.array([[[np.nan, np.inf, -np.inf], [0, -1, 2]]])
    np.savez(tmp_path / "picture.npz", **picture(image=image, sigma=np.abs(image), position=image, facing=image[..., 0]))
    reading = ADAPTER.read(RawRender({"picture.npz": tmp_path / "picture.npz"}), program(), MitsubaKnobs())
    assert np.array_equal(reading.image, image, equal_nan=True)
    assert np.isfinite(stated(reading.budget, reading.image).bound(np.zeros((1, 2, 3)))).all()


def test_a_surface_at_the_eye_leaves_the_budget_finite_and_says_that_it_may_be_anywhere(tmp_path):
    def film_px(**changes: np.ndarray) -> float:
        np.savez(tmp_path / "picture.npz", **picture(**changes))
        reading = ADAPTER.read(RawRender({"picture.npz": tmp_path / "picture.npz"}), program(), MitsubaKnobs())
        return next(term.film_px for term in reading.budget.terms if isinstance(term, Geometric))

    at_the_eye = np.broadcast_to([0.0, 0.0, 3.0], (1, 2, 3))
    a_degree = 1 / 30  # the film's one pixel is 30° high
    assert film_px() < 1e-3 * a_degree
    assert 10 * a_degree < film_px(position=at_the_eye) < np.inf
    assert 10 * a_degree < film_px(passed=np.array([[True, False]])) < np.inf
