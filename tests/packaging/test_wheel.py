"""The wheel alone is equilux: built from the sources, installed into an empty environment, it runs its own corpus and finds a
third party's adapter. Nothing of the checkout is on the path."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
UV = ROOT / "build/uv/bin/uv"

pytestmark = [pytest.mark.packaging, pytest.mark.slow, pytest.mark.timeout(900)]


def run(*command: str | Path, cwd: Path, expect: int = 0, **environment: str) -> subprocess.CompletedProcess[str]:
    clean = {key: value for key, value in os.environ.items() if key not in ("VIRTUAL_ENV", "PYTHONPATH", "PYTHONHOME")}
    done = subprocess.run(
        [str(part) for part in command], cwd=cwd, env=clean | environment, capture_output=True, text=True, timeout=600
    )
    said = f"{done.stdout[-2000:]}\n{done.stderr[-4000:]}"
    assert done.returncode == expect, f"{command}: exit {done.returncode}, expected {expect}\n{said}"
    return done


@pytest.fixture(scope="session")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Built as a release is. What `make setup` has compiled from the same sources is taken over: a minute less."""
    folder = tmp_path_factory.mktemp("wheel")
    run(UV, "build", "--wheel", "--no-build-isolation", "--python", sys.executable, "--out-dir", folder, ROOT, cwd=folder,
        VIRTUAL_ENV=sys.prefix)
    (path,) = folder.glob("*.whl")
    return path


@pytest.fixture(scope="session")
def environment(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An environment with the locked dependencies and the wheel, and nothing else. Returns its folder."""
    folder = tmp_path_factory.mktemp("installed")
    venv = folder / "venv"
    run(UV, "venv", "--quiet", "--python", sys.executable, venv, cwd=folder)
    inside = {"VIRTUAL_ENV": str(venv), "UV_LINK_MODE": "copy"}
    install = (UV, "pip", "install", "--quiet", "--no-deps")
    sync = (UV, "pip", "sync", "--quiet", "--require-hashes", "--only-binary", ":all:")
    run(*sync, ROOT / "requirements.lock", cwd=folder, **inside)
    run(*install, wheel, cwd=folder, **inside)
    run(*install, "--no-build-isolation", ROOT / "adapters/example", cwd=folder, **inside)
    return venv


def test_the_wheel_holds_the_packages_and_the_corpus_and_no_sources_of_the_extensions(wheel: Path):
    names = zipfile.ZipFile(wheel).namelist()
    tops = {name.split("/")[0] for name in names if ".dist-info" not in name}
    assert tops == {"equilux", "equilux_scenes", "equilux_tracer", "equilux_oracle", "equilux_adapters", "equilux_report"}
    assert sum(name.endswith(".scene.yaml") for name in names) >= 36
    assert "equilux_scenes/corpus/showcase/teapot.ply" in names
    assert "equilux_scenes/scene.schema.json" in names
    for folder in ("equilux_report/templates/", "equilux_report/static/"):
        assert [name for name in names if name.startswith(folder)], f"nothing of {folder} is in the wheel"
    assert not [name for name in names if name.endswith((".cpp", ".h", ".hpp"))]


def test_the_installed_wheel_runs_the_shipped_corpus_and_every_expectation_holds(environment: Path, tmp_path: Path):
    out = tmp_path / "run"
    run(environment / "bin/equilux", "run", "--adapters", "povray,vtk,reference,oracle", "--no-reuse", "--no-html", "--out", out,
        cwd=tmp_path, EQUILUX_CACHE=str(tmp_path / "cache"))
    results = json.loads((out / "results.json").read_text())
    scenes = {case["scene"] for case in results["cases"]}
    assert len(scenes) >= 36
    for name in ("povray", "vtk", "reference"):
        rendered = {case["scene"] for case in results["cases"] if case["renders"][name]["status"] == "ok"}
        assert len(rendered) >= 36, f"{name} rendered {len(rendered)} scenes of {len(scenes)}"
    unexpected = [
        (case["case"], pair["a"], pair["b"], pair["judged"], pair["diverge"], pair["max_abs"])
        for case in results["cases"]
        for pair in case["pairs"]
        if pair["judged"] not in ("agree", "diverge_expected")
    ]
    assert not unexpected
    assert results["summary"]["pairs"]["diverge_unexpected"] == 0 == results["summary"]["pairs"]["improved"]


def test_a_third_partys_adapter_installed_beside_equilux_is_listed_and_agrees_with_the_truth(environment: Path, tmp_path: Path):
    listed = json.loads(run(environment / "bin/equilux", "adapters", "list", "--json", cwd=tmp_path).stdout)
    assert "ballcaster" in json.dumps(listed)
    out = tmp_path / "run"
    (corpus,) = environment.glob("lib/python*/site-packages/equilux_scenes/corpus")
    scenes = [corpus / "materials/diffuse-only.scene.yaml", corpus / "lights/clay-ball.scene.yaml"]
    run(environment / "bin/equilux", "run", *scenes, "--adapters", "ballcaster", "--no-html", "--out", out, cwd=tmp_path,
        EQUILUX_CACHE=str(tmp_path / "cache"))
    cases = {case["case"]: case for case in json.loads((out / "results.json").read_text())["cases"]}
    lambert = cases["diffuse-only"]
    assert lambert["renders"]["ballcaster"]["status"] == "ok"
    verdicts = {(pair["a"], pair["b"]): pair["verdict"] for pair in lambert["pairs"]}
    assert verdicts["ballcaster", "oracle"] == verdicts["ballcaster", "reference"] == "agree"
    unsupported = cases["clay-ball"]["renders"]["ballcaster"]
    assert (unsupported["status"], unsupported["missing_features"]) == ("unsupported", ["material.specular"])


def test_the_example_adapter_imports_nothing_private():
    allowed = ("from equilux.adapter import", "from equilux_ballcaster")
    private = [
        f"{path.name}:{number}: {line.strip()}"
        for path in (ROOT / "adapters/example").rglob("*.py")
        for number, line in enumerate(path.read_text().splitlines(), 1)
        if line.startswith(("import equilux", "from equilux")) and not line.startswith(allowed)
    ]
    assert not private
