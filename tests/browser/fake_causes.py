"""A results tree whose divergences were diagnosed: declared and undeclared causes, alternatives, remainders, expectations gone.

Pictures and statistics are the fake tree's; what the diagnosis would say of them is written into results.json and run.json.
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from browser.fake_tree import HOSTILE, FakeCase, Image, Sphere, shade, write_tree

WIDTH, HEIGHT = 64, 48
REGION = {
    "pixels": 97,
    "x0": 20,
    "y0": 12,
    "x1": 44,
    "y1": 30,
    "words": "on objects[0] (sphere, clay), in the highlight of light key",
}

CLAMPED = {
    "id": "exponent-clamped", "parameter": 128.0, "words": "the highlight's exponent is cut off at a [max]: max = 128",
    "formula": ["K_spec max(0, R·V)^p", "K_spec max(0, R·V)^min(p, max)"], "recognised": "128", "suspects": "renderer",
    "declared": True, "explained": 1.0, "residual_max_abs": 1.8e-4, "region": REGION,
}  # fmt: skip
SCALED = {
    "id": "scaled", "parameter": math.pi, "words": f"radiance is multiplied by a constant: k = 3.141593 (π) {HOSTILE}",
    "formula": ["L", "k L"], "recognised": "π", "suspects": "renderer", "declared": False, "explained": 0.98,
    "residual_max_abs": 2e-9, "region": REGION | {"x0": 5, "words": HOSTILE},
    "alternatives": [{"id": "intensity-scaled", "parameter": math.pi}, {"id": "diffuse-scaled", "parameter": 3.14}],
}  # fmt: skip
SWAPPED = {
    "id": "bands-permuted", "parameter": "BGR", "words": "bands are in another order (order BGR)",
    "formula": ["R G B", "order BGR"], "suspects": "translation", "declared": False, "explained": 0.88,
    "residual_max_abs": 0.03, "region": REGION,
}  # fmt: skip
LEFT = {
    "id": "unexplained", "explained": 0.12, "words": "12 of 97 diverging pixels are not accounted for", "residual_max_abs": 0.03,
    "region": REGION | {"pixels": 12}, "terms": {"diffuse key": 0.83, "specular key": -0.41, "ambient": 0.02},
}  # fmt: skip
ALL_LEFT = LEFT | {"explained": 1.0, "words": "97 of 97 diverging pixels are not accounted for", "region": REGION}
HALF = {
    "id": "half-vector", "words": "the highlight is (N·H)^p instead of (R·V)^p", "formula": ["(R·V)^p", "(N·H)^p"],
    "suspects": "renderer", "declared": True, "explained": 1.0, "residual_max_abs": 1e-5, "region": REGION,
}  # fmt: skip

DIALECTS: dict[str, list[dict[str, Any]]] = {
    "vtk": [
        {"cause": "exponent-clamped", "parameter": 128.0, "reading": "", "quirk": "Q5", "models": [], "unless": [],
         "words": "the highlight's exponent is cut off at a [max]", "formula": CLAMPED["formula"]},
        {"cause": "half-vector", "parameter": None, "reading": "", "quirk": "", "models": ["opengl", "phong"], "unless": [],
         "words": HALF["words"], "formula": HALF["formula"]},
        {"cause": "occlusion-ignored", "parameter": None, "reading": "", "quirk": "Q11", "models": [], "unless": ["shape.mesh"],
         "words": f"light passes through objects {HOSTILE}", "formula": ["E τ", "E"]},
    ],
    "povray": [],
}  # fmt: skip

WHY: dict[str, dict[str, tuple[list[dict[str, Any]], str]]] = {
    "clamped[exponent=300]": {"vtk": ([CLAMPED], "model-difference")},
    "clamped[exponent=600]": {"vtk": ([CLAMPED], "model-difference")},
    "bright": {"povray": ([SCALED], "implementation-bug")},
    "swapped": {"vtk": ([SWAPPED, LEFT], "translation-bug")},
    "riddle": {"povray": ([ALL_LEFT], "unexplained")},
    "half-gone": {"vtk": ([HALF], "model-difference")},
}
"""Case → adapter → what was found of it, and the finding."""


def _cases() -> list[FakeCase]:
    def clamp(image: Image) -> Image:
        return shade(Sphere(exponent=128), WIDTH, HEIGHT)

    def riddle(image: Image) -> Image:
        return np.where(image > 0.4, image**1.1, image)

    pin = {"adapter": "vtk", "cause": "exponent-clamped", "when": "exponent > 128", "held": True}
    cone = {"adapter": "vtk", "cause": "spot-cone-ignored", "when": None, "held": False}

    def case(scene: str, about: str, sphere: Sphere, **more: Any) -> FakeCase:
        return FakeCase(scene, "light", about, sphere, width=WIDTH, height=HEIGHT, **more)

    half = {"adapter": "vtk", "cause": "half-vector", "when": None, "held": True}
    return [
        *(
            case("clamped", "A declared limit.", Sphere(exponent=p), axes={"exponent": p}, expect=[pin], faults={"vtk": clamp})
            for p in (300, 600)
        ),
        case("bright", "A factor that nobody declared.", Sphere(), faults={"povray": lambda image: image * math.pi}),
        case("swapped", "Bands in another order.", Sphere((0.7, 0.25, 0.1)), faults={"vtk": lambda image: image[..., ::-1]}),
        case("riddle", "Nobody knows.", Sphere(), faults={"povray": riddle}),
        case("gone", "A pin without its divergence.", Sphere(), expect=[cone]),
        case("half-gone", "Two pins, one of them gone.", Sphere(exponent=300), expect=[half, cone], faults={"vtk": clamp}),
    ]


def write_diagnosed_tree(root: Path) -> Path:
    """Write it under `root` and return it."""
    write_tree(root, _cases())
    results = json.loads((root / "results.json").read_text())
    for case in results["cases"]:
        _tell(case, WHY.get(case["case"], {}))
    (root / "results.json").write_text(json.dumps(results))
    run = json.loads((root / "run.json").read_text())
    for name, dialect in DIALECTS.items():
        run["adapters"][name] |= {"dialect": dialect, "title": {"vtk": "VTK", "povray": "POV-Ray"}[name]}
    (root / "run.json").write_text(json.dumps(run))
    return root


def _tell(case: dict[str, Any], found: dict[str, tuple[list[dict[str, Any]], str]]) -> None:
    verdicts = {pair["a"]: pair["verdict"] for pair in case["pairs"] if pair["b"] == "oracle"}
    for pair in case["pairs"]:
        if pair["verdict"] != "diverge":
            continue
        causes = [cause | {"side": name} for name in (pair["a"], pair["b"]) if name in found for cause in found[name][0]]
        pair |= {"causes": causes, "explained": 1 - sum(cause["explained"] for cause in causes if cause["id"] == "unexplained")}
        if pair["b"] == "oracle" and any(item.get("held") is False for item in case["expect"]):
            pair["judged"] = "improved"
    for name in ("povray", "vtk"):
        agrees = verdicts[name] == "agree"
        finding = "as-modelled" if agrees else found[name][1]
        peers = {
            peer: "agree" if agrees and verdicts[peer] == "agree" else "diverge" for peer in ("povray", "vtk") if peer != name
        }
        dialect = None if agrees else "agree" if finding == "model-difference" else "diverge"
        case["renders"][name]["standing"] = {
            "truth": verdicts[name], "dialect": dialect, "peers": peers, "finding": finding,
            "reason": f"agrees with the oracle {HOSTILE}" if agrees else f"because of {finding} {HOSTILE}",
        }  # fmt: skip


if __name__ == "__main__":
    import sys

    print(write_diagnosed_tree(Path(sys.argv[1])))
