"""The adapter as the engine sees it."""

from __future__ import annotations

import subprocess
import sys
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

from equilux.adapter import Adapter, Limits, Program, RawRender, RendererFailed
from equilux_adapters.vtk import ADAPTER
from equilux_adapters.vtk.knobs import VtkKnobs
from equilux_scenes.features import FEATURES

FACTS = {"facets": {"normal": {}, "position_m": {}, "film_px": 0.0}, "set_back_m": {}, "lights": 0, "exponent": 0.0}
FACTS |= {"reach_m": {}, "cone_px": 0.0, "horizon": 0.0}


def test_it_is_an_adapter():
    assert isinstance(ADAPTER, Adapter)
    assert ADAPTER.name == "vtk"


def test_every_feature_of_the_model_has_a_capability_and_no_other_has():
    assert set(ADAPTER.capabilities()) == set(FEATURES)


def test_version_and_probe_do_not_import_vtk():
    code = (
        "import sys; from equilux_adapters.vtk import ADAPTER; print(ADAPTER.version(), ADAPTER.probe().found, "
        "any(name.startswith('vtk') for name in sys.modules))"
    )
    out = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True, timeout=60).stdout.split()
    assert out == [metadata.version("vtk"), "True", "False"]


def test_a_missing_package_is_found_missing(monkeypatch):
    def nowhere(name):
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(metadata, "version", nowhere)
    probe = ADAPTER.probe()
    assert not probe.found
    assert "vtk" in probe.detail


@pytest.mark.parametrize("value", [7, 4097, 10.5])
def test_a_tessellation_out_of_range_is_refused(value):
    with pytest.raises(ValidationError):
        VtkKnobs(tessellation=value)


def test_a_script_that_raises_is_a_failed_render_with_its_message(tmp_path):
    (tmp_path / "scene.py").write_text("def picture():\n    raise ValueError('no such light')\n")
    program = Program({}, "scene.py", FACTS)
    with pytest.raises(RendererFailed, match=r"scene\.py: ValueError: no such light"):
        ADAPTER.render(program, tmp_path, tmp_path, Limits(), VtkKnobs())


@pytest.mark.parametrize("content", [None, b"", b"not an array"])
def test_an_image_that_cannot_be_read_is_a_failed_render(content, tmp_path):
    path = tmp_path / "image.npy"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(RendererFailed, match=r"image\.npy"):
        ADAPTER.read(RawRender({"image.npy": path}), Program({}, "scene.py", FACTS), VtkKnobs())


def test_pixels_that_are_not_finite_are_handed_on_as_they_are(tmp_path: Path):
    path, image = tmp_path / "image.npy", np.float32([[[np.nan, np.inf, -np.inf], [0, -1, 2]]])
    np.save(path, image)
    reading = ADAPTER.read(RawRender({"image.npy": path}), Program({}, "scene.py", FACTS), VtkKnobs())
    assert np.array_equal(reading.image, image, equal_nan=True)
