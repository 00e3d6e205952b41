"""Random scenes of model `reflection-equation`, the same on every machine: `random_scenes`, with emitters among them."""

from __future__ import annotations

import math
import random

from support.random_scenes import Spec, _bands, _cross, _direction, random_spec

EMITTERS = ("sphere", "disc", "rectangle", "environment")


def random_emitter_spec(seed: int, *, exponents: tuple[float, float] = (0.1, 60.0), film: tuple[int, int] = (24, 18)) -> Spec:
    """Two to five objects about unit size, one or two emitters near them, now and then a light without an extent."""
    rng = random.Random(f"emitters {seed}")
    spec = random_spec(seed, exponents=exponents, lights=(0, 1), film=film)
    spec["model"] = "reflection-equation"
    del spec["ambient"]
    for material in spec["materials"].values():
        del material["ambient"]
        material["brdf"] = rng.choice(["lambert", "phong-classic", "phong-cosine"])
        if material["brdf"] == "lambert":
            del material["specular"], material["exponent"]
    if rng.random() < 0.7:
        spec["lights"] = {}
    for k in range(rng.randint(1, 2)):
        kind = rng.choice(EMITTERS)
        if kind == "environment":
            if "sky" not in spec["lights"]:
                spec["lights"]["sky"] = {"kind": kind, "radiance": _bands(rng, 2)}
            spec.pop("background", None)
        else:
            spec["lights"][f"e{k}"] = _emitter(rng, kind)
    return spec


def _emitter(rng: random.Random, kind: str) -> Spec:
    side, distance = _direction(rng), rng.uniform(0.5, 2.5)
    center = [distance * c for c in side]
    radiance = [rng.uniform(0.2, 3) for _ in range(3)]
    if kind == "sphere":
        return {"kind": kind, "radiance": radiance, "center": center, "radius": rng.uniform(0.1, 0.6)}
    normal = [-c + 0.5 * w for c, w in zip(side, _direction(rng), strict=True)]
    if kind == "disc":
        return {"kind": kind, "radiance": radiance, "center": center, "normal": normal, "radius": rng.uniform(0.1, 0.7)}
    u = _scaled(_cross(normal, _direction(rng)), rng.uniform(0.2, 1.2))
    v = _scaled(_cross(normal, u), rng.uniform(0.2, 1.2))
    return {"kind": kind, "radiance": radiance, "corner": center, "edge_u": u, "edge_v": v}


def _scaled(v: list[float], length: float) -> list[float]:
    size = math.hypot(*v)
    return [length * c / size for c in v]
