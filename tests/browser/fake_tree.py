"""Writes a small results tree without any renderer: Phong spheres in numpy, and every state that a report must show.

What the tree holds: a sweep in which one renderer clamps the exponent (pinned), a colour scene with an unexpected divergence, one
with NaN and Inf, one crash, one unsupported, one timeout, one pinned divergence that is gone, one without oracle, one picture of
the wrong size.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio

from equilux.brdf import Brdf, study

Image = npt.NDArray[np.float64]

HOSTILE = "</pre></script><script>window.hacked = 1</script><img src=x onerror='window.hacked = 1'>"
TRUST = {"oracle": 0, "reference": 1}
BUDGETS = {
    "oracle": {"abs": 0.0, "rel": 2.2e-16},
    "reference": {"abs": 1e-12, "rel": 1e-12},
    "povray": {"abs": 7.7e-6, "rel": 1e-7},
    "vtk": {"abs": 1e-9, "rel": 2.4e-7},
}
PHOTOMETRY = {
    "k_m": 683.002,
    "k_m_text": "683.002 lm/W, the SI's",
    "bands": "linear Rec.709 primaries",
    "luminance_weights": [145.232866, 488.461638, 49.307496],
}
VERSIONS = {"oracle": "0.1.0", "reference": "0.1.0 (Embree 3.13.5)", "povray": "3.7.0.10", "vtk": "9.7.2"}


@dataclass(frozen=True)
class Sphere:
    """One Phong sphere under one point light, over a coloured floor: enough to look like a render."""

    diffuse: tuple[float, float, float] = (0.6, 0.6, 0.6)
    specular: tuple[float, float, float] = (0.5, 0.5, 0.5)
    exponent: float = 20.0
    intensity: float = 7.5
    light: tuple[float, float, float] = (0.9, 2.0, 3.0)
    floor: tuple[float, float, float] = (0.0, 0.0, 0.0)


def shade(sphere: Sphere, width: int, height: int) -> Image:
    """(h, w, 3) radiance of the sphere, in double."""
    tan = np.tan(np.radians(15.0))
    x = (2 * (np.arange(width) + 0.5) / width - 1) * width / height * tan
    y = (1 - 2 * (np.arange(height) + 0.5) / height) * tan
    directions = np.stack(np.broadcast_arrays(x[None, :], y[:, None], -1.0), axis=-1)
    directions = directions / np.linalg.norm(directions, axis=-1, keepdims=True)
    eye = np.array([0.0, 0.0, 3.0])
    image = np.zeros((height, width, 3))
    along = -(directions @ eye)
    inside = along**2 - (eye @ eye - 0.25)
    _surface(image, sphere, eye + (along - np.sqrt(np.maximum(inside, 0)))[..., None] * directions, directions, inside > 0, None)
    if any(sphere.floor):
        distance = np.where(directions[..., 1] < -1e-6, -0.5 / np.minimum(directions[..., 1], -1e-6), np.inf)
        hit = (inside <= 0) & np.isfinite(distance) & (distance < 6)
        points = eye + np.where(hit, distance, 1.0)[..., None] * directions
        _surface(
            image, replace(sphere, diffuse=sphere.floor, specular=(0, 0, 0)), points, directions, hit, np.array([0.0, 1.0, 0.0])
        )
    return image


def _surface(image: Image, sphere: Sphere, points: Image, directions: Image, hit: Any, normal: Any) -> None:
    n = points / np.linalg.norm(points, axis=-1, keepdims=True) if normal is None else np.broadcast_to(normal, points.shape)
    to_light = np.array(sphere.light) - points
    distance = np.linalg.norm(to_light, axis=-1, keepdims=True)
    to_light = to_light / distance
    cosine = np.sum(n * to_light, axis=-1, keepdims=True)
    mirror = 2 * cosine * n - to_light
    highlight = np.maximum(np.sum(mirror * -directions, axis=-1, keepdims=True), 0) ** sphere.exponent
    reflected = np.where(cosine > 0, np.array(sphere.diffuse) * cosine + np.array(sphere.specular) * highlight, 0)
    image[hit] = (sphere.intensity / distance**2 * reflected)[hit]


@dataclass
class FakeCase:
    """One case to write: its truth, and what each renderer makes of it (an image, or a dict of a render that gave none)."""

    scene: str
    family: str
    about: str
    sphere: Sphere
    axes: dict[str, Any] = field(default_factory=dict)
    requires: tuple[str, ...] = (
        "camera.perspective",
        "light.point",
        "material.diffuse",
        "material.specular",
        "model.phong",
        "shape.sphere",
    )
    expect: list[dict[str, Any]] = field(default_factory=list)
    faults: Mapping[str, Callable[[Image], Image] | dict[str, Any]] = field(default_factory=dict)
    width: int = 96
    height: int = 72

    @property
    def name(self) -> str:
        return self.scene + (f"[{','.join(f'{k}={v}' for k, v in self.axes.items())}]" if self.axes else "")


def default_cases(width: int = 96, height: int = 72) -> Iterator[FakeCase]:
    for exponent in (1, 10, 100, 1000):
        clamped = shade(Sphere(exponent=min(exponent, 128)), width, height)
        expect = [{"adapter": "vtk", "cause": "exponent-clamped", "when": "exponent > 128"}]
        yield FakeCase(
            "clay-ball",
            "highlight",
            "Point light on a Phong sphere; the whole local formula and nothing else.",
            Sphere(exponent=exponent),
            {"exponent": exponent},
            expect=expect if exponent > 128 else [],
            faults={"vtk": lambda _image, clamped=clamped: clamped},
        )
    yield FakeCase(
        "three-bands",
        "material",
        "Three bands that must not leak into each other.",
        Sphere((0.7, 0.25, 0.1), (0.1, 0.4, 0.9), 12, floor=(0.05, 0.2, 0.5)),
        requires=("light.point", "shape.plane", "shape.sphere"),
        faults={"vtk": lambda image: np.where(image[..., :1] > 0.3, image * 1.004, image)},
    )
    yield FakeCase(
        "broken-floor",
        "robustness",
        "A renderer that writes NaN and Inf.",
        Sphere(exponent=40, floor=(0.3, 0.3, 0.3)),
        faults={"povray": _with_nan},
    )
    crash = {
        "status": "crashed",
        "signal": 11,
        "reason": "the worker was ended by signal 11",
        "stderr_tail": f"Segmentation fault {HOSTILE}",
    }
    lacks = {
        "status": "unsupported",
        "missing_features": ["attenuation.linear"],
        "reason": "attenuation terms near their double root",
    }
    yield FakeCase(
        "crash-test",
        "robustness",
        f"Hostile words: {HOSTILE} & more.",
        Sphere(exponent=3),
        faults={"vtk": crash, "povray": lacks},
    )
    yield FakeCase(
        "slow-mesh",
        "mesh",
        "A mesh has no closed form: the reference is the truth.",
        Sphere((0.2, 0.5, 0.3), exponent=60),
        requires=("light.point", "normals.smooth", "shape.mesh"),
        faults={
            "oracle": {"status": "unsupported", "missing_features": ["shape.mesh"], "reason": "no closed form for a mesh"},
            "povray": {"status": "timeout", "reason": "no image after 120 s"},
        },
    )
    yield FakeCase(
        "half-size",
        "robustness",
        "One renderer returns an image of the wrong size.",
        Sphere(),
        faults={"vtk": lambda image: image[::2, ::2]},
    )
    yield FakeCase(
        "spot-cone",
        "light",
        "A pinned divergence that is gone.",
        Sphere(exponent=5, light=(-1, 2, 2)),
        requires=("light.spot", "shape.sphere"),
        expect=[{"adapter": "vtk", "cause": "spot-cone-ignored", "when": ""}],
    )


def _with_nan(image: Image) -> Image:
    image = image.copy()
    image[30:33, 40:44] = np.nan
    image[50, 10] = np.inf
    image[50, 12] = -np.inf
    image[60, 60, 1] = -0.25
    return image


def write_exr(path: Path, planes: npt.NDArray[Any], names: tuple[str, ...]) -> None:
    spec = oiio.ImageSpec(planes.shape[1], planes.shape[0], planes.shape[2], oiio.FLOAT)
    spec.channelnames = names
    output = oiio.ImageOutput.create(str(path))
    assert output.open(str(path), spec), output.geterror()
    assert output.write_image(np.ascontiguousarray(planes, dtype=np.float32)), output.geterror()
    output.close()


def _observed(adapter: str, truth: Image, seed: int) -> Image:
    """What an adapter without faults returns: the truth as its channel stores it."""
    if adapter == "povray":
        return np.round(truth * 65536) / 65536
    if adapter == "vtk":
        return truth.astype(np.float32).astype(np.float64)
    if adapter == "reference":
        return truth * (1 + 1e-13 * np.random.default_rng(seed).uniform(-1, 1, truth.shape))
    return truth


def _bound(adapter: str, image: Image) -> Image:
    budget = BUDGETS[adapter]
    return budget["abs"] + budget["rel"] * np.abs(np.nan_to_num(image, posinf=0, neginf=0)) + 1e-30


def write_tree(
    root: Path, cases: list[FakeCase] | None = None, adapters: tuple[str, ...] = ("oracle", "povray", "reference", "vtk")
) -> Path:
    """Write a whole run under `root` and return it."""
    entries = [
        _write_case(root, case, adapters, seed) for seed, case in enumerate(list(default_cases()) if cases is None else cases)
    ]
    pairs = [pair for entry in entries for pair in entry["pairs"]]
    renders = [render for entry in entries for render in entry["renders"].values()]
    judged = ("agree", "diverge_expected", "diverge_unexpected", "improved", "not_comparable")
    statuses = ("ok", "unsupported", "missing", "timeout", "crashed", "failed", "invalid")
    run = _manifest(adapters)
    results = {
        "schema": "equilux/results/1",
        "cases": entries,
        "run": run,
        "summary": {
            "cases": len(entries),
            "expectations_used": 2,
            "pairs": {key: sum(pair["judged"] == key for pair in pairs) for key in judged},
            "renders": {key: sum(render["status"] == key for render in renders) for key in statuses},
        },
    }
    root.mkdir(parents=True, exist_ok=True)
    (root / "run.json").write_text(json.dumps(run, indent=1))
    (root / "results.json").write_text(json.dumps(results, indent=1))
    return root


def _manifest(adapters: tuple[str, ...]) -> dict[str, Any]:
    found = {"distribution": "equilux 0.1.0", "found": True, "detail": "found where it was looked for", "error": None}
    return {
        "schema": "equilux/run/1",
        "equilux": "0.1.0",
        "command": ["equilux", "run", "scenes", "--jobs", "2"],
        "clock": {"started": "2025-03-01T10:20:30+00:00", "ended": "2025-03-01T10:21:11+00:00", "seconds": 41.3},
        "interrupted": None,
        "adapters": {name: {"version": VERSIONS[name], **found, "knobs": {"threads": 1}} for name in adapters},
        "libraries": {"numpy": "2.2.0", "Embree": "3.13.5"},
        "machine": {"system": "Linux", "architecture": "x86_64", "cores": 2, "memory_bytes": 8 << 30},
        "options": {"jobs": 2, "timeout_s": 120.0, "reuse": True},
        "identity": {"cases": {}, "adapters": {}},
    }


def _write_case(root: Path, case: FakeCase, adapters: tuple[str, ...], seed: int) -> dict[str, Any]:
    folder = root / "cases" / case.name
    truth = shade(case.sphere, case.width, case.height)
    renders: dict[str, dict[str, Any]] = {}
    images: dict[str, Image] = {}
    for adapter in adapters:
        fault = case.faults.get(adapter)
        image = None if isinstance(fault, dict) else _observed(adapter, truth if fault is None else fault(truth), seed)
        facts = _write_render(folder / adapter, case, adapter, image, fault if isinstance(fault, dict) else {})
        renders[adapter] = {
            key: facts[key] for key in ("status", "seconds", "uncertainty", "missing_features", "reason", "signal")
        }
        if image is not None:
            images[adapter] = image
    (folder / "pairs").mkdir(parents=True)
    (folder / "materials.json").write_text(json.dumps(_materials(case)))
    pairs = []
    by_trust = sorted(images, key=lambda name: (TRUST.get(name, 2), name))
    for rank, b in enumerate(by_trust):
        for a in by_trust[rank + 1 :]:
            pairs.append(_write_pair(folder / "pairs", case, a, b, images[a], images[b], is_truth=rank == 0))
    return {
        "case": case.name,
        "scene": case.scene,
        "model": "phong",
        "requires": list(case.requires),
        "photometry": PHOTOMETRY,
        "about": case.about,
        "scene_file": f"corpus/{case.family}/{case.scene}.scene.yaml",
        "axes": case.axes,
        "width": case.width,
        "height": case.height,
        "expect": case.expect,
        "renders": renders,
        "pairs": pairs,
    }


def _materials(case: FakeCase) -> dict[str, Any]:
    """As the engine writes them: a material whose name is hostile, its bands apart where the sphere's are."""
    grey = len(set(case.sphere.diffuse)) == len(set(case.sphere.specular)) == 1
    bands = {
        band: study(Brdf("phong-classic", case.sphere.diffuse[k], case.sphere.specular[k], case.sphere.exponent)).to_json()
        for k, band in enumerate(("all",) if grey else "rgb")
    }
    material = {"name": f"clay {HOSTILE}", "kind": "phong-classic", "bands": bands}
    return {"schema": "equilux/materials/1", "case": case.name, "materials": [material]}


def _write_render(folder: Path, case: FakeCase, adapter: str, image: Image | None, fault: dict[str, Any]) -> dict[str, Any]:
    (folder / "program").mkdir(parents=True)
    files = {
        "scene.txt": f"// what {adapter} was given for {case.name}\nsphere {{ 0, 0.5 }}\n{HOSTILE}\n".encode(),
        "mesh.bin": bytes(range(256)) * 40,
    }
    for name, data in files.items():
        (folder / "program" / name).write_bytes(data)
    finite = image is None or bool(np.isfinite(image).all())
    facts: dict[str, Any] = {
        "schema": "equilux/render/1",
        "case": case.name,
        "adapter": adapter,
        "status": "ok" if finite else "invalid",
        "missing_features": [],
        "reason": None if finite else "non-finite pixels",
        "signal": None,
        "attempts": 1,
        "version": VERSIONS[adapter],
        "seconds": {"translate": 0.002, "start": 0.31, "render": 0.052, "read": 0.011} | fault.get("seconds", {}),
        "uncertainty": {
            **BUDGETS[adapter],
            "per_pixel": None,
            "film_px": 1e-6,
            "terms": [
                {"name": "storage", "kind": "bound", "reason": "float32 keeps 24 bits of the mantissa", "abs": 0.0, "rel": 6e-8},
                {
                    "name": "tessellation",
                    "kind": "geometric",
                    "reason": "sagitta of the facets",
                    "normal": 2e-5,
                    "position_m": 1e-6,
                    "film_px": 1e-4,
                },
            ],
        },
        "knobs": {"exposures": 3},
        "environment": {"GL_RENDERER": "llvmpipe", "threads": "2"},
        "stderr_tail": "",
        "reused": adapter == "oracle",
        "program": {"entry": "scene.txt", "sha256": "0" * 64, "files": list(files)},
        "image": None,
    } | {key: value for key, value in fault.items() if key != "seconds"}
    if image is not None:
        write_exr(folder / "image.exr", image, ("R", "G", "B"))
        with np.errstate(invalid="ignore"):
            facts["image"] = {
                "width": image.shape[1],
                "height": image.shape[0],
                "dtype": "float64",
                "nan": int(np.isnan(image).sum()),
                "+inf": int((image == np.inf).sum()),
                "-inf": int((image == -np.inf).sum()),
                "negative": int((image < 0).sum()),
            }
        if adapter in TRUST:
            np.save(folder / "image.npy", image)
    else:
        facts["uncertainty"] = None
    (folder / "render.json").write_text(json.dumps(facts, indent=1))
    return facts


def _write_pair(
    folder: Path, case: FakeCase, a: str, b: str, image_a: Image, image_b: Image, *, is_truth: bool
) -> dict[str, Any]:
    if image_a.shape != image_b.shape:
        sizes = [f"{image.shape[1]} × {image.shape[0]}" for image in (image_a, image_b)]
        facts: dict[str, Any] = {
            "a": a,
            "b": b,
            "verdict": "diverge",
            "reason": f"images differ in size: {sizes[0]} and {sizes[1]}",
            "pixels": 0,
            "agree": 0,
            "diverge": 0,
            "edge": 0,
            "invalid": 0,
            "worst": None,
            "explained": None,
            "causes": [],
        }
    else:
        facts = _statistics(folder, a, b, image_a, image_b)
    expect = [item for item in case.expect if item["adapter"] in (a, b)]
    expected = bool(expect) and facts["verdict"] == "diverge"
    judged = {"agree": "agree", "diverge": "diverge_expected" if expected else "diverge_unexpected"}[facts["verdict"]]
    if facts["verdict"] == "agree" and expect and is_truth:
        judged = "improved"
    facts |= {"expected": expected, "judged": judged}
    (folder / f"{a}--{b}.json").write_text(json.dumps(facts, indent=1))
    return facts


def _statistics(folder: Path, a: str, b: str, image_a: Image, image_b: Image) -> dict[str, Any]:
    with np.errstate(all="ignore"):
        difference = image_a - image_b
        bound = _bound(a, image_a) + _bound(b, image_b)
        en = difference / bound
        bad = ~np.isfinite(image_a) | ~np.isfinite(image_b) | (image_a < -bound) | (image_b < -bound)
    classes = np.where(np.abs(np.nan_to_num(en)).max(axis=-1) > 1, 1, 0)
    edge_rows = (classes == 1) & (np.arange(classes.shape[1])[None, :] % 31 == 0)
    classes = np.where(edge_rows, 2, classes)
    classes = np.where(bad.any(axis=-1), 3, classes)
    write_exr(
        folder / f"{a}--{b}.exr",
        np.concatenate([difference, en, classes[..., None]], axis=-1),
        ("R", "G", "B", "en.R", "en.G", "en.B", "class"),
    )
    counted = classes < 2
    absolute, en_abs = np.abs(difference[counted]), np.abs(en[counted])
    y, x = np.unravel_index(np.argmax(np.where(counted, np.abs(np.nan_to_num(en)).max(axis=-1), -1)), classes.shape)
    edges = np.concatenate([[0.0], 10.0 ** (np.arange(-24, 25) / 4), [np.finfo(np.float64).max]])
    kinds = [
        {
            "nan": int(np.isnan(image).sum()),
            "+inf": int((image == np.inf).sum()),
            "-inf": int((image == -np.inf).sum()),
            "negative": int((np.isfinite(image) & (image < -bound)).sum()),
        }
        for image in (image_a, image_b)
    ]
    diverges = bool((classes == 1).any() or (classes == 3).any())
    percentiles = np.percentile(absolute, [50, 95, 99])
    return {
        "a": a,
        "b": b,
        "verdict": "diverge" if diverges else "agree",
        "reason": None,
        "pixels": int(classes.size),
        **{name: int((classes == number).sum()) for number, name in enumerate(("agree", "diverge", "edge", "invalid"))},
        "max_abs": float(absolute.max()),
        "max_rel": float((absolute / np.maximum(np.abs(image_b[counted]), 1e-3)).max()),
        "rms": float(np.sqrt((absolute**2).mean())),
        "bias": float(difference[counted].mean()),
        "p50": percentiles[0],
        "p95": percentiles[1],
        "p99": percentiles[2],
        "edge_max_abs": float(np.abs(difference[classes == 2]).max(initial=0)),
        "flip": None,
        "worst": {"x": int(x), "y": int(y), "a": image_a[y, x].tolist(), "b": image_b[y, x].tolist()},
        "explained": None,
        "causes": [],
        "invalid_kinds": {"a": kinds[0], "b": kinds[1]},
        "film_delta_px": 1e-4,
        "coverage_factor": 1.0,
        "comparer": "1",
        "en_max": float(en_abs.max()),
        "en_histogram": {"edges": edges.tolist(), "counts": np.histogram(en_abs, edges)[0].tolist()},
    }


if __name__ == "__main__":
    import sys

    print(write_tree(Path(sys.argv[1])))
