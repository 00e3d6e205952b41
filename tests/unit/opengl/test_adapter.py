"""The adapter as the engine sees it."""

from __future__ import annotations

import importlib.util
import math
import os
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

from equilux.adapter import Adapter, Limits, Program, RawRender, RendererFailed
from equilux_adapters.opengl import ADAPTER
from equilux_adapters.opengl.kit.context import why_not
from equilux_adapters.opengl.knobs import OpenGLKnobs
from equilux_scenes.causes import is_known
from equilux_scenes.features import FEATURES

FACTS = {
    "camera": {"projection": "orthographic", "eye": [0, 0, 1], "target": [0, 0, 0], "up": [0, 1, 0], "height_m": 1},
    "film": {"width": 2, "height": 1}, "lights": [], "surfaces": [], "round": [], "ambient": [0, 0, 0], "local_viewer": True,
    "film_px": 0.0, "set_back_m": {},
}  # fmt: skip


def test_it_is_an_adapter():
    assert isinstance(ADAPTER, Adapter)
    assert ADAPTER.name == "opengl"


def test_every_cause_that_stands_for_a_lack_is_known_and_stands_for_a_feature_that_is_lacking():
    for feature, cause in ADAPTER.lack_causes.items():
        assert is_known(cause), cause
        assert ADAPTER.capabilities()[feature].level == "none", feature


def test_every_capability_is_of_a_feature_of_the_spec():
    assert set(ADAPTER.capabilities()) <= set(FEATURES)


def test_version_and_probe_do_not_import_opengl():
    code = (
        "import sys; from equilux_adapters.opengl import ADAPTER; print(ADAPTER.version(), ADAPTER.probe().found, "
        "any(name.startswith('OpenGL') for name in sys.modules))"
    )
    out = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True, timeout=60).stdout.split()
    assert out == ["PyOpenGL", metadata.version("PyOpenGL"), "True", "False"]


def test_a_missing_package_is_found_missing(monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    probe = ADAPTER.probe()
    assert not probe.found
    assert "PyOpenGL" in probe.detail


@pytest.mark.parametrize("knobs", [{"triangle_px": 0}, {"triangle_px": math.nan}, {"tessellation": 7}, {"tessellation": 20.5}])
def test_knobs_out_of_range_are_refused(knobs):
    with pytest.raises(ValidationError):
        OpenGLKnobs(**knobs)


def test_a_script_that_raises_is_a_failed_render_with_its_message(tmp_path):
    (tmp_path / "scene.py").write_text("def scene():\n    raise ValueError('no such light')\n")
    with pytest.raises(RendererFailed, match=r"scene\.py: ValueError: no such light"):
        ADAPTER.render(Program({}, "scene.py", FACTS), tmp_path, tmp_path, Limits(), OpenGLKnobs())


@pytest.mark.parametrize("content", [None, b"", b"not an array"])
def test_an_image_that_cannot_be_read_is_a_failed_render(content, tmp_path):
    path = tmp_path / "image.npy"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(RendererFailed, match=r"image\.npy"):
        ADAPTER.read(RawRender({"image.npy": path}), Program({}, "scene.py", FACTS), OpenGLKnobs())


def test_pixels_that_are_not_finite_are_handed_on_as_they_are(tmp_path: Path):
    path, image, drawn = tmp_path / "image.npy", np.float32([[[np.nan, np.inf, -np.inf], [0, -1, 2]]]), tmp_path / "drawn.npz"
    np.save(path, image)
    np.savez(drawn)
    reading = ADAPTER.read(RawRender({"image.npy": path, "drawn.npz": drawn}), Program({}, "scene.py", FACTS), OpenGLKnobs())
    assert np.array_equal(reading.image, image, equal_nan=True)


STARTED = "from equilux_adapters.opengl.kit.context import started; print(started()['window'], started()['opengl_lights'])"


@pytest.mark.parametrize(("platform", "window"), [("egl", "EGL"), ("osmesa", "OSMesa")])
def test_each_platform_gives_a_context_with_eight_lights_and_no_display(platform, window):
    if reason := why_not(platform):
        pytest.skip(reason)
    lights = _python(STARTED, PYOPENGL_PLATFORM=platform)
    name, count = lights.split()
    assert name == window
    assert int(count) >= 8, f"{count} lights"


def test_where_egl_has_no_surfaceless_platform_osmesa_is_taken():
    if reason := why_not("osmesa"):
        pytest.skip(reason)
    without = (
        "from equilux_adapters.opengl.kit import context; real = context.why_not\n"
        "context.why_not = lambda platform: 'not here' if platform == 'egl' else real(platform)\n"
        "print(context.started()['window'])"
    )
    assert _python(without).strip() == "OSMesa"


def test_without_any_platform_both_reasons_are_given():
    without = (
        "from equilux_adapters.opengl.kit import context; context.why_not = lambda platform: f'no {platform}'\n"
        "try: context.started()\nexcept RuntimeError as error: print(error)"
    )
    assert _python(without).strip() == "no OpenGL without a display: egl: no egl; osmesa: no osmesa"


def _python(code: str, **environment: str) -> str:
    kept = {key: value for key, value in os.environ.items() if key not in ("PYOPENGL_PLATFORM", "DISPLAY", "WAYLAND_DISPLAY")}
    ran = subprocess.run(
        [sys.executable, "-c", code], check=False, capture_output=True, text=True, timeout=120, env=kept | environment
    )
    assert ran.returncode == 0, ran.stderr
    return ran.stdout
